#pragma once
/// Doing jobs, one after another.
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batch/plan.h"
#include "batch/results.h"
#include "pipeline/still.h"

namespace sunder::batch {

/// What became of a job that was tried.
struct JobEnd {
  bool failed = false;
  double seconds = 0;  ///< wall clock
  double processor_seconds = 0;
  double memory_mb = 0;  ///< most at once
};

/// Does jobs of a plan and leaves in the folder of each (docs/batch.md): result.json, what the plan keeps, and what
/// differs from one time to the next: measured.json and log.txt. A job that cannot be done leaves the reason.
class Worker {
 public:
  Worker(const Plan& plan, const std::filesystem::path& out) : plan_(plan), out_(out), results_(out) {}

  /// Errors: ErrorKind::io when the result cannot be written: the disk is full, or the folder gone.
  JobEnd work(const Job& job);

 private:
  struct Loaded {
    std::string of;  ///< the parameters that decide what is loaded
    pipeline::StillBody body;
  };

  /// What a job says, and where its time went.
  struct Told {
    std::string log;
    std::vector<std::pair<std::string, double>> stages;  ///< wall clock [s]
  };

  Told fracture(const Job& job, const std::filesystem::path& folder);
  Told run(const Job& job, const std::filesystem::path& folder);
  void keep_original(const std::string& name, const geometry::TriangleMesh& mesh) const;
  const pipeline::StillBody& loaded(const Job& job, const pipeline::FractureOptions& options);

  const Plan& plan_;
  std::filesystem::path out_;
  Results results_;
  std::optional<Loaded> loaded_;  ///< jobs of the same body follow each other
};

/// Leaves a result that says why there is none, for a process that could not say it itself. Errors: ErrorKind::io.
void write_failure(const Job& job, const Results& results, int code, const std::string& message);

}  // namespace sunder::batch
