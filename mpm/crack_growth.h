#pragma once
/// Where cracks start and advance in a body: the softening law of its points and, with front rules, who may begin.
#include <cstdint>
#include <vector>

#include "mpm/continuum.h"
#include "mpm/front.h"
#include "mpm/rankine.h"
#include "mpm/solve.h"

namespace sunder::mpm {

class CrackGrowth {
 public:
  /// Gives all points of the body their thresholds, and with DamageModel::local their laws.
  CrackGrowth(const Material& material, const SolveSettings& settings, const std::vector<Vec3>& points,
              Continuum& body);

  /// After each advance(): starts the cracks that the rules allow.
  void grow(double time, Continuum& body);

  /// The law at crack fronts (front) or everywhere but for scatter (local).
  const Softening& law() const { return law_; }
  long nuclei() const { return nuclei_; }  ///< cracks that started in virgin material

 private:
  Candidate candidate(int id, const Continuum& body) const;
  void decide(const std::vector<Candidate>& candidates, double time, Continuum& body);

  const Softening law_;
  std::vector<double> nucleation_strength_;
  std::vector<long> look_again_;  ///< step from which a shielded point is asked again
  long step_ = 0;
  CrackFronts fronts_;
  long nuclei_ = 0;
};

}  // namespace sunder::mpm
