#pragma once
/// The command `batch`: a plan in, a folder of results and their manifest out.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/progress.h"

namespace sunder::batch {

enum class Engine { local, slurm };

struct BatchOptions {
  std::filesystem::path plan;
  std::filesystem::path out;  ///< empty: out/<plan>
  Engine engine = Engine::local;
  int workers = 0;            ///< processes side by side; 0: as many as there are processors for them
  int threads = 1;            ///< of one job
  std::string jobs;           ///< "120-179": only these, without a manifest; what a task of a cluster does
  bool dry_run = false;       ///< list the jobs and what they will take
  bool retry = false;         ///< do failed jobs again
  bool yes = false;           ///< also more than most_unasked jobs
  bool collect = false;       ///< only write the manifest of what is there
  bool status = false;        ///< only say how far it is
  bool print_script = false;  ///< of slurm: what would be submitted
  double task_minutes = 10;   ///< of slurm: how long a task should last
  int tasks_at_once = 0;      ///< of slurm: at most; 0: as many as the site allows
};

/// More jobs than these are taken for a slip of the pen.
constexpr std::uint64_t most_unasked = 100'000;

/// Says on stdout what it does. Returns the exit code: 0, or that of ErrorKind::jobs_failed or
/// ErrorKind::interrupted. Errors: ErrorKind::usage for the plan, a second batch in the folder, results of another
/// build in it, and too many jobs; ErrorKind::io.
int batch(const BatchOptions& options, Progress& progress);

}  // namespace sunder::batch
