#pragma once
/// Line charts as SVG, for pages and documents that need no script.
#include <string>
#include <vector>

namespace sunder::output {

struct ChartPoint {
  double x = 0, y = 0;
  std::string label = {};  ///< shown when one points at it; empty: its numbers
};

struct ChartSeries {
  std::string name;
  std::vector<ChartPoint> points;
  bool joined = true;  ///< by a line, in this order
};

struct ChartAxis {
  std::string name;  ///< with its unit
  bool logarithmic = true;
};

struct Chart {
  std::string title;
  ChartAxis x, y;
  std::vector<ChartSeries> series;
  int width = 560, height = 360;  ///< [px]
};

/// An svg element, readable on light and dark ground. Points whose coordinates are not finite, or not positive on a
/// logarithmic axis, are left out; a chart without points says so. Series beyond the eight colours begin anew.
std::string svg(const Chart& chart);

/// Text that can stand in XML.
std::string escaped_xml(const std::string& text);

}  // namespace sunder::output
