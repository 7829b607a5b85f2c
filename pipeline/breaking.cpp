/// How a body of the simulation breaks: loads in, solve, pieces out, momentum handed over.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <tbb/parallel_for.h>

#include "core/random.h"
#include "pipeline/detail/piece_mesh.h"
#include "pipeline/simulation.h"

namespace sunder::pipeline {
namespace {

/// Fragments are resolved by at least this share of a whole body's particles.
constexpr double fragment_particle_share = 0.25;

/// Each crack has two faces [m^2].
double crack_area(const FractureOutcome& outcome) {
  double area = 0;
  for (const BrokenPiece& piece : outcome.pieces) {
    const geometry::TriangleMesh& mesh = piece.fragment.mesh;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      if (piece.fragment.source_face[f] < 0) area += geometry::face_area(mesh, f) / 2;
    }
  }
  return area;
}

RigidPart rotated(const RigidPart& part, const Quat& q) {
  const Mat3 r = q.toRotationMatrix();
  return {part.mass, r * part.centre, r * part.inertia * r.transpose()};
}

}  // namespace

/// `number`: of the solve, counted over the run.
FractureInput Simulation::fracture_input(const Hit& hit, std::size_t number,
                                         std::vector<rigid::BodyId>& partner_ids) const {
  const Live& live = state_.live.at(hit.body);
  const output::Piece& piece = piece_of(live);
  const Pose pose = world_.state(hit.body).pose;
  const Quat to_body = pose.orientation.conjugate();
  FractureInput input;
  input.mesh = piece.mesh;
  input.material = origin_of(live).material;
  for (const rigid::Impact& impact : hit.impacts) {
    const auto known = std::find(partner_ids.begin(), partner_ids.end(), impact.body_b);
    mpm::Load load;
    load.partner = static_cast<int>(known - partner_ids.begin());
    load.point = to_body * impact.arm_a;
    load.outward = -(to_body * impact.normal);
    load.approach_speed = impact.approach_speed;
    double inverse_radius = 1 / load.point.norm();
    const Material* other = scene_.ground ? &scene_.ground->material : nullptr;
    if (const auto partner = state_.live.find(impact.body_b); partner != state_.live.end()) {
      other = &origin_of(partner->second).material;
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
  input.seed = input.solve.seed = random_word(scene_.seed, static_cast<std::uint64_t>(piece.id), number);
  input.own = live.particles;
  input.particles =
      static_cast<int>(scene_.quality.particles * std::clamp(share_of(live), fragment_particle_share, 1.0));
  input.nearly_whole = scene_.fracture.nearly_whole_volume;
  return as_asked(std::move(input), scene_, effects_);
}

/// The hits are of bodies that do not touch each other, so their solves run side by side; what comes of them is settled
/// in the order of the hits.
void Simulation::break_bodies(const std::vector<Hit>& hits, Progress& progress) {
  std::vector<FractureInput> inputs;
  std::vector<std::vector<rigid::BodyId>> partners(hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i)
    inputs.push_back(fracture_input(hits[i], state_.report.fractures.size() + i, partners[i]));
  const std::vector<FractureOutcome> outcomes = fracture_all(inputs, progress);
  for (std::size_t i = 0; i < hits.size(); ++i) settle(hits[i], inputs[i], outcomes[i], partners[i]);
}

void Simulation::settle(const Hit& hit, const FractureInput& input, const FractureOutcome& outcome,
                        const std::vector<rigid::BodyId>& partners) {
  Live& live = state_.live.at(hit.body);
  const Pose pose = world_.state(hit.body).pose;
  live.last_solve = world_.time();
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
  state_.report.fractures.push_back(record);
  options_.on_solve({state_.report.fractures.back(), input, outcome, pose});
}

void Simulation::account(const FractureRecord& record, const FractureOutcome& outcome) {
  state_.report.particle_steps += record.particles * record.steps;
  state_.report.seconds.sample += record.seconds.sample;
  state_.report.seconds.solve += record.seconds.solve;
  state_.report.seconds.extract += record.seconds.extract;
  state_.report.seconds.cut += record.seconds.cut;
  for (const auto& [name, count] : outcome.fallbacks) state_.report.fallbacks[name] += count;
  for (const std::string& trouble : outcome.cracked.troubles)
    state_.report.notes.push_back(record.body + ": " + trouble);
}

std::vector<output::Piece> Simulation::pieces_of(const Live& parent, const FractureOutcome& outcome,
                                                 std::vector<RigidPart>& parts) const {
  const output::Piece& old = piece_of(parent);
  const std::string& body = origin_of(parent).name;
  const auto known = std::count_if(state_.sequence.pieces.begin(), state_.sequence.pieces.end(),
                                   [&](const output::Piece& p) { return p.body == body; });
  std::vector<output::Piece> pieces(outcome.pieces.size());
  parts.resize(pieces.size());
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t k) {
    output::Piece& piece = pieces[k];
    piece = detail::fragment_piece(old, outcome.pieces[k].fragment, outcome.cracked);
    piece.id = static_cast<int>(state_.sequence.pieces.size() + k);
    piece.name = output::fragment_name(body, static_cast<int>(known) + static_cast<int>(k));
    piece.birth_time = world_.time();
    parts[k] = detail::centred(piece, origin_of(parent).material.density);
  });
  return pieces;
}

/// What the solve's contacts delivered, scaled to what body and partners can afford.
std::vector<Push> Simulation::pushes_of(const Hit& hit, const FractureOutcome& outcome,
                                        const std::vector<rigid::BodyId>& partners) {
  std::vector<Push> pushes;
  std::vector<RigidPart> parts;
  std::vector<Twist> twists;
  std::vector<int> index(partners.size(), -1);
  bool driven = motion_of(state_.live.at(hit.body)) != rigid::Motion::dynamic;
  for (std::size_t p = 0; p < partners.size(); ++p) {
    driven = driven ||
             (state_.live.contains(partners[p]) && motion_of(state_.live.at(partners[p])) == rigid::Motion::kinematic);
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
  if (share < 1) ++state_.report.fallbacks["impulse_limited"];
  for (Push& push : pushes) push.impulse *= share;
  return pushes;
}

/// The step was taken back to its start, but a fast body or partner may have touched late in it: both go on to where
/// they touched.
void Simulation::meet_partners(const Hit& hit, const std::vector<Push>& pushes) {
  rigid::BodyState body = world_.state(hit.body);
  double soonest = std::numeric_limits<double>::infinity();
  const auto way_to_meet = [&](std::size_t l) {
    return Vec3(body.pose.position + pushes[l].arm - pushes[l].partner_arm -
                world_.state(hit.impacts[l].body_b).pose.position);
  };
  for (std::size_t l = 0; l < pushes.size(); ++l) {
    if (pushes[l].partner < 0) continue;
    const Vec3 closing = world_.state(hit.impacts[l].body_b).twist.linear - body.twist.linear;
    if (closing.norm() > 0) soonest = std::min(soonest, way_to_meet(l).dot(closing) / closing.squaredNorm());
  }
  if (std::isfinite(soonest) && motion_of(state_.live.at(hit.body)) == rigid::Motion::dynamic) {
    body.pose.position += std::max(soonest, 0.0) * body.twist.linear;
    world_.set_state(hit.body, body);
  }
  for (std::size_t l = 0; l < pushes.size(); ++l) {
    if (pushes[l].partner < 0) continue;
    rigid::BodyState other = world_.state(hit.impacts[l].body_b);
    other.pose.position += way_to_meet(l);
    world_.set_state(hit.impacts[l].body_b, other);
  }
}

/// The partners take their pushes where they touch the body.
void Simulation::push_partners(const Hit& hit, const std::vector<Push>& pushes) {
  const Vec3 centre = world_.state(hit.body).pose.position;
  for (std::size_t l = 0; l < pushes.size(); ++l) {
    const rigid::BodyId id = hit.impacts[l].body_b;
    if (pushes[l].partner < 0) continue;
    rigid::BodyState other = world_.state(id);
    const Vec3 arm = centre + pushes[l].arm - other.pose.position;
    other.twist.linear -= pushes[l].impulse / free_mass(id);
    other.twist.angular -= world_.world_inertia(id).inverse() * arm.cross(pushes[l].impulse);
    world_.set_state(id, other);
  }
}

/// Of bodies of the world that yield, in world axes about a point.
Momentum Simulation::momentum_of(const std::vector<rigid::BodyId>& ids, const Vec3& about) const {
  std::vector<RigidPart> parts;
  std::vector<Twist> twists;
  for (rigid::BodyId id : ids) {
    if (std::isinf(free_mass(id))) continue;
    parts.push_back(world_part(id));
    parts.back().centre = world_.state(id).pose.position - about;
    twists.push_back(world_.state(id).twist);
  }
  return momentum(parts, twists);
}

double Simulation::energy_of(const std::vector<rigid::BodyId>& ids) const {
  double sum = 0;
  for (rigid::BodyId id : ids) sum += energy_of(id);
  return sum;
}

/// Motion of the pieces in world axes about the centre of the body: that of their own material, with the momentum that
/// the solve's contacts delivered and no more energy than there is.
std::vector<Twist> Simulation::twists_of(const FractureOutcome& outcome, const std::vector<RigidPart>& parts,
                                         const rigid::BodyState& state, const Momentum& delivered) const {
  std::vector<Twist> twists;
  const Quat& q = state.pose.orientation;
  for (const BrokenPiece& piece : outcome.pieces) twists.push_back({q * piece.twist.linear, q * piece.twist.angular});
  twists = with_momentum(parts, twists, delivered);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    twists[k].linear += state.twist.at(parts[k].centre);
    twists[k].angular += state.twist.angular;
  }
  return twists;
}

/// The body is replaced by its pieces. The pieces together get the momentum that the solve's contacts delivered, the
/// partners the opposite; the rigid solver's own impulse was taken back with the step.
void Simulation::hand_over(const Hit& hit, const FractureOutcome& outcome, const std::vector<rigid::BodyId>& partners,
                           FractureRecord& record) {
  const Live parent = state_.live.at(hit.body);
  const std::vector<Push> pushes = pushes_of(hit, outcome, partners);
  meet_partners(hit, pushes);
  const rigid::BodyState state = world_.state(hit.body);
  const bool free = motion_of(parent) == rigid::Motion::dynamic;
  std::vector<RigidPart> body_parts, parts;
  std::vector<output::Piece> pieces = pieces_of(parent, outcome, body_parts);
  for (const RigidPart& part : body_parts) parts.push_back(rotated(part, state.pose.orientation));

  record.kinetic_before = energy_of(hit.body) + energy_of(partners);
  std::vector<rigid::BodyId> all = partners;
  all.push_back(hit.body);
  Momentum expected = momentum_of(all, state.pose.position), delivered;
  for (const Push& push : pushes) {
    const Momentum given{push.impulse, push.arm.cross(push.impulse)};
    delivered = delivered + given;
    if (push.partner < 0) expected = expected + given;
  }
  push_partners(hit, pushes);
  std::vector<Twist> twists = twists_of(outcome, parts, state, delivered);
  // What the cracks took is no longer there to move the pieces.
  record.crack_energy = origin_of(parent).material.fracture_energy * crack_area(outcome);
  const double available = record.kinetic_before - energy_of(partners) - record.crack_energy;
  if (free && kinetic_energy(parts, twists) > available) {
    twists = with_energy_limit(parts, twists, available);
    ++state_.report.fallbacks["fragment_energy_limited"];
  }

  remove(hit.body);
  ++state_.fracture_count[static_cast<std::size_t>(parent.origin)];
  const std::vector<rigid::BodyId> ids = add_pieces(parent, outcome, pieces, body_parts, state.pose, twists);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    pieces[k].birth_position = state.pose * body_parts[k].centre;
    pieces[k].birth = twists[k];
    pieces[k].birth_energy = kinetic_energy({parts[k]}, {twists[k]});
  }
  record.fragments = static_cast<int>(pieces.size());
  record.kinetic_after = kinetic_energy(parts, twists) + energy_of(partners);
  all = partners;
  all.insert(all.end(), ids.begin(), ids.end());
  if (free) record.momentum_error = relative_difference(expected, momentum_of(all, state.pose.position), parts, twists);
  std::move(pieces.begin(), pieces.end(), std::back_inserter(state_.sequence.pieces));
}

void Simulation::remove(rigid::BodyId id) {
  const Live& live = state_.live.at(id);
  state_.sequence.pieces[static_cast<std::size_t>(live.piece)].death_time = world_.time();
  if (piece_of(live).generation > 0) --state_.fragment_count;
  world_.remove(id);
  state_.live.erase(id);
}

/// Fragments of one fracture touch along their cracks: they are one family, whose first overlaps push nothing apart.
std::vector<rigid::BodyId> Simulation::add_pieces(const Live& parent, const FractureOutcome& outcome,
                                                  const std::vector<output::Piece>& pieces,
                                                  const std::vector<RigidPart>& parts, const Pose& pose,
                                                  const std::vector<Twist>& twists) {
  std::vector<Live> lives;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const RigidPart& part = parts[k];
    Live live{pieces[k].id, parent.origin, {part.mass, Vec3::Zero(), part.inertia}};
    if (const auto& own = outcome.pieces[k].own) {
      Particles moved = *own;
      for (Vec3& x : moved.samples.points) x -= part.centre;
      live.particles = std::make_shared<Particles>(std::move(moved));
    }
    lives.push_back(std::move(live));
  }
  const double original = state_.original_volume[static_cast<std::size_t>(parent.origin)];
  std::vector<Hulls> hulls(pieces.size());
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t k) {
    hulls[k] = hulls_of(pieces[k], size_class(pieces[k].volume / original, scene_.fracture));
  });
  ++state_.families;
  state_.fragment_count += static_cast<int>(pieces.size());
  std::vector<rigid::BodyId> ids;
  for (std::size_t k = 0; k < pieces.size(); ++k)
    ids.push_back(add_body(pieces[k], lives[k], std::move(hulls[k]), {pose * parts[k].centre, pose.orientation},
                           twists[k], state_.families));
  return ids;
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
  if (std::none_of(state_.report.notes.begin(), state_.report.notes.end(),
                   [&](const std::string& note) { return note.starts_with(material.name + ": the damage band"); }))
    state_.report.notes.push_back(text);
}

}  // namespace sunder::pipeline
