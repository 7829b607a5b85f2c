#pragma once
/// A sequence seen piece by piece, as an animation format wants it.
#include <array>
#include <vector>

#include "output/sequence.h"

namespace sunder::output::detail {

/// Motion of one piece at the frames where it is alive; `t` = 0 is the first frame of the sequence [s].
struct Track {
  std::vector<float> times;
  std::vector<std::array<float, 3>> translations;
  std::vector<std::array<float, 4>> rotations;  ///< unit quaternions x, y, z, w; neighbours on the same hemisphere

  /// When the piece appears (1) and disappears (0): the state at the first frame, then the changes.
  std::vector<float> switch_times;
  std::vector<float> visible;
};

/// One track per piece.
std::vector<Track> tracks(const Sequence& sequence);

}  // namespace sunder::output::detail
