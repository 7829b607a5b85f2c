#include "output/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace sunder::output {
namespace {

/// Told apart by people with any colour vision (Okabe and Ito).
constexpr std::array colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#8c6d31"};

constexpr int left = 64, right = 16, top = 34, bottom = 46, legend_line = 15;

std::string number(double x) {
  char text[32];
  if (std::abs(x) >= 1e6 && std::abs(x) < 1e9)
    std::snprintf(text, sizeof text, "%.4g M", 1e-6 * x);
  else if (std::abs(x) >= 1e4 && std::abs(x) < 1e6)
    std::snprintf(text, sizeof text, "%.4g k", 1e-3 * x);
  else
    std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

/// Maps one axis to pixels, and knows where its ticks are.
class Scale {
 public:
  Scale(const ChartAxis& axis, double least, double most, double from, double to)
      : logarithmic_(axis.logarithmic), from_(from), to_(to) {
    low_ = logarithmic_ ? std::log10(least) : least;
    high_ = logarithmic_ ? std::log10(most) : most;
    const double margin = high_ > low_ ? 0.06 * (high_ - low_) : std::max(0.3, 0.1 * std::abs(low_));
    low_ -= margin;
    high_ += margin;
    if (!logarithmic_ && least >= 0 && low_ < 0) low_ = 0;
  }

  double pixel(double value) const {
    return from_ + ((logarithmic_ ? std::log10(value) : value) - low_) / (high_ - low_) * (to_ - from_);
  }

  std::vector<double> ticks() const {
    if (!logarithmic_) return steps_of(low_, high_);
    // Fewer than two decades need marks in between.
    const std::vector<double> within = high_ - low_ > 2.5 ? std::vector<double>{1} : std::vector<double>{1, 2, 5};
    std::vector<double> list;
    for (double decade = std::floor(low_); decade <= high_; ++decade)
      for (const double digit : within)
        if (const double at = decade + std::log10(digit); at >= low_ && at <= high_)
          list.push_back(digit * std::pow(10, decade));
    return list.size() > 2 ? list : steps_of(std::pow(10, low_), std::pow(10, high_));
  }

 private:
  static double step_of(double range) {
    const double raw = range / 7, power = std::pow(10, std::floor(std::log10(raw)));
    for (const double digit : {1.0, 2.0, 5.0})
      if (digit * power >= raw) return digit * power;
    return 10 * power;
  }
  static std::vector<double> steps_of(double least, double most) {
    const double step = step_of(most - least);
    std::vector<double> list;
    for (double n = std::ceil(least / step); n * step <= most; ++n) list.push_back(n * step);
    return list;
  }

  bool logarithmic_;
  double from_, to_, low_ = 0, high_ = 1;
};

bool shown(const Chart& chart, const ChartPoint& p) {
  const auto on = [](const ChartAxis& axis, double v) { return std::isfinite(v) && (!axis.logarithmic || v > 0); };
  return on(chart.x, p.x) && on(chart.y, p.y);
}

void add(std::string& out, const char* format, auto... values) {
  char text[512];
  std::snprintf(text, sizeof text, format, values...);
  out += text;
}

void add_text(std::string& out, double x, double y, const char* anchor, const std::string& text) {
  add(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor);
  out.append(escaped_xml(text)).append("</text>\n");
}

void add_axes(std::string& out, const Chart& chart, const Scale& x, const Scale& y, double plot_bottom) {
  const double plot_right = chart.width - right;
  for (const double tick : x.ticks()) {
    const double at = x.pixel(tick);
    add(out, "<path d=\"M%.1f %d V%.1f\" class=\"rule\"/>\n", at, top, plot_bottom);
    add_text(out, at, plot_bottom + 15, "middle", number(tick));
  }
  for (const double tick : y.ticks()) {
    const double at = y.pixel(tick);
    add(out, "<path d=\"M%d %.1f H%.1f\" class=\"rule\"/>\n", left, at, plot_right);
    add_text(out, left - 6, at + 4, "end", number(tick));
  }
  add(out, "<path d=\"M%d %d V%.1f H%.1f\" class=\"axis\"/>\n", left, top, plot_bottom, plot_right);
  add_text(out, 0.5 * (left + plot_right), plot_bottom + 33, "middle", chart.x.name);
  add(out, "<text transform=\"translate(14 %.1f) rotate(-90)\" text-anchor=\"middle\">", 0.5 * (top + plot_bottom));
  out.append(escaped_xml(chart.y.name)).append("</text>\n");
}

void add_series(std::string& out, const Chart& chart, const ChartSeries& series, const char* colour, const Scale& x,
                const Scale& y) {
  std::string line, dots;
  for (const ChartPoint& p : series.points) {
    if (!shown(chart, p)) continue;
    add(line, "%s%.1f %.1f", line.empty() ? "M" : " L", x.pixel(p.x), y.pixel(p.y));
    add(dots, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\" fill=\"%s\"><title>", x.pixel(p.x), y.pixel(p.y), colour);
    dots.append(escaped_xml(series.name)).append(": ");
    dots.append(escaped_xml(p.label.empty() ? number(p.x) + ", " + number(p.y) : p.label))
        .append("</title></circle>\n");
  }
  if (series.joined && !line.empty())
    out.append("<path d=\"")
        .append(line)
        .append("\" fill=\"none\" stroke-width=\"1.8\" stroke=\"")
        .append(colour)
        .append("\"/>\n");
  out += dots;
}

}  // namespace

std::string escaped_xml(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string svg(const Chart& chart) {
  constexpr double huge = std::numeric_limits<double>::infinity();
  double x_least = huge, x_most = -huge, y_least = huge, y_most = -huge;
  for (const ChartSeries& series : chart.series)
    for (const ChartPoint& p : series.points)
      if (shown(chart, p)) {
        x_least = std::min(x_least, p.x), x_most = std::max(x_most, p.x);
        y_least = std::min(y_least, p.y), y_most = std::max(y_most, p.y);
      }
  const int legend = chart.series.size() > 1 ? legend_line * static_cast<int>(chart.series.size()) : 0;
  std::string out;
  add(out, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" role=\"img\">\n", chart.width,
      chart.height + legend, chart.width);
  out +=
      "<style>text{font:12px sans-serif;fill:#777}.title{font-weight:bold;font-size:13px}"
      ".rule{stroke:#999;stroke-opacity:.3}.axis{stroke:#777;fill:none}</style>\n";
  add(out, "<text class=\"title\" x=\"%d\" y=\"18\">", left);
  out.append(escaped_xml(chart.title)).append("</text>\n");
  const double plot_bottom = chart.height - bottom;
  if (x_least > x_most) {
    add_text(out, 0.5 * chart.width, 0.5 * chart.height, "middle", "nothing to show");
    return out + "</svg>\n";
  }
  const Scale x(chart.x, x_least, x_most, left, chart.width - right), y(chart.y, y_least, y_most, plot_bottom, top);
  add_axes(out, chart, x, y, plot_bottom);
  for (std::size_t n = 0; n < chart.series.size(); ++n) {
    const char* colour = colours[n % colours.size()];
    add_series(out, chart, chart.series[n], colour, x, y);
    if (legend == 0) continue;
    const double at = chart.height + legend_line * static_cast<double>(n) + 4;
    add(out, "<path d=\"M%d %.1f h18\" stroke-width=\"3\" stroke=\"%s\"/>\n", left, at, colour);
    add_text(out, left + 24, at + 4, "start", chart.series[n].name);
  }
  return out + "</svg>\n";
}

}  // namespace sunder::output
