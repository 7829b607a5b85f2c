#include "mpm/crack_growth.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/optional_effects.h"
#include "mpm/strength_scatter.h"

namespace sunder::mpm {
namespace {

/// Fronts take seven steps to cross a cell, so that asking every other one loses nothing.
constexpr long steps_between_decisions = 2;
/// What the fronts say about a point changes with new fronts, which ask for another look, and otherwise only as its
/// stress turns or grows: fronts run about a cell in this many steps.
constexpr long steps_between_looks = 8, shielded_steps_between_looks = 16;
constexpr double same_direction = 0.985;  ///< 10 degrees
/// Candidates worth waking a thread for.
constexpr std::size_t grain = 48;

Softening law_of(const Material& m, const SolveSettings& settings, double cell_size) {
  const double k = settings.damage == DamageModel::front ? settings.front.energy_factor : 1;
  return make_softening(m.youngs_modulus, m.tensile_strength, k * m.fracture_energy, settings.band_width * cell_size,
                        CoarseGrid::lower_strength);
}

/// The law scaled to another strength at the same energy. Scatter beyond what it can carry would make its slope
/// negative.
Softening scattered(const Softening& law, double factor) {
  const double most = std::sqrt((1 + law.slope) / law.slope / 1.02);
  const double f = std::min(factor, most), ratio = law.slope / (1 + law.slope) * f * f;
  return {f * law.strength, ratio / (1 - ratio), law.fracture_energy};
}

/// Factors of the points' strengths; counts those that differ from one.
std::vector<double> factors_of_strength(const Material& material, const SolveSettings& settings,
                                        const std::vector<Vec3>& points, double cell_size, Effort& scattered) {
  if (!with_optional_effects || material.weibull_modulus <= 0) return std::vector<double>(points.size(), 1.0);
  const Stopwatch watch(scattered.seconds);
  scattered.count = static_cast<long>(points.size());
  return strength_scatter(points, material.weibull_modulus, settings.scatter_length.value_or(3 * cell_size),
                          settings.seed);
}

}  // namespace

CrackGrowth::CrackGrowth(const Material& material, const SolveSettings& settings, const std::vector<Vec3>& points,
                         Continuum& body)
    : law_(law_of(material, settings, body.cell_size())),
      nucleation_strength_(factors_of_strength(material, settings, points, body.cell_size(), flaws_)),
      reach_(settings.front.shield_radius * body.cell_size()),
      memory_(points.size()),
      fronts_(box_of(points), body.cell_size(), material.p_wave_speed(), settings.front),
      neighbourhoods_(box_of(points), body.cell_size()) {
  for (int id = 0; id < body.size(); ++id) {
    double& strength = nucleation_strength_[static_cast<std::size_t>(id)];
    PointState state = body.point(id);
    if (settings.damage == DamageModel::local) {
      const Softening law = scattered(law_, strength);
      state.strength = state.threshold = law.strength;
      state.softening_slope = law.slope;
    }
    strength *= material.tensile_strength;
    if (settings.damage == DamageModel::front) {
      state.threshold = strength;
      neighbourhoods_.bin(state.material_position).points.push_back(id);
    }
    body.set_point(id, state);
  }
}

/// Points that the new front may have a say about fail at its strength from now on, and the near ones are asked again.
void CrackGrowth::wake(const Vec3& front, const Vec3& normal, Continuum& body) {
  MaterialBins<Neighbourhood>::visit(neighbourhoods_, front, reach_, [&](Neighbourhood& there) {
    if (!there.awake)
      for (int id : there.points) body.lower_threshold(id, law_.strength);
    there.awake = true;
    return false;
  });
  MaterialBins<Neighbourhood>::visit(neighbourhoods_, front, fronts_.near_distance(), [&](Neighbourhood& there) {
    for (int id : there.points) {
      if (!fronts_.reaches(front, normal, body.material_position(id))) continue;
      memory_[static_cast<std::size_t>(id)].look_again = 0;
      memory_[static_cast<std::size_t>(id)].near_fronts = true;
    }
    return false;
  });
}

void CrackGrowth::add_front(int id, const Vec3& normal, double time, Continuum& body) {
  const Vec3 position = body.material_position(id);
  fronts_.add(position, normal, time);
  closed_.push_back(front_points_.size());
  front_points_.push_back({id, normal});
  wake(position, normal, body);
}

void CrackGrowth::seed(int id, const Vec3& normal, Continuum& body) {
  PointState state = body.point(id);
  state.strength = state.threshold = law_.strength;
  state.softening_slope = law_.slope;
  state.damage = 1;
  if (state.damage_time < 0) state.damage_time = 0;
  body.set_point(id, state);
  // Cracks that are there have had all the time that a front needs.
  add_front(id, normal, -std::numeric_limits<double>::infinity(), body);
}

void CrackGrowth::inherit(const PriorDamage& prior, Continuum& body) {
  for (std::size_t id = 0; id < prior.damage.size(); ++id) {
    const double c = prior.damage[id];
    if (c <= 0) continue;
    PointState state = body.point(static_cast<int>(id));
    if (std::isinf(state.strength)) {
      state.strength = law_.strength;
      state.softening_slope = law_.slope;
    }
    // The stress that did this damage: c = (1 + H) (1 - strength / r).
    state.threshold = state.strength / (1 - std::min(c, 1.0) / (1 + state.softening_slope));
    state.damage = c;
    if (c >= failed_damage) state.damage_time = 0;
    body.set_point(static_cast<int>(id), state);
  }
  for (const PriorDamage::Front& front : prior.fronts)
    add_front(front.particle, front.normal, -std::numeric_limits<double>::infinity(), body);
}

PriorDamage CrackGrowth::damage(const Continuum& body) const {
  PriorDamage result;
  for (int id = 0; id < body.size(); ++id) result.damage.push_back(body.damage(id));
  result.fronts = front_points_;
  return result;
}

std::vector<CrackFace> CrackGrowth::new_faces(const Continuum& body) {
  std::vector<CrackFace> faces;
  std::erase_if(closed_, [&](std::size_t n) {
    const PriorDamage::Front& front = front_points_[n];
    if (body.damage(front.particle) < failed_damage) return false;
    faces.push_back({body.material_position(front.particle), front.normal});
    return true;
  });
  return faces;
}

Candidate CrackGrowth::candidate(int id, const Continuum& body) const {
  const Mat3 h = body.displacement_gradient(id);
  const auto stress = largest_principal_stress(body.elasticity().cauchy_stress(h, volume_change(h)));
  return {id, body.material_position(id), stress.direction, stress.value,
          stress.value / nucleation_strength_[static_cast<std::size_t>(id)]};
}

/// Near fronts that had nothing to say are not asked again before there are new ones or the stress has turned.
CrackFronts::Sight CrackGrowth::look(const Candidate& c, double time) {
  Memory& memory = memory_[static_cast<std::size_t>(c.particle)];
  const bool turned = std::abs(memory.normal.dot(c.normal)) < same_direction;
  const CrackFronts::Hint hint{!memory.near_fronts && !turned, memory.shielder};
  const auto sight = fronts_.look(c.position, c.normal, time, hint);
  memory.shielder = sight.shielder;
  if (!hint.far) {
    memory.near_fronts = sight.early || sight.ahead || sight.fills;
    memory.normal = c.normal;
  }
  return sight;
}

/// Strongest first, ties by index. What the fronts of earlier steps say has been asked in parallel; only fronts of this
/// step are asked in order.
void CrackGrowth::decide(const std::vector<Asked>& asked, double time, Continuum& body) {
  const int known = fronts_.count();
  for (const auto& [c, earlier] : asked) {
    const auto sight = fronts_.count() > known ? earlier | fronts_.look(c.position, c.normal, time, known) : earlier;
    const Verdict verdict = sight.verdict();
    const double needed =
        verdict == Verdict::nucleate ? nucleation_strength_[static_cast<std::size_t>(c.particle)] : law_.strength;
    if (verdict == Verdict::wait || c.stress <= needed) {
      if (!sight.early)
        memory_[static_cast<std::size_t>(c.particle)].look_again =
            step_ + (sight.shields ? shielded_steps_between_looks : steps_between_looks);
      continue;
    }
    body.start_crack(c.particle, law_.strength, law_.slope);
    if (verdict == Verdict::nucleate) ++nuclei_;
    if (verdict == Verdict::filler) continue;
    add_front(c.particle, c.normal, time, body);
  }
}

void CrackGrowth::grow(double time, Continuum& body) {
  if (++step_ % steps_between_decisions != 0) return;
  std::vector<int> ids;
  for (int id : body.candidates())
    if (memory_[static_cast<std::size_t>(id)].look_again <= step_) ids.push_back(id);
  if (ids.empty()) return;
  std::vector<Asked> asked(ids.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, ids.size(), grain), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      asked[n].candidate = candidate(ids[n], body);
      asked[n].sight = look(asked[n].candidate, time);
    }
  });
  std::sort(asked.begin(), asked.end(), [](const Asked& a, const Asked& b) {
    const Candidate &p = a.candidate, &q = b.candidate;
    return p.urgency > q.urgency || (p.urgency == q.urgency && p.particle < q.particle);
  });
  decide(asked, time, body);
}

}  // namespace sunder::mpm
