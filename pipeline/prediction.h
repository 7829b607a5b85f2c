#pragma once
/// What a run will take, before it runs.
#include "core/progress.h"
#include "pipeline/quality.h"
#include "pipeline/scene.h"
#include "pipeline/simulation.h"

namespace sunder::pipeline {

/// Time of one step of one particle on this machine over that on the machine that the model was fitted on, measured
/// by a short solve (a tenth of a second of processor time).
double measured_slowness();

/// What is known of a scene before it runs: a pilot, the same scene at a resolution so coarse that it takes a small
/// share of the time, says how often bodies break and how many pieces move; what each of these takes at another
/// quality follows from laws fitted on the scenes of assets/scenes.
class Forecaster {
 public:
  /// Seconds of processor time that a pilot may take; what is left of the scene then is taken to go on as at its end.
  static constexpr double most_seconds = 4;
  /// Shares of what a run is predicted to take, which a pilot may take too: any, and what is little beside a run.
  static constexpr double whole = 1e9, little = 0.08;

  /// `simulation` has placed the bodies, which took `setup_seconds` of processor time; it is left as it is. Errors:
  /// ErrorKind::interrupted.
  Forecaster(const Scene& scene, const Simulation& simulation, double setup_seconds, double share, Progress& progress);

  /// With `threads` (0: all). Within a factor of two of what the scenes in assets/scenes take.
  Prediction at(const Quality& quality, int threads) const;
  /// The finest quality that is predicted to take at most `seconds`, in steps of a fifth so that the same machine
  /// chooses the same one again; the coarsest one when nothing fits.
  Quality within(double seconds, int threads) const;
  double slowness() const { return slowness_; }  ///< measured_slowness() when it was made

 private:
  /// Outside ones are those of the bodies, of whatever quality.
  struct Faces {
    double outside = 0, on_cracks = 0;
    void add(const output::Piece& piece);
    double at(const Quality& quality) const;
  };

  double follow(Simulation& pilot, Progress& progress);
  void sum_up(Simulation& pilot, long steps);
  double solve_seconds(const Quality& quality) const;
  double write_seconds(const Quality& quality) const;

  const Scene& scene_;
  double setup_seconds_, slowness_;
  std::vector<double> rigid_;  ///< of the steps of the pilot [s]
  // Of the whole scene at the pilot's quality.
  double rigid_seconds_ = 0;
  double particles_ = 0, particle_steps_ = 0;  ///< of all solves
  Faces last_, ever_;                          ///< of the pieces at the end, and of all that there ever were
  int solves_ = 0, fragments_ = 0;
};

/// The finest quality with which the scene takes at most its time_budget. Errors: those of Simulation.
Quality affordable_quality(const Scene& scene, const RunOptions& options, Progress& progress);

}  // namespace sunder::pipeline
