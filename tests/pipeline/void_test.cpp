/// D7: a body in the void of another, as a closed crack leaves it, stays quiet.
#include <gtest/gtest.h>

#include "geometry/cut.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "pipeline/lifecycle.h"
#include "rigid/world.h"

namespace sunder::pipeline {
namespace {

constexpr double density = 2400;

/// A crack all round a ball in the middle of a body.
geometry::RegionBoundary round_crack(const Vec3& centre, double radius) {
  const geometry::TriangleMesh ball = geometry::transformed(geometry::sphere(radius), Mat3::Identity(), centre);
  geometry::RegionBoundary regions;
  regions.vertices = ball.vertices;
  regions.region_count = 2;
  for (const geometry::Triangle& t : ball.faces) regions.faces.push_back({{t[0], t[1], t[2]}, 0, 1});
  return regions;
}

rigid::BodySetup setup_of(const geometry::TriangleMesh& mesh, double whole_volume, const FractureSettings& settings) {
  const geometry::MassProperties m = geometry::mass_properties(mesh);
  const geometry::TriangleMesh centred = geometry::transformed(mesh, Mat3::Identity(), -m.centroid);
  rigid::BodySetup setup;
  setup.hulls = geometry::convex_parts(centred, collision_detail(size_class(m.volume / whole_volume, settings))).hulls;
  setup.mass = density * m.volume;
  setup.inertia = density * m.inertia;
  setup.pose.position = m.centroid;
  setup.family = 1;
  return setup;
}

TEST(Void, ABodyInsideAnotherStaysQuiet) {
  for (const double size : {0.02, 0.1, 1.0}) {
    for (const double off_centre : {0.0, 0.1}) {
      const geometry::TriangleMesh body =
          geometry::transformed(geometry::box(Vec3::Constant(size)), Mat3::Identity(), Vec3(0, size / 2, 0));
      SilentProgress progress;
      const geometry::CutResult cut =
          geometry::cut(body, round_crack(Vec3(off_centre * size, size / 2, 0), 0.3 * size), {}, progress);
      ASSERT_EQ(cut.fragments.size(), 2u) << cut.detail;
      rigid::WorldSettings settings;
      settings.has_ground = true;
      rigid::World world(settings);
      std::vector<Vec3> places;
      for (const geometry::Fragment& fragment : cut.fragments) {
        const rigid::BodySetup setup = setup_of(fragment.mesh, size * size * size, {});
        places.push_back(setup.pose.position);
        world.add(setup);
      }
      double fastest = 0;
      for (int step = 0; step < 5 * 480; ++step) {
        world.step();
        for (rigid::BodyId id : world.bodies()) fastest = std::max(fastest, world.state(id).twist.linear.norm());
      }
      // In five seconds it may settle by a thousandth of its size; a jolt would be some sqrt(g size).
      EXPECT_LT(fastest, 0.02 * std::sqrt(9.81 * size)) << size << " " << off_centre;
      for (rigid::BodyId id : world.bodies())
        EXPECT_LT((world.state(id).pose.position - places[static_cast<std::size_t>(id)]).norm(), 1e-3 * size)
            << size << " " << off_centre;
    }
  }
}

}  // namespace
}  // namespace sunder::pipeline
