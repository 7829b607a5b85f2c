/// Chevron marks: what they are, and that the complex stays valid whatever is asked.
#include "crack/surface_detail.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/crack/self_intersection.h"
#include "tests/crack/shapes.h"
#include "tests/geometry/voronoi_regions.h"

namespace sunder::crack::test {
namespace {

using geometry::RegionBoundary;

const Box body(Vec3::Zero(), Vec3::Ones());
const Box hull(Vec3::Constant(-0.2), Vec3::Constant(1.2));

/// Voronoi cells of a jittered lattice with `n` seeds along a side; seeds are in the region that `region_at` says.
RegionBoundary voronoi(int n, const std::function<int(const Vec3&)>& region_at, double jitter, std::uint64_t seed) {
  std::vector<Vec3> seeds;
  std::vector<int> region;
  for (int i = 0; i < n * n * n; ++i) {
    const Vec3 cell(i % n, i / n % n, i / (n * n));
    const auto index = static_cast<std::uint64_t>(i);
    const Vec3 shift(random_unit(seed, 0, index), random_unit(seed, 1, index), random_unit(seed, 2, index));
    const Vec3 at = cell + Vec3::Constant(0.5) + jitter * (2 * shift - Vec3::Ones());
    seeds.push_back(hull.min() + at.cwiseProduct(hull.sizes()) / n);
    region.push_back(region_at(seeds.back()));
  }
  return geometry::voronoi_regions(hull, seeds, region);
}

int half(const Vec3& x) { return x.y() > 0.47; }
int three_sectors(const Vec3& x) {
  const double angle = std::atan2(x.y() - 0.52, x.x() - 0.47) + std::numbers::pi;
  return std::min(2, static_cast<int>(angle / (2 * std::numbers::pi / 3)));
}
int eight_corners(const Vec3& x) { return (x.x() > 0.52) + 2 * (x.y() > 0.47) + 4 * (x.z() > 0.5); }
int ball(const Vec3& x) { return (x - Vec3(0.5, 0.45, 0.55)).norm() < 0.4; }
int thin_slab(const Vec3& x) { return x.y() + 0.1 * x.x() < 0.45 ? 0 : x.y() + 0.1 * x.x() < 0.62 ? 1 : 2; }
int wave(const Vec3& x) { return x.y() > 0.5 + 0.15 * std::sin(6 * x.x()) * std::cos(5 * x.z()); }

struct Complex {
  std::string name;
  RegionBoundary boundary;
};

const std::vector<Complex>& complexes() {
  static const std::vector<Complex> all = {
      {"plane", geometry::voronoi_regions(hull, {{0.5, 0.2, 0.5}, {0.5, 0.8, 0.5}}, {0, 1})},
      {"rough plane", voronoi(6, half, 0.4, 2)},
      {"junction", voronoi(6, three_sectors, 0.4, 3)},
      {"corners", voronoi(2, eight_corners, 0.1, 4)},
      {"rough corners", voronoi(6, eight_corners, 0.4, 5)},
      {"ball", voronoi(6, ball, 0.3, 6)},
      {"slab", voronoi(7, thin_slab, 0.4, 7)},
      {"wave", voronoi(7, wave, 0.2, 8)},
  };
  return all;
}

/// Damage everywhere in the body, spreading from a point.
DamageTimes spreading(const Vec3& source = Vec3(0.1, 0.4, 0.2)) {
  DamageTimes times;
  times.spacing = 0.05;
  for (double x = 0.025; x < 1; x += 0.05)
    for (double y = 0.025; y < 1; y += 0.05)
      for (double z = 0.025; z < 1; z += 0.05) {
        times.points.emplace_back(x, y, z);
        times.time.push_back(1e-4 * (times.points.back() - source).norm());
      }
  return times;
}

DetailSettings coarse() {
  return {.edge_length = 0.05,
          .line_step = 0.06,
          .line_length = 0.5,
          .influence_radius = 0.06,
          .grid_spacing = 0.06,
          .height = 0.02};
}

DetailedBoundary detailed(const RegionBoundary& boundary, const DetailSettings& settings,
                          const DamageTimes& times = spreading()) {
  SilentProgress progress;
  return add_surface_detail(boundary, body, times, settings, progress);
}

double total_volume(const RegionBoundary& boundary) {
  double sum = 0;
  for (int region = 0; region < boundary.region_count; ++region) sum += volume(boundary, region);
  return sum;
}

/// What must hold whatever the settings are; the reason why it does not, or nothing.
std::string defect(const DetailedBoundary& result) {
  constexpr double rounding = 1e-12;
  if (!closed(result.boundary)) return "a region is open";
  for (int region = 0; region < result.boundary.region_count; ++region)
    if (!(volume(result.boundary, region) > 0)) return "a region is turned inside out";
  if (std::abs(total_volume(result.boundary) / hull.volume() - 1) > rounding) return "the regions overlap";
  if (const int n = self_intersections(result.boundary)) return std::to_string(n) + " pairs of faces cross";
  return {};
}

TEST(SelfIntersection, IsFound) {
  RegionBoundary cross;
  cross.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, -1}, {0.2, 0.2, 1}, {2, 2, 0}, {0.3, 0.3, 0.5}};
  cross.faces = {{{0, 1, 2}, 0, 1}, {{3, 4, 5}, 0, 1}};
  EXPECT_EQ(self_intersections(cross), 1);
  cross.faces[1].loop = {0, 4, 5};
  EXPECT_EQ(self_intersections(cross), 0);
  cross.vertices[5] = {0.5, 0.5, -1};
  EXPECT_EQ(self_intersections(cross), 1);
  cross.vertices.push_back({0.4, 0.4, 0});
  cross.faces[1].loop = {1, 0, 7};
  EXPECT_EQ(self_intersections(cross), 1);
}

TEST(SurfaceDetail, RefinesToTheEdgeLengthAndKeepsEveryEdgeClosed) {
  for (const Complex& complex : complexes()) {
    SCOPED_TRACE(complex.name);
    ASSERT_TRUE(closed(complex.boundary));
    DetailSettings settings = coarse();
    settings.height = 0;
    const DetailedBoundary result = detailed(complex.boundary, settings);
    EXPECT_EQ(defect(result), "");
    EXPECT_EQ(result.largest_height, 0);
    EXPECT_EQ(result.limited, 0);
    for (std::size_t v = 0; v < complex.boundary.vertices.size(); ++v)
      EXPECT_EQ(result.boundary.vertices[v], complex.boundary.vertices[v]);
    for (std::size_t f = 0; f < result.boundary.faces.size(); ++f) {
      const auto& face = result.boundary.faces[f];
      const auto& source = complex.boundary.faces[result.source_face[f]];
      ASSERT_EQ(face.inside, source.inside);
      ASSERT_EQ(face.outside, source.outside);
      ASSERT_EQ(face.loop.size(), 3u);
      for (int i = 0; i < 3; ++i) {
        const Vec3 &a = result.boundary.vertices[face.loop[i]], &b = result.boundary.vertices[face.loop[(i + 1) % 3]];
        if (body.contains((a + b) / 2)) {
          EXPECT_LE((a - b).norm(), settings.edge_length);
        }
      }
    }
  }
}

TEST(SurfaceDetail, RaisesLinesOnEveryComplexAndLeavesItValid) {
  for (const Complex& complex : complexes()) {
    SCOPED_TRACE(complex.name);
    const DetailedBoundary result = detailed(complex.boundary, coarse());
    EXPECT_EQ(defect(result), "");
    EXPECT_GT(result.lines, 5);
    EXPECT_EQ(result.raised_lines, result.lines);
    EXPECT_LE(result.largest_height, coarse().height);
    EXPECT_GT(result.largest_height, 0.2 * coarse().height);
  }
}

TEST(SurfaceDetail, StaysValidForAbsurdHeights) {
  for (const Complex& complex : complexes())
    for (double height : {0.3, 10.0, 1e6}) {
      SCOPED_TRACE(complex.name + " " + std::to_string(height));
      DetailSettings settings = coarse();
      settings.height = height;
      const DetailedBoundary result = detailed(complex.boundary, settings);
      EXPECT_EQ(defect(result), "");
      EXPECT_GT(result.largest_height, 0);
      EXPECT_GT(result.limited, 0);
    }
}

RC_GTEST_PROP(SurfaceDetail, IsValidWhateverIsAsked, ()) {
  const Complex& complex = complexes()[*rc::gen::inRange<std::size_t>(0, complexes().size())];
  const auto length = [](double low, double high) {
    return low * std::pow(high / low, *rc::gen::inRange(0, 1001) / 1000.0);
  };
  DetailSettings settings;
  settings.edge_length = length(0.05, 0.2);
  settings.line_step = length(0.01, 0.5);
  settings.line_length = length(0.02, 3);
  settings.influence_radius = length(0.01, 0.5);
  settings.grid_spacing = length(0.01, 0.3);
  settings.height = length(1e-3, 1e3);
  settings.longest_share = *rc::gen::inRange(0, 11) / 10.0;
  settings.grain = *rc::gen::inRange(0, 5) / 4.0;
  settings.grain_size = length(0.02, 0.5);
  settings.seed = *rc::gen::arbitrary<std::uint64_t>();
  const DetailedBoundary result = detailed(complex.boundary, settings);
  RC_ASSERT(defect(result) == "");
  RC_ASSERT(result.largest_height <= settings.height);
}

TEST(SurfaceDetail, LeavesJunctionsTheHullAndFarVerticesInPlace) {
  DetailSettings settings = coarse(), flat = coarse();
  flat.height = 0;
  for (const Complex& complex : complexes()) {
    SCOPED_TRACE(complex.name);
    const RegionBoundary before = detailed(complex.boundary, flat).boundary;
    // The same planes of refinement: the refined box grows with the height, so compare input vertices only.
    const RegionBoundary after = detailed(complex.boundary, settings).boundary;
    std::map<int, std::set<std::pair<int, int>>> pairs;
    for (const auto& face : complex.boundary.faces)
      for (int v : face.loop) pairs[v].insert(std::minmax(face.inside, face.outside));
    for (const auto& [v, between] : pairs)
      if (between.size() > 1) {
        EXPECT_EQ(after.vertices[v], before.vertices[v]);
      }
  }
}

// Front lines are parallel planes: marks run along x, over the whole body, and their heights grow on the way.
TEST(SurfaceDetail, LinesFollowTheFrontAndRise) {
  DamageTimes times = spreading();
  for (std::size_t p = 0; p < times.points.size(); ++p) times.time[p] = times.points[p].x();
  DetailSettings settings = coarse();
  settings.edge_length = 0.02;
  settings.line_length = 10;
  settings.influence_radius = 0.15;
  const DetailedBoundary result = detailed(complexes()[0].boundary, settings, times);
  double along = 0, across = 0, early = 0, late = 0;
  for (const auto& face : result.boundary.faces) {
    const Vec3 n = area_vector(polygon_of(result.boundary, face, face.inside));
    Vec3 middle = Vec3::Zero();
    for (int v : face.loop) middle += result.boundary.vertices[v] / 3;
    if (face.outside < 0 || !Box(Vec3::Constant(0.2), Vec3::Constant(0.8)).contains(middle)) continue;
    along += n.x() * n.x() / n.norm();
    across += n.z() * n.z() / n.norm();
    (middle.x() < 0.5 ? early : late) += (middle.y() - 0.5) * n.norm();
  }
  EXPECT_GT(across, 4 * along);
  EXPECT_GT(std::abs(late), 1.1 * std::abs(early));
  EXPECT_LT(result.lines, 30);
}

TEST(SurfaceDetail, GoesOnWhereNoDamageIsNear) {
  DamageTimes times = spreading();
  for (std::size_t p = 0; p < times.points.size(); ++p)
    times.time[p] = times.points[p].x() < 0.5 ? times.points[p].x() : -1;
  const DetailedBoundary result = detailed(complexes()[0].boundary, coarse(), times);
  double highest = 0;
  for (std::size_t v = 0; v < result.boundary.vertices.size(); ++v) {
    const Vec3& x = result.boundary.vertices[v];
    if (!body.contains(x)) continue;
    EXPECT_GE(result.damage_time[v], 0);
    if (x.x() > 0.8) {
      EXPECT_NEAR(result.damage_time[v], x.x(), 1e-9);  // the linear field goes on
      highest = std::max(highest, std::abs(x.y() - 0.5));
    }
  }
  EXPECT_GT(highest, 0.3 * coarse().height);
}

TEST(SurfaceDetail, RaisesNothingWithoutDamage) {
  const DetailedBoundary result = detailed(complexes()[1].boundary, coarse(), {});
  EXPECT_EQ(result.lines, 0);
  EXPECT_EQ(result.largest_height, 0);
  EXPECT_EQ(defect(result), "");
}

TEST(SurfaceDetail, RepeatsBitForBit) {
  const DetailedBoundary a = detailed(complexes()[2].boundary, coarse());
  const DetailedBoundary b = detailed(complexes()[2].boundary, coarse());
  EXPECT_EQ(a.boundary.vertices, b.boundary.vertices);
  EXPECT_EQ(a.damage_time, b.damage_time);
  EXPECT_EQ(a.lines, b.lines);
}

TEST(SurfaceDetail, RefusesSettingsThatMakeNoSense) {
  const auto kind_of = [](const DetailSettings& settings) {
    try {
      detailed(complexes()[0].boundary, settings);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::internal;
  };
  DetailSettings settings = coarse();
  settings.height = -1;
  EXPECT_EQ(kind_of(settings), ErrorKind::usage);
  settings = coarse();
  settings.line_step = std::nan("");
  EXPECT_EQ(kind_of(settings), ErrorKind::usage);
  settings = coarse();
  settings.edge_length = 2e-4;
  EXPECT_EQ(kind_of(settings), ErrorKind::usage);
}

TEST(DetailPreset, EveryLookIsValidAndUnknownOnesAreRefused) {
  EXPECT_EQ(detail_preset_names().size(), 8u);
  for (const std::string& name : detail_preset_names()) {
    SCOPED_TRACE(name);
    const DetailedBoundary result = detailed(complexes()[2].boundary, detail_preset(name, 4));
    EXPECT_EQ(defect(result), "");
    EXPECT_GT(result.largest_height, 0);
    EXPECT_EQ(detail_preset(name, 4).height, 4 * detail_preset(name, 1).height);
  }
  try {
    detail_preset("cheese", 1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find("slate"), std::string::npos);
  }
}

}  // namespace
}  // namespace sunder::crack::test
