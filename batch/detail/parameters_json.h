#pragma once
/// Parameters of a job by name.
#include <nlohmann/json.hpp>

#include "batch/plan.h"

namespace sunder::batch::detail {

inline nlohmann::ordered_json parameters_json(const Job& job) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
  for (const Parameter& parameter : job.parameters)
    parameters[parameter.name] = nlohmann::ordered_json::parse(parameter.value);
  return parameters;
}

}  // namespace sunder::batch::detail
