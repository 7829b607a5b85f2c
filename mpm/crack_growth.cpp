#include "mpm/crack_growth.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "mpm/strength_scatter.h"

namespace sunder::mpm {
namespace {

/// Shields are there to stay and only the direction of the stress can turn out of them, so a shielded point need not be
/// asked in every step. In this many a wave runs little more than a cell.
constexpr long steps_between_looks = 4;

Softening law_of(const Material& m, const SolveSettings& settings, double cell_size) {
  const double k = settings.damage == DamageModel::front ? settings.front.energy_factor : 1;
  return make_softening(m.youngs_modulus, m.tensile_strength, k * m.fracture_energy, settings.band_width * cell_size,
                        CoarseGrid::lower_strength);
}

Box box_of(const std::vector<Vec3>& points) {
  Box box;
  for (const Vec3& x : points) box.extend(x);
  return box;
}

/// The law scaled to another strength at the same energy. Scatter beyond what it can carry would make its slope
/// negative.
Softening scattered(const Softening& law, double factor) {
  const double most = std::sqrt((1 + law.slope) / law.slope / 1.02);
  const double f = std::min(factor, most), ratio = law.slope / (1 + law.slope) * f * f;
  return {f * law.strength, ratio / (1 - ratio), law.fracture_energy};
}

}  // namespace

CrackGrowth::CrackGrowth(const Material& material, const SolveSettings& settings, const std::vector<Vec3>& points,
                         Continuum& body)
    : law_(law_of(material, settings, body.cell_size())),
      nucleation_strength_(strength_scatter(points, material.weibull_modulus,
                                            settings.scatter_length * body.cell_size(), settings.seed)),
      look_again_(points.size(), 0),
      fronts_(box_of(points), body.cell_size(), material.p_wave_speed(), settings.front) {
  for (int id = 0; id < body.size(); ++id) {
    double& strength = nucleation_strength_[static_cast<std::size_t>(id)];
    PointState state = body.point(id);
    if (settings.damage == DamageModel::local) {
      const Softening law = scattered(law_, strength);
      state.strength = state.threshold = law.strength;
      state.softening_slope = law.slope;
    }
    strength *= material.tensile_strength;
    if (settings.damage == DamageModel::front) state.threshold = std::min(strength, law_.strength);
    body.set_point(id, state);
  }
}

Candidate CrackGrowth::candidate(int id, const Continuum& body) const {
  const Mat3 h = body.displacement_gradient(id);
  const PrincipalStress stress = principal_stress(body.elasticity().cauchy_stress(h, volume_change(h)));
  return {id, body.material_position(id), stress.direction.col(2), stress.value[2],
          stress.value[2] / nucleation_strength_[static_cast<std::size_t>(id)]};
}

void CrackGrowth::grow(double time, Continuum& body) {
  ++step_;
  std::vector<int> ids;
  for (int id : body.candidates())
    if (look_again_[static_cast<std::size_t>(id)] <= step_) ids.push_back(id);
  if (ids.empty()) return;
  std::vector<Candidate> candidates(ids.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, ids.size(), 64), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) candidates[n] = candidate(ids[n], body);
  });
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.urgency > b.urgency || (a.urgency == b.urgency && a.particle < b.particle);
  });
  decide(candidates, time, body);
}

/// Strongest first, ties by index. What the fronts of earlier steps say is asked in parallel; only fronts of this step
/// are asked in order.
void CrackGrowth::decide(const std::vector<Candidate>& candidates, double time, Continuum& body) {
  std::vector<CrackFronts::Sight> sights(candidates.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, candidates.size(), 16), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n)
      sights[n] = fronts_.look(candidates[n].position, candidates[n].normal, time);
  });
  const int known = fronts_.count();
  for (std::size_t n = 0; n < candidates.size(); ++n) {
    const Candidate& c = candidates[n];
    const auto sight =
        fronts_.count() > known ? sights[n] | fronts_.look(c.position, c.normal, time, known) : sights[n];
    const Verdict verdict = sight.verdict();
    if (sight.shields) look_again_[static_cast<std::size_t>(c.particle)] = step_ + steps_between_looks;
    const double needed =
        verdict == Verdict::nucleate ? nucleation_strength_[static_cast<std::size_t>(c.particle)] : law_.strength;
    if (verdict == Verdict::wait || c.stress <= needed) continue;
    body.start_crack(c.particle, law_.strength, law_.slope);
    if (verdict == Verdict::nucleate) ++nuclei_;
    if (verdict != Verdict::filler) fronts_.add(c.position, c.normal, time);
  }
}

}  // namespace sunder::mpm
