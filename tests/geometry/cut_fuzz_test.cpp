/// Thousands of random cuts of small bodies, many of them degenerate on purpose.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "core/random.h"
#include "geometry/detail/embedding.h"
#include "geometry/primitives.h"
#include "tests/geometry/cut_checks.h"
#include "tests/geometry/delaunay_regions.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry {
namespace {

constexpr int kCuts = 2000;
// Cuts may end without fragments when even nudged regions do not divide the body cleanly, but seldom.
constexpr double kFailureShare = 0.005;

/// Random numbers of one case.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : seed_(seed) {}
  double unit() { return random_unit(seed_, 0xf522, next_++); }
  double real(double low, double high) { return low + (high - low) * unit(); }
  int below(int count) { return static_cast<int>(unit() * count); }
  Vec3 vector() {
    const double x = real(-1, 1), y = real(-1, 1), z = real(-1, 1);
    return {x, y, z};
  }
  Mat3 rotation() {
    const Vec3 axis = vector().normalized();
    return Eigen::AngleAxisd(real(0, 6), axis).toRotationMatrix();
  }

 private:
  std::uint64_t seed_, next_ = 0;
};

TriangleMesh random_body(Dice& dice) {
  switch (dice.below(9)) {
    case 0:
      return box({1, 0.6, 0.3});
    case 1:
      return sphere(1, 2);
    case 2:
      return sphere(0.7, 3);
    case 3:
      return torus(1, 0.3, 24, 12);
    case 4:
      return cylinder(0.5, 1, 24);
    case 5:
      return hollow_sphere(1, 0.2, 2);
    case 6:
      return together(sphere(0.5, 2), moved(torus(1, 0.2, 24, 8), {0.1, 0.05, 0}));
    case 7:
      return revolve({{0, 0}, {0.6, 0}, {0.6, 1}, {0.5, 1}, {0.5, 0.1}, {0, 0.1}}, 24);  // a cup
    default:
      return revolve({{0, 0}, {1, 0}, {1, 0.2}, {0.5, 0.2}, {0.5, 1}, {0, 1}}, 8);  // a step with plane sides
  }
}

RegionBoundary random_cells(const TriangleMesh& body, Dice& dice, double jitter = 0) {
  const int cells = 2 + dice.below(20), regions = 1 + dice.below(cells);
  std::vector<Vec3> seeds;
  const Box space = bounds(body);
  for (int i = 0; i < cells; ++i) {
    Vec3 x = dice.vector();
    // A lattice, nearly: cells nearly meet at common vertices.
    if (jitter > 0) x = Vec3((i % 3) - 1, (i / 3 % 3) - 1, (i / 9) - 1) + jitter * x;
    seeds.push_back(space.center() + 0.5 * x.cwiseProduct(space.diagonal()));
  }
  return delaunay_regions(space, seeds, grown_regions(seeds, regions));
}

/// Every triangle of a fan over each face, split in four, `times` times.
RegionBoundary refined(const RegionBoundary& regions, int times) {
  RegionBoundary result{regions.vertices, {}, regions.region_count};
  for (const RegionBoundary::Face& face : regions.faces) {
    for (std::size_t i = 1; i + 1 < face.loop.size(); ++i) {
      result.faces.push_back({{face.loop[0], face.loop[i], face.loop[i + 1]}, face.inside, face.outside});
    }
  }
  for (int n = 0; n < times; ++n) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, added] = middles.emplace(std::minmax(a, b), static_cast<int>(result.vertices.size()));
      if (added) result.vertices.push_back((result.vertices[a] + result.vertices[b]) / 2);
      return found->second;
    };
    std::vector<RegionBoundary::Face> faces;
    for (const RegionBoundary::Face& face : result.faces) {
      const int a = face.loop[0], b = face.loop[1], c = face.loop[2];
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const std::vector<int>& loop : {std::vector{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
        faces.push_back({loop, face.inside, face.outside});
      }
    }
    result.faces = std::move(faces);
  }
  return result;
}

bool crosses_itself(const RegionBoundary& triangles) {
  TriangleMesh mesh{triangles.vertices, {}};
  for (const auto& face : triangles.faces) mesh.faces.push_back({face.loop[0], face.loop[1], face.loop[2]});
  return detail::intersects_itself(mesh, detail::BoxTree(mesh.vertices, mesh.faces));
}

/// Cells whose faces are bent by one smooth map of space. It is one to one, but straight triangles follow it only in
/// their corners: where faces stand at a small angle they may cross, so they are bent less until they do not.
RegionBoundary bent_cells(const TriangleMesh& body, Dice& dice) {
  const RegionBoundary straight = refined(random_cells(body, dice), 2);
  const Mat3 turn = dice.rotation();
  const double size = bounds(body).diagonal().norm();
  const double wave = 2 * 3.14159265358979 * dice.real(1, 3) / size;
  RegionBoundary regions = straight;
  for (double height = dice.real(0.05, 0.4) / wave; height * wave > 1e-3; height /= 2) {
    for (std::size_t i = 0; i < regions.vertices.size(); ++i) {
      const Vec3 y = turn * straight.vertices[i];
      const Vec3 bend(std::sin(wave * y.y()), std::sin(wave * y.z()), 0);
      regions.vertices[i] = turn.transpose() * (y + height * bend);
    }
    if (!crosses_itself(regions)) return regions;
  }
  return straight;
}

/// Parallel sheets, far larger than the body; sheet i parts region i from region i + 1.
RegionBoundary sheets(const TriangleMesh& body, const Vec3& at, const Vec3& normal,
                      const std::vector<double>& heights) {
  const Vec3 n = normal.normalized(), u = n.unitOrthogonal(), v = n.cross(u);
  const double size = 3 * bounds(body).diagonal().norm();
  RegionBoundary regions;
  for (const double height : heights) {
    const int first = static_cast<int>(regions.vertices.size());
    for (const auto& [x, y] : {std::pair{-size, -size}, {size, -size}, {size, size}, {-size, size}}) {
      regions.vertices.push_back(at + height * n + x * u + y * v);
    }
    regions.faces.push_back({{first, first + 1, first + 2, first + 3}, regions.region_count, regions.region_count + 1});
    ++regions.region_count;
  }
  ++regions.region_count;
  return regions;
}

Vec3 random_vertex(const TriangleMesh& body, Dice& dice) {
  return body.vertices[dice.below(static_cast<int>(body.vertices.size()))];
}

// The plane of a face of the body.
RegionBoundary coplanar(const TriangleMesh& body, Dice& dice) {
  const Triangle& face = body.faces[dice.below(static_cast<int>(body.faces.size()))];
  const Vec3 &a = body.vertices[face[0]], &b = body.vertices[face[1]], &c = body.vertices[face[2]];
  return sheets(body, a, (b - a).cross(c - a), {0, 0.3});
}

// Planes along axes, through vertices.
RegionBoundary through_vertices(const TriangleMesh& body, Dice& dice) {
  const Vec3 at = random_vertex(body, dice);
  return sheets(body, at, Vec3::Unit(dice.below(3)), {0, dice.real(0.01, 0.3)});
}

// A plane through an edge of the body.
RegionBoundary through_edge(const TriangleMesh& body, Dice& dice) {
  const Triangle& face = body.faces[dice.below(static_cast<int>(body.faces.size()))];
  const Vec3 &a = body.vertices[face[0]], &b = body.vertices[face[1]];
  return sheets(body, a, (b - a).cross(dice.vector()), {0});
}

RegionBoundary near_duplicates(const TriangleMesh& body, Dice& dice) {
  const double gap = std::pow(10, dice.real(-11, -5));
  return sheets(body, bounds(body).center() + 0.2 * dice.vector(), dice.vector(), {0, gap, 2.5 * gap});
}

/// A bent sheet whose vertices lie in vertices of the body where they are near.
RegionBoundary snapped(const TriangleMesh& body, Dice& dice) {
  RegionBoundary regions = refined(sheets(body, bounds(body).center(), dice.vector(), {0.1}), 5);
  const double near = 0.02 * bounds(body).diagonal().norm();
  std::vector<bool> taken(body.vertices.size(), false);
  for (Vec3& x : regions.vertices) {
    const auto closer = [&](const Vec3& a, const Vec3& b) { return (a - x).norm() < (b - x).norm(); };
    const auto nearest = std::min_element(body.vertices.begin(), body.vertices.end(), closer);
    const auto index = nearest - body.vertices.begin();
    if ((*nearest - x).norm() < near && !taken[index]) x = *nearest, taken[index] = true;
  }
  return regions;
}

struct Case {
  TriangleMesh body;
  RegionBoundary regions;
};

struct Kind {
  const char* name;
  Case (*make)(Dice&);
};

template <RegionBoundary (*make)(const TriangleMesh&, Dice&)>
Case aligned(Dice& dice) {
  const TriangleMesh body = random_body(dice);
  return {body, make(body, dice)};
}

template <RegionBoundary (*make)(const TriangleMesh&, Dice&)>
Case turned(Dice& dice) {
  const TriangleMesh body = transformed(random_body(dice), dice.rotation(), dice.vector());
  return {body, make(body, dice)};
}

RegionBoundary plain(const TriangleMesh& body, Dice& dice) { return random_cells(body, dice); }
RegionBoundary nearly_cospherical(const TriangleMesh& body, Dice& dice) {
  return random_cells(body, dice, std::pow(10, dice.real(-6, -2)));
}

// Bodies with needles for faces.
Case slivers(Dice& dice) {
  const Mat3 squeeze = Vec3(1, std::pow(10, dice.real(-4, 0)), std::pow(10, dice.real(-3, 0))).asDiagonal();
  const TriangleMesh body = transformed(random_body(dice), dice.rotation() * squeeze, dice.vector());
  return {body, dice.below(2) == 0 ? random_cells(body, dice) : bent_cells(body, dice)};
}

constexpr Kind kKinds[] = {{"plane cells", turned<plain>},
                           {"bent cells", turned<bent_cells>},
                           {"coplanar", aligned<coplanar>},
                           {"coplanar, turned", turned<coplanar>},
                           {"through vertices", aligned<through_vertices>},
                           {"through an edge", turned<through_edge>},
                           {"near duplicates", turned<near_duplicates>},
                           {"snapped to vertices", aligned<snapped>},
                           {"nearly cospherical", aligned<nearly_cospherical>},
                           {"slivers", slivers}};

struct Tally {
  int cuts = 0, fragments = 0, nudged = 0, nudges = 0, failed = 0, broken = 0;
};

// Suites named *Slow* get the label slow.
TEST(CutFuzzSlow, NeverLeaks) {
  constexpr int kinds = static_cast<int>(std::size(kKinds));
  std::array<Tally, kinds> tallies;
  std::mutex lock;
  tbb::parallel_for(0, kCuts, [&](int i) {
    Dice dice(static_cast<std::uint64_t>(i));
    const auto& [name, make] = kKinds[i % kinds];
    const auto [body, regions] = make(dice);
    const CutResult result = cut_silently(body, regions);
    const bool ok = result.status == CutStatus::ok;
    const std::string wrong = ok ? broken_cut(body, result) : "";
    const std::lock_guard guard(lock);
    Tally& tally = tallies[i % kinds];
    ++tally.cuts;
    tally.fragments += static_cast<int>(result.fragments.size());
    tally.nudged += result.nudges > 0;
    tally.nudges += result.nudges;
    tally.failed += !ok;
    tally.broken += !wrong.empty();
    if (!ok) std::printf("case %d, %s: %s\n", i, name, result.detail.c_str());
    EXPECT_EQ(wrong, "") << "case " << i << ", " << name;
  });
  Tally all;
  std::printf("%-20s %5s %9s %7s %7s %7s %7s\n", "", "cuts", "fragments", "nudged", "nudges", "failed", "broken");
  for (int i = 0; i < kinds; ++i) {
    const Tally& t = tallies[i];
    std::printf("%-20s %5d %9d %7d %7d %7d %7d\n", kKinds[i].name, t.cuts, t.fragments, t.nudged, t.nudges, t.failed,
                t.broken);
    all.cuts += t.cuts, all.nudged += t.nudged, all.failed += t.failed, all.broken += t.broken;
  }
  std::printf("%d of %d cuts nudged, %d failed, %d broken\n", all.nudged, all.cuts, all.failed, all.broken);
  EXPECT_EQ(all.cuts, kCuts);
  EXPECT_EQ(all.broken, 0);
  EXPECT_LE(all.failed, kFailureShare * kCuts);
}

}  // namespace
}  // namespace sunder::geometry
