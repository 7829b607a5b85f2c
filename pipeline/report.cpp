#include "pipeline/report.h"

#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "pipeline/detail/statistics_json.h"
#include "pipeline/fragment_statistics.h"
#include "sunder_version.h"

namespace sunder::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json fragments_json(const Report& report, const output::Sequence& sequence) {
  Json list = Json::array();
  int closed = 0;
  for (const output::Piece* p : living_fragments(sequence)) {
    closed += p->closed;
    list.push_back({{"id", p->id},
                    {"name", p->name},
                    {"body", p->body},
                    {"parent", p->parent},
                    {"generation", p->generation},
                    {"birth_time", p->birth_time},
                    {"volume", p->volume},
                    {"mass", p->mass},
                    {"area", p->area},
                    {"closed", p->closed}});
  }
  double worst = report.cut_volume_error;
  for (const FractureRecord& f : report.fractures) worst = std::max(worst, f.volume_error);
  return {{"count", list.size()}, {"closed", closed}, {"volume_error", worst}, {"list", list}};
}

Json effects_json(const std::vector<EffectRecord>& effects) {
  Json list = Json::array();
  for (const EffectRecord& e : effects)
    list.push_back({{"name", info_of(e.effect).name},
                    {"asked", name_of(e.asked)},
                    {"ran", e.ran},
                    {"why", e.why},
                    {"work", {{info_of(e.effect).work, e.work.count}}},
                    {"seconds", e.work.seconds}});
  return list;
}

Json ledger_json(const mpm::EnergyLedger& energy) {
  return {{"work", energy.work},          {"kinetic", energy.kinetic},
          {"tension", energy.tension},    {"compression", energy.compression},
          {"fracture", energy.fracture},  {"viscous", energy.viscous},
          {"numerical", energy.balance()}};
}

Json fracture_json(const FractureRecord& f) {
  return {{"body", f.body},
          {"piece", f.piece},
          {"time", f.time},
          {"impulse", f.impulse},
          {"delivered_impulse", f.delivered_impulse},
          {"approach_speed", f.approach_speed},
          {"particles", f.particles},
          {"steps", f.steps},
          {"seconds",
           {{"sample", f.seconds.sample},
            {"solve", f.seconds.solve},
            {"extract", f.seconds.extract},
            {"cut", f.seconds.cut}}},
          {"fragments", f.fragments},
          {"cracks_nucleated", f.nuclei},
          {"damaged_share", f.damaged_share},
          {"lump_share", f.lump_share},
          {"volume_error", f.volume_error},
          {"debris", f.effects[Effect::debris].count},
          {"hairline_faces", f.effects[Effect::hairlines].count},
          {"surface_detail", {{"vertices", f.effects[Effect::surface_detail].count}, {"limited", f.detail_limited}}},
          {"work_over_impact_energy", f.work_over_impact_energy},
          {"energy", f.energy ? ledger_json(*f.energy) : Json()},
          {"crack_energy", f.crack_energy},
          {"momentum_error", f.momentum_error},
          {"stopped_by", f.stopped_by},
          {"damage_band", f.band_width},
          {"admissible_band", f.admissible_length},
          {"tensile_strength", f.tensile_strength},
          {"propagation_strength", f.propagation_strength}};
}

Json extract_json(const ExtractRecord& e) {
  return {{"points", e.points},
          {"point_spacing", e.point_spacing},
          {"node_spacing", e.node_spacing},
          {"sites", e.sites},
          {"faces", e.interior + e.extension + e.partial},
          {"faces_by_kind", {{"interior", e.interior}, {"extension", e.extension}, {"partial", e.partial}}},
          {"pieces", e.pieces},
          {"effective_pieces", e.effective_count},
          {"damaged_share", e.damaged_share},
          {"lump_share", e.lump_share},
          {"debris", e.debris}};
}

std::string names_of_effects_that_ran(const Report& report) {
  std::string names;
  for (const EffectRecord& e : report.effects)
    if (e.ran) names.append(names.empty() ? "" : ", ").append(info_of(e.effect).name);
  return names.empty() ? "none" : names;
}

Json energy_json(const Report& report) {
  Json list = Json::array();
  for (const FractureRecord& f : report.fractures)
    list.push_back(
        {{"time", f.time}, {"body", f.body}, {"kinetic_before", f.kinetic_before}, {"kinetic_after", f.kinetic_after}});
  return list;
}

/// How large fragments are, in a line; empty without them.
std::string sizes_line(const std::vector<const output::Piece*>& fragments) {
  const std::vector<double> volumes = positive_volumes(fragments);
  if (volumes.empty()) return "";
  char line[128];
  std::snprintf(line, sizeof line, "sizes: the largest fragment has %.3g %% of the volume of all",
                100 * largest_share(volumes));
  const std::optional<statistics::Law> best = statistics::best_law(volumes);
  return line + (best ? "; law with the lowest AIC: " + std::string(name_of(*best)) : std::string()) + "\n";
}

/// Not of reports of commands that solve nothing.
Json accuracy_json(const Report& report) {
  const auto quality = quality_of(report.quality);
  return quality ? Json(accuracy_of(*quality)) : Json(nullptr);
}

Json prediction_json(const Report& report) {
  if (!report.prediction) return nullptr;
  const Prediction& p = *report.prediction;
  return {{"processor_seconds", p.processor_seconds},
          {"seconds", p.seconds},
          {"peak_memory_mb", p.memory_mb},
          {"solves", p.solves}};
}

}  // namespace

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
  record.lump_share = outcome.cracked.extraction.lump_share;
  record.volume_error = outcome.cracked.cut.volume_error;
  record.effects = work_of(outcome);
  record.detail_limited = outcome.cracked.detail_limited;
  record.work_over_impact_energy = outcome.solve.work / outcome.solve.impact_energy;
  record.energy = outcome.solve.energy;
  record.stopped_by = mpm::name_of(outcome.solve.stop);
  record.band_width = outcome.solve.band_width;
  record.admissible_length = outcome.solve.admissible_length;
  record.tensile_strength = input.material.tensile_strength;
  record.propagation_strength = outcome.solve.propagation_strength;
  return record;
}

EffectWork total_work(const std::vector<FractureRecord>& fractures) {
  EffectWork sum;
  for (const FractureRecord& f : fractures) sum += f.effects;
  return sum;
}

ExtractRecord record_of(const crack::Extraction& extraction) {
  ExtractRecord record;
  record.points = static_cast<long>(extraction.region.size());
  record.sites = extraction.sites;
  record.node_spacing = extraction.node_spacing;
  record.pieces = extraction.region_count;
  record.effective_count = extraction.effective_count;
  record.damaged_share = extraction.damaged_share;
  record.lump_share = extraction.lump_share;
  record.debris = extraction.debris;
  for (const crack::CrackFace& face : extraction.faces) {
    if (!face.in_body) continue;
    record.interior += face.kind == crack::FaceKind::interior;
    record.extension += face.kind == crack::FaceKind::extension;
    record.partial += face.kind == crack::FaceKind::partial;
  }
  return record;
}

std::string to_json(const Report& report, const output::Sequence& sequence) {
  Json fractures = Json::array(), repairs = Json::array();
  double solve_seconds = 0;
  for (const FractureRecord& f : report.fractures) {
    fractures.push_back(fracture_json(f));
    solve_seconds += f.seconds.solve;
  }
  for (const RepairRecord& r : report.repairs)
    repairs.push_back({{"body", r.body},
                       {"steps", r.repair.steps},
                       {"remeshed", r.repair.remeshed},
                       {"volume_before", r.repair.volume_before},
                       {"volume_after", r.repair.volume_after},
                       {"hausdorff", r.repair.hausdorff}});
  const auto& s = report.seconds;
  Json json = {
      {"version", SUNDER_VERSION},
      {"git", SUNDER_GIT},
      {"scene", report.scene},
      {"fingerprint", report.fingerprint},
      {"seed", report.seed},
      {"quality", report.quality},
      {"accuracy", accuracy_json(report)},
      {"threads", report.threads},
      {"interrupted", report.interrupted},
      {"prediction", prediction_json(report)},
      {"effects", effects_json(report.effects)},
      {"fragments", fragments_json(report, sequence)},
      {"fractures", fractures},
      {"energy", energy_json(report)},
      {"statistics", detail::statistics_json(fragment_statistics(report, sequence))},
      {"mpm",
       {{"particle_steps", report.particle_steps},
        {"particle_steps_per_second",
         solve_seconds > 0 ? static_cast<double>(report.particle_steps) / solve_seconds : 0.0}}},
      {"motion",
       {{"steps", report.motion.work.steps},
        {"sub_steps", report.motion.work.sub_steps},
        {"body_sub_steps", report.motion.work.body_sub_steps},
        {"contacts", report.motion.work.contacts},
        {"fastest_start", report.motion.fastest_start},
        {"fastest_fragment",
         {{"name", report.motion.fastest_name},
          {"speed", report.motion.fastest_fragment},
          {"time", report.motion.fastest_time}}}}},
      {"repairs", repairs},
      {"fallbacks", report.fallbacks},
      {"notes", report.notes},
      {"frames", {{"count", sequence.frames.size()}, {"first", sequence.start_frame}, {"rate", sequence.frame_rate}}},
      {"seconds",
       {{"total", s.total},
        {"processor", s.processor},
        {"setup", s.setup},
        {"rigid", s.rigid},
        {"contact_search", report.motion.work.search_seconds},
        {"contact_solve", report.motion.work.solve_seconds},
        {"sample", s.sample},
        {"solve", s.solve},
        {"extract", s.extract},
        {"cut", s.cut},
        {"export", s.write},
        {"checkpoint", s.checkpoint}}},
      {"peak_memory_mb", report.peak_memory_mb}};
  if (report.extract) json["extract"] = extract_json(*report.extract);
  return json.dump(2) + "\n";
}

std::string summary(const Report& report, const output::Sequence& sequence) {
  const auto living = living_fragments(sequence);
  const auto closed = std::count_if(living.begin(), living.end(), [](const output::Piece* p) { return p->closed; });
  const auto broke =
      std::count_if(report.fractures.begin(), report.fractures.end(), [](const auto& f) { return f.fragments > 0; });
  char line[256];
  std::snprintf(line, sizeof line, "%zu fragments (%td closed) from %td fractures, %zu solves, %zu frames, %.1f s",
                living.size(), closed, broke, report.fractures.size(), sequence.frames.size(), report.seconds.total);
  std::string text = std::string(line) + "\n";
  text += sizes_line(living);
  text += "effects: " + names_of_effects_that_ran(report) + "\n";
  for (const std::string& note : report.notes) text += "note: " + note + "\n";
  for (const auto& [name, count] : report.fallbacks) text += "fallback: " + name + " x " + std::to_string(count) + "\n";
  return text;
}

}  // namespace sunder::pipeline
