#pragma once
/// What accuracy costs: the error of a problem at several resolutions against the time that it takes.
#include <vector>

#include "validation/problem.h"

namespace sunder::validation {

struct Measurement {
  int resolution = 0;
  double error = 0, particle_steps = 0;
  double seconds = 0;  ///< of processor time, all threads; the least of several runs where one is short
};

struct StudyResult {
  std::vector<Measurement> points;
  double order = 0;          ///< p of error ~ resolution^-p
  double cost_exponent = 0;  ///< q of seconds ~ error^-q: to halve the error costs 2^q times the time
  bool passed = false;       ///< the order is at least the study's, if it has one
};

/// Slope of ln y over ln x by least squares; not a number with fewer than two points or when one is not positive.
double power_of(const std::vector<double>& x, const std::vector<double>& y);

/// Runs the study at its own resolutions, or at others.
StudyResult measure(const Study& study, const std::vector<int>& resolutions);
inline StudyResult measure(const Study& study) { return measure(study, study.resolutions); }

}  // namespace sunder::validation
