#pragma once
/// Chevron marks (river lines) on crack surfaces, from the times at which the material was damaged.
#include <cstdint>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/types.h"
#include "geometry/cut.h"

namespace sunder::crack {

/// When the points of one body were damaged, in material (undeformed) space.
struct DamageTimes {
  std::vector<Vec3> points;  ///< [m]
  std::vector<double> time;  ///< [s], one per point; negative: never damaged
  double spacing = 0;        ///< mean distance between neighbouring points [m]
};

/// The six controls of Fan (2024), table 3.2, and a grain that makes surfaces of granular materials.
struct DetailSettings {
  double edge_length = 0;       ///< d: no edge near the body stays longer [m]
  double line_step = 0;         ///< step of a line; longer: lines with fewer bends [m]
  double line_length = 0;       ///< l_c: the longest line [m]
  double influence_radius = 0;  ///< s: no other line runs so near beside one [m]; larger: fewer lines, flatter between
  double grid_spacing = 0;      ///< h_c: width to which lines are smeared; larger: smoother [m]
  double height = 0;  ///< G: bound of the displacement [m]; no more than a twentieth of the body's diagonal is used
  double longest_share = 1;  ///< m: share of the lines, the longest ones, that is raised, in [0, 1]
  double grain = 0;          ///< share of the height that is grain instead of lines, in [0, 1]
  double grain_size = 0;     ///< size of the coarsest grains [m]; not used when grain is 0
  std::uint64_t seed = 1;    ///< of the grain
};

/// A complex of triangles. The vertices of the input keep their indices; new ones follow.
struct DetailedBoundary {
  geometry::RegionBoundary boundary;
  std::vector<int> source_face;     ///< per face: the face of the input that it is a part of
  std::vector<double> damage_time;  ///< per vertex [s]; -1 where no time is known: far vertices, or no damage at all
  int lines = 0;                    ///< chevron lines that were found
  int raised_lines = 0;             ///< and that shape the surface
  long limited = 0;                 ///< vertices that are lower than asked so that the surfaces stay valid
  long lowered = 0;                 ///< those among them that the final check lowered, for a fold or a crossing
  double largest_height = 0;        ///< largest displacement [m], at most settings.height
};

/// Refines the faces near the body and displaces their vertices along the normals of their sheets.
///
/// Source: Fan (2024), section 3.7: equations 3.13 and 3.14, Algorithm 4, table 3.2. Differs in this:
/// * The gradient of the damage time is a moving least squares fit over the nodes that have data (time_field.h): eq.
///   3.14 with M = h^2/4 is right for full stencils only. Its grid is never finer than 1.5 spacings of the points.
/// * Lines follow the unit gradient in the tangent plane: the raw one is the slowness of the front, not a length.
/// * Heights grow along a line, from 1 at its source to 2 at its end, as the text says; the printed rule falls.
/// * Lines are smeared as curves, weighted by length, so the step does not change the height; the sum b over lines is
///   not normalised, but bounded: a vertex moves by G tanh(b), so that G is the largest height whatever the lines do.
/// * Where no damage is near, a vertex continues the time of the nearest vertex that knows it, so the look goes on to
///   the body's surface.
/// * A share `grain` of the height may be noise of two octaves.
///
/// Always valid: a vertex is moved once for all regions that share it; the topology is that of the refined input.
/// Vertices on junctions (edges of other than two faces, or between different pairs of regions), on the hull and far
/// from the body stay; heights rise from there with a slope of at most 1/2, stay below 0.4 of the distance to another
/// sheet, and have a slope of at most 1 everywhere. Then triangles that turned by more than acos(0.3) or cross another
/// one are lowered until none is left. `body` is the body's bounding box. Without damage nothing but grain is raised.
/// Deterministic. Errors: ErrorKind::usage for settings that make no sense or more than `most_triangles` triangles;
/// ErrorKind::internal for malformed input.
DetailedBoundary add_surface_detail(const geometry::RegionBoundary& regions, const Box& body, const DamageTimes& times,
                                    const DetailSettings& settings, Progress& progress);

/// Refinement stops with an error above it.
constexpr int most_triangles = 8'000'000;

/// The names that detail_preset knows: clay, rock, concrete, glass, slate, ceramic, plaster, metal.
std::vector<std::string> detail_preset_names();

/// The settings of a look. `scale` [m]: the largest extent of the body, or less for finer detail. Errors:
/// ErrorKind::usage for an unknown name.
DetailSettings detail_preset(const std::string& name, double scale);

}  // namespace sunder::crack
