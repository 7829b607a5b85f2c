#include "geometry/detail/halving.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

namespace sunder::geometry::detail {
namespace {

// Three planes that meet at an angle flatter than this have no corner worth keeping.
constexpr double kFlat = 1e-9;

// A vertex closer to the plane than this share of the farthest one's distance lies in it.
constexpr double kInPlane = 1e-12;

struct Corner {
  int vertex;
  double distance;
};

// A triangle clipped once has at most four corners.
struct Polygon {
  std::array<Corner, 4> corners;
  int count = 0;

  void add(const Corner& corner) { corners[count++] = corner; }
};

class Cutter {
 public:
  Cutter(const CellPart& part, const Plane& plane) : vertices_(part.vertices), normal_(plane.normal) {
    distance_.reserve(vertices_.size());
    double farthest = 0;
    for (const Vec3& x : vertices_) {
      distance_.push_back(plane.distance(x));
      farthest = std::max(farthest, std::abs(distance_.back()));
    }
    for (double& d : distance_) {
      if (std::abs(d) < kInPlane * farthest) d = 0;
    }
  }

  void cut(const std::vector<Triangle>& faces, std::vector<Triangle>& below, std::vector<Triangle>& above) {
    for (const Triangle& face : faces) {
      Polygon lower, upper;
      split(face, lower, upper);
      const bool is_below = reaches(lower, -1), is_above = reaches(upper, 1);
      // A face in the plane goes where the solid is that it bounds.
      const bool closes_below = !is_below && !is_above && looks_up(face);
      if (is_below || closes_below) emit(lower, below), add_rim(lower);
      if (is_above || !(is_below || closes_below)) emit(upper, above);
    }
  }

  void add_caps(std::vector<Triangle>& below, std::vector<Triangle>& above) const {
    for (const auto& [from, to] : rim_) {
      const int apex = rim_.front()[0];
      if (from == apex || to == apex) continue;
      below.push_back({apex, to, from});
      above.push_back({apex, from, to});
    }
  }

  const std::vector<Vec3>& vertices() const { return vertices_; }

 private:
  static bool reaches(const Polygon& polygon, int sign) {
    return std::any_of(polygon.corners.begin(), polygon.corners.begin() + polygon.count,
                       [&](const Corner& corner) { return sign * corner.distance > 0; });
  }

  bool looks_up(const Triangle& face) const {
    const Vec3& a = vertices_[face[0]];
    return (vertices_[face[1]] - a).cross(vertices_[face[2]] - a).dot(normal_) > 0;
  }

  void split(const Triangle& face, Polygon& lower, Polygon& upper) {
    for (int k = 0; k < 3; ++k) {
      const Corner a{face[k], distance_[face[k]]}, b{face[(k + 1) % 3], distance_[face[(k + 1) % 3]]};
      if (a.distance <= 0) lower.add(a);
      if (a.distance >= 0) upper.add(a);
      if (a.distance * b.distance >= 0) continue;
      const Corner crossing{crossing_vertex(a, b), 0};
      lower.add(crossing);
      upper.add(crossing);
    }
  }

  // The same point whichever way the edge runs.
  int crossing_vertex(const Corner& a, const Corner& b) {
    const Corner &low = a.distance < b.distance ? a : b, &high = a.distance < b.distance ? b : a;
    const Vec3 x = vertices_[low.vertex], y = vertices_[high.vertex];
    vertices_.push_back(x + (y - x) * (low.distance / (low.distance - high.distance)));
    return static_cast<int>(vertices_.size()) - 1;
  }

  static void emit(const Polygon& polygon, std::vector<Triangle>& faces) {
    for (int k = 2; k < polygon.count; ++k) {
      faces.push_back({polygon.corners[0].vertex, polygon.corners[k - 1].vertex, polygon.corners[k].vertex});
    }
  }

  // Edges in the plane bound the lower part; those that two lower faces share cancel.
  void add_rim(const Polygon& polygon) {
    for (int k = 0; k < polygon.count; ++k) {
      const Corner &a = polygon.corners[k], &b = polygon.corners[(k + 1) % polygon.count];
      if (a.distance == 0 && b.distance == 0) rim_.push_back({a.vertex, b.vertex});
    }
  }

  std::vector<Vec3> vertices_;
  Vec3 normal_;
  std::vector<double> distance_;
  std::vector<std::array<int, 2>> rim_;
};

void drop_unused_vertices(CellPart& part) {
  std::vector<int> index(part.vertices.size(), -1);
  std::vector<Vec3> used;
  used.reserve(part.vertices.size());
  const auto renumber = [&](std::vector<Triangle>& faces) {
    for (Triangle& face : faces) {
      for (int& vertex : face) {
        if (index[vertex] < 0) {
          index[vertex] = static_cast<int>(used.size());
          used.push_back(part.vertices[vertex]);
        }
        vertex = index[vertex];
      }
    }
  };
  renumber(part.surface);
  part.on_surface = static_cast<int>(used.size());
  renumber(part.caps);
  part.vertices = std::move(used);
}

}  // namespace

double CellPart::volume() const {
  if (vertices.empty()) return 0;
  double six_volumes = 0;
  const Vec3 origin = vertices[0];
  for (const std::vector<Triangle>* faces : {&surface, &caps}) {
    for (const auto& [a, b, c] : *faces) {
      six_volumes += (vertices[a] - origin).dot((vertices[b] - origin).cross(vertices[c] - origin));
    }
  }
  return six_volumes / 6;
}

Halves halve(const CellPart& part, const Plane& plane) {
  Halves result;
  Cutter cutter(part, plane);
  cutter.cut(part.surface, result.below.surface, result.above.surface);
  cutter.cut(part.caps, result.below.caps, result.above.caps);
  cutter.add_caps(result.below.caps, result.above.caps);
  for (CellPart* half : {&result.below, &result.above}) {
    half->vertices = cutter.vertices();
    half->planes = part.planes;
    drop_unused_vertices(*half);
  }
  result.below.planes.push_back(plane);
  result.above.planes.push_back({-plane.normal, -plane.height});
  return result;
}

std::vector<Vec3> cell_corners(const std::vector<Plane>& planes) {
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      for (std::size_t k = j + 1; k < planes.size(); ++k) {
        Mat3 normals;
        normals << planes[i].normal.transpose(), planes[j].normal.transpose(), planes[k].normal.transpose();
        if (std::abs(normals.determinant()) < kFlat) continue;
        const Vec3 x = normals.inverse() * Vec3(planes[i].height, planes[j].height, planes[k].height);
        bool inside = true;
        for (std::size_t other = 0; other < planes.size(); ++other) {
          inside &= other == i || other == j || other == k || planes[other].distance(x) <= 0;
        }
        if (inside) corners.push_back(x);
      }
    }
  }
  return corners;
}

}  // namespace sunder::geometry::detail
