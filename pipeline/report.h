#pragma once
/// What happened in a run, for people and for farms: report.json.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "output/sequence.h"
#include "pipeline/effects.h"
#include "pipeline/fracture.h"
#include "pipeline/scene.h"
#include "rigid/world.h"

namespace sunder::pipeline {

/// One solve of one body, whether it broke or not.
struct FractureRecord {
  std::string body;  ///< piece name
  int piece = 0;
  double time = 0;               ///< [s]
  double impulse = 0;            ///< the rigid solver's, which triggered the solve [N s]
  double delivered_impulse = 0;  ///< what the solve's contact delivered [N s]
  double approach_speed = 0;     ///< largest of the loads [m/s]
  long particles = 0, steps = 0, nuclei = 0;
  StageSeconds seconds;
  int fragments = 0;  ///< 0: stayed whole
  double damaged_share = 0, lump_share = 0, volume_error = 0;
  EffectWork effects;
  long detail_limited = 0;  ///< vertices of detailed crack faces that are lower than asked
  double work_over_impact_energy = 0;
  std::optional<mpm::EnergyLedger> energy;                ///< [J]; not set: not asked for
  std::string stopped_by;                                 ///< what ended the solve
  double kinetic_before = 0, kinetic_after = 0;           ///< of the body and its partners [J]
  double crack_energy = 0;                                ///< what the new crack faces took, G_f times area [J]
  double momentum_error = 0;                              ///< of the hand-over, relative (relative_difference)
  double band_width = 0, admissible_length = 0;           ///< l_ch, l_max [m]
  double tensile_strength = 0, propagation_strength = 0;  ///< of the material, and used at crack fronts [Pa]
};

/// What the solve says of itself; where and when it was is left open.
FractureRecord record_of(const FractureInput& input, const FractureOutcome& outcome);

EffectWork total_work(const std::vector<FractureRecord>& fractures);

/// What crack extraction found, for commands that extract without a run.
struct ExtractRecord {
  long points = 0, sites = 0;
  double point_spacing = 0, node_spacing = 0;     ///< [m]
  long interior = 0, extension = 0, partial = 0;  ///< faces in the body, by kind
  int pieces = 1;
  double effective_count = 1, damaged_share = 0, lump_share = 0;
  int debris = 0;
};
ExtractRecord record_of(const crack::Extraction& extraction);

struct RepairRecord {
  std::string body;
  MeshRepair repair;
};

/// How bodies moved, and what that took.
struct MotionRecord {
  rigid::StepWork work;         ///< steps that were taken back included
  double fastest_start = 0;     ///< of the scene's bodies [m/s]
  double fastest_fragment = 0;  ///< in any frame [m/s]
  std::string fastest_name;     ///< of the piece
  double fastest_time = 0;      ///< [s]
};

/// What a run will take, before it runs.
struct Prediction {
  double processor_seconds = 0;  ///< of all threads
  double seconds = 0;            ///< with the threads asked for, on a machine that does nothing else
  double memory_mb = 0;          ///< most at once
  int solves = 0;                ///< of bodies and fragments
};

struct Report {
  std::string scene, quality;
  std::string fingerprint;  ///< of all that decides the results (pipeline/fingerprint.h)
  std::uint64_t seed = 0;
  int threads = 0;
  bool interrupted = false;
  std::optional<Prediction> prediction;  ///< not set: nobody asked
  std::vector<EffectRecord> effects;
  std::vector<FractureRecord> fractures;
  std::optional<ExtractRecord> extract;
  std::vector<RepairRecord> repairs;
  MotionRecord motion;
  long particle_steps = 0;
  double cut_volume_error = 0;  ///< of a cut that no fracture made
  struct Seconds {
    double total = 0;
    double processor = 0;  ///< of all threads, for the whole run
    double setup = 0, rigid = 0, sample = 0, solve = 0, extract = 0, cut = 0, write = 0, checkpoint = 0;
  } seconds;
  Fallbacks fallbacks;
  double peak_memory_mb = 0;
  std::vector<std::string> notes;  ///< what the run did that a user should know, in sentences
};

/// The report as JSON text; `sequence` supplies fragments and frames. docs/report.md explains every key.
std::string to_json(const Report& report, const output::Sequence& sequence);

/// A few lines for the terminal.
std::string summary(const Report& report, const output::Sequence& sequence);

}  // namespace sunder::pipeline
