#include "geometry/primitives.h"

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "core/error.h"
#include "geometry/detail/profile.h"

namespace sunder::geometry {
namespace {

using detail::Corner;
using std::numbers::pi;

void require(bool condition, const std::string& message) {
  if (!condition) throw Error(ErrorKind::usage, message);
}

TriangleMesh centred(const TriangleMesh& mesh) { return transformed(mesh, Mat3::Identity(), -bounds(mesh).center()); }

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.faces) mesh.faces.push_back({first + a, first + b, first + c});
}

// Rings of vertices, bottom row first, joined by quads and closed by a fan at either end. `radius(row, angle)` is the
// distance from the axis; heights[0] and heights.back() are the heights of the end points on the axis.
TriangleMesh lathe(const std::vector<double>& heights, int segments, const std::function<double(int, double)>& radius) {
  const int rows = static_cast<int>(heights.size()) - 2;
  TriangleMesh mesh;
  for (int row = 1; row <= rows; ++row) {
    for (int i = 0; i < segments; ++i) {
      const double angle = 2 * pi * i / segments, r = radius(row, angle);
      mesh.vertices.emplace_back(r * std::sin(angle), heights[row], r * std::cos(angle));
    }
  }
  const int bottom = rows * segments, top = bottom + 1;
  mesh.vertices.emplace_back(0, heights.front(), 0);
  mesh.vertices.emplace_back(0, heights.back(), 0);
  for (int i = 0; i < segments; ++i) {
    const int next = (i + 1) % segments, last = (rows - 1) * segments;
    mesh.faces.push_back({bottom, next, i});
    for (int row = 0; row + 1 < rows; ++row) {
      const int a = row * segments + i, b = row * segments + next, c = b + segments, d = a + segments;
      mesh.faces.push_back({a, b, c});
      mesh.faces.push_back({a, c, d});
    }
    mesh.faces.push_back({top, last + i, last + next});
  }
  return mesh;
}

// A hollow vessel: `outer` runs from the axis at the bottom to the lip, `bowl` is the part of it that the inner wall
// follows. The lip leans with the wall and its rounding trims the corner, so the result is scaled to the size that was
// asked for.
TriangleMesh vessel(std::vector<Corner> outer, const std::vector<Corner>& bowl, double wall, double diameter,
                    double height) {
  const std::vector<Corner> inner = detail::offset_left(bowl, wall);
  outer.insert(outer.end(), inner.rbegin(), inner.rend());
  const TriangleMesh mesh = revolve(detail::rounded(outer, height / 24));
  const Vec3 scale = Vec3(diameter, height, diameter).cwiseQuotient(bounds(mesh).diagonal());
  return centred(transformed(mesh, scale.asDiagonal(), Vec3::Zero()));
}

// Fillet of the lip: a half circle over the wall, less a hair so that its two arcs do not meet.
double lip(double wall) { return 0.48 * wall; }

void require_vessel(const char* name, double height, double wall, double largest_share) {
  require(height > 0, std::string(name) + ": the height must be positive");
  require(wall > 0 && wall <= largest_share * height, std::string(name) + ": the wall must be positive and at most " +
                                                          std::to_string(largest_share) + " of the height");
}

int midpoint(TriangleMesh& mesh, std::map<std::pair<int, int>, int>& midpoints, int a, int b) {
  const auto [entry, is_new] = midpoints.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
  if (is_new) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
  return entry->second;
}

TriangleMesh subdivided(TriangleMesh mesh) {
  std::map<std::pair<int, int>, int> midpoints;
  std::vector<Triangle> faces;
  for (const auto& [a, b, c] : mesh.faces) {
    const int ab = midpoint(mesh, midpoints, a, b), bc = midpoint(mesh, midpoints, b, c),
              ca = midpoint(mesh, midpoints, c, a);
    faces.insert(faces.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  mesh.faces = std::move(faces);
  return mesh;
}

TriangleMesh unit_icosahedron() {
  const double g = std::numbers::phi;
  TriangleMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3& vertex : mesh.vertices) vertex.normalize();
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return mesh;
}

// One row of the column: round with flutes of the given depth, or square with half side `radius`.
struct ColumnRow {
  double radius = 0, height = 0, flute_depth = 0;
  bool square = false;
};

constexpr int kFlutes = 20;

double column_radius(const ColumnRow& row, double angle) {
  if (row.square) return row.radius / std::max(std::abs(std::sin(angle)), std::abs(std::cos(angle)));
  // Doric flutes: hollows that meet in sharp arrises.
  return row.radius - row.flute_depth * std::abs(std::sin(angle * kFlutes / 2));
}

void append_round(std::vector<ColumnRow>& rows, const std::vector<Corner>& corners, double step) {
  for (const auto& [radius, height] : detail::rounded(corners, step)) rows.push_back({radius, height});
}

// The shaft swells a little and tapers (entasis); its flutes run out at both ends.
void append_shaft(std::vector<ColumnRow>& rows, double low, double high, double low_radius, double high_radius) {
  constexpr int kRows = 40;
  for (int i = 0; i <= kRows; ++i) {
    const double t = static_cast<double>(i) / kRows;
    const double radius = low_radius + (high_radius - low_radius) * t + 0.04 * low_radius * std::sin(pi * t);
    const double run_out = std::min(1.0, 16 * std::min(t, 1 - t));
    rows.push_back({radius, low + (high - low) * t, 0.11 * radius * std::sqrt(run_out * (2 - run_out))});
  }
}

}  // namespace

TriangleMesh box(const Vec3& size) {
  require((size.array() > 0).all(), "box: all sizes must be positive");
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.vertices.emplace_back(
        Vec3(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5).cwiseProduct(size));
  }
  mesh.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh sphere(double radius, int subdivisions) {
  require(radius > 0, "sphere: the radius must be positive");
  require(subdivisions >= 0 && subdivisions <= 6, "sphere: subdivisions must be 0 to 6");
  TriangleMesh mesh = unit_icosahedron();
  for (int i = 0; i < subdivisions; ++i) mesh = subdivided(std::move(mesh));
  for (Vec3& vertex : mesh.vertices) vertex *= radius;
  return mesh;
}

TriangleMesh cylinder(double radius, double height, int segments) {
  require(radius > 0 && height > 0, "cylinder: radius and height must be positive");
  return revolve({{0, -height / 2}, {radius, -height / 2}, {radius, height / 2}, {0, height / 2}}, segments);
}

TriangleMesh torus(double ring_radius, double tube_radius, int ring_segments, int tube_segments) {
  require(tube_radius > 0 && ring_radius > tube_radius, "torus: the ring must be wider than the tube");
  require(ring_segments >= 3 && tube_segments >= 3, "torus: at least 3 segments each way");
  TriangleMesh mesh;
  for (int i = 0; i < ring_segments; ++i) {
    const double along = 2 * pi * i / ring_segments;
    for (int j = 0; j < tube_segments; ++j) {
      const double around = 2 * pi * j / tube_segments, r = ring_radius + tube_radius * std::cos(around);
      mesh.vertices.emplace_back(r * std::sin(along), tube_radius * std::sin(around), r * std::cos(along));
      const int next = (i + 1) % ring_segments, up = (j + 1) % tube_segments;
      const int a = i * tube_segments + j, b = next * tube_segments + j;
      const int c = next * tube_segments + up, d = i * tube_segments + up;
      mesh.faces.insert(mesh.faces.end(), {{a, b, c}, {a, c, d}});
    }
  }
  return mesh;
}

TriangleMesh hollow_sphere(double outer_radius, double wall, int subdivisions) {
  require(wall > 0 && wall < outer_radius, "hollow sphere: the wall must be positive and less than the radius");
  TriangleMesh mesh = sphere(outer_radius, subdivisions);
  TriangleMesh inside = sphere(outer_radius - wall, subdivisions);
  for (Triangle& face : inside.faces) std::swap(face[1], face[2]);
  append(mesh, inside);
  return mesh;
}

TriangleMesh revolve(const std::vector<ProfilePoint>& profile, int segments) {
  require(profile.size() >= 3 && segments >= 3, "revolve: at least 3 profile points and 3 segments");
  require(profile.front().radius == 0 && profile.back().radius == 0,
          "revolve: the profile must start and end on the axis");
  std::vector<double> heights;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    require(i == 0 || i + 1 == profile.size() || profile[i].radius > 0,
            "revolve: inner profile points must be off the axis");
    heights.push_back(profile[i].height);
  }
  return lathe(heights, segments, [&](int row, double) { return profile[row].radius; });
}

TriangleMesh cup(double height, double wall) {
  require_vessel("cup", height, wall, 0.1);
  const double h = height, foot = 0.24 * h, ring = 0.03 * h, rounding = std::min(0.4 * wall, 0.4 * ring);
  const std::vector<Corner> bowl = {
      {0, ring}, {0.27 * h, ring, 0.1 * h}, {0.365 * h, 0.22 * h, 0.5 * h}, {0.4 * h, h, lip(wall)}};
  std::vector<Corner> outer = {{0, ring},
                               {foot - wall, ring, rounding},
                               {foot - wall, 0, rounding},
                               {foot, 0, rounding},
                               {foot, ring, rounding}};
  outer.insert(outer.end(), bowl.begin() + 1, bowl.end());
  return vessel(outer, bowl, wall, 0.8 * h, h);
}

TriangleMesh pot(double height, double wall) {
  require_vessel("pot", height, wall, 0.12);
  const double h = height, rim = 0.16 * h, band = 0.6 * wall;
  const auto side = [h](double y) { return 0.3 * h + 0.14 * y; };
  const std::vector<Corner> bowl = {{0, 0}, {side(0), 0, 0.25 * wall}, {side(h), h, lip(wall)}};
  std::vector<Corner> outer = {bowl[0], bowl[1]};
  outer.push_back({side(h - rim), h - rim, 0.2 * wall});
  outer.push_back({side(h - rim) + band, h - rim, 0.3 * wall});
  outer.push_back({side(h) + band, h, 0.45 * wall});
  return vessel(outer, bowl, wall, 2 * (side(h) + band), h);
}

TriangleMesh goblet(double height, double wall) {
  require_vessel("goblet", height, wall, 0.04);
  const double h = height, stem = 0.025 * h, neck = 0.44 * h;
  const std::vector<Corner> bowl = {
      {0, neck}, {0.16 * h, neck, 0.12 * h}, {0.225 * h, 0.66 * h, 0.3 * h}, {0.17 * h, h, lip(wall)}};
  std::vector<Corner> outer = {{0, 0.012 * h},
                               {0.12 * h, 0, 0.2 * h},
                               {0.19 * h, 0, 0.006 * h},
                               {0.19 * h, 0.012 * h, 0.006 * h},
                               {0.05 * h, 0.035 * h, 0.1 * h},
                               {stem, 0.12 * h, 0.2 * h},
                               {stem, neck - 0.03 * h, 0.06 * h}};
  outer.insert(outer.end(), bowl.begin() + 1, bowl.end());
  return vessel(outer, bowl, wall, 0.42 * h, h);
}

TriangleMesh column(double height) {
  require(height > 0, "column: the height must be positive");
  const double h = height, step = h / 25;
  std::vector<ColumnRow> rows = {{0, 0}, {0.11 * h, 0, 0, true}, {0.11 * h, 0.05 * h, 0, true}};
  append_round(rows,
               {{0.098 * h, 0.05 * h},
                {0.108 * h, 0.055 * h, 0.015 * h},
                {0.108 * h, 0.08 * h, 0.015 * h},
                {0.086 * h, 0.085 * h, 0.006 * h},
                {0.082 * h, 0.1 * h}},
               step);
  append_shaft(rows, 0.105 * h, 0.88 * h, 0.077 * h, 0.064 * h);
  append_round(
      rows,
      {{0.066 * h, 0.885 * h}, {0.066 * h, 0.9 * h, 0.01 * h}, {0.1 * h, 0.93 * h, 0.03 * h}, {0.1 * h, 0.945 * h}},
      step);
  rows.insert(rows.end(), {{0.108 * h, 0.945 * h, 0, true}, {0.108 * h, h, 0, true}, {0, h}});
  std::vector<double> heights;
  for (const ColumnRow& row : rows) heights.push_back(row.height);
  return centred(lathe(heights, 8 * kFlutes, [&](int row, double angle) { return column_radius(rows[row], angle); }));
}

}  // namespace sunder::geometry
