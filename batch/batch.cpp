#include "batch/batch.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <numeric>
#include <thread>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

#include "batch/detail/duration.h"
#include "batch/forecast.h"
#include "batch/manifest.h"
#include "batch/page.h"
#include "batch/pool.h"
#include "batch/slurm.h"
#include "core/error.h"
#include "core/resources.h"
#include "output/atomic_file.h"
#include "pipeline/version.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t most_listed = 20;  // jobs of a dry run
constexpr double memory_share = 0.8;     // of what is free, for all workers together

/// Keeps other batches out of a folder while it lives. Tasks of a cluster share it.
class FolderLock {
 public:
  FolderLock(const fs::path& out, bool shared) {
    const fs::path file = out / "batch.lock";
    file_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0) throw Error(ErrorKind::io, file.string() + ": " + std::generic_category().message(errno));
    if (flock(file_, (shared ? LOCK_SH : LOCK_EX) | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    close(file_);
    throw Error(ErrorKind::usage, out.string() + ": another batch works in this folder; wait for it, or give --out");
  }
  ~FolderLock() { close(file_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_;
};

std::string file_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Results of two builds are not to be mixed up.
void require_same_build(const fs::path& out) {
  const std::string build = pipeline::build_name();
  const fs::path file = out / "batch.json";
  std::ifstream in(file);
  if (!in) {
    output::write_atomically(file, Json{{"build", build}}.dump() + "\n");
    return;
  }
  const auto there = nlohmann::json::parse(in, nullptr, false);
  const std::string other = there.is_object() ? there.value("build", "") : "";
  if (other != build)
    throw Error(ErrorKind::usage, out.string() + ": holds results of build " + other + ", this is build " + build +
                                      "; go on with that one, or give another --out");
}

void require_wanted(const Plan& plan, bool yes) {
  const std::uint64_t size = plan.size();
  if (size <= most_unasked || yes) return;
  std::string factors = std::to_string(plan.samples) + " samples";
  for (const Axis& axis : plan.axes)
    if (axis.kind == Axis::Kind::grid && axis.values.size() > 1)
      factors += " x " + std::to_string(axis.values.size()) + " " + axis.name;
  throw Error(ErrorKind::usage, plan.file.string() + ": makes " + std::to_string(size) + " jobs (" + factors +
                                    "); --yes if they are all wanted");
}

struct Range {
  std::uint64_t first, last;
};

/// "120-179". Jobs past the end of the plan are not there, which ends the last task of an array.
Range range_of(const std::string& text, std::uint64_t size) {
  Range range{0, size - 1};
  if (text.empty()) return range;
  const char *at = text.data(), *end = at + text.size();
  const auto first = std::from_chars(at, end, range.first);
  const bool dash = first.ec == std::errc() && first.ptr != end && *first.ptr == '-';
  const auto last = dash ? std::from_chars(first.ptr + 1, end, range.last) : first;
  if (!dash || last.ec != std::errc() || last.ptr != end || range.first > range.last)
    throw Error(ErrorKind::usage, "--jobs " + text + ": expected a range such as 0-99");
  range.last = std::min(range.last, size - 1);
  return range;
}

bool has_failed(const Results& results, const std::string& id) {
  std::ifstream in(results.folder(id) / "result.json");
  const auto result = nlohmann::json::parse(in, nullptr, false);
  return !result.is_object() || result.value("outcome", "failed") == "failed";
}

/// Jobs of the range without a result; those that failed are done again when that is asked for.
std::vector<std::uint64_t> pending_jobs(const Plan& plan, const Range& range, const Results& results, bool retry,
                                        Progress& progress) {
  std::vector<std::uint64_t> pending;
  for (std::uint64_t index = range.first; index <= range.last && index < plan.size(); ++index) {
    if (index % 256 == 0) progress.checkpoint("look", 0);
    const Job job = plan.job(index);
    const bool there = results.has(job.id);
    if (there && !(retry && has_failed(results, job.id))) continue;
    if (there) results.remove(job.id);
    pending.push_back(index);
  }
  return pending;
}

std::string text_of(const Job& job) {
  std::string text = job.id;
  for (const Parameter& parameter : job.parameters) text += "  " + parameter.name + "=" + parameter.value;
  return text;
}

int workers_of(const BatchOptions& options) {
  if (options.workers > 0) return options.workers;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / options.threads);
}

void say_forecast(const BatchOptions& options, const JobForecast& forecast, double jobs) {
  if (forecast.tried == 0) {
    std::cout << "what they take is not known: none of those that were tried came to an end\n";
    return;
  }
  const int workers = workers_of(options);
  std::cout << "a job takes about " << detail::duration(forecast.seconds) << " of processor time and "
            << std::lround(forecast.memory_mb) << " MB";
  if (forecast.bytes > 0) std::cout << ", and leaves " << std::lround(forecast.bytes / 1000) << " kB";
  std::cout << " (" << forecast.tried << " tried)\n"
            << "all of them " << detail::duration(forecast.seconds * jobs) << ", "
            << detail::duration(forecast.seconds * jobs / workers) << " with " << workers << " side by side";
  if (forecast.bytes > 0) std::cout << "; " << std::ceil(forecast.bytes * jobs / 1e6) << " MB on disk";
  std::cout << std::endl;
}

/// A folder that does not exist yet holds nothing.
int dry_run(const Plan& plan, const BatchOptions& options, Progress& progress) {
  output::require_writable(options.out);
  const std::vector<std::uint64_t> pending =
      pending_jobs(plan, range_of(options.jobs, plan.size()), Results(options.out), false, progress);
  for (std::size_t i = 0; i < std::min(most_listed, pending.size()); ++i)
    std::cout << pending[i] << "  " << text_of(plan.job(pending[i])) << "\n";
  if (pending.size() > most_listed) std::cout << "... and " << pending.size() - most_listed << " more\n";
  std::cout << plan.size() << " jobs, " << plan.size() - pending.size() << " of them done; results go to "
            << options.out.string() << std::endl;
  if (pending.empty()) return 0;
  say_forecast(options, forecast(plan, pending, progress), static_cast<double>(pending.size()));
  return 0;
}

void say_tally(const Tally& tally, const fs::path& out) {
  std::cout << tally.broken << " broken, " << tally.whole << " stayed whole, " << tally.failed << " failed";
  if (tally.missing > 0) std::cout << ", " << tally.missing << " not done yet";
  std::cout << "; " << (out / "index.html").string() << " shows it, manifest.sqlite lists it" << std::endl;
}

int code_of(const Tally& tally) {
  return tally.failed + tally.missing > 0 ? static_cast<int>(ErrorKind::jobs_failed) : 0;
}

int collect_command(const Plan& plan, const BatchOptions& options, Progress& progress) {
  const Tally tally = collect(plan, options.out, progress);
  write_batch_page(options.out);
  say_tally(tally, options.out);
  return code_of(tally);
}

int status_command(const Plan& plan, const BatchOptions& options, Progress& progress) {
  const Results results(options.out);
  std::uint64_t done = 0;
  for (std::uint64_t index = 0; index < plan.size(); ++index) {
    if (index % 256 == 0) progress.checkpoint("look", 0);
    done += results.has(plan.job(index).id);
  }
  std::cout << done << " of " << plan.size() << " jobs have a result\n";
  if (options.engine == Engine::slurm)
    for (const auto& [state, count] : task_states(options.out)) std::cout << count << " tasks " << state << "\n";
  std::cout.flush();
  return 0;
}

int run_on_slurm(const Plan& plan, const BatchOptions& options, Progress& progress) {
  const std::vector<std::uint64_t> pending =
      pending_jobs(plan, range_of(options.jobs, plan.size()), Results(options.out), options.retry, progress);
  if (pending.empty()) {
    std::cout << "nothing left to do; --collect writes the manifest" << std::endl;
    return 0;
  }
  const SlurmSettings settings{options.task_minutes, options.threads, options.tasks_at_once};
  // What would be submitted can be looked at where there is no Slurm.
  constexpr std::uint64_t usual_largest_index = 1000;
  const std::uint64_t largest = options.print_script ? usual_largest_index : largest_array_index();
  const std::vector<Submission> arrays =
      submissions(plan, options.out, pending, forecast(plan, pending, progress), settings, largest);
  if (options.print_script) {
    for (const Submission& array : arrays)
      std::cout << "# sbatch --array=" << array.array << "\n" << array.script << std::endl;
    return 0;
  }
  const std::vector<std::string> numbers = submit(arrays, options.out);
  std::uint64_t tasks = 0;
  for (const Submission& array : arrays) tasks += array.tasks;
  std::cout << pending.size() << " jobs in " << tasks << " tasks of " << numbers.size() << " arrays:";
  for (const std::string& number : numbers) std::cout << " " << number;
  std::cout << std::endl;
  return 0;
}

int run_here(const Plan& plan, const BatchOptions& options, Progress& progress) {
  const bool task = !options.jobs.empty();
  const FolderLock lock(options.out, task);
  require_same_build(options.out);
  const Results results(options.out);
  results.remove_abandoned();
  const std::vector<std::uint64_t> pending =
      pending_jobs(plan, range_of(options.jobs, plan.size()), results, options.retry, progress);
  PoolSettings settings;
  settings.workers = workers_of(options);
  settings.threads_per_job = options.threads;
  settings.memory_mb = memory_share * available_memory_mb();
  const PoolTally done = work_through(plan, options.out, pending, settings, progress);
  progress.report("total", 1);
  if (done.interrupted) {
    std::cout << done.done + done.failed << " of " << pending.size()
              << " jobs done; the same command goes on with the rest" << std::endl;
    return static_cast<int>(ErrorKind::interrupted);
  }
  // A task has done its duty when all jobs have a result, good or bad.
  if (task) return 0;
  output::write_atomically(options.out / "plan.toml", file_text(plan.file));
  return collect_command(plan, options, progress);
}

}  // namespace

int batch(const BatchOptions& asked, Progress& progress) {
  const Plan plan = load_plan(asked.plan);
  require_wanted(plan, asked.yes || asked.collect || asked.status || !asked.jobs.empty());
  BatchOptions options = asked;
  if (options.out.empty()) options.out = fs::path("out") / plan.name;
  if (options.dry_run) return dry_run(plan, options, progress);
  if (options.status) return status_command(plan, options, progress);
  output::create_folder(options.out);
  output::require_writable(options.out);
  if (options.collect) return collect_command(plan, options, progress);
  return options.engine == Engine::slurm ? run_on_slurm(plan, options, progress) : run_here(plan, options, progress);
}

}  // namespace sunder::batch
