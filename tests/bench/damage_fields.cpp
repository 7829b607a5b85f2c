/// The damage that the two models leave in the same bodies, as CSV for tools/damage_pictures.py: case, position [m],
/// damage, time of failure [s].
#include <cstdio>
#include <tuple>

#include "tests/mpm/bodies.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

void print(const char* name, const fixture::Body& body, const SolveResult& result) {
  for (std::size_t n = 0; n < body.points.size(); ++n) {
    const Vec3& x = body.points[n];
    std::printf("%s,%.6g,%.6g,%.6g,%.4g,%.4g\n", name, x[0], x[1], x[2], result.particles[n].damage,
                result.particles[n].damage_time);
  }
  std::fprintf(stderr, "%s: %.1f %% damaged\n", name, 100 * result.damaged_share);
}

}  // namespace

int main() {
  const fixture::Body plate = fixture::plate(0.1 / 60);
  const Load load = fixture::steel_ball_on_glass({0.013, 0.01, -0.02}, Vec3::UnitY(), 10);
  for (const auto& [name, damage, fields] :
       {std::tuple{"local", DamageModel::local, false}, std::tuple{"front", DamageModel::front, false},
        std::tuple{"front with two fields", DamageModel::front, true}}) {
    SolveSettings settings;
    settings.damage = damage;
    settings.two_fields = fields;
    print(name, plate, fixture::run(plate, fixture::glass(), {load}, {{fixture::steel_ball_mass(0.01)}}, settings));
  }
}
