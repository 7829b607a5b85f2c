#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "geometry/mass_properties.h"
#include "output/poster.h"

namespace sunder::output {
namespace {

constexpr double kBestOpening =
    0.3;  // growth of a body's radius of gyration at which its cracks gape and it is still itself

/// Second moment about the own centre of mass over the volume, the square of the radius of gyration [m^2]. Zero for a
/// piece without volume.
double own_spread(const Piece& piece) {
  const geometry::MassProperties properties = geometry::mass_properties(piece.mesh);
  return properties.volume > 0 ? properties.inertia.trace() / 2 / properties.volume : 0;
}

/// What came of one body, in one frame.
struct Remains {
  double volume = 0, moment = 0;  ///< [m^3, m^5], moment about the origin
  Vec3 centre = Vec3::Zero();     ///< times volume
  int fragments = 0;

  double gyration() const { return std::sqrt(std::max(0.0, moment / volume - (centre / volume).squaredNorm())); }
};

std::map<std::string, Remains> remains(const Sequence& sequence, const std::vector<double>& spread,
                                       const Frame& frame) {
  std::map<std::string, Remains> bodies;
  for (const PiecePose& pose : frame.poses) {
    const auto id = static_cast<std::size_t>(pose.piece);
    const Piece& piece = sequence.pieces[id];
    Remains& body = bodies[piece.body];
    body.volume += piece.volume;
    body.moment += piece.volume * (spread[id] + pose.pose.position.squaredNorm());
    body.centre += piece.volume * pose.pose.position;
    body.fragments += piece.parent >= 0 ? 1 : 0;
  }
  return bodies;
}

}  // namespace

std::size_t telling_frame(const Sequence& sequence) {
  if (sequence.frames.empty()) return 0;
  std::vector<double> spread;
  for (const Piece& piece : sequence.pieces) spread.push_back(own_spread(piece));
  std::map<std::string, double> whole;  // radius of gyration
  for (const Piece& piece : sequence.pieces)
    if (piece.parent < 0) whole[piece.body] = std::sqrt(spread[static_cast<std::size_t>(piece.id)]);
  std::size_t best = sequence.frames.size() - 1;
  double best_score = 0;
  for (std::size_t f = 0; f < sequence.frames.size(); ++f) {
    double score = 0;
    for (const auto& [name, body] : remains(sequence, spread, sequence.frames[f])) {
      if (body.fragments == 0 || body.volume <= 0 || whole[name] <= 0) continue;
      const double opening = std::max(0.0, body.gyration() / whole[name] - 1) / kBestOpening;
      score += body.fragments * opening * std::exp(-opening);
    }
    if (score > best_score * (1 + 1e-9)) {
      best_score = score;
      best = f;
    }
  }
  return best;
}

}  // namespace sunder::output
