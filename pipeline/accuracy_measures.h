#pragma once
/// How far two results of the same fracture are from each other.
#include <optional>
#include <vector>

#include "pipeline/fracture.h"

namespace sunder::pipeline {

/// One solve of a ladder, reduced to what is compared.
struct FractureTrace {
  Box box;                       ///< of the body [m]
  double volume = 0;             ///< of the body [m^3]
  std::vector<Vec3> failed;      ///< points that failed [m]
  geometry::TriangleMesh crack;  ///< crack faces in the body that separate pieces, in triangles; may be empty
  std::vector<double> shares;    ///< of the pieces in the volume, descending; {1}: whole
  double crack_area = 0;         ///< [m^2]
  double dissipated = 0;         ///< by damage [J]; 0 without an energy ledger
  double peak_force = 0;         ///< of the loads [N]
  double impulse = 0;            ///< delivered [N s]
};
FractureTrace trace_of(const FractureInput& input, const FractureOutcome& outcome);

/// What separates two traces of one body. Distances of surfaces are shares of the body's diagonal; they are not set
/// when one of the two has no crack.
struct TraceDistance {
  double damage = 0;  ///< share of the cells with failed points of either that have such points of one only, in [0, 1];
                      ///< cells are a sixteenth of the body's diagonal, wider than the damage band of any resolution
  std::optional<double> crack_mean, crack_hausdorff;
  double volumes = 0;  ///< of the distributions of volume over the size of the piece it is in: the mean shift of a
                       ///< piece's size that turns one into the other (Wasserstein), in shares of the body
};
TraceDistance distance(const FractureTrace& a, const FractureTrace& b);

}  // namespace sunder::pipeline
