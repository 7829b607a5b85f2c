#include <cmath>

#include "validation/catalogue.h"
#include "validation/specimen.h"

namespace sunder::validation {
namespace {

constexpr double cell = 0.125, friction = 0.3;

/// Halves of a block of dust on the two sides of a crack plane, one step with two velocity fields.
struct Halves {
  double crosstalk = 0;         ///< largest change of a particle's velocity [m/s]
  double momentum = 0;          ///< change of momentum over mass [m/s]
  double sliding = 0;           ///< largest change of a velocity across the normal [m/s]
  Vec3 impulse = Vec3::Zero();  ///< mean change of the half in front of the plane [m/s]
};

/// `front` and `back`: velocities before the step.
Halves step_halves(const Vec3& normal, const Vec3& front, const Vec3& back, double coefficient) {
  const Vec3 n = normal.normalized(), u = n.unitOrthogonal(), v = n.cross(u);
  constexpr double offset = 0.013;
  const Lattice lattice = solid(Box(Vec3::Constant(-0.5), Vec3::Constant(0.5)), cell, {}, 0.2);
  mpm::ContinuumSettings settings;
  settings.cell_size = cell;
  settings.time_step = 1e-4;
  settings.anchor = Vec3::Constant(0.0371);
  mpm::Continuum body(lattice.points, lattice.particle_volume, {.density = 1000}, settings);
  std::vector<mpm::CrackFace> faces;
  for (int i = -24; i <= 24; ++i)
    for (int j = -24; j <= 24; ++j) faces.push_back({offset * n + 0.5 * cell * (i * u + j * v), n});
  std::vector<mpm::Motion> before;
  for (const Vec3& x : lattice.points) before.push_back({x.dot(n) > offset ? front : back, Mat3::Zero()});
  body.open(faces, coefficient);
  body.start(before);
  body.update_grid();
  const auto after = body.finish();

  Halves result;
  Vec3 sum = Vec3::Zero();
  int in_front = 0;
  for (std::size_t p = 0; p < after.size(); ++p) {
    const Vec3 change = after[p].velocity - before[p].velocity;
    sum += change;
    result.crosstalk = std::max(result.crosstalk, change.norm());
    result.sliding = std::max(result.sliding, (change - change.dot(n) * n).norm());
    if (lattice.points[p].dot(n) <= offset) continue;
    result.impulse += change;
    ++in_front;
  }
  result.momentum = sum.norm() / static_cast<double>(after.size());
  result.impulse /= in_front;
  return result;
}

/// D6. Fan (2024) eq. 3.7 prints the sign of separation, and eq. 3.6 a normal that is no unit vector: bodies would
/// stick as they part and pass through each other as they meet.
Outcome two_fields() {
  double crosstalk = 0, momentum = 0, sliding = 0, ratio = 0, least_push = 1;
  for (const Vec3& n : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 2, 3), Vec3(1, 1, 1)}) {
    const Vec3 away = n.normalized(), along = away.unitOrthogonal();
    crosstalk = std::max(crosstalk, step_halves(n, away, -away, friction).crosstalk);
    const Halves smooth = step_halves(n, along - away, away - along, 0);
    momentum = std::max(momentum, smooth.momentum);
    sliding = std::max(sliding, smooth.sliding);
    least_push = std::min(least_push, smooth.impulse.dot(away));
    const Halves rough = step_halves(n, 5 * along - away, away - 5 * along, friction);
    momentum = std::max(momentum, rough.momentum);
    ratio = std::max(ratio, std::abs(-rough.impulse.dot(along) / rough.impulse.dot(away) - friction));
  }
  Outcome outcome;
  outcome.checks = {absolute("parting halves: change of velocity [m/s]", crosstalk, 0, 1e-12),
                    within("meeting halves: push on one of them [m/s]", least_push, 0.05, 1),
                    absolute("change of momentum over mass [m/s]", momentum, 0, 1e-13),
                    absolute("without friction: change of the sliding [m/s]", sliding, 0, 1e-12),
                    absolute("share of the push that friction takes, from Coulomb's [1]", ratio, 0, 1e-12)};
  return outcome;
}

}  // namespace

std::vector<Problem> contact() {
  return {{"D6", "Contact of two velocity fields across a crack", "inelastic impact; Coulomb", two_fields}};
}

}  // namespace sunder::validation
