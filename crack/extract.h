#pragma once
/// Where damage becomes surface: from a cloud of damaged points to regions and the medial faces between them.
#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "core/types.h"
#include "geometry/cut.h"

namespace sunder::crack {

/// Damage of the points of one body in material (undeformed) space.
struct DamageField {
  std::vector<Vec3> points;    ///< [m]
  std::vector<double> damage;  ///< in [0, 1], one per point
  double spacing = 0;          ///< mean distance between neighbouring points [m]
  double cell_size = 0;        ///< h, the width of a cell of the solver's grid [m]
};

struct Settings {
  double crack_damage = 0.95;  ///< points at or above it are crack, below it sound
  double link = 1.5;           ///< sound points nearer than this many spacings are connected
  double neck_radius = 0.6;  ///< sound points nearer than this many cell sizes to damage are necks that closing may cut
  bool close_necks = true;  ///< try `neck_radius` as well as 0 and keep what gives more pieces (larger effective count)
  double smallest_share = 0.002;  ///< sound islands with a smaller share of the points go to their neighbours
  int smallest_points = 8;        ///< and so do islands with fewer points
  double jitter = 1e-5;           ///< displacement of Voronoi sites against cospherical ones, in bounding box diagonals
  std::uint64_t seed = 1;
};

enum class FaceKind {
  interior,   ///< separates two regions, with damage between its two sites
  extension,  ///< separates two regions where the damage did not reach: completes the separation
  partial,    ///< damage between two sites of the same region: a crack that separates nothing
};

/// A medial face.
struct CrackFace {
  std::vector<Vec3> polygon;  ///< [m], counter-clockwise seen from `point_b`
  FaceKind kind = FaceKind::interior;
  int point_a = 0, point_b = 0;  ///< the two sites (indices into the field's points)
};

struct Extraction {
  int region_count = 1;               ///< 1: nothing is separated, `boundary` is empty
  std::vector<int> region;            ///< per point of the field
  geometry::RegionBoundary boundary;  ///< what geometry::cut takes; closed around every region
  std::vector<CrackFace> faces;  ///< for looking and for later solves; face i is boundary.faces[i] unless it is partial
  double damaged_share = 0;      ///< damaged points / points
  double lump_share = 0;         ///< damaged points farther than 1.5 cell sizes from every sound one / points
  double effective_count = 1;    ///< 1 / sum over regions of (share of the points)^2
  double neck_radius_used = 0;   ///< 0 or settings.neck_radius
  int retries = 0;               ///< times the sites had to be jittered anew
};

/// Sound points form islands, connected by links inside the body; every other point goes to the island that is nearest
/// along links inside the body, so nothing is joined through empty space. Islands that are too small are points like
/// the others. The Voronoi faces between sites of different islands are the medial crack faces. For a thin sheet of
/// damage that is its mid-surface, for a lump it is what a flood from the islands around it makes, and it is always
/// closed. Sites are the points of islands, and those others whose nearest island in a straight line is not their own
/// (so that a crack in one limb never cuts another). Voronoi cells are Voro++'s; a crack vertex gets its id from the
/// four cells that meet there. Links are straight: limbs nearer to each other than `link` spacings count as one.
/// Source: Fan (2024), section 3.3 (medial surface by Voronoi cells of the sound nodes around the damage); differs in
/// that sides come from islands instead of midpoint damage, which closes faces up to the surface without a separate
/// search. `domain` holds the body; the regions fill it enlarged by a tenth of its diagonal. Errors:
/// ErrorKind::internal when the cells do not fit together after repeated jitter, or the field is malformed.
Extraction extract(const DamageField& field, const Box& domain, const Settings& settings, Progress& progress);

}  // namespace sunder::crack
