#pragma once
/// Results that no job made, as many as one likes.
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "batch/detail/parameters_json.h"
#include "batch/manifest.h"
#include "batch/plan.h"
#include "batch/results.h"
#include "core/child_process.h"
#include "core/resources.h"
#include "core/stopwatch.h"

namespace sunder::batch {

/// Results such as jobs with eight pieces leave.
inline void fabricate(const Plan& plan, const std::filesystem::path& out) {
  const Results results(out);
  nlohmann::ordered_json pieces = nlohmann::ordered_json::array(), files = nlohmann::ordered_json::array();
  for (int p = 0; p < 8; ++p)
    pieces.push_back({{"name", "block_" + std::to_string(p)},
                      {"volume", 0.001 + p},
                      {"mass", 1.5 + p},
                      {"area", 0.3},
                      {"inside_area", 0.1},
                      {"closed", true}});
  for (const char* name : {"pieces.npz", "still.png"})
    files.push_back({{"name", name}, {"bytes", 123456}, {"sha256", std::string(64, 'a')}});
  for (std::uint64_t i = 0; i < plan.size(); ++i) {
    const Job job = plan.job(i);
    const nlohmann::ordered_json result = {
        {"id", job.id},         {"build", "bench"},   {"parameters", detail::parameters_json(job)},
        {"outcome", "broken"},  {"error", nullptr},   {"fragments", 8},
        {"largest_share", 0.4}, {"crack_area", 0.02}, {"work", 3.5},
        {"pieces", pieces},     {"files", files}};
    std::filesystem::create_directories(results.folder(job.id));
    std::ofstream(results.folder(job.id) / "result.json") << result.dump(1);
    std::ofstream(results.folder(job.id) / "measured.json") << R"({"seconds":1.1,"processor_seconds":1.0,"host":"a"})";
  }
}

struct Collecting {
  double seconds = 0, memory_mb = 0;
};

/// In a process of its own, for the memory is its most.
inline Collecting measured_collecting(const Plan& plan, const std::filesystem::path& out) {
  const auto work = [&] {
    restart_peak_memory();
    SilentProgress progress;
    double seconds = 0;
    {
      const Stopwatch watch(seconds);
      collect(plan, out, progress);
    }
    return std::to_string(seconds) + " " + std::to_string(peak_memory_mb());
  };
  constexpr double kEnough = 86400;  // processor time [s]
  std::istringstream answer(in_child_process(work, kEnough));
  Collecting collecting;
  answer >> collecting.seconds >> collecting.memory_mb;
  return collecting;
}

}  // namespace sunder::batch
