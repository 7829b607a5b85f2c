#pragma once
/// What all jobs of a plan came to, in one place.
#include <cstdint>
#include <filesystem>

#include "batch/plan.h"
#include "core/progress.h"

namespace sunder::batch {

struct Tally {
  std::uint64_t broken = 0, whole = 0, failed = 0, missing = 0;
};

/// Reads the results that there are of the plan's jobs and writes manifest.sqlite and manifest.jsonl (docs/batch.md)
/// into `out`, each whole or not at all. Takes the memory of one result, however many there are; results may come in
/// meanwhile. Errors: ErrorKind::io, ErrorKind::interrupted.
Tally collect(const Plan& plan, const std::filesystem::path& out, Progress& progress);

}  // namespace sunder::batch
