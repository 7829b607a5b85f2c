#pragma once
/// Partial crack faces as connected two-sided sheets.
#include <map>
#include <set>
#include <vector>

#include "crack/extract.h"

namespace sunder::crack::detail {

using Edge = std::pair<int, int>;  ///< the lower corner first

Edge edge_of(const std::vector<int>& loop, std::size_t i);

/// A partial face with its corners, some of which may have become one.
struct Panel {
  std::vector<int> loop;
  int region = 0;
};

/// Those that share no corner with a crack between regions.
std::vector<Panel> shown_panels(const Extraction& extraction);

/// Corners that an edge shorter than `length` joins become one: the sides of a panel thinner than the gap would cross.
std::vector<Panel> without_short_edges(std::vector<Panel> panels, const std::vector<Vec3>& vertices, double length);

/// Where more than two panels meet, only the two that go on most smoothly into each other stay: a branch ends short of
/// the crack that it comes from.
std::vector<Panel> without_branches(const std::vector<Panel>& panels, const std::vector<Vec3>& vertices);

std::vector<Panel> without(const std::vector<Panel>& panels, const std::set<int>& dropped);

using PanelsByEdge = std::map<Edge, std::vector<int>>;

PanelsByEdge panels_by_edge(const std::vector<Panel>& panels);

/// Panels that hang together across edges of two, each with the way that it has to be turned to fit its sheet.
struct Sheets {
  std::vector<int> sheet, turned;  ///< per panel
  int count = 0;
  std::set<int> one_sided;  ///< panels at which a sheet comes back to itself upside down
};

Sheets find_sheets(const std::vector<Panel>& panels, const PanelsByEdge& by_edge);

}  // namespace sunder::crack::detail
