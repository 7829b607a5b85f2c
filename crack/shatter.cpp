#include "crack/shatter.h"

#include <cmath>
#include <string>

#include "crack/detail/medial.h"

namespace sunder::crack {

namespace {

constexpr double margin = 0.1, jitter = 1e-6, shortest_edge = 1e-10;  // of the domain's diagonal

}  // namespace

geometry::RegionBoundary voronoi_cells(const std::vector<Vec3>& sites, const Box& domain, std::uint64_t seed,
                                       Progress& progress) {
  if (sites.empty()) return {};
  const double diagonal = domain.diagonal().norm();
  std::vector<detail::Site> cells;
  for (const Vec3& x : sites) {
    const int number = static_cast<int>(cells.size());
    cells.push_back({x, number, number, number, false});
  }
  detail::CellRequest request;
  request.box = {domain.min() - Vec3::Constant(margin * diagonal), domain.max() + Vec3::Constant(margin * diagonal)};
  request.unit = std::cbrt(domain.volume() / static_cast<double>(sites.size()));
  if (!(request.unit > 0)) request.unit = diagonal / std::cbrt(static_cast<double>(sites.size()));
  request.shortest_edge = shortest_edge * diagonal;
  request.inner_distance = std::numeric_limits<double>::infinity();
  return detail::medial_faces(cells, {request, static_cast<int>(sites.size()), jitter * diagonal, seed}, progress)
      .boundary;
}

}  // namespace sunder::crack
