#include "pipeline/validate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <unistd.h>

#include "core/resources.h"
#include "core/stopwatch.h"
#include "output/atomic_file.h"
#include "pipeline/detail/validation_report.h"
#include "pipeline/hard_cases.h"

namespace sunder::pipeline {
namespace {

using detail::ProblemResult;
using validation::Check;
using validation::Problem;

/// In the order of the catalogue, each once.
std::vector<Problem> chosen(const ValidateOptions& options) {
  const auto& all = options.hard ? hard_cases() : catalogue();
  for (const std::string& id : options.only) {
    if (std::any_of(all.begin(), all.end(), [&](const Problem& p) { return p.id == id; })) continue;
    std::string known;
    for (const Problem& p : all) known += (known.empty() ? "" : ", ") + p.id;
    throw Error(ErrorKind::usage, std::string("there is no ") + (options.hard ? "hard case" : "validation problem") +
                                      " '" + id + "'; known: " + known);
  }
  std::vector<Problem> list;
  std::copy_if(all.begin(), all.end(), std::back_inserter(list), [&](const Problem& p) {
    return options.only.empty() || std::find(options.only.begin(), options.only.end(), p.id) != options.only.end();
  });
  return list;
}

void require_resolutions(const ValidateOptions& options, const std::vector<Problem>& list) {
  if (options.resolutions.empty()) return;
  if (list.size() != 1)
    throw Error(ErrorKind::usage, "--resolution belongs to one problem: what it counts differs; name it by --only");
  if (list[0].study) return;
  std::string studied;
  for (const Problem& p : catalogue())
    if (p.study) studied += (studied.empty() ? "" : ", ") + p.id;
  throw Error(ErrorKind::usage,
              "the answer of " + list[0].id + " does not depend on a resolution; problems that have one: " + studied);
}

ProblemResult solve(const Problem& problem, const std::vector<int>& resolutions) {
  ProblemResult result;
  result.problem = &problem;
  restart_peak_memory();
  const double start = cpu_seconds();
  {
    const Stopwatch watch(result.seconds);
    result.outcome = problem.run();
  }
  result.processor_seconds = cpu_seconds() - start;
  result.memory_mb = peak_memory_mb();
  if (problem.study)
    result.study = validation::measure(*problem.study, resolutions.empty() ? problem.study->resolutions : resolutions);
  return result;
}

void print(const ProblemResult& result) {
  // Over the progress bar.
  if (isatty(STDERR_FILENO)) std::fputs("\r\x1b[K", stdout);
  std::printf("%-4s %s: %s, %.1f s, %.0f MB\n", result.problem->id.c_str(), result.problem->title.c_str(),
              result.passed() ? "pass" : "FAIL", result.seconds, result.memory_mb);
  for (const Check& c : result.outcome.checks)
    std::printf("       %-76s %12.6g %12.6g %10.3g %10.3g  %s\n", c.what.c_str(), c.value, c.reference, c.error,
                c.bound, c.passed() ? "ok" : "FAIL");
  if (result.study) {
    for (const auto& m : result.study->points)
      std::printf("       %6d %-40s  error %10.3g   %8.3g s   %8.2g particle-steps\n", m.resolution,
                  result.problem->study->size.c_str(), m.error, m.seconds, m.particle_steps);
    const std::string cost = detail::cost_sentence(*result.problem->study, *result.study);
    std::printf("       error of the %s: order %.2f%s%s%s\n", result.problem->study->error.c_str(), result.study->order,
                cost.empty() ? "" : "; ", cost.c_str(), result.study->passed ? "" : "  FAIL: too low");
  }
  std::fflush(stdout);
}

void write(const std::vector<ProblemResult>& results, const ValidateOptions& options) {
  if (!options.json.empty()) output::write_atomically(options.json, detail::validation_json(results).dump(2) + "\n");
  if (!options.svg.empty()) output::write_atomically(options.svg, detail::overview_svg(results));
  if (!options.html.empty())
    output::write_atomically(
        options.html, detail::validation_page(options.hard ? "Hard cases of Sunder" : "Validation of Sunder", results));
}

}  // namespace

bool validate(const ValidateOptions& options, Progress& progress) {
  const std::vector<Problem> list = chosen(options);
  require_resolutions(options, list);
  for (const auto& file : {options.json, options.svg, options.html})
    if (!file.empty()) output::require_writable(std::filesystem::absolute(file).parent_path());
  std::vector<ProblemResult> results;
  double seconds = 0;
  std::printf("%-83s %12s %12s %10s %10s\n", "problem and check", "value", "reference", "error", "bound");
  for (const Problem& problem : list) {
    if (progress.cancelled()) break;
    progress.report(problem.id, 0);
    progress.report("total", static_cast<double>(results.size()) / static_cast<double>(list.size()));
    results.push_back(solve(problem, options.resolutions));
    seconds += results.back().seconds;
    print(results.back());
  }
  const bool interrupted = results.size() < list.size();
  if (!interrupted) progress.report("total", 1);
  const auto failed = std::count_if(results.begin(), results.end(), [](const auto& r) { return !r.passed(); });
  std::printf("%zu problems, %ld failed, %.1f s\n", results.size(), static_cast<long>(failed), seconds);
  write(results, options);
  if (interrupted) throw Error(ErrorKind::interrupted, "interrupted");
  return failed == 0;
}

}  // namespace sunder::pipeline
