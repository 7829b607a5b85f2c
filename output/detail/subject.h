#pragma once
/// What a picture is about.
#include <vector>

#include "output/sequence.h"

namespace sunder::output::detail {

/// Indices into the frame's poses: the pieces of bodies that broke in the run; if none did, of those that moved; else
/// all. Of these the core, which is the nearest to their median that make up 90 % of their volume, and whatever moves
/// and can be reached from it in steps of at most a tenth of its size.
std::vector<std::size_t> subject(const Sequence& sequence, const Frame& frame);

}  // namespace sunder::output::detail
