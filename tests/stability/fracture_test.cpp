/// Hard cases of one fracture: extreme speeds, sizes, materials and generations stay finite, closed and complete.
#include "pipeline/fracture.h"

#include <cmath>

#include <gtest/gtest.h>

#include "geometry/inspect.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"

namespace sunder::pipeline {
namespace {

Material glass() { return {"glass", 2500, 70e9, 0.22, 40e6, 8, 5.5e9, 8, 0.4, 0.4, true, ""}; }

/// A steel ball of a tenth of the body's size against the top of the body, a little off its centre.
FractureInput hit(const geometry::TriangleMesh& mesh, const Material& material, double speed, int particles = 1500) {
  const Box box = geometry::bounds(mesh);
  const double radius = 0.05 * box.sizes().maxCoeff();
  FractureInput input;
  input.mesh = mesh;
  input.material = material;
  input.particles = particles;
  mpm::Load load;
  load.point = box.center() + Vec3(0.11 * box.sizes()[0], 0.5 * box.sizes()[1], 0.07 * box.sizes()[2]);
  load.outward = Vec3::UnitY();
  load.approach_speed = speed;
  load.pair = {radius, mpm::effective_modulus(material.youngs_modulus, material.poisson_ratio, 210e9, 0.3),
               material.contact_pressure};
  input.loads = {load};
  input.partners = {{7800 * 4.19 * radius * radius * radius}};
  return input;
}

/// Returns the number of pieces.
std::size_t expect_sound(const FractureInput& input, const std::string& what) {
  SilentProgress progress;
  const FractureOutcome outcome = fracture(input, progress);
  EXPECT_FALSE(outcome.fallbacks.contains("fracture_abandoned")) << what;
  EXPECT_LE(outcome.solve.work, 1.001 * outcome.solve.impact_energy) << what;  // the books close to first order in dt
  const double volume = geometry::mass_properties(input.mesh).volume;
  double sum = 0;
  for (const BrokenPiece& piece : outcome.pieces) {
    EXPECT_TRUE(geometry::inspect(piece.fragment.mesh).is_solid()) << what;
    EXPECT_TRUE(piece.twist.linear.allFinite() && piece.twist.angular.allFinite()) << what;
    sum += geometry::mass_properties(piece.fragment.mesh).volume;
  }
  if (!outcome.pieces.empty()) {
    EXPECT_NEAR(sum / volume, 1, 1e-9) << what;
  }
  return outcome.pieces.size();
}

TEST(StableFracture, AnySpeed) {
  const auto plate = geometry::box(Vec3(0.2, 0.01, 0.2));
  EXPECT_EQ(expect_sound(hit(plate, glass(), 1e-3), "a touch"), 0u);
  for (const double speed : {5.0, 50.0, 500.0, 3000.0})
    expect_sound(hit(plate, glass(), speed), std::to_string(speed) + " m/s");
}

TEST(StableFracture, AnySize) {
  // Speeds that bring the same energy per crack area: v^2 size is constant.
  for (const double size : {1e-3, 0.02, 0.2, 20.0})
    expect_sound(hit(geometry::box(size * Vec3(1, 0.06, 1)), glass(), 10 * std::sqrt(0.2 / size)),
                 std::to_string(size) + " m");
}

TEST(StableFracture, MaterialsAtTheEdge) {
  const auto cup = geometry::cup(0.1, 0.006);
  Material nearly_incompressible = glass(), auxetic = glass(), weak = glass(), tough = glass(), soft = glass();
  nearly_incompressible.poisson_ratio = 0.49;
  auxetic.poisson_ratio = -0.2;
  weak.tensile_strength = 200;
  tough.fracture_energy = 1e5;
  soft.youngs_modulus = 1e6;
  for (const Material& m : {nearly_incompressible, auxetic, weak, tough, soft}) expect_sound(hit(cup, m, 10), "cup");
}

TEST(StableFracture, ThinnerThanTheParticles) {
  // At 1500 particles the wall is a fifth of a spacing thick: whatever breaks must be closed and complete.
  expect_sound(hit(geometry::box(Vec3(0.3, 0.0006, 0.3)), glass(), 10), "a foil");
  expect_sound(hit(geometry::box(Vec3(0.004, 0.5, 0.004)), glass(), 10), "a needle");
}

TEST(StableFracture, FewParticles) {
  for (const int particles : {1, 7, 40})
    expect_sound(hit(geometry::sphere(0.05, 2), glass(), 80, particles), std::to_string(particles));
}

TEST(StableFracture, GenerationAfterGeneration) {
  geometry::TriangleMesh mesh = geometry::box(Vec3(0.2, 0.02, 0.2));
  int broken = 0;
  for (int generation = 0; generation < 8; ++generation) {
    // Smaller and stouter pieces take more to break.
    FractureInput input = hit(mesh, glass(), 40 * std::pow(1.5, generation));
    input.seed = static_cast<std::uint64_t>(generation);
    SilentProgress progress;
    const FractureOutcome outcome = fracture(input, progress);
    EXPECT_FALSE(outcome.fallbacks.contains("fracture_abandoned")) << "generation " << generation;
    if (outcome.pieces.empty()) break;
    ++broken;
    const auto largest =
        std::max_element(outcome.pieces.begin(), outcome.pieces.end(), [](const auto& a, const auto& b) {
          return geometry::mass_properties(a.fragment.mesh).volume < geometry::mass_properties(b.fragment.mesh).volume;
        });
    mesh = largest->fragment.mesh;
    const Vec3 centroid = geometry::mass_properties(mesh).centroid;
    mesh = geometry::transformed(mesh, Mat3::Identity(), -centroid);
  }
  EXPECT_GE(broken, 3);
}

}  // namespace
}  // namespace sunder::pipeline
