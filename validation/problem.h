#pragma once
/// The catalogue of validation problems: set-ups with a reference that is not Sunder's own, what comes out, and how far
/// off it may be. The tests run every one of them, and so does `sunder validate`.
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace sunder::validation {

/// One number against its reference. `error` is |value - reference| in the unit of the bound, or as `what` says.
struct Check {
  std::string what;
  double value = 0, reference = 0;
  double error = 0, bound = 0;
  bool passed() const { return error <= bound; }  ///< false for an error that is not a number
};

/// Relative deviation from a reference.
Check relative(const std::string& what, double value, double reference, double bound);
/// Deviation in the unit of the value.
Check absolute(const std::string& what, double value, double reference, double bound);
/// Holds when `value` lies in [least, most]; the error is how far outside it is.
Check within(const std::string& what, double value, double least, double most);

struct Outcome {
  std::vector<Check> checks;
  double particle_steps = 0;  ///< what it cost in the damage solve; 0: nothing
};

/// One error at a resolution, and what it cost in the damage solve.
struct StudyPoint {
  double error = 0, particle_steps = 0;
};

/// How the error of a problem falls as the resolution grows.
struct Study {
  std::string error;             ///< what it is, with its unit: "period [4L/c]"
  std::string size;              ///< what a resolution counts: "cells along the bar"
  std::vector<int> resolutions;  ///< ascending
  /// Of the error in 1 / resolution; the fitted order must reach it. Not set: the error does not depend on the
  /// resolution by design.
  std::optional<double> least_order;
  std::function<StudyPoint(int resolution)> run;
};

struct Problem {
  std::string id;      ///< of the catalogue: "A1"
  std::string title;   ///< what is simulated
  std::string source;  ///< of the reference
  std::function<Outcome()> run;
  std::optional<Study> study = std::nullopt;
};

/// All problems, in the order of their ids.
const std::vector<Problem>& problems();

}  // namespace sunder::validation
