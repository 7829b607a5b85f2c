#pragma once
/// Which marked position of a lattice is nearest in a straight line, for every position.
#include <vector>

#include "crack/detail/lattice.h"

namespace sunder::crack::detail {

/// Squared distances between positions are whole numbers of squared spacings: ties are ties.
struct Nearest {
  std::vector<int> source;   ///< per position: a nearest marked position, -1 if there is none
  std::vector<int> squared;  ///< per position: its squared distance
};

/// Exact Euclidean feature transform, linear in the number of positions: lower envelopes of parabolas, one axis after
/// the other (Felzenszwalb, Huttenlocher 2012; Maurer, Qi, Raghavan 2003).
Nearest nearest_marked(const Lattice& lattice, const std::vector<char>& marked);

/// |a - b|^2 in squared spacings.
int squared_steps(const Lattice& lattice, int position_a, int position_b);

/// Marks every position of the body at most `radius` spacings away from a node that is marked, itself included.
std::vector<char> dilated(const Lattice& lattice, const std::vector<char>& marked_nodes, double radius);

}  // namespace sunder::crack::detail
