#pragma once
/// Batches on a cluster by Slurm: arrays of tasks, each of which works through a range of jobs.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "batch/forecast.h"
#include "batch/plan.h"

namespace sunder::batch {

struct SlurmSettings {
  double task_minutes = 10;
  int threads = 1;        ///< of a job; a task does one job after another
  int tasks_at_once = 0;  ///< 0: as many as the site allows
};

/// An array of tasks: task k of it does the jobs offset + k * chunk to offset + (k + 1) * chunk - 1.
struct Submission {
  std::string array;    ///< as `sbatch --array` takes it: "0-3,7"
  std::uint64_t tasks;  ///< that it names
  std::string script;
};

/// Submissions that cover `pending` (ascending), none with a larger index than `largest_index`. Chunks are as many jobs
/// as the forecast says last `task_minutes`; time and memory limits leave room over the forecast.
std::vector<Submission> submissions(const Plan& plan, const std::filesystem::path& out,
                                    const std::vector<std::uint64_t>& pending, const JobForecast& forecast,
                                    const SlurmSettings& settings, std::uint64_t largest_index);

/// Largest index of an array that the site takes (its MaxArraySize less one). Errors: ErrorKind::usage when there is
/// no Slurm here.
std::uint64_t largest_array_index();

/// Hands the submissions to sbatch, and keeps their scripts and numbers in out/slurm. Returns the numbers. Errors:
/// ErrorKind::usage with what sbatch says.
std::vector<std::string> submit(const std::vector<Submission>& submissions, const std::filesystem::path& out);

/// How many tasks of everything that was submitted for the folder are in which state, as squeue names them; those that
/// have ended are not among them. Errors: ErrorKind::usage.
std::vector<std::pair<std::string, std::uint64_t>> task_states(const std::filesystem::path& out);

}  // namespace sunder::batch
