#pragma once
/// What jobs will take, by trying a few.
#include <filesystem>
#include <vector>

#include "batch/plan.h"
#include "core/progress.h"

namespace sunder::batch {

/// Of one job, with one thread.
struct JobForecast {
  double seconds = 0;    ///< of processor time, the mean
  double memory_mb = 0;  ///< the largest
  double bytes = 0;      ///< of its files, the mean; 0: not known
  int tried = 0;         ///< jobs that this comes from
};

/// Does a few jobs, evenly from `jobs`, into a folder that is then removed; scenes are not run, but predicted as
/// `check` does. Ends after the first job past a quarter of a minute. Jobs that fail are left out; nothing is known
/// when all do. Errors: ErrorKind::interrupted, ErrorKind::io.
JobForecast forecast(const Plan& plan, const std::vector<std::uint64_t>& jobs, Progress& progress);

}  // namespace sunder::batch
