#pragma once
/// What the catalogue gave, as JSON and as a page.
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "validation/study.h"

namespace sunder::pipeline::detail {

struct ProblemResult {
  const validation::Problem* problem = nullptr;
  validation::Outcome outcome;
  double seconds = 0, processor_seconds = 0, memory_mb = 0;  ///< of its run; memory is the process's peak
  std::optional<validation::StudyResult> study;

  bool passed() const;
  /// The check that is closest to its bound, or beyond it.
  const validation::Check& tightest() const;
};

/// `machine` and `problems[]`; docs/accuracy.md explains the keys.
nlohmann::ordered_json validation_json(const std::vector<ProblemResult>& results);

/// Error against time of all studies, relative to their coarsest resolutions.
std::string overview_svg(const std::vector<ProblemResult>& results);

/// HTML in one file, without scripts.
std::string validation_page(const std::string& title, const std::vector<ProblemResult>& results);

/// "to halve the error costs 2.1 times the time"; empty where no order is expected.
std::string cost_sentence(const validation::Study& study, const validation::StudyResult& result);

}  // namespace sunder::pipeline::detail
