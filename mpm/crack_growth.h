#pragma once
/// Where cracks start and advance in a body: the softening law of its points and, with front rules, who may begin.
#include <cstdint>
#include <vector>

#include "core/stopwatch.h"
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

  /// A point of a crack that is there already: it has failed, pulls the crack ahead and shields beside it.
  void seed(int id, const Vec3& normal, Continuum& body);
  /// Damage and cracks of an earlier solve of the same points. Before the first step.
  void inherit(const PriorDamage& prior, Continuum& body);
  PriorDamage damage(const Continuum& body) const;
  /// After each advance(): starts the cracks that the rules allow.
  void grow(double time, Continuum& body);

  /// The mid-surface of cracks that opened since this was last asked: fronts that failed. A local law has none.
  std::vector<CrackFace> new_faces(const Continuum& body);

  /// The law at crack fronts (front) or everywhere but for scatter (local).
  const Softening& law() const { return law_; }
  long nuclei() const { return nuclei_; }           ///< cracks that started in virgin material
  const Effort& scatter() const { return flaws_; }  ///< points whose strength was scattered

 private:
  void add_front(int id, const Vec3& normal, double time, Continuum& body);
  void wake(const Vec3& front, const Vec3& normal, Continuum& body);
  Candidate candidate(int id, const Continuum& body) const;
  CrackFronts::Sight look(const Candidate& candidate, double time);
  struct Asked {
    Candidate candidate;
    CrackFronts::Sight sight;
  };
  void decide(const std::vector<Asked>& asked, double time, Continuum& body);

  const Softening law_;
  Effort flaws_;
  std::vector<double> nucleation_strength_;
  const double reach_;  ///< within which fronts have a say [m]
  /// What a point was last told.
  struct Memory {
    long look_again = 0;         ///< step from which it is asked again
    int shielder = -1;           ///< front that shielded it; -1: none
    bool near_fronts = false;    ///< fronts may be so near that they do more than shield
    Vec3 normal = Vec3::Zero();  ///< with which it asked about those
  };
  std::vector<Memory> memory_;
  long step_ = 0;
  CrackFronts fronts_;
  std::vector<PriorDamage::Front> front_points_;  ///< by sequence number
  std::vector<std::size_t> closed_;               ///< those that have not failed yet
  struct Neighbourhood {
    std::vector<int> points;
    bool awake = false;  ///< a front is within its reach; before, only the nucleation strength of the points matters
  };
  MaterialBins<Neighbourhood> neighbourhoods_;
  long nuclei_ = 0;
};

}  // namespace sunder::mpm
