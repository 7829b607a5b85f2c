#pragma once
/// What a ladder of resolutions gave, as JSON, as a page and as pictures.
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pipeline/accuracy_measures.h"

namespace sunder::pipeline::detail {

enum class Variant { plain, cubic, two_fields };
const char* name_of(Variant variant);  ///< "quadratic", "cubic", "two_fields"

/// One solve of a hit.
struct Rung {
  int particles = 0;
  Variant variant = Variant::plain;
  int seed = 1;
  double processor_seconds = 0, memory_mb = 0;
  long steps = 0;
  int fragments = 1;
  double effective_count = 1, damaged_share = 0;
  FractureTrace trace = {};
  TraceDistance to_finest = {};
};

struct HitStudy {
  std::string body;
  double time = 0, severity = 0;
  std::vector<Rung> rungs;  ///< the finest first
};

/// What one can rely on and what not, in sentences: each quantity with its fitted order, or the spread between seeds
/// that hides one.
std::vector<std::string> findings(const HitStudy& study);

nlohmann::ordered_json accuracy_json(const std::string& scene, const std::vector<HitStudy>& studies);

/// accuracy.json, accuracy.html and crack_<particles>.png, in which the crack of each resolution (red) is drawn over
/// that of the finest (blue). Errors: ErrorKind::io.
void write_accuracy(const std::string& scene, const std::vector<HitStudy>& studies,
                    const std::filesystem::path& folder);

}  // namespace sunder::pipeline::detail
