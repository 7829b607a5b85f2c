#include "pipeline/detail/accuracy_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>

#include "output/atomic_file.h"
#include "output/chart.h"
#include "output/poster.h"
#include "pipeline/detail/measured_json.h"
#include "pipeline/detail/piece_mesh.h"
#include "validation/study.h"

namespace sunder::pipeline::detail {
namespace {

using Json = nlohmann::ordered_json;
using output::Chart;
using output::ChartSeries;
using output::escaped_xml;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string formatted(const char* format, auto... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

double relative_difference(double a, double b) { return b != 0 ? std::abs(a / b - 1) : nan; }

/// How two rungs differ in one respect; not a number where that cannot be said.
struct Quantity {
  std::string name, unit;
  std::function<double(const Rung&, const Rung&)> difference;
};

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all = {
      {"crack surface, mean distance", "of the body's diagonal",
       [](const Rung& a, const Rung& b) { return distance(a.trace, b.trace).crack_mean.value_or(nan); }},
      {"crack surface, Hausdorff distance", "of the body's diagonal",
       [](const Rung& a, const Rung& b) { return distance(a.trace, b.trace).crack_hausdorff.value_or(nan); }},
      {"damage field", "of the cells that either cracks",
       [](const Rung& a, const Rung& b) { return distance(a.trace, b.trace).damage; }},
      {"fragment volumes", "shift of a piece's size, of the body",
       [](const Rung& a, const Rung& b) { return distance(a.trace, b.trace).volumes; }},
      {"number of fragments", "relative",
       [](const Rung& a, const Rung& b) { return relative_difference(a.fragments, b.fragments); }},
      {"crack area", "relative",
       [](const Rung& a, const Rung& b) { return relative_difference(a.trace.crack_area, b.trace.crack_area); }},
      {"energy dissipated by damage", "relative",
       [](const Rung& a, const Rung& b) { return relative_difference(a.trace.dissipated, b.trace.dissipated); }},
      {"peak contact force", "relative",
       [](const Rung& a, const Rung& b) { return relative_difference(a.trace.peak_force, b.trace.peak_force); }},
      {"delivered impulse", "relative",
       [](const Rung& a, const Rung& b) { return relative_difference(a.trace.impulse, b.trace.impulse); }}};
  return all;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  int count = 0;
  for (const double v : values)
    if (std::isfinite(v)) sum += v, ++count;
  return count > 0 ? sum / count : nan;
}

/// By particles, the plain rungs of all seeds below the finest.
std::map<int, std::vector<const Rung*>> plain_below(const HitStudy& study) {
  std::map<int, std::vector<const Rung*>> by_particles;
  for (const Rung& r : study.rungs)
    if (r.variant == Variant::plain && r.particles < study.rungs[0].particles) by_particles[r.particles].push_back(&r);
  return by_particles;
}

/// Mean over seeds of the difference to the finest, per number of particles.
struct Convergence {
  std::vector<double> particles, difference;
  double order = nan;   ///< in the particle spacing
  double spread = nan;  ///< between seeds, at the finest number of particles with several
  bool converges() const {
    return difference.size() >= 3 && order > 0.3 && difference.back() < 0.7 * difference.front();
  }
};

Convergence convergence(const HitStudy& study, const Quantity& quantity) {
  Convergence c;
  std::vector<double> spacing;
  for (const auto& [particles, rungs] : plain_below(study)) {
    std::vector<double> differences, between;
    for (const Rung* r : rungs) differences.push_back(quantity.difference(*r, study.rungs[0]));
    for (std::size_t i = 0; i < rungs.size(); ++i)
      for (std::size_t j = i + 1; j < rungs.size(); ++j) between.push_back(quantity.difference(*rungs[i], *rungs[j]));
    if (!between.empty()) c.spread = mean(between);
    const double difference = mean(differences);
    if (!std::isfinite(difference)) continue;
    c.particles.push_back(particles);
    c.difference.push_back(difference);
    spacing.push_back(1 / std::cbrt(particles));
  }
  // What is only half as fine as the finest is near to it for that reason alone.
  if (spacing.size() > 3) spacing.pop_back();
  c.order =
      validation::power_of(spacing, {c.difference.begin(), c.difference.begin() + static_cast<long>(spacing.size())});
  return c;
}

std::string finding(const Quantity& q, const Convergence& c) {
  if (c.difference.empty()) return q.name + ": nothing to compare";
  const double at = c.particles.back(), last = c.difference.back();
  std::string text = q.name + ": " + formatted("%.3g at %.0f particles", last, at) + " (" + q.unit + ")";
  if (std::isfinite(c.spread)) text += formatted(", %.3g between seeds", c.spread);
  if (c.converges()) return text + formatted("; converges, order %.1f in the spacing", c.order);
  return text + (std::isfinite(c.spread) && last < 1.5 * c.spread
                     ? "; no closer to the finest than another seed is: does not converge in this range"
                     : "; does not converge in this range");
}

const char* words(Variant v) {
  switch (v) {
    case Variant::plain:
      return "quadratic splines, one velocity field";
    case Variant::cubic:
      return "cubic splines";
    case Variant::two_fields:
      return "two velocity fields";
  }
  return "";
}

/// Not beaten in both time and crack distance by any other.
std::vector<const Rung*> pareto_front(const HitStudy& study) {
  std::vector<const Rung*> candidates, front;
  for (const Rung& r : study.rungs)
    if (r.to_finest.crack_mean && r.seed == 1 && &r != &study.rungs[0]) candidates.push_back(&r);
  std::sort(candidates.begin(), candidates.end(),
            [](const Rung* a, const Rung* b) { return a->processor_seconds < b->processor_seconds; });
  double best = std::numeric_limits<double>::infinity();
  for (const Rung* r : candidates)
    if (*r->to_finest.crack_mean < best) {
      best = *r->to_finest.crack_mean;
      front.push_back(r);
    }
  return front;
}

Json distance_json(const TraceDistance& d) {
  const auto optional = [](const std::optional<double>& x) { return x ? number_json(*x) : Json(nullptr); };
  return {{"damage", d.damage},
          {"crack_mean", optional(d.crack_mean)},
          {"crack_hausdorff", optional(d.crack_hausdorff)},
          {"volumes", d.volumes}};
}

Json rung_json(const Rung& r, const std::vector<const Rung*>& front) {
  return {{"particles", r.particles},
          {"variant", name_of(r.variant)},
          {"seed", r.seed},
          {"processor_seconds", r.processor_seconds},
          {"peak_memory_mb", r.memory_mb},
          {"steps", r.steps},
          {"fragments", r.fragments},
          {"effective_count", r.effective_count},
          {"damaged_share", r.damaged_share},
          {"crack_area", r.trace.crack_area},
          {"dissipated", r.trace.dissipated},
          {"peak_force", r.trace.peak_force},
          {"impulse", r.trace.impulse},
          {"to_finest", distance_json(r.to_finest)},
          {"pareto", std::find(front.begin(), front.end(), &r) != front.end()}};
}

Json study_json(const HitStudy& study) {
  Json rungs = Json::array(), converging = Json::array();
  const auto front = pareto_front(study);
  for (const Rung& r : study.rungs) rungs.push_back(rung_json(r, front));
  for (const Quantity& q : quantities()) {
    const Convergence c = convergence(study, q);
    converging.push_back({{"quantity", q.name},
                          {"unit", q.unit},
                          {"particles", c.particles},
                          {"difference", c.difference},
                          {"between_seeds", number_json(c.spread)},
                          {"order", number_json(c.order)},
                          {"converges", c.converges()}});
  }
  return {{"body", study.body}, {"time", study.time},        {"severity", study.severity},
          {"rungs", rungs},     {"convergence", converging}, {"findings", findings(study)}};
}

Chart front_chart(const HitStudy& study) {
  Chart chart{"How long for how good", {"processor time [s]"}, {"mean distance of the cracks [diagonal]"}, {}};
  for (const Variant v : {Variant::plain, Variant::cubic, Variant::two_fields}) {
    ChartSeries series{words(v), {}, false};
    for (const Rung& r : study.rungs)
      if (r.variant == v && r.to_finest.crack_mean && &r != &study.rungs[0])
        series.points.push_back({r.processor_seconds, *r.to_finest.crack_mean,
                                 formatted("%d particles, seed %d: %d pieces, %.3g s", r.particles, r.seed, r.fragments,
                                           r.processor_seconds)});
    if (!series.points.empty()) chart.series.push_back(std::move(series));
  }
  ChartSeries front{"nothing is better in less time", {}, true};
  for (const Rung* r : pareto_front(study)) front.points.push_back({r->processor_seconds, *r->to_finest.crack_mean});
  chart.series.push_back(std::move(front));
  return chart;
}

Chart quantity_chart(const HitStudy& study, const std::vector<std::size_t>& which, const std::string& title) {
  Chart chart{title, {"particles"}, {"difference to the finest"}, {}};
  for (const std::size_t n : which) {
    const Quantity& q = quantities()[n];
    const Convergence c = convergence(study, q);
    ChartSeries series{q.name + " [" + q.unit + "]", {}};
    for (std::size_t i = 0; i < c.particles.size(); ++i) series.points.push_back({c.particles[i], c.difference[i]});
    chart.series.push_back(std::move(series));
  }
  return chart;
}

std::string picture_name(std::size_t study, int particles) {
  return formatted("crack_%zu_%d.png", study + 1, particles);
}

std::string table(const HitStudy& study) {
  std::string text =
      "<div class=\"scroll\"><table><tr><th class=\"n\">particles</th><th>variant</th><th class=\"n\">seed</th><th "
      "class=\"n\">processor s</th><th class=\"n\">MB</th><th class=\"n\">pieces</th><th class=\"n\">damage</th><th "
      "class=\"n\">crack mean</th><th class=\"n\">Hausdorff</th><th class=\"n\">volumes</th></tr>\n";
  const auto cell = [](double x, const char* format) {
    return "<td class=\"n\">" + (std::isfinite(x) ? formatted(format, x) : std::string("-")) + "</td>";
  };
  for (const Rung& r : study.rungs)
    text += "<tr>" + cell(r.particles, "%.0f") + "<td>" + words(r.variant) + "</td>" + cell(r.seed, "%.0f") +
            cell(r.processor_seconds, "%.2f") + cell(r.memory_mb, "%.0f") + cell(r.fragments, "%.0f") +
            cell(r.to_finest.damage, "%.3f") + cell(r.to_finest.crack_mean.value_or(nan), "%.4f") +
            cell(r.to_finest.crack_hausdorff.value_or(nan), "%.4f") + cell(r.to_finest.volumes, "%.4f") + "</tr>\n";
  return text + "</table></div>\n";
}

std::string study_section(const HitStudy& study, std::size_t number) {
  std::string text = "<section><h2>" + escaped_xml(study.body) + formatted(", hit at %.4f s</h2>\n", study.time);
  text += "<div class=\"grid\"><div>" + svg(front_chart(study)) + "</div><div><h3>What to rely on</h3><ul>";
  for (const std::string& sentence : findings(study)) text += "<li>" + escaped_xml(sentence) + "</li>\n";
  text += "</ul></div><div>" + svg(quantity_chart(study, {0, 1, 2, 3}, "Where it breaks")) + "</div><div>" +
          svg(quantity_chart(study, {4, 5, 6, 7, 8}, "How much it breaks")) + "</div></div>\n" + table(study);
  text += "<h3>Cracks (red) over those of the finest (blue)</h3><div class=\"grid\">\n";
  for (const auto& [particles, rungs] : plain_below(study))
    if (!rungs[0]->trace.crack.faces.empty())
      text += formatted("<figure><img src=\"%s\" alt=\"cracks\"><figcaption>%d particles</figcaption></figure>\n",
                        picture_name(number, particles).c_str(), particles);
  return text + "</div></section>\n";
}

output::Piece coloured(const std::string& name, const geometry::TriangleMesh& mesh, const geometry::Colour& colour) {
  geometry::SurfaceAttributes surface;
  surface.colour.assign(mesh.faces.size(), {colour, colour, colour});
  output::Piece piece = whole_piece(name, "crack", mesh, std::move(surface));
  measured(piece, 1);
  return piece;
}

std::string overlay(const Rung& rung, const Rung& finest) {
  output::Sequence sequence;
  sequence.frames.resize(1);
  sequence.pieces = {coloured("finest", finest.trace.crack, {0.1, 0.3, 0.9, 1}),
                     coloured("rung", rung.trace.crack, {0.85, 0.15, 0.1, 1})};
  sequence.pieces[1].id = 1;
  sequence.frames[0].poses = {{0, {}, {}}, {1, {}, {}}};
  output::PosterSettings settings;
  settings.width = 640;
  settings.height = 480;
  return output::poster_png(sequence, 0, {}, settings);
}

}  // namespace

const char* name_of(Variant variant) {
  switch (variant) {
    case Variant::plain:
      return "quadratic";
    case Variant::cubic:
      return "cubic";
    case Variant::two_fields:
      return "two_fields";
  }
  return "";
}

std::vector<std::string> findings(const HitStudy& study) {
  std::vector<std::string> sentences;
  for (const Quantity& q : quantities()) sentences.push_back(finding(q, convergence(study, q)));
  return sentences;
}

Json accuracy_json(const std::string& scene, const std::vector<HitStudy>& studies) {
  Json hits = Json::array();
  for (const HitStudy& s : studies) hits.push_back(study_json(s));
  return {{"machine", machine_json()}, {"scene", scene}, {"hits", hits}};
}

void write_accuracy(const std::string& scene, const std::vector<HitStudy>& studies,
                    const std::filesystem::path& folder) {
  std::string body;
  for (std::size_t n = 0; n < studies.size(); ++n) {
    body += study_section(studies[n], n);
    const Rung& finest = studies[n].rungs[0];
    for (const auto& [particles, rungs] : plain_below(studies[n]))
      if (!rungs[0]->trace.crack.faces.empty() && !finest.trace.crack.faces.empty())
        output::write_atomically(folder / picture_name(n, particles), overlay(*rungs[0], finest));
  }
  output::write_atomically(folder / "accuracy.html", measured_page("What accuracy costs in " + scene, body));
  output::write_atomically(folder / "accuracy.json", accuracy_json(scene, studies).dump(2) + "\n");
}

}  // namespace sunder::pipeline::detail
