#include "output/detail/tracks.h"

namespace sunder::output::detail {
namespace {

// q and -q are the same rotation, but a viewer that interpolates between them spins the piece once around.
Quat on_hemisphere_of(const Quat& reference, const Quat& q) { return reference.dot(q) < 0 ? Quat(-q.coeffs()) : q; }

void append_pose(Track& track, float time, const Pose& pose, Quat& previous) {
  const Quat q = on_hemisphere_of(previous, pose.orientation.normalized());
  const Eigen::Vector3f position = pose.position.cast<float>();
  const Eigen::Vector4f rotation = q.coeffs().cast<float>();
  track.times.push_back(time);
  track.translations.push_back({position.x(), position.y(), position.z()});
  track.rotations.push_back({rotation.x(), rotation.y(), rotation.z(), rotation.w()});
  previous = q;
}

void append_visibility(Track& track, float time, bool alive) {
  const float visible = alive ? 1 : 0;
  if (!track.visible.empty() && track.visible.back() == visible) return;
  track.switch_times.push_back(time);
  track.visible.push_back(visible);
}

}  // namespace

std::vector<Track> tracks(const Sequence& sequence) {
  std::vector<Track> result(sequence.pieces.size());
  std::vector<Quat> previous(sequence.pieces.size(), Quat::Identity());
  for (const Frame& frame : sequence.frames) {
    const float time = static_cast<float>(frame.time - sequence.frames.front().time);
    std::vector<bool> alive(sequence.pieces.size(), false);
    for (const auto& [piece, pose, twist] : frame.poses) {
      const std::size_t i = static_cast<std::size_t>(piece);
      alive.at(i) = true;
      append_pose(result[i], time, pose, previous[i]);
    }
    for (std::size_t i = 0; i < result.size(); ++i) append_visibility(result[i], time, alive[i]);
  }
  return result;
}

}  // namespace sunder::output::detail
