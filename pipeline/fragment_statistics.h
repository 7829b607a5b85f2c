#pragma once
/// What a run's fragments are as a whole: how many and when, how large, by what law, whether volume and energy add up.
#include <optional>
#include <string>
#include <vector>

#include "output/sequence.h"
#include "pipeline/report.h"
#include "statistics/fit.h"

namespace sunder::pipeline {

/// Of the fragments that exist at the end [m^3].
struct VolumeSummary {
  double minimum = 0, median = 0, mean = 0, maximum = 0;
};

/// Of a body that broke [m^3].
struct VolumeClosure {
  std::string body;
  double original = 0;
  double fragments = 0;       ///< sum over what exists of it at the end
  double relative_error = 0;  ///< (fragments - original) / original
};

/// What a moment in which fragments were born did to a body of the scene.
struct FragmentCount {
  double time = 0;  ///< [s]
  std::string body;
  int born = 0;
  int alive = 0;  ///< fragments of the body after that
};

/// What one piece broke into.
struct BreakupSizes {
  double time = 0;    ///< [s]
  std::string piece;  ///< name of what broke
  int fragments = 0;
  double median_volume = 0;  ///< [m^3]
  double largest_share = 0;  ///< of the volume of all of them
};

/// [J]; gravity's work and what contacts take without breaking are not in it, so it does not add up to 0.
struct EnergyBalance {
  double kinetic_start = 0;           ///< of the scene's bodies at their birth
  std::optional<double> kinetic_end;  ///< of the pieces in the last frame; not set: there is none
  double fracture = 0;                ///< taken by new crack faces: fracture energy times area
  double lost_in_fractures = 0;       ///< kinetic energy before minus after, of all fractures
};

struct FragmentStatistics {
  std::size_t fragments = 0;               ///< that exist at the end
  std::optional<double> largest_share;     ///< of their volume; not set: there are none
  std::optional<VolumeSummary> volume;     ///< not set: there are none
  std::vector<VolumeClosure> closure;      ///< in the order of the scene's bodies
  std::vector<FragmentCount> counts;       ///< by time, then in the order of the scene's bodies
  std::vector<statistics::Fit> fits;       ///< to the volumes of the fragments that exist at the end
  std::string fits_note;                   ///< what limits the fits, in sentences; empty: nothing
  std::vector<BreakupSizes> per_fracture;  ///< in the order of the pieces that broke
  EnergyBalance energy;
};

/// Fragments that exist at the end of the run, by id.
std::vector<const output::Piece*> living_fragments(const output::Sequence& sequence);

/// Of the pieces that have one (cuts on a coarse voxel grid can leave nothing of a sliver) [m^3].
std::vector<double> positive_volumes(const std::vector<const output::Piece*>& fragments);

/// Of the largest in the sum of all; at least one.
double largest_share(const std::vector<double>& volumes);

/// A pure function; with 1000 fragments nearly all of its time goes to the fits.
FragmentStatistics fragment_statistics(const Report& report, const output::Sequence& sequence);

}  // namespace sunder::pipeline
