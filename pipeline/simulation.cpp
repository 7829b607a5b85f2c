#include "pipeline/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geometry/convex_parts.h"
#include "geometry/primitives.h"
#include "pipeline/detail/piece_mesh.h"
#include "pipeline/quality.h"
#include "pipeline/stopwatch.h"

namespace sunder::pipeline {
namespace {

/// Collision hulls bulge over concave surfaces: overlaps under this share of the smaller body are not the scene's
/// fault.
constexpr double tolerated_overlap = 0.05;

rigid::WorldSettings world_settings(const Scene& scene, int steps_per_frame) {
  rigid::WorldSettings w;
  w.gravity = scene.gravity;
  w.time_step = 1 / (scene.frame_rate * steps_per_frame);
  if (scene.ground) {
    w.has_ground = true;
    w.ground_height = scene.ground->height;
    w.ground_restitution = scene.ground->material.restitution;
    w.ground_friction = scene.ground->material.friction;
  }
  return w;
}

int steps_in_frame(const Scene& scene) {
  return static_cast<int>(std::ceil(settings_of(scene.quality).rigid_rate / scene.frame_rate - 1e-9));
}

/// Collision cost grows with the product of the parts of two bodies, and the shape of a small fragment hardly shows. A
/// whole body may be a ball, which takes many vertices to roll.
geometry::ConvexPartsSettings collision_detail(double share_of_original) {
  if (share_of_original < 0.002) return {.max_parts = 1, .gap = 0.02, .max_hull_vertices = 24};
  if (share_of_original < 0.02) return {.max_parts = 4, .gap = 0.01, .max_hull_vertices = 32};
  if (share_of_original < 0.2) return {.max_parts = 10, .gap = 0.01, .max_hull_vertices = 48};
  if (share_of_original < 0.98) return {.max_parts = 20, .gap = 0.005, .max_hull_vertices = 64};
  return {.max_parts = 40, .gap = 0.005, .max_hull_vertices = 256};
}

double size_of(const Piece& piece) { return geometry::bounds(piece.mesh).sizes().maxCoeff(); }

}  // namespace

Simulation::Simulation(const Scene& scene, const RunOptions& options, Progress& progress)
    : scene_(scene),
      options_(options),
      steps_per_frame_(steps_in_frame(scene)),
      world_(world_settings(scene, steps_per_frame_)) {
  sequence_.name = scene.name;
  sequence_.frame_rate = scene.frame_rate;
  sequence_.start_frame = scene.start_frame;
  original_volume_.resize(scene.bodies.size());
  fracture_count_.resize(scene.bodies.size());
  const Stopwatch watch(report_.seconds.setup);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    progress.checkpoint("setup", static_cast<double>(b) / static_cast<double>(scene.bodies.size()));
    place(scene.bodies[b], static_cast<int>(b));
  }
  require_no_overlap();
}

void Simulation::place(const SceneBody& body, int index) {
  BodyMesh source = body_mesh(body);
  if (!source.repairs.empty()) report_.repairs.push_back({body.name, source.repairs});
  Piece piece;
  piece.id = static_cast<int>(sequence_.pieces.size());
  piece.name = piece.body = body.name;
  piece.material = body.material.name;
  piece.mesh = std::move(source.mesh);
  RigidPart part = detail::centred(piece.mesh, body.material.density, piece);
  const Pose pose{part.centre, Quat::Identity()};
  part.centre.setZero();
  piece.inside.assign(piece.mesh.faces.size(), false);
  original_volume_[static_cast<std::size_t>(index)] = piece.volume;
  const Live live{piece.id, &body, index, part};
  add_body(piece, live, pose, {body.velocity, body.angular_velocity}, 0);
  sequence_.pieces.push_back(std::move(piece));
}

rigid::BodyId Simulation::add_body(const Piece& piece, const Live& live, const Pose& pose, const Twist& twist,
                                   int family) {
  rigid::BodySetup setup;
  const double share = piece.volume / original_volume_[static_cast<std::size_t>(live.origin_index)];
  setup.hulls = geometry::convex_parts(piece.mesh, collision_detail(share)).hulls;
  if (setup.hulls.empty()) {
    const Box box = geometry::bounds(piece.mesh);
    setup.hulls = {geometry::transformed(geometry::box(box.sizes().cwiseMax(1e-3 * box.sizes().maxCoeff())),
                                         Mat3::Identity(), box.center())};
    ++report_.fallbacks["sliver_collides_as_box"];
  }
  setup.mass = live.part.mass;
  setup.inertia = live.part.inertia;
  setup.pose = pose;
  setup.twist = twist;
  setup.motion = piece.generation > 0 ? rigid::Motion::dynamic : live.origin->motion;
  setup.restitution = live.origin->material.restitution;
  setup.friction = live.origin->material.friction;
  setup.family = family;
  const rigid::BodyId id = world_.add(setup);
  live_.emplace(id, live);
  return id;
}

void Simulation::require_no_overlap() const {
  for (const rigid::World::Overlap& o : world_.overlaps()) {
    const Piece& a = piece_of(live_.at(o.body_a));
    const bool on_ground = o.body_b == rigid::ground_id;
    const double size = on_ground ? size_of(a) : std::min(size_of(a), size_of(piece_of(live_.at(o.body_b))));
    if (o.depth <= tolerated_overlap * size) continue;
    char depth[32];
    std::snprintf(depth, sizeof depth, "%.3g mm", o.depth * 1e3);
    throw Error(ErrorKind::usage, scene_.file.string() + ":" + std::to_string(live_.at(o.body_a).origin->line) +
                                      ": body '" + a.name + "' overlaps " +
                                      (on_ground ? "the ground" : "body '" + piece_of(live_.at(o.body_b)).name + "'") +
                                      " by " + depth + " at the start; move one of them");
  }
}

bool Simulation::may_break(const Live& live, double now) const {
  const Piece& piece = piece_of(live);
  const std::size_t origin = static_cast<std::size_t>(live.origin_index);
  if (!scene_.effects.fracture || !live.origin->breakable || !live.origin->material.breakable) return false;
  if (piece.generation > 0 && !scene_.effects.refracture) return false;
  if (fracture_count_[origin] >= scene_.fracture.maximum_fractures) return false;
  if (piece.volume < scene_.fracture.minimum_volume * original_volume_[origin]) return false;
  const double delay = scene_.fracture.refracture_delay;
  if (piece.generation > 0 && now - piece.birth_time < delay) return false;
  return live.last_solve < now && now - live.last_solve >= delay;
}

const Piece& Simulation::piece_of(const Live& live) const {
  return sequence_.pieces[static_cast<std::size_t>(live.piece)];
}

/// Infinite for the ground and for bodies that do not yield.
double Simulation::free_mass(rigid::BodyId id) const {
  const auto live = live_.find(id);
  if (live == live_.end() || motion_of(live->second) != rigid::Motion::dynamic)
    return std::numeric_limits<double>::infinity();
  return live->second.part.mass;
}

/// Fragments fly free whatever held their body.
rigid::Motion Simulation::motion_of(const Live& live) const {
  return piece_of(live).generation > 0 ? rigid::Motion::dynamic : live.origin->motion;
}

/// About its own centre of mass, in world axes.
RigidPart Simulation::world_part(rigid::BodyId id) const {
  return {world_.mass(id), Vec3::Zero(), world_.world_inertia(id)};
}

double Simulation::energy_of(rigid::BodyId id) const {
  return std::isinf(free_mass(id)) ? 0 : kinetic_energy({world_part(id)}, {world_.state(id).twist});
}

/// Not set in the scene: the impulse whose energy could just open one crack of area V^(2/3).
double Simulation::minimum_impulse(const Live& live, double partner_mass) const {
  if (scene_.fracture.minimum_impulse) return *scene_.fracture.minimum_impulse;
  const Piece& piece = piece_of(live);
  const double energy = live.origin->material.fracture_energy * std::pow(piece.volume, 2.0 / 3);
  const double m = std::isinf(partner_mass) ? piece.mass : piece.mass * partner_mass / (piece.mass + partner_mass);
  return std::sqrt(2 * m * energy);
}

std::vector<Simulation::Hit> Simulation::breaking_hits(const std::vector<rigid::Impact>& impacts, double now) const {
  std::map<rigid::BodyId, Hit> hits;
  std::map<std::pair<rigid::BodyId, rigid::BodyId>, double> impulse;
  const auto add = [&](const rigid::Impact& impact) {
    const auto live = live_.find(impact.body_a);
    if (live == live_.end() || !may_break(live->second, now)) return;
    Hit& hit = hits[impact.body_a];
    hit.body = impact.body_a;
    hit.impacts.push_back(impact);
    impulse[{impact.body_a, impact.body_b}] += impact.impulse;
  };
  for (const rigid::Impact& impact : impacts) {
    add(impact);
    if (impact.body_b == rigid::ground_id) continue;
    rigid::Impact mirrored = impact;
    std::swap(mirrored.body_a, mirrored.body_b);
    mirrored.normal = -impact.normal;
    std::swap(mirrored.arm_a, mirrored.arm_b);
    add(mirrored);
  }
  for (const auto& [pair, sum] : impulse) {
    Hit& hit = hits.at(pair.first);
    hit.impulse += sum;
    hit.severity = std::max(hit.severity, sum / minimum_impulse(live_.at(pair.first), free_mass(pair.second)));
  }
  std::vector<Hit> chosen;
  for (auto& [body, hit] : hits)
    if (hit.severity >= 1) chosen.push_back(std::move(hit));
  std::stable_sort(chosen.begin(), chosen.end(), [](const Hit& a, const Hit& b) { return a.severity > b.severity; });
  // The impulse between two bodies is settled by one solve: the body hit harder breaks first, the other one in the
  // repeated step.
  std::vector<Hit> independent;
  for (Hit& hit : chosen) {
    const bool clashes = std::any_of(independent.begin(), independent.end(), [&](const Hit& other) {
      return std::any_of(hit.impacts.begin(), hit.impacts.end(), [&](const auto& i) { return i.body_b == other.body; });
    });
    if (!clashes) independent.push_back(std::move(hit));
  }
  return independent;
}

std::vector<rigid::Impact> Simulation::step_world() {
  const Stopwatch watch(report_.seconds.rigid);
  return world_.step();
}

void Simulation::step(Progress& progress) {
  if (!scene_.effects.fracture) {
    step_world();
    return;
  }
  for (;;) {
    const auto before = world_.snapshot();
    const auto hits = breaking_hits(step_world(), before.time);
    if (hits.empty()) return;
    world_.restore(before);
    for (const Hit& hit : hits) solve(hit, progress);
  }
}

void Simulation::record_frame() {
  Frame frame;
  frame.time = world_.time();
  for (const auto& [id, live] : live_) frame.poses.push_back({live.piece, world_.state(id).pose});
  std::sort(frame.poses.begin(), frame.poses.end(),
            [](const PiecePose& a, const PiecePose& b) { return a.piece < b.piece; });
  sequence_.frames.push_back(std::move(frame));
}

}  // namespace sunder::pipeline
