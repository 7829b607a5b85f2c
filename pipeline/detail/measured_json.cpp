#include "pipeline/detail/measured_json.h"

#include <cmath>
#include <cstdio>

#include "core/resources.h"
#include "output/plain_page.h"
#include "sunder_version.h"

namespace sunder::pipeline::detail {

nlohmann::ordered_json number_json(double x) {
  return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json machine_json() {
  const Machine here = machine();
  return {{"processor", here.processor},
          {"threads", here.threads},
          {"memory_gb", here.memory_gb},
          {"version", SUNDER_VERSION},
          {"git", SUNDER_GIT}};
}

std::string machine_sentence() {
  const Machine here = machine();
  char text[256];
  std::snprintf(text, sizeof text, "%s, %d threads, %.0f GB; version %s (%s)", here.processor.c_str(), here.threads,
                here.memory_gb, SUNDER_VERSION, SUNDER_GIT);
  return text;
}

std::string measured_page(const std::string& title, const std::string& body) {
  return output::plain_page(title, machine_sentence(), body);
}

}  // namespace sunder::pipeline::detail
