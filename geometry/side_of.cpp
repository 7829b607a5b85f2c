#include "geometry/side_of.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "geometry/detail/inside.h"

namespace sunder::geometry {

std::vector<Side> side_of(const TriangleMesh& solid, const std::vector<Vec3>& points) {
  std::vector<Side> result(points.size());
  const detail::InsideTest inside(solid);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      result[i] = inside.on_surface(points[i]) ? Side::on : inside(points[i]) ? Side::inside : Side::outside;
    }
  });
  return result;
}

}  // namespace sunder::geometry
