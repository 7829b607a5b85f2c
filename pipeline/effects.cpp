#include "pipeline/effects.h"

#include <algorithm>
#include <cstdio>
#include <set>

#include "core/optional_effects.h"
#include "pipeline/fracture.h"
#include "pipeline/scene.h"

namespace sunder::pipeline {
namespace {

const Decision asked_for = {true, "asked for"};

bool can_break(const SceneBody& body) { return body.breakable && body.material.breakable; }

std::string metres(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g m", length);
  return text;
}

std::string listed(const std::set<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

/// Names of the materials of bodies that can break, if `holds`.
template <class Predicate>
std::set<std::string> breaking_materials(const Scene& scene, Predicate&& holds) {
  std::set<std::string> names;
  for (const SceneBody& body : scene.bodies)
    if (can_break(body) && holds(body.material)) names.insert(body.material.name);
  return names;
}

double largest_that_breaks(const EffectQuestion& q) {
  double largest = 0;
  for (std::size_t b = 0; b < q.scene.bodies.size(); ++b)
    if (can_break(q.scene.bodies[b])) largest = std::max(largest, q.sizes[b]);
  return largest;
}

Decision by_size(const EffectQuestion& q, const std::string& given, double bound) {
  const double largest = largest_that_breaks(q);
  if (largest < bound) return {false, "no body that can break is as large as " + metres(bound)};
  return {true, given + ", for bodies from " + metres(bound) + " on"};
}

Decision fracture_runs(const EffectQuestion& q) {
  const auto count = std::count_if(q.scene.bodies.begin(), q.scene.bodies.end(), can_break);
  if (count == 0) return {false, "no body can break"};
  if (q.scene.fracture.maximum_fractures == 0) return {false, "maximum_fractures is 0"};
  if (q.wanted) return asked_for;
  return {true, std::to_string(count) + " of " + std::to_string(q.scene.bodies.size()) + " bodies can break"};
}

Decision secondary_fracture_runs(const EffectQuestion& q) {
  const FractureSettings& fracture = q.scene.fracture;
  if (fracture.maximum_fractures < 2) return {false, "maximum_fractures is 1"};
  if (q.scene.duration <= fracture.refracture_delay)
    return {false, "the scene ends before the refracture_delay of a fragment could"};
  if (q.wanted) return asked_for;
  return {true, "up to " + std::to_string(fracture.maximum_fractures) + " fractures of a body"};
}

Decision flaws_run(const EffectQuestion& q) {
  const auto names = breaking_materials(q.scene, [](const Material& m) { return m.weibull_modulus > 0; });
  if (names.empty()) return {false, "no material that breaks has a weibull_modulus"};
  return q.wanted ? asked_for : Decision{true, "weibull_modulus of " + listed(names)};
}

Decision two_velocity_fields_run(const EffectQuestion& q) {
  if (q.scene.fracture.damage != DamageModel::front) return {false, "damage = \"local\" has no crack faces"};
  if (q.wanted) return asked_for;
  if (q.scene.quality.particles < Quality::final.particles) return {false, "the quality is below final"};
  return {true, "the quality is " + name_of(q.scene.quality)};
}

Decision surface_detail_runs(const EffectQuestion& q) {
  const std::string& look = q.scene.effects.surface_look;
  if (q.wanted) {
    const auto names = breaking_materials(q.scene, [](const Material& m) { return !m.surface_look.empty(); });
    if (look.empty() && names.empty()) return {false, "neither the scene nor a material gives a surface_look"};
    return asked_for;
  }
  if (look.empty()) return {false, "no surface_look is given"};
  return by_size(q, "surface_look is \"" + look + "\"", q.scene.effects.smallest_detail);
}

Decision hairlines_run(const EffectQuestion& q) {
  if (q.scene.effects.hairline_width == 0) return {false, "no hairline_width is given"};
  if (q.wanted) return asked_for;
  return by_size(q, "hairline_width is " + metres(q.scene.effects.hairline_width), q.scene.effects.smallest_detail);
}

Decision debris_runs(const EffectQuestion& q) {
  const double size = q.scene.effects.debris_size;
  if (size == 0) return {false, "no debris_size is given"};
  if (q.wanted) return asked_for;
  return by_size(q, "debris_size is " + metres(size), size);
}

Decision energy_ledger_runs(const EffectQuestion& q) {
  return q.wanted ? asked_for : Decision{true, "it costs little beside a solve"};
}

constexpr std::array<EffectInfo, effect_count> registry = {{
    {Effect::fracture, "fracture", "solves", {}, "", fracture_runs},
    {Effect::secondary_fracture, "secondary_fracture", "solves_of_fragments", {}, "", secondary_fracture_runs},
    {Effect::flaws, "flaws", "scattered_particles", {"scatter_length"}, "", flaws_run},
    {Effect::two_velocity_fields, "two_velocity_fields", "two_field_steps", {}, "", two_velocity_fields_run},
    {Effect::surface_detail,
     "surface_detail",
     "detailed_vertices",
     {"surface_look", "smallest_detail"},
     "",
     surface_detail_runs},
    {Effect::hairlines,
     "hairlines",
     "hairline_faces",
     {"hairline_width", "smallest_detail"},
     "hairline_width",
     hairlines_run},
    {Effect::debris, "debris", "debris_pieces", {"debris_size"}, "debris_size", debris_runs},
    {Effect::energy_ledger, "energy_ledger", "evaluated_ledgers", {}, "", energy_ledger_runs},
}};

Decision decide(const EffectInfo& info, const EffectQuestion& question, const EffectPlan& plan) {
  if (plan.settings.asked[info.effect] == Ask::off) return {false, "switched off"};
  if (info.effect != Effect::fracture) {
    if (!plan.runs(Effect::fracture)) return {false, "nothing can break"};
    if (!with_optional_effects) return {false, "this program is built without it"};
  }
  return info.decide(question);
}

/// What the effect does to a body of this size [m].
bool reaches(const EffectPlan& plan, Effect effect, double size, double bound) {
  return plan.runs(effect) && (plan.settings.asked[effect] == Ask::on || size >= bound);
}

}  // namespace

const char* name_of(Ask ask) {
  switch (ask) {
    case Ask::automatic:
      return "auto";
    case Ask::off:
      return "off";
    case Ask::on:
      return "on";
  }
  return "";
}

std::span<const EffectInfo> effect_registry() { return registry; }

const EffectInfo& info_of(Effect effect) { return registry[static_cast<std::size_t>(effect)]; }

EffectPlan plan_effects(const Scene& scene, const std::vector<double>& sizes) {
  EffectPlan plan{scene.effects, {}};
  for (const EffectInfo& info : registry)
    plan.decisions[info.effect] = decide(info, {scene, sizes, scene.effects.asked[info.effect] == Ask::on}, plan);
  return plan;
}

CrackChoice crack_choice(const Scene& scene, const EffectPlan& plan, const Material& material, double size) {
  CrackChoice choice;
  choice.node_spacing = scene.fracture.node_spacing;
  choice.level_set = scene.fracture.level_set_cut;
  choice.voxel_size = scene.fracture.voxel_size;
  const EffectSettings& s = plan.settings;
  if (reaches(plan, Effect::surface_detail, size, s.smallest_detail))
    choice.detail = s.surface_look.empty() ? material.surface_look : s.surface_look;
  if (reaches(plan, Effect::hairlines, size, s.smallest_detail)) choice.hairline_width = s.hairline_width;
  if (reaches(plan, Effect::debris, size, s.debris_size)) choice.debris_size = s.debris_size;
  return choice;
}

FractureInput as_asked(FractureInput input, const Scene& scene, const EffectPlan& plan) {
  const FractureSettings& fracture = scene.fracture;
  input.solve.damage = fracture.damage == DamageModel::front ? mpm::DamageModel::front : mpm::DamageModel::local;
  input.solve.load = fracture.load == LoadModel::contact ? mpm::LoadModel::contact : mpm::LoadModel::prescribed;
  input.solve.spline = fracture.spline;
  if (!plan.runs(Effect::flaws)) input.material.weibull_modulus = 0;
  input.solve.scatter_length = plan.settings.scatter_length;
  input.solve.two_fields = plan.runs(Effect::two_velocity_fields);
  input.solve.energy_ledger = plan.runs(Effect::energy_ledger);
  input.crack = crack_choice(scene, plan, input.material, geometry::bounds(input.mesh).sizes().maxCoeff());
  return input;
}

EffectWork& operator+=(EffectWork& sum, const EffectWork& other) {
  for (std::size_t e = 0; e < effect_count; ++e) sum.values[e] += other.values[e];
  return sum;
}

EffectWork work_of(const Cracked& cracked) {
  EffectWork work;
  work[Effect::surface_detail] = cracked.detailed_vertices;
  work[Effect::hairlines] = cracked.hairline_faces;
  work[Effect::debris] = {cracked.extraction.debris, cracked.extraction.debris_seconds};
  return work;
}

EffectWork work_of(const FractureOutcome& outcome) {
  EffectWork work = work_of(outcome.cracked);
  const StageSeconds& s = outcome.seconds;
  work[Effect::fracture] = {1, s.sample + s.solve + s.extract + s.cut};
  work[Effect::flaws] = outcome.solve.scattered_points;
  work[Effect::two_velocity_fields] = outcome.solve.two_field_steps;
  work[Effect::energy_ledger] = outcome.solve.evaluated_ledgers;
  return work;
}

std::vector<EffectRecord> effect_records(const EffectPlan& plan, const EffectWork& work) {
  std::vector<EffectRecord> records;
  for (const EffectInfo& info : registry) {
    const Decision& decision = plan.decisions[info.effect];
    const bool ran = work[info.effect].count > 0;
    const std::string idle = decision.runs && !ran ? ", but nothing came of it" : "";
    records.push_back({info.effect, plan.settings.asked[info.effect], ran, decision.why + idle, work[info.effect]});
  }
  return records;
}

}  // namespace sunder::pipeline
