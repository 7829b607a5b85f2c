#include "batch/forecast.h"

#include <algorithm>
#include <fstream>

#include <nlohmann/json.hpp>
#include <tbb/global_control.h>
#include <unistd.h>

#include "batch/detail/job_keys.h"
#include "batch/work.h"
#include "core/child_process.h"
#include "core/resources.h"
#include "core/stopwatch.h"
#include "pipeline/prediction.h"
#include "pipeline/run.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t most_tried = 4;
constexpr double most_seconds = 15;           // after which no further job is tried
constexpr double most_child_seconds = 86400;  // of processor time: jobs may be long

double bytes_in(const fs::path& folder) {
  double bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) bytes += static_cast<double>(entry.file_size());
  return bytes;
}

Json tried(const Plan& plan, const Job& job, const fs::path& scratch) {
  Worker worker(plan, scratch);
  const JobEnd end = worker.work(job);
  return {{"failed", end.failed},
          {"seconds", end.processor_seconds},
          {"memory_mb", end.memory_mb},
          {"bytes", bytes_in(Results(scratch).folder(job.id))}};
}

Json predicted(const Plan& plan, const Job& job) {
  const pipeline::Scene scene = detail::scene_of(plan, job);
  pipeline::RunOptions options;
  options.threads = 1;
  SilentProgress progress;
  const double start = cpu_seconds();
  const pipeline::Simulation simulation(scene, options, progress);
  const pipeline::Forecaster forecaster(scene, simulation, cpu_seconds() - start, pipeline::Forecaster::whole,
                                        progress);
  const pipeline::Prediction prediction = forecaster.at(scene.quality, 1);
  return {
      {"failed", false}, {"seconds", prediction.processor_seconds}, {"memory_mb", prediction.memory_mb}, {"bytes", 0}};
}

/// In a process of its own: this one keeps a single thread.
Json trial(const Plan& plan, const Job& job, const fs::path& scratch) {
  const auto work = [&] {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    return (plan.mode == Mode::fracture ? tried(plan, job, scratch) : predicted(plan, job)).dump();
  };
  try {
    return Json::parse(in_child_process(work, most_child_seconds));
  } catch (const ChildFailed&) {
    return {{"failed", true}};
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    return {{"failed", true}};
  }
}

class Scratch {
 public:
  Scratch() {
    std::string pattern = (fs::temp_directory_path() / "sunder_batch_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw Error(ErrorKind::io, pattern + ": cannot be created");
    path_ = pattern;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

JobForecast forecast(const Plan& plan, const std::vector<std::uint64_t>& jobs, Progress& progress) {
  const Scratch scratch;
  JobForecast forecast;
  double spent = 0;
  const std::size_t count = std::min(most_tried, jobs.size());
  for (std::size_t i = 0; i < count && spent < most_seconds; ++i) {
    progress.checkpoint("forecast", static_cast<double>(i) / static_cast<double>(count));
    const Stopwatch watch(spent);
    // From the middle of each of `count` equal parts.
    const Json result = trial(plan, plan.job(jobs[(2 * i + 1) * jobs.size() / (2 * count)]), scratch.path());
    if (result.at("failed").get<bool>()) continue;
    ++forecast.tried;
    forecast.seconds += result.at("seconds").get<double>();
    forecast.bytes += result.at("bytes").get<double>();
    forecast.memory_mb = std::max(forecast.memory_mb, result.at("memory_mb").get<double>());
  }
  if (forecast.tried > 0) {
    forecast.seconds /= forecast.tried;
    forecast.bytes /= forecast.tried;
  }
  return forecast;
}

}  // namespace sunder::batch
