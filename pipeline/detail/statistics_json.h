#pragma once
/// The key `statistics` of report.json.
#include <nlohmann/json.hpp>

#include "pipeline/fragment_statistics.h"

namespace sunder::pipeline::detail {

/// What is not set is null. docs/report.md explains every key.
nlohmann::ordered_json statistics_json(const FragmentStatistics& statistics);

}  // namespace sunder::pipeline::detail
