#include "pipeline/detail/validation_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "output/chart.h"
#include "pipeline/detail/measured_json.h"

namespace sunder::pipeline::detail {
namespace {

using Json = nlohmann::ordered_json;
using output::Chart;
using output::ChartSeries;
using output::escaped_xml;
using validation::Check;
using validation::StudyResult;

/// Error over bound; an exact answer to a bound of zero is far from it.
double nearness(const Check& c) {
  if (std::isnan(c.error)) return std::numeric_limits<double>::infinity();
  if (c.error == 0) return 0;
  return c.bound > 0 ? c.error / c.bound : std::numeric_limits<double>::infinity();
}

std::string formatted(const char* format, auto... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string cell(const std::string& text, const char* kind = "") {
  return std::string("<td").append(kind).append(">").append(escaped_xml(text)).append("</td>");
}
std::string number_cell(double x) { return cell(formatted("%.4g", x), " class=\"n\""); }

std::string row_of(const Check& c) {
  return "<tr>" + cell(c.what) + number_cell(c.value) + number_cell(c.reference) + number_cell(c.error) +
         number_cell(c.bound) + (c.passed() ? cell("ok") : cell("FAIL", " class=\"fail\"")) + "</tr>\n";
}

Json study_json(const validation::Study& study, const StudyResult& result) {
  Json points = Json::array();
  for (const auto& m : result.points)
    points.push_back({{"resolution", m.resolution},
                      {"error", number_json(m.error)},
                      {"processor_seconds", m.seconds},
                      {"particle_steps", m.particle_steps}});
  return {{"error", study.error},
          {"size", study.size},
          {"points", points},
          {"order", number_json(result.order)},
          {"least_order", study.least_order ? Json(*study.least_order) : Json(nullptr)},
          {"cost_exponent", number_json(result.cost_exponent)},
          {"verdict", result.passed ? "pass" : "fail"}};
}

ChartSeries series_of(const ProblemResult& r, bool relative) {
  ChartSeries series{r.problem->id + ": " + r.problem->study->error, {}};
  const auto& points = r.study->points;
  for (const auto& m : points) {
    const double seconds = relative ? m.seconds / points[0].seconds : m.seconds;
    const double error = relative ? m.error / points[0].error : m.error;
    series.points.push_back(
        {seconds, error,
         formatted("%d %s: error %.3g, %.3g s", m.resolution, r.problem->study->size.c_str(), m.error, m.seconds)});
  }
  return series;
}

Chart overview_chart(const std::vector<ProblemResult>& results) {
  Chart chart{"How long for how good: each line starts at its coarsest resolution",
              {"times the processor time"},
              {"times the error"},
              {}};
  chart.width = 760;
  chart.height = 440;
  for (const ProblemResult& r : results) {
    if (!r.study || r.study->points.size() < 2) continue;
    chart.series.push_back(series_of(r, true));
    const std::string cost = cost_sentence(*r.problem->study, *r.study);
    chart.series.back().name = r.problem->id + ", " + r.problem->study->error + ": " +
                               (cost.empty() ? "none of the resolution, by design" : cost);
  }
  return chart;
}

std::string study_section(const ProblemResult& r) {
  const validation::Study& study = *r.problem->study;
  Chart chart{r.problem->id + ": " + r.problem->title, {"processor time [s]"}, {study.error}, {series_of(r, false)}};
  std::string text = svg(chart) + "<p>";
  text += escaped_xml(formatted("Fitted order %.2f in %s", r.study->order, study.size.c_str()));
  text += escaped_xml(study.least_order ? formatted(" (at least %.2f wanted)", *study.least_order)
                                        : std::string("; by design the answer does not depend on it"));
  if (const std::string cost = cost_sentence(study, *r.study); !cost.empty()) text += "; " + escaped_xml(cost);
  return text + ".</p>\n";
}

std::string problem_section(const ProblemResult& r) {
  std::string text = "<section id=\"" + r.problem->id + "\">\n<h2>" + r.problem->id + ": ";
  text.append(escaped_xml(r.problem->title)).append("</h2>\n<p>Reference: ").append(escaped_xml(r.problem->source));
  text += formatted(". %.1f s, %.2g particle-steps, %.0f MB.</p>\n", r.seconds, r.outcome.particle_steps, r.memory_mb);
  text +=
      "<div class=\"grid\"><div class=\"scroll\"><table><tr><th>check</th><th class=\"n\">value</th><th "
      "class=\"n\">reference</th><th class=\"n\">error</th><th class=\"n\">bound</th><th></th></tr>\n";
  for (const Check& c : r.outcome.checks) text += row_of(c);
  text += "</table></div>\n";
  if (r.study) text += "<div>" + study_section(r) + "</div>\n";
  return text + "</div></section>\n";
}

}  // namespace

bool ProblemResult::passed() const {
  return std::all_of(outcome.checks.begin(), outcome.checks.end(), [](const Check& c) { return c.passed(); }) &&
         (!study || study->passed);
}

const Check& ProblemResult::tightest() const {
  return *std::max_element(outcome.checks.begin(), outcome.checks.end(),
                           [](const Check& a, const Check& b) { return nearness(a) < nearness(b); });
}

std::string cost_sentence(const validation::Study& study, const StudyResult& result) {
  if (!study.least_order || !(result.cost_exponent > 0)) return {};
  return formatted("to halve the error costs %.1f times the time", std::exp2(result.cost_exponent));
}

Json validation_json(const std::vector<ProblemResult>& results) {
  Json problems = Json::array();
  for (const ProblemResult& r : results) {
    Json checks = Json::array();
    for (const Check& c : r.outcome.checks)
      checks.push_back({{"what", c.what},
                        {"value", number_json(c.value)},
                        {"reference", number_json(c.reference)},
                        {"error", number_json(c.error)},
                        {"bound", number_json(c.bound)},
                        {"ok", c.passed()}});
    const Check& tightest = r.tightest();
    problems.push_back({{"id", r.problem->id},
                        {"title", r.problem->title},
                        {"source", r.problem->source},
                        {"verdict", r.passed() ? "pass" : "fail"},
                        {"tightest", tightest.what},
                        {"error", number_json(tightest.error)},
                        {"bound", number_json(tightest.bound)},
                        {"seconds", r.seconds},
                        {"processor_seconds", r.processor_seconds},
                        {"particle_steps", r.outcome.particle_steps},
                        {"memory_mb", r.memory_mb},
                        {"order", r.study ? number_json(r.study->order) : Json(nullptr)},
                        {"cost_exponent", r.study ? number_json(r.study->cost_exponent) : Json(nullptr)},
                        {"checks", checks},
                        {"study", r.study ? study_json(*r.problem->study, *r.study) : Json(nullptr)}});
  }
  return {{"machine", machine_json()}, {"problems", problems}};
}

std::string overview_svg(const std::vector<ProblemResult>& results) { return svg(overview_chart(results)); }

std::string validation_page(const std::string& title, const std::vector<ProblemResult>& results) {
  const auto failed = std::count_if(results.begin(), results.end(), [](const auto& r) { return !r.passed(); });
  std::string body = formatted("<p>%zu problems, %ld of them failed.</p>\n", results.size(), static_cast<long>(failed));
  const bool studied = std::any_of(results.begin(), results.end(), [](const auto& r) { return r.study.has_value(); });
  if (studied) body += svg(overview_chart(results));
  body +=
      "<table><tr><th>problem</th><th></th><th>tightest check</th><th class=\"n\">error</th><th "
      "class=\"n\">bound</th><th class=\"n\">seconds</th><th>verdict</th></tr>\n";
  for (const ProblemResult& r : results) {
    const Check& c = r.tightest();
    body += "<tr><td><a href=\"#" + r.problem->id + "\">" + r.problem->id + "</a></td>" + cell(r.problem->title) +
            cell(c.what) + number_cell(c.error) + number_cell(c.bound) +
            cell(formatted("%.1f", r.seconds), " class=\"n\"") +
            (r.passed() ? cell("pass") : cell("FAIL", " class=\"fail\"")) + "</tr>\n";
  }
  body += "</table>\n";
  for (const ProblemResult& r : results) body += problem_section(r);
  return measured_page(title, body);
}

}  // namespace sunder::pipeline::detail
