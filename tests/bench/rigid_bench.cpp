/// How fast heaps of fragments move, and how well they lie: ./sunder bench rigid [--json FILE]. The baseline of each
/// ratio is Bullet as it comes, with the same hulls, in the same run.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <btBulletDynamicsCommon.h>

#include "core/random.h"
#include "crack/shatter.h"
#include "geometry/convex_parts.h"
#include "geometry/cut.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "rigid/world.h"
#include "tests/bench/table.h"

namespace sunder {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int fragment_count = 1000;
constexpr double body_size = 0.4;  // [m]
constexpr double density = 2400;   // [kg/m^3]
constexpr double rate = 480;       // steps per second of simulated time
constexpr double falling = 1.0;    // until the heap has formed [s]
constexpr double lying = 0.5;      // the heap is watched for so long [s]
constexpr double settling = 4;     // after so long everything should sleep [s]

/// Fragments of a torus: those at its surface are concave, those inside are convex.
std::vector<geometry::TriangleMesh> fragments_of_ring() {
  const geometry::TriangleMesh ring = geometry::torus(body_size / 2, body_size / 5, 96, 48);
  const Box box = geometry::bounds(ring);
  std::vector<Vec3> sites;
  for (std::uint64_t i = 0; sites.size() < fragment_count; ++i) {
    const Vec3 unit(random_unit(1, 0, i), random_unit(1, 1, i), random_unit(1, 2, i));
    const Vec3 x = box.min() + unit.cwiseProduct(box.sizes());
    const double from_axis = std::hypot(x.x(), x.z()) - body_size / 2;
    if (std::hypot(from_axis, x.y()) < body_size / 5) sites.push_back(x);
  }
  SilentProgress progress;
  const geometry::CutResult cut = geometry::cut(ring, crack::voronoi_cells(sites, box, 1, progress), {}, progress);
  std::vector<geometry::TriangleMesh> meshes;
  for (const geometry::Fragment& fragment : cut.fragments) meshes.push_back(fragment.mesh);
  meshes.resize(std::min<std::size_t>(meshes.size(), fragment_count));
  return meshes;
}

/// The fragments on a lattice above the floor, turned at random.
std::vector<rigid::BodySetup> poured() {
  std::vector<rigid::BodySetup> setups;
  for (const geometry::TriangleMesh& mesh : fragments_of_ring()) {
    const geometry::MassProperties whole = geometry::mass_properties(mesh);
    rigid::BodySetup setup;
    setup.hulls = geometry::convex_parts(geometry::transformed(mesh, Mat3::Identity(), -whole.centroid),
                                         {.max_parts = 4, .gap = 0.01, .max_hull_vertices = 32})
                      .hulls;
    setup.mass = density * whole.volume;
    setup.inertia = density * whole.inertia;
    const std::uint64_t i = setups.size();
    const int place = static_cast<int>(i);
    const double gap = 0.07;
    setup.pose.position = gap * Vec3(place % 8 - 3.5, place / 64 + 1, place / 8 % 8 - 3.5);
    setup.pose.position += 0.2 * gap * Vec3(random_unit(2, 0, i), 0, random_unit(2, 1, i));
    setup.pose.orientation = Quat(Eigen::AngleAxisd(
        2 * std::numbers::pi * random_unit(2, 2, i),
        Vec3(random_unit(2, 3, i) - 0.5, random_unit(2, 4, i) - 0.5, random_unit(2, 5, i) - 0.5).normalized()));
    setups.push_back(std::move(setup));
  }
  return setups;
}

struct Rates {
  double heap = 0, resting = 0;  ///< steps per second
};

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// `step()` advances by one step.
template <class Step>
Rates rates_of(Step&& step) {
  const auto steps_per_second = [&](double time) {
    const int steps = static_cast<int>(time * rate);
    const auto start = Clock::now();
    for (int i = 0; i < steps; ++i) step();
    return steps / seconds_since(start);
  };
  steps_per_second(falling);
  Rates rates;
  rates.heap = steps_per_second(lying);
  steps_per_second(settling - falling - lying);
  rates.resting = steps_per_second(lying);
  return rates;
}

/// Bullet's own world, margins set to a hundredth of the smallest fragment instead of its 4 cm.
class StockWorld {
 public:
  explicit StockWorld(const std::vector<rigid::BodySetup>& setups)
      : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    world_.setGravity(btVector3(0, -9.81, 0));
    shapes_.push_back(std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0), 0));
    add(*shapes_.back(), 0, btTransform::getIdentity());
    for (const rigid::BodySetup& setup : setups) {
      auto compound = std::make_unique<btCompoundShape>();
      for (const geometry::TriangleMesh& mesh : setup.hulls) {
        auto hull = std::make_unique<btConvexHullShape>();
        for (const Vec3& x : mesh.vertices) hull->addPoint(btVector3(x.x(), x.y(), x.z()), false);
        hull->setMargin(1e-4);
        hull->recalcLocalAabb();
        compound->addChildShape(btTransform::getIdentity(), hull.get());
        shapes_.push_back(std::move(hull));
      }
      const Vec3& p = setup.pose.position;
      const Quat& q = setup.pose.orientation;
      add(*compound, setup.mass, btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), btVector3(p.x(), p.y(), p.z())));
      shapes_.push_back(std::move(compound));
    }
  }
  ~StockWorld() {
    for (auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  void step() { world_.stepSimulation(1 / rate, 0); }

 private:
  void add(btCollisionShape& shape, double mass, const btTransform& place) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape.calculateLocalInertia(mass, inertia);
    bodies_.push_back(std::make_unique<btRigidBody>(mass, nullptr, &shape, inertia));
    bodies_.back()->setWorldTransform(place);
    bodies_.back()->setFriction(0.5);
    world_.addRigidBody(bodies_.back().get());
  }

  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
};

double size_of(const rigid::BodySetup& setup) {
  Box box;
  for (const geometry::TriangleMesh& hull : setup.hulls)
    for (const Vec3& x : hull.vertices) box.extend(x);
  return box.sizes().maxCoeff();
}

/// Deepest overlap of two bodies over the size of the smaller one.
double penetration(const rigid::World& world, const std::vector<rigid::BodySetup>& setups) {
  double worst = 0;
  for (const rigid::World::Overlap& o : world.overlaps()) {
    const double a = size_of(setups[static_cast<std::size_t>(o.body_a)]);
    const double b = o.body_b < 0 ? a : size_of(setups[static_cast<std::size_t>(o.body_b)]);
    worst = std::max(worst, o.depth / std::min(a, b));
  }
  return worst;
}

void measure(bench::Table& table) {
  const std::vector<rigid::BodySetup> setups = poured();
  rigid::WorldSettings settings;
  settings.has_ground = true;
  settings.time_step = 1 / rate;
  rigid::World world(settings);
  std::size_t parts = 0;
  for (const rigid::BodySetup& setup : setups) world.add(setup), parts += setup.hulls.size();
  const Rates ours = rates_of([&] { world.step(); });
  StockWorld stock(setups);
  const Rates theirs = rates_of([&] { stock.step(); });
  table.add("fragments", static_cast<double>(setups.size()), "of a shattered ring, poured on the floor");
  table.add("hulls", static_cast<double>(parts), "they collide as");
  table.add("heap_1000_steps_per_second", ours.heap, "as the heap comes to rest, nearly all awake");
  table.add("heap_1000_over_stock", ours.heap / theirs.heap, "ratio to Bullet as it comes");
  table.add("resting_1000_steps_per_second", ours.resting, "after 3.5 s (goal 60)");
  table.add("resting_1000_over_stock", ours.resting / theirs.resting, "ratio to Bullet as it comes");
  table.add("resting_penetration", penetration(world, setups),
            "deepest overlap over the smaller body's size (goal 0.01)");
  double fastest = 0;
  for (rigid::BodyId id : world.bodies()) fastest = std::max(fastest, world.state(id).twist.linear.norm());
  table.add("resting_fastest", fastest, "speed of the fastest fragment at the end [m/s]");
}

}  // namespace
}  // namespace sunder

int main(int argc, char** argv) {
  const bool json = argc == 3 && std::strcmp(argv[1], "--json") == 0;
  if (argc != 1 && !json) {
    std::fprintf(stderr, "usage: rigid_bench [--json FILE]\n");
    return 2;
  }
  try {
    sunder::bench::Table table;
    sunder::measure(table);
    if (json) table.save(argv[2]);
    return 0;
  } catch (const sunder::Error& error) {
    std::fprintf(stderr, "rigid_bench: %s\n", error.what());
    return static_cast<int>(error.kind());
  }
}
