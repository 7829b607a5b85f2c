/// How a body of the simulation breaks: loads in, solve, pieces out, momentum handed over.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/random.h"
#include "pipeline/detail/piece_mesh.h"
#include "pipeline/quality.h"
#include "pipeline/simulation.h"

namespace sunder::pipeline {
namespace {

/// Fragments are resolved by at least this share of a whole body's particles.
constexpr double fragment_particle_share = 0.25;
std::string fragment_name(const std::string& body, int number) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "_%04d", number);
  return body + digits;
}

RigidPart rotated(const RigidPart& part, const Quat& q) {
  const Mat3 r = q.toRotationMatrix();
  return {part.mass, r * part.centre, r * part.inertia * r.transpose()};
}

}  // namespace

FractureInput Simulation::fracture_input(const Hit& hit, std::vector<rigid::BodyId>& partner_ids) const {
  const Live& live = live_.at(hit.body);
  const Piece& piece = piece_of(live);
  const Pose pose = world_.state(hit.body).pose;
  const Quat to_body = pose.orientation.conjugate();
  FractureInput input;
  input.mesh = piece.mesh;
  input.material = live.origin->material;
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
  input.seed = input.solve.seed =
      random_word(scene_.seed, static_cast<std::uint64_t>(piece.id), report_.fractures.size());
  const double share = piece.volume / original_volume_[static_cast<std::size_t>(live.origin_index)];
  input.own = live.particles;
  input.particles =
      static_cast<int>(settings_of(scene_.quality).particles * std::clamp(share, fragment_particle_share, 1.0));
  return as_asked(std::move(input), scene_, effects_);
}

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
  if (piece_of(live).generation > 0) record.effects[Effect::secondary_fracture] = record.effects[Effect::fracture];
  account(record, outcome);
  note_coarse_grid(input.material, record);
  if (outcome.pieces.size() >= 2)
    hand_over(hit, outcome, partners, record);
  else
    live.particles = outcome.own;
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
  for (const std::string& trouble : outcome.cracked.troubles) report_.notes.push_back(record.body + ": " + trouble);
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
    parts.push_back(detail::centred(piece.mesh, parent.origin->material.density, piece));
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
    const RigidPart& part = body_parts[k];
    Live live{pieces[k].id, parent.origin, parent.origin_index, {part.mass, Vec3::Zero(), part.inertia}};
    if (const auto& own = outcome.pieces[k].own) {
      Particles moved = *own;
      for (Vec3& x : moved.samples.points) x -= part.centre;
      live.particles = std::make_shared<Particles>(std::move(moved));
    }
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

}  // namespace sunder::pipeline
