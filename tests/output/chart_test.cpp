#include "output/chart.h"

#include <limits>

#include <gtest/gtest.h>

namespace sunder::output {
namespace {

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(Chart, ShowsEveryPointThatCanBeShown) {
  Chart chart{"title", {"time [s]"}, {"error [1]"}, {{"a", {{1, 0.1}, {10, 0.01}, {100, 0}}}}};
  EXPECT_EQ(count(svg(chart), "<circle"), 2u) << "0 has no place on a logarithmic axis";
  chart.y.logarithmic = false;
  EXPECT_EQ(count(svg(chart), "<circle"), 3u);
  chart.series[0].points.push_back({std::numeric_limits<double>::quiet_NaN(), 1});
  EXPECT_EQ(count(svg(chart), "<circle"), 3u);
}

TEST(Chart, EveryAxisHasMarks) {
  // 0.031 to 0.042 holds no 1, 2 or 5.
  const std::string text = svg({"title", {"time [s]"}, {"error [1]"}, {{"a", {{1, 0.031}, {300, 0.042}}}}});
  EXPECT_GE(count(text, "text-anchor=\"end\""), 3u) << text;
}

TEST(Chart, NothingToShow) {
  const Chart chart{"title", {"x"}, {"y"}, {{"a", {}}}};
  EXPECT_NE(svg(chart).find("nothing to show"), std::string::npos);
}

TEST(Chart, OnePointAndTextThatNeedsEscapes) {
  const std::string text = svg({"a < b & c", {"x"}, {"y"}, {{"\"s\"", {{1, 1}}}}});
  EXPECT_NE(text.find("a &lt; b &amp; c"), std::string::npos);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(count(text, "<circle"), 1u);
}

TEST(Chart, LegendNamesSeriesWhenThereAreSeveral) {
  const Chart chart{"t", {"x"}, {"y"}, {{"first", {{1, 1}, {2, 2}}}, {"second", {{1, 2}, {2, 1}}, false}}};
  const std::string text = svg(chart);
  EXPECT_NE(text.find(">first</text>"), std::string::npos);
  EXPECT_EQ(count(text, "stroke-width=\"1.8\""), 1u) << "only one of them is joined";
}

}  // namespace
}  // namespace sunder::output
