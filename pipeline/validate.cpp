#include "pipeline/validate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/stopwatch.h"
#include "output/atomic_file.h"
#include "validation/problem.h"

namespace sunder::pipeline {
namespace {

using validation::Check;
using validation::Problem;

struct Result {
  validation::Outcome outcome;
  double seconds = 0;

  bool passed() const {
    return std::all_of(outcome.checks.begin(), outcome.checks.end(), [](const Check& c) { return c.passed(); });
  }
};

/// In the order of the catalogue, each once.
std::vector<Problem> chosen(const std::vector<std::string>& only) {
  const auto& all = validation::problems();
  for (const std::string& id : only) {
    if (std::any_of(all.begin(), all.end(), [&](const Problem& p) { return p.id == id; })) continue;
    std::string known;
    for (const Problem& p : all) known += (known.empty() ? "" : ", ") + p.id;
    throw Error(ErrorKind::usage, "there is no validation problem '" + id + "'; known: " + known);
  }
  std::vector<Problem> list;
  std::copy_if(all.begin(), all.end(), std::back_inserter(list), [&](const Problem& p) {
    return only.empty() || std::find(only.begin(), only.end(), p.id) != only.end();
  });
  return list;
}

void print(const Problem& problem, const Result& result) {
  // Over the progress bar.
  if (isatty(STDERR_FILENO)) std::fputs("\r\x1b[K", stdout);
  std::printf("%-4s %s: %s, %.1f s\n", problem.id.c_str(), problem.title.c_str(), result.passed() ? "pass" : "FAIL",
              result.seconds);
  for (const Check& c : result.outcome.checks)
    std::printf("       %-76s %12.6g %12.6g %10.3g %10.3g  %s\n", c.what.c_str(), c.value, c.reference, c.error,
                c.bound, c.passed() ? "ok" : "FAIL");
  std::fflush(stdout);
}

/// JSON has no word for what is not a number.
nlohmann::ordered_json number(double x) {
  return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json entry(const Problem& problem, const Result& result) {
  nlohmann::ordered_json checks = nlohmann::ordered_json::array();
  for (const Check& c : result.outcome.checks)
    checks.push_back({{"what", c.what},
                      {"value", number(c.value)},
                      {"reference", number(c.reference)},
                      {"error", number(c.error)},
                      {"bound", number(c.bound)},
                      {"ok", c.passed()}});
  return {{"id", problem.id},          {"title", problem.title},
          {"source", problem.source},  {"verdict", result.passed() ? "pass" : "fail"},
          {"seconds", result.seconds}, {"particle_steps", result.outcome.particle_steps},
          {"checks", checks}};
}

}  // namespace

bool validate(const ValidateOptions& options, Progress& progress) {
  const std::vector<Problem> list = chosen(options.only);
  nlohmann::ordered_json problems = nlohmann::ordered_json::array();
  std::size_t failed = 0;
  double seconds = 0;
  std::printf("%-83s %12s %12s %10s %10s\n", "problem and check", "value", "reference", "error", "bound");
  for (std::size_t n = 0; n < list.size(); ++n) {
    if (progress.cancelled()) break;
    progress.report(list[n].id, 0);
    progress.report("total", static_cast<double>(n) / static_cast<double>(list.size()));
    Result result;
    {
      const Stopwatch watch(result.seconds);
      result.outcome = list[n].run();
    }
    seconds += result.seconds;
    failed += !result.passed();
    print(list[n], result);
    problems.push_back(entry(list[n], result));
  }
  const bool interrupted = problems.size() < list.size();
  if (!interrupted) progress.report("total", 1);
  std::printf("%zu problems, %zu failed, %.1f s\n", problems.size(), failed, seconds);
  if (!options.json.empty())
    output::write_atomically(options.json, nlohmann::ordered_json{{"problems", problems}}.dump(2) + "\n");
  if (interrupted) throw Error(ErrorKind::interrupted, "interrupted");
  return failed == 0;
}

}  // namespace sunder::pipeline
