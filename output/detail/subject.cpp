#include "output/detail/subject.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace sunder::output::detail {
namespace {

constexpr double kCore = 0.9;    // share of the volume
constexpr double kStep = 0.1;    // of the core's diagonal
constexpr double kStill = 1e-3;  // of a body's diagonal: it has not moved

const Piece& piece_of(const Sequence& sequence, const PiecePose& pose) {
  return sequence.pieces[static_cast<std::size_t>(pose.piece)];
}

std::set<std::string> broken_bodies(const Sequence& sequence) {
  std::set<std::string> names;
  for (const Piece& piece : sequence.pieces)
    if (piece.parent >= 0) names.insert(piece.body);
  return names;
}

/// Broken ones included.
std::set<std::string> moved_bodies(const Sequence& sequence) {
  std::set<std::string> names = broken_bodies(sequence);
  std::vector<const PiecePose*> first(sequence.pieces.size(), nullptr);
  std::vector<double> still;
  for (const Piece& piece : sequence.pieces) {
    const Box box = geometry::bounds(piece.mesh);
    still.push_back(box.isEmpty() ? 0 : kStill * box.diagonal().norm());
  }
  for (const Frame& frame : sequence.frames)
    for (const PiecePose& pose : frame.poses) {
      const auto id = static_cast<std::size_t>(pose.piece);
      if (!first[id]) first[id] = &pose;
      if ((pose.pose.position - first[id]->pose.position).norm() > still[id] ||
          pose.pose.orientation.angularDistance(first[id]->pose.orientation) > kStill)
        names.insert(sequence.pieces[id].body);
    }
  return names;
}

std::vector<Box> boxes(const Sequence& sequence, const Frame& frame) {
  std::vector<Box> result(frame.poses.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Pose& pose = frame.poses[i].pose;
    const Mat3 rotation = pose.orientation.toRotationMatrix();
    for (const Vec3& x : piece_of(sequence, frame.poses[i]).mesh.vertices)
      result[i].extend(pose.position + rotation * x);
  }
  return result;
}

/// Indices of the poses of these bodies' pieces that have a surface.
std::vector<std::size_t> poses_of(const Sequence& sequence, const Frame& frame, const std::set<std::string>& bodies) {
  std::vector<std::size_t> poses;
  for (std::size_t i = 0; i < frame.poses.size(); ++i) {
    const Piece& piece = piece_of(sequence, frame.poses[i]);
    if (!piece.mesh.faces.empty() && bodies.contains(piece.body)) poses.push_back(i);
  }
  return poses;
}

/// Per axis, weighted by volume.
Vec3 median(const Sequence& sequence, const Frame& frame, std::vector<std::size_t> poses) {
  Vec3 result = Vec3::Zero();
  const auto volume = [&](std::size_t i) { return piece_of(sequence, frame.poses[i]).volume; };
  double total = 0;
  for (const std::size_t i : poses) total += volume(i);
  for (int axis = 0; axis < 3; ++axis) {
    const auto place = [&](std::size_t i) { return frame.poses[i].pose.position[axis]; };
    std::stable_sort(poses.begin(), poses.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
    double below = 0;
    for (const std::size_t i : poses) {
      result[axis] = place(i);
      below += volume(i);
      if (below >= total / 2) break;
    }
  }
  return result;
}

/// Puts the core of the poses in front and returns its number.
std::size_t core(const Sequence& sequence, const Frame& frame, std::vector<std::size_t>& poses) {
  const Vec3 centre = median(sequence, frame, poses);
  const auto distance = [&](std::size_t i) { return (frame.poses[i].pose.position - centre).squaredNorm(); };
  std::stable_sort(poses.begin(), poses.end(), [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  double total = 0, within = 0;
  for (const std::size_t i : poses) total += piece_of(sequence, frame.poses[i]).volume;
  std::size_t count = 0;
  while (count < poses.size() && (count == 0 || within < kCore * total))
    within += piece_of(sequence, frame.poses[poses[count++]]).volume;
  return count;
}

Box grown(const Box& box, double by) { return {box.min() - Vec3::Constant(by), box.max() + Vec3::Constant(by)}; }

}  // namespace

std::vector<std::size_t> subject(const Sequence& sequence, const Frame& frame) {
  const std::set<std::string> moved = moved_bodies(sequence);
  std::vector<std::size_t> chosen = poses_of(sequence, frame, broken_bodies(sequence));
  if (chosen.empty()) chosen = poses_of(sequence, frame, moved);
  if (chosen.empty()) {
    std::set<std::string> all;
    for (const Piece& piece : sequence.pieces) all.insert(piece.body);
    return poses_of(sequence, frame, all);
  }
  chosen.resize(core(sequence, frame, chosen));
  std::vector<std::size_t> others;
  for (const std::size_t i : poses_of(sequence, frame, moved))
    if (std::find(chosen.begin(), chosen.end(), i) == chosen.end()) others.push_back(i);

  const std::vector<Box> box = boxes(sequence, frame);
  Box whole;
  for (const std::size_t i : chosen) whole.extend(box[i]);
  const double step = kStep * whole.diagonal().norm();
  for (bool found = true; found;) {
    const auto near = std::stable_partition(others.begin(), others.end(),
                                            [&](std::size_t i) { return !grown(whole, step).intersects(box[i]); });
    found = near != others.end();
    for (auto i = near; i != others.end(); ++i) {
      whole.extend(box[*i]);
      chosen.push_back(*i);
    }
    others.erase(near, others.end());
  }
  return chosen;
}

}  // namespace sunder::output::detail
