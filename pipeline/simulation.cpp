#include "pipeline/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/random.h"
#include "geometry/convex_parts.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "pipeline/handover.h"
#include "pipeline/quality.h"
#include "pipeline/stopwatch.h"

namespace sunder::pipeline {
namespace {

/// Fragments are resolved by at least this share of a whole body's particles.
constexpr double fragment_particle_share = 0.25;
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

std::string fragment_name(const std::string& body, int number) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "_%04d", number);
  return body + digits;
}

/// Collision cost grows with the product of the parts of two bodies, and the shape of a small fragment hardly shows.
geometry::ConvexPartsSettings collision_detail(double share_of_original) {
  if (share_of_original < 0.005) return {.max_parts = 1, .excess = 0.1, .max_hull_vertices = 16};
  if (share_of_original < 0.05) return {.max_parts = 2, .excess = 0.1, .max_hull_vertices = 24};
  if (share_of_original < 0.2) return {.max_parts = 4, .excess = 0.1, .max_hull_vertices = 24};
  if (share_of_original < 0.98) return {.max_parts = 8, .excess = 0.1, .max_hull_vertices = 24};
  return {.max_parts = 16, .excess = 0.05, .max_hull_vertices = 32};
}

RigidPart rotated(const RigidPart& part, const Quat& q) {
  const Mat3 r = q.toRotationMatrix();
  return {part.mass, r * part.centre, r * part.inertia * r.transpose()};
}

/// Mass properties of a mesh in its own frame at this density, and the mesh moved so that its centre of mass is the
/// origin.
RigidPart centred(geometry::TriangleMesh& mesh, double density, Piece& piece) {
  const auto m = geometry::mass_properties(mesh);
  mesh = geometry::transformed(mesh, Mat3::Identity(), -m.centroid);
  piece.volume = m.volume;
  piece.closed = geometry::is_closed_two_manifold(mesh);
  piece.area = m.area;
  piece.mass = density * m.volume;
  return {piece.mass, m.centroid, density * m.inertia};
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
    place(scene.bodies[b], static_cast<int>(b), progress);
  }
  require_no_overlap();
}

void Simulation::place(const SceneBody& body, int index, Progress&) {
  BodyMesh source = body_mesh(body);
  if (!source.repairs.empty()) report_.repairs.push_back({body.name, source.repairs});
  Piece piece;
  piece.id = static_cast<int>(sequence_.pieces.size());
  piece.name = piece.body = body.name;
  piece.material = body.material.name;
  piece.mesh = std::move(source.mesh);
  RigidPart part = centred(piece.mesh, body.material.density, piece);
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

void Simulation::step(Progress& progress) {
  for (;;) {
    const auto before = world_.snapshot();
    std::vector<rigid::Impact> impacts;
    {
      const Stopwatch watch(report_.seconds.rigid);
      impacts = world_.step();
      if (!scene_.effects.fracture) return;
    }
    const auto hits = breaking_hits(impacts, before.time);
    if (hits.empty()) return;
    world_.restore(before);
    for (const Hit& hit : hits) solve(hit, progress);
  }
}

FractureInput Simulation::fracture_input(const Hit& hit, std::vector<rigid::BodyId>& partner_ids) const {
  const Live& live = live_.at(hit.body);
  const Piece& piece = piece_of(live);
  const Pose pose = world_.state(hit.body).pose;
  const Quat to_body = pose.orientation.conjugate();
  FractureInput input;
  input.mesh = piece.mesh;
  input.material = live.origin->material;
  if (!scene_.effects.strength_scatter) input.material.weibull_modulus = 0;
  for (const rigid::Impact& impact : hit.impacts) {
    const auto known = std::find(partner_ids.begin(), partner_ids.end(), impact.body_b);
    mpm::Load load;
    load.partner = static_cast<int>(known - partner_ids.begin());
    load.point = to_body * impact.arm_a;
    load.outward = -(to_body * impact.normal);
    load.approach_speed = impact.approach_speed;
    double inverse_radius = 1 / load.point.norm();
    const Material* other = scene_.ground ? &scene_.ground->material : nullptr;
    if (const auto partner = live_.find(impact.body_b); partner != live_.end()) {
      other = &partner->second.origin->material;
      inverse_radius += 1 / impact.arm_b.norm();
    }
    load.pair.effective_radius = 1 / inverse_radius;
    load.pair.effective_modulus = mpm::effective_modulus(input.material.youngs_modulus, input.material.poisson_ratio,
                                                         other->youngs_modulus, other->poisson_ratio);
    load.pair.contact_pressure = std::min(input.material.contact_pressure, other->contact_pressure);
    input.loads.push_back(load);
    if (known != partner_ids.end()) continue;
    partner_ids.push_back(impact.body_b);
    const bool yields = std::isfinite(free_mass(impact.body_b));
    input.partners.push_back({yields ? effective_mass(world_part(impact.body_b), impact.arm_b, impact.normal)
                                     : std::numeric_limits<double>::infinity()});
  }
  input.solve.damage = scene_.fracture.damage == DamageModel::front ? mpm::DamageModel::front : mpm::DamageModel::local;
  input.solve.load = scene_.fracture.load == LoadModel::contact ? mpm::LoadModel::contact : mpm::LoadModel::prescribed;
  input.seed = input.solve.seed =
      random_word(scene_.seed, static_cast<std::uint64_t>(piece.id), report_.fractures.size());
  const double share = piece.volume / original_volume_[static_cast<std::size_t>(live.origin_index)];
  input.particles =
      static_cast<int>(settings_of(scene_.quality).particles * std::clamp(share, fragment_particle_share, 1.0));
  return input;
}

namespace {

FractureRecord record_of(const FractureInput& input, const FractureOutcome& outcome) {
  FractureRecord record;
  for (const mpm::LoadResult& load : outcome.solve.loads) record.delivered_impulse += load.impulse;
  for (const mpm::Load& load : input.loads)
    record.approach_speed = std::max(record.approach_speed, load.approach_speed);
  record.particles = outcome.particles;
  record.steps = outcome.solve.steps;
  record.nuclei = outcome.solve.nuclei;
  record.seconds = outcome.seconds;
  record.damaged_share = outcome.damaged_share;
  record.lump_share = outcome.lump_share;
  record.volume_error = outcome.volume_error;
  record.work_over_impact_energy = outcome.solve.work / outcome.solve.impact_energy;
  record.dissipated = outcome.solve.dissipated;
  record.band_width = outcome.solve.band_width;
  record.admissible_length = outcome.solve.admissible_length;
  record.tensile_strength = input.material.tensile_strength;
  record.propagation_strength = outcome.solve.propagation_strength;
  return record;
}

}  // namespace

void Simulation::solve(const Hit& hit, Progress& progress) {
  Live& live = live_.at(hit.body);
  live.last_solve = world_.time();
  std::vector<rigid::BodyId> partners;
  const FractureInput input = fracture_input(hit, partners);
  const FractureOutcome outcome = fracture(input, progress);

  FractureRecord record = record_of(input, outcome);
  record.piece = live.piece;
  record.body = piece_of(live).name;
  record.time = world_.time();
  record.impulse = hit.impulse;
  account(record, outcome);
  note_coarse_grid(input.material, record);
  if (outcome.pieces.size() >= 2) hand_over(hit, outcome, partners, record);
  report_.fractures.push_back(record);
  options_.on_fracture(report_.fractures.back());
}

void Simulation::account(const FractureRecord& record, const FractureOutcome& outcome) {
  report_.particle_steps += record.particles * record.steps;
  report_.seconds.sample += record.seconds.sample;
  report_.seconds.solve += record.seconds.solve;
  report_.seconds.extract += record.seconds.extract;
  report_.seconds.cut += record.seconds.cut;
  for (const auto& [name, count] : outcome.fallbacks) report_.fallbacks[name] += count;
}

std::vector<Piece> Simulation::pieces_of(const Live& parent, const FractureOutcome& outcome,
                                         std::vector<RigidPart>& parts) const {
  const Piece& old = piece_of(parent);
  const std::string& body = parent.origin->name;
  const auto known =
      std::count_if(sequence_.pieces.begin(), sequence_.pieces.end(), [&](const Piece& p) { return p.body == body; });
  std::vector<Piece> pieces;
  for (const BrokenPiece& broken : outcome.pieces) {
    Piece piece;
    piece.id = static_cast<int>(sequence_.pieces.size() + pieces.size());
    piece.name = fragment_name(body, static_cast<int>(known) + static_cast<int>(pieces.size()));
    piece.body = body;
    piece.parent = old.id;
    piece.generation = old.generation + 1;
    piece.birth_time = world_.time();
    piece.material = old.material;
    piece.mesh = broken.fragment.mesh;
    for (int source : broken.fragment.source_face)
      piece.inside.push_back(source < 0 || old.inside[static_cast<std::size_t>(source)]);
    parts.push_back(centred(piece.mesh, parent.origin->material.density, piece));
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// What the solve's contacts delivered, scaled to what body and partners can afford.
std::vector<Push> Simulation::pushes_of(const Hit& hit, const FractureOutcome& outcome,
                                        const std::vector<rigid::BodyId>& partners) {
  std::vector<Push> pushes;
  std::vector<RigidPart> parts;
  std::vector<Twist> twists;
  std::vector<int> index(partners.size(), -1);
  bool driven = motion_of(live_.at(hit.body)) != rigid::Motion::dynamic;
  for (std::size_t p = 0; p < partners.size(); ++p) {
    driven = driven || (live_.contains(partners[p]) && motion_of(live_.at(partners[p])) == rigid::Motion::kinematic);
    if (std::isinf(free_mass(partners[p]))) continue;
    index[p] = static_cast<int>(parts.size());
    parts.push_back(world_part(partners[p]));
    twists.push_back(world_.state(partners[p]).twist);
  }
  for (std::size_t l = 0; l < hit.impacts.size(); ++l) {
    const rigid::Impact& impact = hit.impacts[l];
    const auto partner = std::find(partners.begin(), partners.end(), impact.body_b) - partners.begin();
    pushes.push_back({outcome.solve.loads[l].impulse * impact.normal, impact.arm_a, impact.arm_b,
                      index[static_cast<std::size_t>(partner)]});
  }
  // What a driven or held body does or takes is not in the balance.
  const double share =
      driven ? 1.0 : affordable_share(world_part(hit.body), world_.state(hit.body).twist, parts, twists, pushes);
  if (share < 1) ++report_.fallbacks["impulse_limited"];
  for (Push& push : pushes) push.impulse *= share;
  return pushes;
}

/// The partners take their pushes where they touch the body. A fast partner may have touched late in the step that was
/// taken back: it is put where it touched.
void Simulation::push_partners(const Hit& hit, const std::vector<Push>& pushes) {
  const Vec3 centre = world_.state(hit.body).pose.position;
  for (std::size_t l = 0; l < pushes.size(); ++l) {
    const rigid::BodyId id = hit.impacts[l].body_b;
    if (pushes[l].partner < 0) continue;
    rigid::BodyState other = world_.state(id);
    other.pose.position = centre + pushes[l].arm - pushes[l].partner_arm;
    other.twist.linear -= pushes[l].impulse / free_mass(id);
    other.twist.angular -= world_.world_inertia(id).inverse() * pushes[l].partner_arm.cross(pushes[l].impulse);
    world_.set_state(id, other);
  }
}

/// The body is replaced by its pieces. The pieces together get the momentum that the solve's contacts delivered, the
/// partners the opposite; the rigid solver's own impulse was taken back with the step.
void Simulation::hand_over(const Hit& hit, const FractureOutcome& outcome, const std::vector<rigid::BodyId>& partners,
                           FractureRecord& record) {
  const Live parent = live_.at(hit.body);
  const rigid::BodyState state = world_.state(hit.body);
  const Quat& q = state.pose.orientation;
  std::vector<RigidPart> body_parts, parts;
  std::vector<Piece> pieces = pieces_of(parent, outcome, body_parts);
  std::vector<Twist> twists;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    parts.push_back(rotated(body_parts[k], q));
    twists.push_back({q * outcome.pieces[k].twist.linear, q * outcome.pieces[k].twist.angular});
  }
  const auto partners_energy = [&] {
    double sum = 0;
    for (rigid::BodyId id : partners) sum += energy_of(id);
    return sum;
  };
  record.kinetic_before = energy_of(hit.body) + partners_energy();
  const std::vector<Push> pushes = pushes_of(hit, outcome, partners);
  push_partners(hit, pushes);
  Momentum delivered;
  for (const Push& push : pushes) {
    delivered.linear += push.impulse;
    delivered.angular += push.arm.cross(push.impulse);
  }
  twists = with_momentum(parts, twists, delivered);
  const double available = record.kinetic_before - partners_energy();
  for (std::size_t k = 0; k < parts.size(); ++k) {
    twists[k].linear += state.twist.at(parts[k].centre);
    twists[k].angular += state.twist.angular;
  }
  if (motion_of(parent) == rigid::Motion::dynamic && kinetic_energy(parts, twists) > available) {
    twists = with_energy_limit(parts, twists, available);
    ++report_.fallbacks["fragment_energy_limited"];
  }
  record.kinetic_after = kinetic_energy(parts, twists) + partners_energy();
  record.fragments = static_cast<int>(pieces.size());

  world_.remove(hit.body);
  live_.erase(hit.body);
  ++fracture_count_[static_cast<std::size_t>(parent.origin_index)];
  ++families_;
  sequence_.pieces[static_cast<std::size_t>(parent.piece)].death_time = world_.time();
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const Live live{
        pieces[k].id, parent.origin, parent.origin_index, {body_parts[k].mass, Vec3::Zero(), body_parts[k].inertia}};
    add_body(pieces[k], live, {state.pose.position + parts[k].centre, q}, twists[k], families_);
  }
  std::move(pieces.begin(), pieces.end(), std::back_inserter(sequence_.pieces));
}

void Simulation::note_coarse_grid(const Material& material, const FractureRecord& record) {
  if (record.band_width < record.admissible_length) return;
  char text[400];
  std::snprintf(text, sizeof text,
                "%s: the damage band of this resolution (%.3g mm) is wider than the material allows (l_max = %.3g mm); "
                "crack fronts use "
                "a strength of %.3g MPa instead of %.3g MPa so that the fracture energy is kept%s",
                material.name.c_str(), record.band_width * 1e3, record.admissible_length * 1e3,
                record.propagation_strength * 1e-6, record.tensile_strength * 1e-6,
                scene_.fracture.damage == DamageModel::front ? "; new cracks still need the full strength" : "");
  if (std::none_of(report_.notes.begin(), report_.notes.end(),
                   [&](const std::string& note) { return note.starts_with(material.name + ": the damage band"); }))
    report_.notes.push_back(text);
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
