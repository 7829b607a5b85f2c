#include "batch/plan.h"

#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "batch/detail/job_keys.h"
#include "core/hash.h"
#include "core/random.h"
#include "pipeline/fingerprint.h"

namespace sunder::batch {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t stream_of(const std::string& name) {
  Hash hash;
  hash.add(name);
  return hash.value();
}

/// A whole number stays one.
std::string drawn(const Axis& axis, std::uint64_t seed, std::uint64_t sample) {
  const std::uint64_t stream = stream_of(axis.name);
  const double u = random_unit(seed, stream, sample);
  switch (axis.kind) {
    case Axis::Kind::uniform:
      return Json(axis.low + u * (axis.high - axis.low)).dump();
    case Axis::Kind::log_uniform:
      return Json(axis.low * std::pow(axis.high / axis.low, u)).dump();
    case Axis::Kind::integer:
      return Json(static_cast<std::int64_t>(axis.low + std::floor(u * (axis.high - axis.low + 1)))).dump();
    case Axis::Kind::choice:
      return axis.values[random_word(seed, stream, sample) % axis.values.size()];
    case Axis::Kind::grid:
      break;
  }
  return "";
}

bool has_axis(const std::vector<Axis>& axes, const std::string& name) {
  for (const Axis& axis : axes)
    if (axis.name == name) return true;
  return false;
}

constexpr std::uint64_t seed_bits = 31;  // short enough to be read and typed

}  // namespace

std::uint64_t Plan::size() const {
  constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t size = samples;
  for (const Axis& axis : axes) {
    if (axis.kind != Axis::Kind::grid) continue;
    const std::uint64_t count = axis.values.size();
    if (count > 0 && size > most / count) return most;
    size *= count;
  }
  return size;
}

Job Plan::job(std::uint64_t index) const {
  const std::uint64_t sample = index % samples;
  std::uint64_t rest = index / samples;
  Job job{index, "", "", {}};
  job.parameters.resize(axes.size());
  for (std::size_t a = axes.size(); a-- > 0;) {
    const Axis& axis = axes[a];
    const bool grid = axis.kind == Axis::Kind::grid;
    job.parameters[a] = {axis.name, grid ? axis.values[rest % axis.values.size()] : drawn(axis, seed, sample)};
    if (grid) rest /= axis.values.size();
  }
  const bool named = mode == Mode::fracture || samples > 1;
  if (named && !has_axis(axes, mode == Mode::fracture ? "seed" : "scene.seed") && !has_axis(axes, "seed")) {
    const std::uint64_t word = random_word(seed, stream_of("seed"), sample) >> (64 - seed_bits);
    job.parameters.push_back({"seed", std::to_string(word)});
  }
  if (samples > 1) job.parameters.push_back({"sample", std::to_string(sample)});
  Hash hash;
  for (const Parameter& parameter : job.parameters) hash.add(parameter.name + "=" + parameter.value + "\n");
  job.content = content_of(job.parameters.front().value);
  hash.add(job.content);
  for (const Parameter& parameter : job.parameters)
    if (mode == Mode::run && parameter.name.ends_with(".mesh")) hash.add(content_of(parameter.value));
  job.id = hash.digits();
  return job;
}

const std::string& Plan::content_of(const std::string& subject) const {
  const auto [known, is_new] = contents_.try_emplace(subject);
  if (!is_new) return known->second;
  const auto found = detail::subject_file(*this, detail::text_of(subject));
  Hash hash;
  if (found && mode == Mode::run && found->extension() == ".toml") {
    hash.add(pipeline::fingerprint(pipeline::load_scene(*found)));
  } else {
    if (found) hash.add_file(*found);
    hash.add_file(pipeline::default_assets().materials);
  }
  return known->second = hash.digits();
}

std::string value_of(const Job& job, const std::string& name) {
  for (const Parameter& parameter : job.parameters)
    if (parameter.name == name) return parameter.value;
  return "";
}

}  // namespace sunder::batch
