#pragma once
/// The catalogue of validation problems: set-ups with a reference that is not Sunder's own, what comes out, and how far
/// off it may be. The tests run every one of them, and so does `sunder validate`.
#include <functional>
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

struct Problem {
  std::string id;      ///< of the catalogue: "A1"
  std::string title;   ///< what is simulated
  std::string source;  ///< of the reference
  std::function<Outcome()> run;
};

/// All problems, in the order of their ids.
const std::vector<Problem>& problems();

}  // namespace sunder::validation
