#include "batch/page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "batch/detail/database.h"
#include "batch/detail/duration.h"
#include "output/atomic_file.h"
#include "output/chart.h"
#include "output/plain_page.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;
using detail::Database;
using detail::quoted;
using detail::Statement;
using output::Chart;
using output::ChartSeries;
using output::escaped_xml;

constexpr int most_stills = 48;
constexpr int most_points = 2000;  // of a chart: a sample of all jobs, even by number
constexpr int most_rows = 40;      // of a table of values
constexpr int size_bins = 40;

std::string formatted(const char* format, auto... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

/// One value of one row.
struct Answer {
  double number = 0;
  std::string text;
};
Answer ask(Database& database, const std::string& sql) {
  Statement statement = database.prepare(sql);
  if (!statement.next()) return {};
  return {statement.number(0), statement.text(0)};
}

/// The rows of a question as a table; columns of numbers are set right.
std::string table(Database& database, const std::string& sql, const std::vector<std::string>& heads) {
  Statement rows = database.prepare(sql);
  std::string text = "<div class=\"scroll\"><table><tr>";
  for (const std::string& head : heads) text += "<th>" + escaped_xml(head) + "</th>";
  text += "</tr>\n";
  int count = 0;
  while (rows.next() && count++ < most_rows) {
    text += "<tr>";
    for (int c = 0; c < rows.columns(); ++c) {
      std::string value = rows.text(c);
      if (value.find('.') != std::string::npos && value.find_first_not_of("0123456789.e+-") == std::string::npos)
        value = formatted("%.3g", rows.number(c));
      text += "<td>" + escaped_xml(value) + "</td>";
    }
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

std::string overview(Database& database) {
  const auto number = [&](const std::string& sql) { return ask(database, sql).number; };
  const double jobs = number("SELECT count(*) FROM job");
  const double processor = number("SELECT sum(processor_seconds) FROM job");
  const double done = number("SELECT count(*) FROM job WHERE outcome IN ('broken', 'whole')");
  std::string text = "<p>";
  text += formatted("%.0f jobs: ", jobs);
  Statement outcomes = database.prepare("SELECT outcome, count(*) FROM job GROUP BY outcome ORDER BY 2 DESC");
  for (bool first = true; outcomes.next(); first = false) {
    const std::string outcome = outcomes.text(0);
    text += first ? "" : ", ";
    text += (outcome == "failed" ? "<span class=\"fail\">" : "<span>") + std::to_string(outcomes.integer(1)) + " " +
            (outcome == "whole" ? "stayed whole" : outcome) + "</span>";
  }
  text += formatted("; %.0f fragments.", number("SELECT sum(fragments) FROM job"));
  text += " Processor time " + detail::duration(processor);
  if (done > 0)
    text += formatted(", %.2f s a job (%.0f jobs in a core-hour)", processor / done, 3600 * done / processor);
  text += formatted("; %.1f MB on disk", number("SELECT sum(bytes) FROM file") / 1e6);
  text += formatted("; most memory of a job %.0f MB.</p>\n", number("SELECT max(peak_memory_mb) FROM job"));
  return text;
}

std::string failures(Database& database) {
  if (ask(database, "SELECT count(*) FROM failures").number == 0) return "";
  return "<h2>Failures</h2>\n" + table(database, "SELECT jobs, error_code, error, first_job FROM failures",
                                       {"jobs", "code", "why", "first job"});
}

/// Jobs that broke or stayed whole, a sample of them when there are many.
std::string sampled(Database& database) {
  const double jobs = ask(database, "SELECT count(*) FROM job").number;
  const int stride = std::max(1, static_cast<int>(std::ceil(jobs / most_points)));
  return "outcome IN ('broken', 'whole') AND number % " + std::to_string(stride) + " = 0";
}

Chart scatter(Database& database, const std::string& title, const std::string& x, const std::string& x_name,
              const std::string& y, const std::string& y_name, bool logarithmic) {
  Chart chart{title, {x_name, logarithmic}, {y_name, false}, {}};
  ChartSeries series{"jobs", {}, false};
  Statement rows = database.prepare("SELECT " + x + ", " + y + ", number FROM job WHERE " + sampled(database) +
                                    " AND " + x + " IS NOT NULL AND " + y + " IS NOT NULL");
  while (rows.next()) series.points.push_back({rows.number(0), rows.number(1), "job " + rows.text(2)});
  chart.series.push_back(std::move(series));
  return chart;
}

/// Fragments against a parameter: points for numbers, a table of its values otherwise.
std::string against(Database& database, const std::string& parameter) {
  const std::string name = quoted(parameter);
  const std::string type = ask(database, "SELECT typeof(" + name + ") FROM job WHERE " + name + " IS NOT NULL").text;
  std::string text = "<h3>" + escaped_xml(parameter) + "</h3>\n";
  if (type == "integer" || type == "real") {
    const double low = ask(database, "SELECT min(" + name + ") FROM job").number;
    const double high = ask(database, "SELECT max(" + name + ") FROM job").number;
    return text + output::svg(scatter(database, "Fragments against " + parameter, name, parameter, "fragments",
                                      "fragments", low > 0 && high > 20 * low));
  }
  return text +
         table(database,
               "SELECT " + name +
                   ", count(*), sum(outcome = 'failed'), avg(outcome = 'broken'), avg(fragments), max(fragments), "
                   "avg(largest_share), avg(seconds) FROM job WHERE outcome != 'missing' GROUP BY " +
                   name,
               {parameter, "jobs", "failed", "share that broke", "mean fragments", "most", "largest piece's share",
                "mean seconds"});
}

std::string varied(Database& database) {
  const auto names = nlohmann::json::parse(ask(database, "SELECT value FROM plan WHERE key = 'varied'").text);
  std::string text = "<h2>What was varied</h2>\n<div class=\"grid\">";
  for (const auto& name : names)
    if (name != "seed") text += "<div>" + against(database, name.get<std::string>()) + "</div>\n";
  return text + "</div>\n";
}

/// How many pieces there are of which share of their body.
Chart sizes(Database& database) {
  Chart chart{"Sizes of fragments", {"volume over that of the body"}, {"fragments", true}, {}};
  const std::string bin = "cast(floor(" + std::to_string(size_bins / 8) + " * log10(p.volume / t.total)) AS INTEGER)";
  Statement rows =
      database.prepare("WITH t AS (SELECT job, sum(volume) AS total FROM piece GROUP BY job) SELECT " + bin +
                       ", count(*) FROM piece p JOIN t ON t.job = p.job WHERE p.volume > 0 GROUP BY 1");
  ChartSeries series{"all jobs", {}, true};
  while (rows.next())
    series.points.push_back({std::pow(10, (rows.number(0) + 0.5) / (size_bins / 8)), rows.number(1), ""});
  chart.series.push_back(std::move(series));
  return chart;
}

std::string stills(Database& database) {
  const double count = ask(database, "SELECT count(*) FROM file WHERE name = 'still.png'").number;
  if (count == 0) return "";
  std::string text = "<h2>Stills</h2>\n<div class=\"stills\">";
  const int stride = std::max(1, static_cast<int>(std::ceil(count / most_stills)));
  Statement rows = database.prepare(
      "SELECT number, id, fragments FROM (SELECT row_number() OVER (ORDER BY number) AS row, number, id, fragments "
      "FROM job "
      "WHERE EXISTS (SELECT 1 FROM file WHERE file.job = job.number AND name = 'still.png')) WHERE row % " +
      std::to_string(stride) + " = 0");
  while (rows.next()) {
    const std::string id = rows.text(1);
    text += "<figure><img loading=\"lazy\" src=\"jobs/" + id.substr(0, 2) + "/" + id +
            "/still.png\" alt=\"\"><figcaption>job " + rows.text(0) + ", " + rows.text(2) +
            " fragments</figcaption></figure>\n";
  }
  return text + "</div>\n";
}

constexpr const char* style =
    "<style>.stills{display:grid;grid-template-columns:repeat(auto-fill,minmax(180px,1fr));gap:.6rem}"
    "figure{margin:0}figcaption{font-size:12px}</style>\n";

}  // namespace

bool is_batch(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "manifest.sqlite", ignored);
}

void write_batch_page(const fs::path& folder) {
  Database database(folder / "manifest.sqlite", Database::Use::read);
  const std::string name = ask(database, "SELECT value FROM plan WHERE key = 'name'").text;
  const std::string note = "build " + ask(database, "SELECT value FROM plan WHERE key = 'build'").text + ", seed " +
                           ask(database, "SELECT value FROM plan WHERE key = 'seed'").text;
  std::string body = style + overview(database) + failures(database) + varied(database);
  body += "<h2>Sizes and energy</h2>\n<div class=\"grid\"><div>" + output::svg(sizes(database)) + "</div><div>" +
          output::svg(scatter(database, "Work of the impact over new crack area", "crack_area", "crack area [m^2]",
                              "work / nullif(crack_area, 0)", "work per crack area [J/m^2]", true)) +
          "</div></div>\n" + stills(database);
  output::write_atomically(folder / "index.html", output::plain_page("Batch " + name, note, body));
}

}  // namespace sunder::batch
