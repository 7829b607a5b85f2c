#pragma once
/// Many processes on one machine that work through jobs.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "batch/plan.h"
#include "batch/work.h"
#include "core/progress.h"

namespace sunder::batch {

struct PoolSettings {
  int workers = 1;          ///< processes side by side, at most
  int threads_per_job = 1;  ///< of each
  double memory_mb =
      0;  ///< for all of them together; 0: no limit. The first job is done alone and tells what one takes
};

/// What a pool did.
struct PoolTally {
  std::uint64_t done = 0, failed = 0;  ///< failed are not among done
  double busy_seconds = 0;             ///< sum over jobs, wall clock
  bool interrupted = false;            ///< the user asked to stop
};

/// Works through jobs in their order, as many at once as the memory holds (at least one). A job whose process crashes,
/// is killed or exceeds the plan's time limit fails with that reason, and the others go on. When `progress` is
/// cancelled what is being worked at is given up. Has to be called while the process has one thread (workers are forks
/// of it). Errors: ErrorKind::io when results cannot be written, ErrorKind::internal when no process can be started.
PoolTally work_through(const Plan& plan, const std::filesystem::path& out, const std::vector<std::uint64_t>& jobs,
                       const PoolSettings& settings, Progress& progress);

}  // namespace sunder::batch
