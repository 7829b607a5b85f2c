#include "geometry/detail/inside.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/detail/cgal_mesh.h"

namespace sunder::geometry::detail {
namespace {

constexpr double kFacesPerBin = 2;
constexpr double kMostBins = 4096;
constexpr double kFlat = kMostBins * std::numeric_limits<double>::min();  // thinner, and a bin's inverse is infinite

using Point2 = Kernel::Point_2;

// Whether the ray from q along +X crosses the edge. An edge owns its lower end; a point on the edge counts as right of
// it: both rules depend on the edge alone, so two faces that share it agree.
bool crosses(const Vec3& a, const Vec3& b, const Vec3& q) {
  if ((a.y() > q.y()) == (b.y() > q.y())) return false;
  const Vec3 &low = a.y() < b.y() ? a : b, &high = a.y() < b.y() ? b : a;
  return CGAL::orientation(Point2(low.x(), low.y()), Point2(high.x(), high.y()), Point2(q.x(), q.y())) ==
         CGAL::LEFT_TURN;
}

enum class Side { below, on, above };

// Where the face lies relative to the point, on the point's vertical line, which pierces the face.
Side side_of_face(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  if (std::min({a.z(), b.z(), c.z()}) > p.z()) return Side::above;
  if (std::max({a.z(), b.z(), c.z()}) < p.z()) return Side::below;
  const auto spatial = CGAL::orientation(to_point(a), to_point(b), to_point(c), to_point(p));
  if (spatial == CGAL::COPLANAR) return Side::on;
  const auto planar = CGAL::orientation(Point2(a.x(), a.y()), Point2(b.x(), b.y()), Point2(c.x(), c.y()));
  // A face that turns left seen from above has the point on its positive side when the point is above it.
  return (spatial == CGAL::POSITIVE) == (planar == CGAL::LEFT_TURN) ? Side::below : Side::above;
}

}  // namespace

InsideTest::InsideTest(const TriangleMesh& mesh) : mesh_(mesh), box_(bounds(mesh)) {
  const Vec3 size = box_.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box_.diagonal());
  const double width = std::sqrt(size.x() * size.y() * kFacesPerBin / std::max<double>(1, mesh.faces.size()));
  for (int axis = 0; axis < 2; ++axis) {
    bins_[axis] = width > 0 ? static_cast<int>(std::clamp(size[axis] / width, 1.0, kMostBins)) : 1;
    per_length_[axis] = size[axis] > kFlat ? bins_[axis] / size[axis] : 0;
  }
  const auto for_each_bin = [&](int face, const auto& visit) {
    Box shadow;
    for (const int vertex : mesh.faces[face]) shadow.extend(mesh.vertices[vertex]);
    for (int y = bin(1, shadow.min().y()); y <= bin(1, shadow.max().y()); ++y) {
      for (int x = bin(0, shadow.min().x()); x <= bin(0, shadow.max().x()); ++x) visit(y * bins_[0] + x);
    }
  };
  const int count = static_cast<int>(mesh.faces.size());
  first_.assign(bins_[0] * bins_[1] + 1, 0);
  for (int face = 0; face < count; ++face) for_each_bin(face, [&](int at) { ++first_[at + 1]; });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  faces_.resize(first_.back());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int face = 0; face < count; ++face) for_each_bin(face, [&](int at) { faces_[next[at]++] = face; });
}

int InsideTest::bin(int axis, double x) const {
  return static_cast<int>(std::clamp((x - box_.min()[axis]) * per_length_[axis], 0.0, bins_[axis] - 1.0));
}

bool InsideTest::operator()(const Vec3& point) const {
  if (!box_.contains(point)) return false;
  const int at = bin(1, point.y()) * bins_[0] + bin(0, point.x());
  bool inside = false;
  for (int i = first_[at]; i < first_[at + 1]; ++i) {
    const auto& face = mesh_.faces[faces_[i]];
    const Vec3 &a = mesh_.vertices[face[0]], &b = mesh_.vertices[face[1]], &c = mesh_.vertices[face[2]];
    if (!(crosses(a, b, point) ^ crosses(b, c, point) ^ crosses(c, a, point))) continue;
    const Side side = side_of_face(a, b, c, point);
    if (side == Side::on) return false;
    inside ^= side == Side::above;
  }
  return inside;
}

bool InsideTest::on_surface(const Vec3& point) const {
  if (!box_.contains(point)) return false;
  const int at = bin(1, point.y()) * bins_[0] + bin(0, point.x());
  for (int i = first_[at]; i < first_[at + 1]; ++i) {
    const auto& [a, b, c] = mesh_.faces[faces_[i]];
    Box box(mesh_.vertices[a], mesh_.vertices[a]);
    box.extend(mesh_.vertices[b]).extend(mesh_.vertices[c]);
    if (!box.contains(point)) continue;
    const Kernel::Triangle_3 face(to_point(mesh_.vertices[a]), to_point(mesh_.vertices[b]),
                                  to_point(mesh_.vertices[c]));
    if (!face.is_degenerate() && face.has_on(to_point(point))) return true;
  }
  return false;
}

}  // namespace sunder::geometry::detail
