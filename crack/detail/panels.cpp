#include "crack/detail/panels.h"

#include <algorithm>
#include <cmath>

namespace sunder::crack::detail {

Edge edge_of(const std::vector<int>& loop, std::size_t i) { return std::minmax(loop[i], loop[(i + 1) % loop.size()]); }

std::vector<Panel> shown_panels(const Extraction& extraction) {
  std::set<int> separating;
  for (const geometry::RegionBoundary::Face& face : extraction.boundary.faces)
    if (face.outside >= 0) separating.insert(face.loop.begin(), face.loop.end());
  std::vector<Panel> shown;
  for (const CrackFace& face : extraction.faces) {
    if (face.kind != FaceKind::partial) continue;
    if (std::none_of(face.loop.begin(), face.loop.end(), [&](int v) { return separating.contains(v); }))
      shown.push_back({face.loop, face.region_a});
  }
  return shown;
}

std::vector<Panel> without_short_edges(std::vector<Panel> panels, const std::vector<Vec3>& vertices, double length) {
  std::map<int, int> parent;
  const auto find = [&](int v) {
    while (parent.contains(v) && parent[v] != v) v = parent[v];
    return v;
  };
  for (const Panel& panel : panels)
    for (std::size_t i = 0; i < panel.loop.size(); ++i) {
      const auto [a, b] = edge_of(panel.loop, i);
      if ((vertices[static_cast<std::size_t>(a)] - vertices[static_cast<std::size_t>(b)]).norm() >= length) continue;
      const int first = find(a), second = find(b);
      parent[std::max(first, second)] = std::min(first, second);
    }
  for (Panel& panel : panels) {
    for (int& v : panel.loop) v = find(v);
    panel.loop.erase(std::unique(panel.loop.begin(), panel.loop.end()), panel.loop.end());
    while (panel.loop.size() > 1 && panel.loop.front() == panel.loop.back()) panel.loop.pop_back();
  }
  const auto repeats = [](const Panel& panel) {
    return std::set<int>(panel.loop.begin(), panel.loop.end()).size() < std::max<std::size_t>(panel.loop.size(), 3);
  };
  std::erase_if(panels, repeats);
  // Two panels between the same corners would part from each other at the same points.
  std::set<std::set<int>> seen;
  std::erase_if(panels, [&](const Panel& panel) {
    return !seen.insert(std::set<int>(panel.loop.begin(), panel.loop.end())).second;
  });
  return panels;
}

static Vec3 middle_of(const Panel& panel, const std::vector<Vec3>& vertices) {
  Vec3 sum = Vec3::Zero();
  for (const int v : panel.loop) sum += vertices[static_cast<std::size_t>(v)];
  return sum / static_cast<double>(panel.loop.size());
}

PanelsByEdge panels_by_edge(const std::vector<Panel>& panels) {
  PanelsByEdge result;
  for (std::size_t f = 0; f < panels.size(); ++f)
    for (std::size_t i = 0; i < panels[f].loop.size(); ++i)
      result[edge_of(panels[f].loop, i)].push_back(static_cast<int>(f));
  return result;
}

std::vector<Panel> without(const std::vector<Panel>& panels, const std::set<int>& dropped) {
  std::vector<Panel> kept;
  for (std::size_t f = 0; f < panels.size(); ++f)
    if (!dropped.contains(static_cast<int>(f))) kept.push_back(panels[f]);
  return kept;
}

std::vector<Panel> without_branches(const std::vector<Panel>& panels, const std::vector<Vec3>& vertices) {
  std::set<int> dropped;
  for (const auto& [edge, faces] : panels_by_edge(panels)) {
    if (faces.size() < 3) continue;
    const Vec3& a = vertices[static_cast<std::size_t>(edge.first)];
    const Vec3 along = (vertices[static_cast<std::size_t>(edge.second)] - a).normalized();
    const auto away = [&](int face) {
      const Vec3 r = middle_of(panels[static_cast<std::size_t>(face)], vertices) - a;
      return (r - along.dot(r) * along).normalized();
    };
    std::pair<int, int> smoothest;
    double least = std::numeric_limits<double>::infinity();
    for (const int p : faces)
      for (const int q : faces)
        if (const double cosine = away(p).dot(away(q)); p < q && cosine < least) {
          least = cosine;
          smoothest = {p, q};
        }
    for (const int face : faces)
      if (face != smoothest.first && face != smoothest.second) dropped.insert(face);
  }
  return without(panels, dropped);
}

static bool runs(const std::vector<int>& loop, int from, int to) {
  for (std::size_t i = 0; i < loop.size(); ++i)
    if (loop[i] == from && loop[(i + 1) % loop.size()] == to) return true;
  return false;
}

Sheets find_sheets(const std::vector<Panel>& panels, const PanelsByEdge& by_edge) {
  Sheets result{std::vector<int>(panels.size(), -1), std::vector<int>(panels.size(), 0), 0, {}};
  for (std::size_t first = 0; first < panels.size(); ++first) {
    if (result.sheet[first] >= 0) continue;
    std::vector<int> queue = {static_cast<int>(first)};
    result.sheet[first] = result.count;
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const std::size_t face = static_cast<std::size_t>(queue[next]);
      const std::vector<int>& loop = panels[face].loop;
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::vector<int>& beside = by_edge.at(edge_of(loop, i));
        if (beside.size() != 2) continue;
        const std::size_t other = static_cast<std::size_t>(beside[0] == queue[next] ? beside[1] : beside[0]);
        const bool same_way = runs(panels[other].loop, loop[i], loop[(i + 1) % loop.size()]);
        const int turned = result.turned[face] != static_cast<int>(same_way);
        if (result.sheet[other] >= 0) {
          if (result.turned[other] != turned) result.one_sided.insert(static_cast<int>(other));
          continue;
        }
        result.sheet[other] = result.count;
        result.turned[other] = turned;
        queue.push_back(static_cast<int>(other));
      }
    }
    ++result.count;
  }
  return result;
}

}  // namespace sunder::crack::detail
