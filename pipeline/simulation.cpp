#include "pipeline/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <tbb/parallel_for.h>

#include "core/optional_effects.h"
#include "core/stopwatch.h"
#include "geometry/convex_parts.h"
#include "geometry/primitives.h"
#include "mpm/contact_load.h"
#include "pipeline/detail/piece_mesh.h"
#include "pipeline/lifecycle.h"

namespace sunder::pipeline {
namespace {

/// Collision hulls bulge over concave surfaces: overlaps under this share of the smaller body are not the scene's
/// fault.
constexpr double tolerated_overlap = 0.05;

/// Elastic bodies leave as fast as they came: they take twice the momentum that stops them.
constexpr double most_restitution = 2;

/// Hits of less than this share of the severity of the hardest on a body are left out of its solve.
constexpr double slight_share = 0.05;

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
  return static_cast<int>(std::ceil(scene.quality.rigid_rate / scene.frame_rate - 1e-9));
}

std::size_t at(int index) { return static_cast<std::size_t>(index); }

double extent_of(const output::Piece& piece) { return geometry::bounds(piece.mesh).sizes().maxCoeff(); }

}  // namespace

Simulation::Simulation(const Scene& scene, const RunOptions& options, Progress& progress)
    : scene_(scene),
      options_(options),
      steps_per_frame_(steps_in_frame(scene)),
      world_(world_settings(scene, steps_per_frame_)) {
  state_.sequence.name = scene.name;
  state_.sequence.frame_rate = scene.frame_rate;
  state_.sequence.start_frame = scene.start_frame;
  state_.original_volume.resize(scene.bodies.size());
  state_.fracture_count.resize(scene.bodies.size());
  const Stopwatch watch(state_.report.seconds.setup);
  std::vector<RigidPart> parts;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    progress.checkpoint("setup", static_cast<double>(b) / static_cast<double>(scene.bodies.size()));
    parts.push_back(make_piece(scene.bodies[b]));
  }
  std::vector<Hulls> hulls(parts.size());
  tbb::parallel_for(std::size_t{0}, parts.size(),
                    [&](std::size_t b) { hulls[b] = hulls_of(state_.sequence.pieces[b], SizeClass::nearly_whole); });
  for (std::size_t b = 0; b < parts.size(); ++b) place(static_cast<int>(b), parts[b], std::move(hulls[b]));
  plan_effects_of_bodies();
  require_no_overlap();
}

Simulation::Simulation(const Scene& scene, const RunOptions& options, const rigid::World::State& world,
                       SimulationState state)
    : scene_(scene),
      options_(options),
      steps_per_frame_(steps_in_frame(scene)),
      world_(world_settings(scene, steps_per_frame_), world),
      state_(std::move(state)) {
  plan_effects_of_bodies();
}

/// The first pieces are the scene's bodies.
void Simulation::plan_effects_of_bodies() {
  std::vector<double> sizes;
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) sizes.push_back(extent_of(state_.sequence.pieces[b]));
  effects_ = plan_effects(scene_, sizes);
}

/// Adds a body of the scene to the sequence; returns its mass properties in world axes.
RigidPart Simulation::make_piece(const SceneBody& body) {
  BodyMesh source = body_mesh(body);
  if (!source.repair.steps.empty()) state_.report.repairs.push_back({body.name, source.repair});
  if (!source.note.empty()) state_.report.notes.push_back(source.note);
  output::Piece piece =
      detail::whole_piece(body.name, body.material.name, std::move(source.mesh), std::move(source.attributes));
  piece.id = static_cast<int>(state_.sequence.pieces.size());
  const RigidPart part = detail::centred(piece, body.material.density);
  piece.birth_position = part.centre;
  piece.birth = {body.velocity, body.angular_velocity};
  piece.birth_energy = kinetic_energy({part}, {piece.birth});
  state_.original_volume[at(piece.id)] = piece.volume;
  state_.sequence.pieces.push_back(std::move(piece));
  return part;
}

void Simulation::place(int index, const RigidPart& part, Hulls hulls) {
  const SceneBody& body = scene_.bodies[at(index)];
  Live live{index, index, {part.mass, Vec3::Zero(), part.inertia}};
  live.start = part.centre;
  try {
    add_body(state_.sequence.pieces[at(index)], live, std::move(hulls), {part.centre, Quat::Identity()},
             {body.velocity, body.angular_velocity}, 0);
  } catch (const Error& error) {
    throw Error(error.kind(), scene_.file.string() + ":" + std::to_string(body.line) + ": body '" + body.name +
                                  "' cannot move as a rigid body: " + error.what() + "; is it too thin or too small?");
  }
}

/// Empty when the piece is too thin for a hull.
Simulation::Hulls Simulation::hulls_of(const output::Piece& piece, SizeClass size) {
  return geometry::convex_parts(piece.mesh, collision_detail(size)).hulls;
}

rigid::BodyId Simulation::add_body(const output::Piece& piece, const Live& live, Hulls hulls, const Pose& pose,
                                   const Twist& twist, int family) {
  rigid::BodySetup setup;
  setup.hulls = std::move(hulls);
  if (setup.hulls.empty()) {
    const Box box = geometry::bounds(piece.mesh);
    setup.hulls = {geometry::transformed(geometry::box(box.sizes().cwiseMax(1e-3 * box.sizes().maxCoeff())),
                                         Mat3::Identity(), box.center())};
    ++state_.report.fallbacks["sliver_collides_as_box"];
  }
  setup.mass = live.part.mass;
  setup.inertia = live.part.inertia;
  setup.pose = pose;
  setup.twist = twist;
  setup.motion = piece.generation > 0 ? rigid::Motion::dynamic : origin_of(live).motion;
  setup.restitution = origin_of(live).material.restitution;
  setup.friction = origin_of(live).material.friction;
  setup.family = family;
  const rigid::BodyId id = world_.add(setup);
  state_.live.emplace(id, live);
  return id;
}

void Simulation::require_no_overlap() const {
  for (const rigid::World::Overlap& o : world_.overlaps()) {
    const output::Piece& a = piece_of(state_.live.at(o.body_a));
    const bool on_ground = o.body_b == rigid::ground_id;
    const double size =
        on_ground ? extent_of(a) : std::min(extent_of(a), extent_of(piece_of(state_.live.at(o.body_b))));
    if (o.depth <= tolerated_overlap * size) continue;
    char depth[32];
    std::snprintf(depth, sizeof depth, "%.3g mm", o.depth * 1e3);
    throw Error(ErrorKind::usage,
                scene_.file.string() + ":" + std::to_string(origin_of(state_.live.at(o.body_a)).line) + ": body '" +
                    a.name + "' overlaps " +
                    (on_ground ? "the ground" : "body '" + piece_of(state_.live.at(o.body_b)).name + "'") + " by " +
                    depth + " at the start; move one of them");
  }
}

bool Simulation::may_break(const Live& live, double now) const {
  const output::Piece& piece = piece_of(live);
  const std::size_t origin = static_cast<std::size_t>(live.origin);
  if (!origin_of(live).breakable || !origin_of(live).material.breakable) return false;
  if (piece.generation > 0 && !(with_optional_effects && effects_.runs(Effect::secondary_fracture))) return false;
  if (state_.fracture_count[origin] >= scene_.fracture.maximum_fractures) return false;
  if (state_.fragment_count >= scene_.fracture.maximum_fragments) return false;
  if (share_of(live) < minimum_volume(scene_.fracture)) return false;
  const double delay = scene_.fracture.refracture_delay;
  if (piece.generation > 0 && now - piece.birth_time < delay) return false;
  return live.last_solve < now && now - live.last_solve >= delay;
}

const output::Piece& Simulation::piece_of(const Live& live) const {
  return state_.sequence.pieces[static_cast<std::size_t>(live.piece)];
}

/// Of the volume of the scene's body that it comes from.
double Simulation::share_of(const Live& live) const {
  return piece_of(live).volume / state_.original_volume[static_cast<std::size_t>(live.origin)];
}

SizeClass Simulation::size_of(const Live& live) const { return size_class(share_of(live), scene_.fracture); }

/// Infinite for the ground and for bodies that do not yield.
double Simulation::free_mass(rigid::BodyId id) const {
  const auto live = state_.live.find(id);
  if (live == state_.live.end() || motion_of(live->second) != rigid::Motion::dynamic)
    return std::numeric_limits<double>::infinity();
  return live->second.part.mass;
}

/// Fragments fly free whatever held their body.
rigid::Motion Simulation::motion_of(const Live& live) const {
  return piece_of(live).generation > 0 ? rigid::Motion::dynamic : origin_of(live).motion;
}

/// About its own centre of mass, in world axes.
RigidPart Simulation::world_part(rigid::BodyId id) const {
  return {world_.mass(id), Vec3::Zero(), world_.world_inertia(id)};
}

double Simulation::energy_of(rigid::BodyId id) const {
  return std::isinf(free_mass(id)) ? 0 : kinetic_energy({world_part(id)}, {world_.state(id).twist});
}

/// Not set in the scene: the impulse whose energy could just open one crack through the body.
double Simulation::minimum_impulse(const Live& live, double partner_mass) const {
  if (origin_of(live).minimum_impulse) return *origin_of(live).minimum_impulse;
  if (scene_.fracture.minimum_impulse) return *scene_.fracture.minimum_impulse;
  const output::Piece& piece = piece_of(live);
  const double energy = crack_through_energy(origin_of(live).material, piece.volume);
  const double m = mpm::reduced_mass(piece.mass, partner_mass);
  return std::sqrt(2 * m * energy);
}

std::vector<Simulation::Hit> Simulation::breaking_hits(const std::vector<rigid::Impact>& impacts, double now) const {
  std::map<rigid::BodyId, Hit> hits;
  std::map<std::pair<rigid::BodyId, rigid::BodyId>, double> impulse, speed;
  const auto add = [&](const rigid::Impact& impact) {
    const auto live = state_.live.find(impact.body_a);
    if (live == state_.live.end() || !may_break(live->second, now)) return;
    Hit& hit = hits[impact.body_a];
    hit.body = impact.body_a;
    hit.impacts.push_back(impact);
    impulse[{impact.body_a, impact.body_b}] += impact.impulse;
    double& fastest = speed[{impact.body_a, impact.body_b}];
    fastest = std::max(fastest, impact.approach_speed);
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
  std::map<std::pair<rigid::BodyId, rigid::BodyId>, double> severity;
  for (const auto& [pair, sum] : impulse) {
    Hit& hit = hits.at(pair.first);
    hit.impulse += sum;
    // A stack passes on what its top takes; what loads a body is what its own contact can stop.
    const double stopped = most_restitution *
                           mpm::reduced_mass(piece_of(state_.live.at(pair.first)).mass, free_mass(pair.second)) *
                           speed[pair];
    severity[pair] = std::min(sum, stopped) / minimum_impulse(state_.live.at(pair.first), free_mass(pair.second));
    hit.severity = std::max(hit.severity, severity[pair]);
  }
  // A crumb that touches a body just as it breaks is no load, and its lightness would cost a thousand times the steps.
  for (auto& [body, hit] : hits)
    std::erase_if(hit.impacts, [&](const rigid::Impact& impact) {
      return severity[{impact.body_a, impact.body_b}] < slight_share * hit.severity;
    });
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
  const Stopwatch watch(state_.report.seconds.rigid);
  std::vector<rigid::Impact> impacts = world_.step();
  state_.report.motion.work += world_.work();
  return impacts;
}

/// Bodies on a path get the motion that takes them to where they are to be at the end of the step.
void Simulation::drive_bodies() {
  const double end = world_.time() + 1 / (scene_.frame_rate * steps_per_frame_);
  for (const auto& [id, live] : state_.live) {
    const SceneBody& body = origin_of(live);
    if (body.path.empty() || motion_of(live) != rigid::Motion::kinematic) continue;
    const Pose anchor = pose_at(body.path, end);
    const Quat turn = anchor.orientation * body.orientation.conjugate();
    world_.drive(id, {anchor.position + turn * (live.start - body.position), turn});
  }
}

void Simulation::step(Progress& progress) {
  drive_bodies();
  if (!effects_.runs(Effect::fracture)) {
    step_world();
    return;
  }
  for (;;) {
    const auto before = world_.snapshot();
    const rigid::StepWork work = state_.report.motion.work;
    const auto hits = breaking_hits(step_world(), before.time);
    if (hits.empty()) return;
    world_.restore(before);
    try {
      break_bodies(hits, progress);
    } catch (...) {
      state_.report.motion.work = work;  // the step will be taken again
      throw;
    }
  }
}

/// Of two bodies that hit each other one comes first; in a run the other one follows in the repeated step.
std::vector<RehearsedHit> Simulation::rehearse_step() {
  drive_bodies();
  const double now = world_.time();
  const std::vector<rigid::Impact> impacts = step_world();
  std::vector<RehearsedHit> rehearsed;
  if (!effects_.runs(Effect::fracture)) return rehearsed;
  for (auto hits = breaking_hits(impacts, now); !hits.empty(); hits = breaking_hits(impacts, now))
    for (const Hit& hit : hits) {
      Live& live = state_.live.at(hit.body);
      std::vector<rigid::BodyId> partners;
      rehearsed.push_back({piece_of(live).name, now, hit.severity, fracture_input(hit, rehearsed.size(), partners)});
      live.last_solve = std::numeric_limits<double>::infinity();
    }
  return rehearsed;
}

std::vector<RehearsedHit> Simulation::rehearse(int most_hits, Progress& progress) {
  const auto before = world_.snapshot();
  const auto live = state_.live;
  const MotionRecord motion = state_.report.motion;
  const double rigid_seconds = state_.report.seconds.rigid;
  const long steps = static_cast<long>(last_frame(scene_) - scene_.start_frame) * steps_per_frame_;
  std::vector<RehearsedHit> hits;
  for (long done = 0; done < steps && static_cast<int>(hits.size()) < most_hits; ++done) {
    progress.checkpoint("rehearsal", static_cast<double>(done) / static_cast<double>(steps));
    for (RehearsedHit& hit : rehearse_step()) hits.push_back(std::move(hit));
  }
  world_.restore(before);
  state_.live = live;
  state_.report.motion = motion;
  state_.report.seconds.rigid = rigid_seconds;
  if (static_cast<int>(hits.size()) > most_hits) hits.resize(static_cast<std::size_t>(most_hits));
  return hits;
}

void Simulation::note_speed(const output::Piece& piece, double speed) {
  MotionRecord& motion = state_.report.motion;
  if (piece.generation == 0 && world_.time() == 0) motion.fastest_start = std::max(motion.fastest_start, speed);
  if (piece.generation == 0 || speed <= motion.fastest_fragment) return;
  motion.fastest_fragment = speed;
  motion.fastest_name = piece.name;
  motion.fastest_time = world_.time();
}

void Simulation::record_frame() {
  output::Frame frame;
  frame.time = world_.time();
  for (const auto& [id, live] : state_.live) {
    const rigid::BodyState body = world_.state(id);
    frame.poses.push_back({live.piece, body.pose, body.twist});
    note_speed(piece_of(live), body.twist.linear.norm());
  }
  std::sort(frame.poses.begin(), frame.poses.end(),
            [](const output::PiecePose& a, const output::PiecePose& b) { return a.piece < b.piece; });
  state_.sequence.frames.push_back(std::move(frame));
}

}  // namespace sunder::pipeline
