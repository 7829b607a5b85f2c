#include "pipeline/report.h"

#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "sunder_version.h"

namespace sunder::pipeline {
namespace {

using Json = nlohmann::ordered_json;

bool is_fragment(const Piece& piece) { return piece.parent >= 0; }

/// Fragments that exist at the end of the run.
std::vector<const Piece*> living_fragments(const Sequence& sequence) {
  std::vector<const Piece*> living;
  for (const Piece& p : sequence.pieces)
    if (is_fragment(p) && std::isinf(p.death_time)) living.push_back(&p);
  return living;
}

Json fragments_json(const Report& report, const Sequence& sequence) {
  Json list = Json::array();
  int closed = 0;
  for (const Piece* p : living_fragments(sequence)) {
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
  double worst = 0;
  for (const FractureRecord& f : report.fractures) worst = std::max(worst, f.volume_error);
  return {{"count", list.size()}, {"closed", closed}, {"volume_error", worst}, {"list", list}};
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
          {"work_over_impact_energy", f.work_over_impact_energy},
          {"energy",
           {{"work", f.energy.work},
            {"kinetic", f.energy.kinetic},
            {"tension", f.energy.tension},
            {"compression", f.energy.compression},
            {"fracture", f.energy.fracture},
            {"viscous", f.energy.viscous},
            {"numerical", f.energy.balance()}}},
          {"stopped_by", f.stopped_by},
          {"damage_band", f.band_width},
          {"admissible_band", f.admissible_length},
          {"tensile_strength", f.tensile_strength},
          {"propagation_strength", f.propagation_strength}};
}

Json energy_json(const Report& report) {
  Json list = Json::array();
  for (const FractureRecord& f : report.fractures)
    list.push_back(
        {{"time", f.time}, {"body", f.body}, {"kinetic_before", f.kinetic_before}, {"kinetic_after", f.kinetic_after}});
  return list;
}

}  // namespace

std::string to_json(const Report& report, const Sequence& sequence) {
  Json fractures = Json::array(), repairs = Json::array();
  double solve_seconds = 0;
  for (const FractureRecord& f : report.fractures) {
    fractures.push_back(fracture_json(f));
    solve_seconds += f.seconds.solve;
  }
  for (const RepairRecord& r : report.repairs) repairs.push_back({{"body", r.body}, {"steps", r.steps}});
  const auto& s = report.seconds;
  const Json json = {
      {"version", SUNDER_VERSION},
      {"git", SUNDER_GIT},
      {"scene", report.scene},
      {"seed", report.seed},
      {"quality", report.quality},
      {"threads", report.threads},
      {"interrupted", report.interrupted},
      {"effects", {{"ran", report.effects_ran}, {"skipped", report.effects_skipped}}},
      {"fragments", fragments_json(report, sequence)},
      {"fractures", fractures},
      {"energy", energy_json(report)},
      {"mpm",
       {{"particle_steps", report.particle_steps},
        {"particle_steps_per_second",
         solve_seconds > 0 ? static_cast<double>(report.particle_steps) / solve_seconds : 0.0}}},
      {"repairs", repairs},
      {"fallbacks", report.fallbacks},
      {"notes", report.notes},
      {"frames", {{"count", sequence.frames.size()}, {"first", sequence.start_frame}, {"rate", sequence.frame_rate}}},
      {"seconds",
       {{"total", s.total},
        {"setup", s.setup},
        {"rigid", s.rigid},
        {"sample", s.sample},
        {"solve", s.solve},
        {"extract", s.extract},
        {"cut", s.cut},
        {"export", s.write}}},
      {"peak_memory_mb", report.peak_memory_mb}};
  return json.dump(2) + "\n";
}

std::string summary(const Report& report, const Sequence& sequence) {
  const auto living = living_fragments(sequence);
  const auto closed = std::count_if(living.begin(), living.end(), [](const Piece* p) { return p->closed; });
  const auto broke =
      std::count_if(report.fractures.begin(), report.fractures.end(), [](const auto& f) { return f.fragments > 0; });
  char line[256];
  std::snprintf(line, sizeof line, "%zu fragments (%td closed) from %td fractures, %zu solves, %zu frames, %.1f s",
                living.size(), closed, broke, report.fractures.size(), sequence.frames.size(), report.seconds.total);
  std::string text = std::string(line) + "\n";
  for (const std::string& note : report.notes) text += "note: " + note + "\n";
  for (const auto& [name, count] : report.fallbacks) text += "fallback: " + name + " x " + std::to_string(count) + "\n";
  return text;
}

}  // namespace sunder::pipeline
