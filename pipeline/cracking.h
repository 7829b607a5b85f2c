#pragma once
/// From damage to pieces: crack surfaces, what makes them look rough, the cut, and what is done when it fails.
#include <map>
#include <optional>
#include <string>

#include "core/progress.h"
#include "core/stopwatch.h"
#include "crack/extract.h"
#include "crack/surface_detail.h"
#include "geometry/cut.h"

namespace sunder::pipeline {

/// Fallbacks that were taken, by name, with how often.
using Fallbacks = std::map<std::string, int>;

/// What a scene asks of crack surfaces and of the cut.
struct CrackChoice {
  double node_spacing = 0;    ///< of the lattice that damage is measured on [m]; 0: that of crack::Settings
  double debris_size = 0;     ///< of the pieces of crushed lumps [m]; 0: lumps join the pieces around them
  double hairline_width = 0;  ///< of partial cracks in the fragments that carry them [m]; 0: not shown
  std::string detail;         ///< look of crack faces, a name that crack::detail_preset knows; empty: as extracted
  bool level_set = false;     ///< cut on a voxel grid instead of exactly
  double voxel_size = 0;      ///< of that grid [m]; 0: 1/150 of the body's diagonal
};

struct Cracked {
  crack::Extraction extraction;
  geometry::RegionBoundary boundary;  ///< what was cut along: with detail and gaps
  geometry::CutResult cut;            ///< without the gaps of hairlines; no fragments: nothing separated
  std::vector<double> damage_time;    ///< per vertex of `boundary` [s], -1: unknown; empty: no times
  Effort detailed_vertices;           ///< vertices of detailed faces
  long detail_limited = 0;            ///< those of them that are lower than asked
  Effort hairline_faces;              ///< partial crack faces that are shown as gaps
  double extract_seconds = 0, cut_seconds = 0;
  Fallbacks fallbacks;
  std::vector<std::string> troubles;  ///< what cuts that failed said
};

/// A failed cut is tried again with other Voronoi sites and narrower hairlines, then without hairlines and detail, then
/// on a voxel grid; if that fails too there are no fragments. Fallbacks: "voronoi_sites_jittered_anew",
/// "cut_regions_nudged" (by 1e-6 of the body's size), "cut_retried", "hairlines_narrowed", "hairlines_dropped",
/// "surface_detail_dropped", "cut_level_set", "fracture_abandoned". Errors: those of crack::extract.
Cracked crack_and_cut(const geometry::TriangleMesh& mesh, const crack::DamageField& field, const CrackChoice& choice,
                      std::uint64_t seed, Progress& progress);

/// Without a body to cut. `boundary` and `cut` stay empty.
Cracked extract_only(const crack::DamageField& field, const CrackChoice& choice, std::uint64_t seed,
                     Progress& progress);

/// The same cut along regions that are already there.
Cracked cut_regions(const geometry::TriangleMesh& mesh, geometry::RegionBoundary regions, const CrackChoice& choice,
                    std::uint64_t seed, Progress& progress);

}  // namespace sunder::pipeline
