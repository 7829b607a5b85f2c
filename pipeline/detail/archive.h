#pragma once
/// What of a run goes into a checkpoint, field by field, for cereal's binary archive.
#include <cereal/archives/binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/map.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/vector.hpp>

#include "pipeline/checkpoint.h"

// cereal finds these by argument-dependent lookup, so each lies in the namespace of what it writes.

namespace Eigen {

template <class Archive, class Scalar, int Rows, int Columns>
void serialize(Archive& archive, Matrix<Scalar, Rows, Columns>& m) {
  static_assert(Rows > 0 && Columns > 0);
  archive(cereal::binary_data(m.data(), sizeof(Scalar) * Rows * Columns));
}

template <class Archive>
void serialize(Archive& archive, Quaterniond& q) {
  archive(q.coeffs());
}

}  // namespace Eigen

namespace sunder {

template <class Archive>
void serialize(Archive& archive, Pose& pose) {
  archive(pose.position, pose.orientation);
}

template <class Archive>
void serialize(Archive& archive, Twist& twist) {
  archive(twist.linear, twist.angular);
}

template <class Archive>
void serialize(Archive& archive, Effort& effort) {
  archive(effort.count, effort.seconds);
}

}  // namespace sunder

namespace sunder::geometry {

template <class Archive>
void serialize(Archive& archive, TriangleMesh& mesh) {
  archive(mesh.vertices, mesh.faces);
}

template <class Archive>
void serialize(Archive& archive, Samples& samples) {
  archive(samples.points, samples.spacing);
}

template <class Archive>
void serialize(Archive& archive, SurfaceAttributes& a) {
  archive(a.uv, a.normal, a.material, a.material_names, a.colour, a.damage_time);
}

}  // namespace sunder::geometry

namespace sunder::mpm {

template <class Archive>
void serialize(Archive& archive, PriorDamage::Front& front) {
  archive(front.particle, front.normal);
}

template <class Archive>
void serialize(Archive& archive, PriorDamage& damage) {
  archive(damage.damage, damage.fronts);
}

template <class Archive>
void serialize(Archive& archive, EnergyLedger& e) {
  archive(e.work, e.kinetic, e.tension, e.compression, e.fracture, e.viscous);
}

}  // namespace sunder::mpm

namespace sunder::rigid {

template <class Archive>
void serialize(Archive& archive, BodySetup& s) {
  archive(s.hulls, s.mass, s.inertia, s.pose, s.twist, s.motion, s.restitution, s.friction, s.family);
}

template <class Archive>
void serialize(Archive& archive, BodyState& state) {
  archive(state.pose, state.twist);
}

template <class Archive>
void serialize(Archive& archive, PartPair& pair) {
  archive(pair.body_a, pair.body_b, pair.part_a, pair.part_b);
}

template <class Archive>
void serialize(Archive& archive, ContactMemory::Point& point) {
  archive(point.on_a, point.impulse);
}

template <class Archive>
void serialize(Archive& archive, ContactMemory& contact) {
  archive(contact.pair, contact.tolerated, contact.points);
}

template <class Archive>
void serialize(Archive& archive, World::Snapshot::Rest& rest) {
  archive(rest.asleep, rest.quiet_time, rest.last_step, rest.newborn);
}

template <class Archive>
void serialize(Archive& archive, World::Snapshot& s) {
  archive(s.time, s.ids, s.states, s.turns, s.rests, s.contacts);
}

template <class Archive>
void serialize(Archive& archive, StepWork& w) {
  archive(w.steps, w.sub_steps, w.body_sub_steps, w.contacts, w.search_seconds, w.solve_seconds);
}

template <class Archive>
void serialize(Archive& archive, World::State& state) {
  archive(state.setups, state.snapshot, state.next_id);
}

}  // namespace sunder::rigid

namespace sunder::output {

template <class Archive>
void serialize(Archive& archive, Piece& p) {
  archive(p.id, p.name, p.body, p.parent, p.generation, p.birth_time, p.death_time, p.birth_position, p.birth,
          p.birth_energy, p.mesh, p.source_face, p.surface, p.volume, p.area, p.mass, p.inside_area, p.closed,
          p.material);
}

template <class Archive>
void serialize(Archive& archive, PiecePose& pose) {
  archive(pose.piece, pose.pose, pose.twist);
}

template <class Archive>
void serialize(Archive& archive, Frame& frame) {
  archive(frame.time, frame.poses);
}

template <class Archive>
void serialize(Archive& archive, Sequence& s) {
  archive(s.name, s.frame_rate, s.start_frame, s.pieces, s.frames);
}

}  // namespace sunder::output

namespace sunder::pipeline {

template <class Archive>
void serialize(Archive& archive, RigidPart& part) {
  archive(part.mass, part.centre, part.inertia);
}

template <class Archive>
void serialize(Archive& archive, Particles& particles) {
  archive(particles.samples, particles.damage);
}

template <class Archive>
void serialize(Archive& archive, StageSeconds& s) {
  archive(s.sample, s.solve, s.extract, s.cut);
}

template <class Archive>
void serialize(Archive& archive, EffectWork& work) {
  archive(work.values);
}

template <class Archive>
void serialize(Archive& archive, FractureRecord& f) {
  archive(f.body, f.piece, f.time, f.impulse, f.delivered_impulse, f.approach_speed, f.particles, f.steps, f.nuclei,
          f.seconds, f.fragments, f.damaged_share, f.lump_share, f.volume_error, f.effects, f.detail_limited,
          f.work_over_impact_energy, f.energy, f.stopped_by, f.kinetic_before, f.kinetic_after, f.crack_energy,
          f.momentum_error, f.band_width, f.admissible_length, f.tensile_strength, f.propagation_strength);
}

template <class Archive>
void serialize(Archive& archive, RepairRecord& repair) {
  MeshRepair& r = repair.repair;
  archive(repair.body, r.steps, r.remeshed, r.volume_before, r.volume_after, r.hausdorff);
}

template <class Archive>
void serialize(Archive& archive, Report::Seconds& s) {
  archive(s.total, s.processor, s.setup, s.rigid, s.sample, s.solve, s.extract, s.cut, s.write, s.checkpoint);
}

template <class Archive>
void serialize(Archive& archive, MotionRecord& m) {
  archive(m.work, m.fastest_start, m.fastest_fragment, m.fastest_name, m.fastest_time);
}

template <class Archive>
void serialize(Archive& archive, Prediction& p) {
  archive(p.processor_seconds, p.seconds, p.memory_mb, p.solves);
}

/// Only what a simulation has written by then; the rest is added when the run ends.
template <class Archive>
void serialize(Archive& archive, Report& r) {
  archive(r.quality, r.prediction, r.fractures, r.repairs, r.motion, r.particle_steps, r.seconds, r.fallbacks, r.notes);
}

template <class Archive>
void serialize(Archive& archive, Live& live) {
  std::optional<Particles> particles;
  if (Archive::is_saving::value && live.particles) particles = *live.particles;
  archive(live.piece, live.origin, live.part, live.start, live.last_solve, particles);
  if (Archive::is_loading::value && particles)
    live.particles = std::make_shared<const Particles>(std::move(*particles));
}

template <class Archive>
void serialize(Archive& archive, SimulationState& s) {
  archive(s.sequence, s.report, s.live, s.original_volume, s.fracture_count, s.families, s.fragment_count);
}

}  // namespace sunder::pipeline
