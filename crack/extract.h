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
  std::vector<Vec3> points;         ///< [m]
  std::vector<double> damage;       ///< in [0, 1], one per point
  std::vector<double> damage_time;  ///< when damage reached 1 [s], negative: never; may be empty
  double spacing = 0;               ///< mean distance between neighbouring points [m]
  double cell_size = 0;             ///< h, the width of a cell of the solver's grid [m]
};

struct Settings {
  double node_spacing = 0;     ///< h_v, of the lattice that damage is measured on [m]; 0: 0.8 point spacings, which
                               ///< keeps the most pieces (measured on the fields of six scenes)
  double crack_damage = 0.95;  ///< points at or above it are crack, below it sound
  double node_damage = 0.4;    ///< nodes with at least this share of crack around them are crack
  double neck_radius = 0.6;  ///< sound nodes nearer than this many cell sizes to damage are necks that closing may cut
  bool close_necks = true;  ///< try `neck_radius` as well as 0 and keep what gives more pieces (larger effective count)
  double smallest_share = 0.002;  ///< sound islands with a smaller share of the nodes go to their neighbours
  int smallest_nodes = 8;         ///< and so do islands with fewer nodes
  double debris_size = 0;  ///< crushed lumps are subdivided into cells of about this size [m]; 0: they join the islands
  double jitter = 1e-4;    ///< displacement of Voronoi sites against cospherical ones, in bounding box diagonals
  std::uint64_t seed = 1;
};

enum class FaceKind {
  interior,   ///< separates two regions, with damage between its two sites
  extension,  ///< separates two regions where the damage did not reach: completes the separation
  partial,    ///< damage between two sites of the same region: a crack that separates nothing
};

/// A medial face.
struct CrackFace {
  std::vector<int> loop;  ///< into `vertices`, counter-clockwise seen from side b
  FaceKind kind = FaceKind::interior;
  int region_a = 0, region_b = 0;  ///< on its two sides; the same for a partial crack
  double damage_time = -1;         ///< mean of the damage beside it [s]; -1: unknown
  bool in_body = true;             ///< its middle lies in the body: Voronoi faces go on in the empty space around it
};

/// A site that stays where it is, on its side of the crack, in later extractions.
struct Anchor {
  int lattice = 0;  ///< its place on the lattice
  int node = 0;     ///< of the body: itself, or the one that it continues beyond the surface
  Vec3 position;    ///< [m]
  int region = 0;
};

struct Extraction {
  int region_count = 1;               ///< 1: nothing is separated, `boundary` is empty
  std::vector<int> region;            ///< per point of the field
  geometry::RegionBoundary boundary;  ///< what geometry::cut takes; closed around every region
  std::vector<Vec3> vertices;         ///< of `faces`; those of `boundary` are the same
  std::vector<double> damage_time;    ///< per vertex, mean of the damage beside it [s]; -1: unknown
  std::vector<CrackFace> faces;       ///< for looking and for later solves; face i is boundary.faces[i] unless partial
  std::vector<Anchor> anchors;        ///< by which a later extraction of the same body keeps these faces
  double node_spacing = 0;            ///< that was used [m]
  long sites = 0;                     ///< Voronoi sites
  double damaged_share = 0;           ///< damaged points / points
  double lump_share = 0;              ///< crack nodes farther than 1.5 cell sizes from every sound one / nodes
  double effective_count = 1;         ///< 1 / sum over regions of (share in the nodes of all islands)^2
  double neck_radius_used = 0;        ///< 0 or settings.neck_radius
  int debris = 0;                     ///< regions that subdivide crushed lumps
  double debris_seconds = 0;          ///< wall-clock, of choosing where they are
  int retries = 0;                    ///< times the sites had to be jittered anew
};

/// Damage is averaged onto a lattice; its sound nodes form islands, connected by links inside the body; every other
/// node goes to the island that is nearest along links inside the body, so nothing is joined through empty space.
/// Islands that are too small are nodes like the others. The Voronoi faces between sites of different islands are the
/// medial crack faces. For a thin sheet of damage that is its mid-surface, for a lump it is what a flood from the
/// islands around it makes, and it is always closed. Sites are the sound nodes beside damage, moved onto the
/// iso-surface of the damage, and what else keeps a crack in its limb. Voronoi cells are Voro++'s; a crack vertex gets
/// its id from the four cells that meet there. Links are up to 1.5 node spacings long: limbs nearer to each other than
/// that count as one. Source: Fan (2024), section 3.3 (medial surface by Voronoi cells of the nodes around the damage).
/// Differs in that sites stand on the sound side and leave the lattice, and that sides come from islands instead of
/// midpoint damage and a search over links: that closes faces up to the surface, whatever the order of the nodes.
/// `domain` holds the body; the regions fill it enlarged by a tenth of its diagonal. `earlier` is the last
/// extraction of the same points, of which no damage was taken back since: its faces stay (to the rounding
/// of their corners), except where a sheet ended and for a few at the edges of the body. Errors: ErrorKind::usage when
/// the node spacing is under 0.75 of the points' or too fine for memory, ErrorKind::internal when the cells do not fit
/// together after repeated jitter, or the field is malformed.
Extraction extract(const DamageField& field, const Box& domain, const Settings& settings, Progress& progress,
                   const Extraction* earlier = nullptr);

}  // namespace sunder::crack
