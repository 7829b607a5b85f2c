#include "geometry/cut.h"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/global_control.h>

#include "geometry/primitives.h"
#include "tests/geometry/cut_checks.h"
#include "tests/geometry/voronoi_regions.h"

namespace sunder::geometry {
namespace {

// A crack in a face of the body is moved by about 1e-6 of the body's size (3 m), so volumes change by that times the
// crack's area (up to 2 m^2).
constexpr double kNudged = 1e-5;
// Areas of the parts of a face against the face: rounding.
constexpr double kAreaKept = 1e-9;
// Fans that touch are moved apart by 1e-9 of the body's size (3 m), so volumes change by that times their area.
constexpr double kMovedApart = 1e-8;
// A cut point is rounded once; its distance from the planes that made it, relative to the body's size.
constexpr double kOnPlane = 1e-12;

// The L of two boxes; its faces at x = 0 and y = 0 go on inside as no face, so cracks there are coplanar with faces.
TriangleMesh l_shape() {
  const std::vector<std::array<double, 2>> outline = {{-1, -1}, {1, -1}, {1, 0}, {0, 0}, {0, 1}, {-1, 1}};
  TriangleMesh mesh;
  for (const double z : {-0.5, 0.5}) {
    for (const auto& [x, y] : outline) mesh.vertices.push_back({x, y, z});
  }
  for (const auto& [a, b, c] : {Triangle{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}}) {
    mesh.faces.push_back({a, c, b});
    mesh.faces.push_back({a + 6, b + 6, c + 6});
  }
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    mesh.faces.push_back({i, j, j + 6});
    mesh.faces.push_back({i, j + 6, i + 6});
  }
  return mesh;
}

struct Family {
  const char* name;
  TriangleMesh mesh;
};

std::vector<Family> families() {
  return {{"box", box({1, 0.6, 0.3})},
          {"sphere", sphere(1, 3)},
          {"torus", torus(1, 0.3, 32, 12)},
          {"cup", cup(0.1, 0.006)},
          {"hollow sphere", hollow_sphere(1, 0.1, 3)},
          {"L", l_shape()}};
}

double plane_distance(const Vec3& x, const Vec3& on_plane, const Vec3& normal) {
  return std::abs((x - on_plane).dot(normal.normalized()));
}

// The largest distance of a face's vertices from the plane of a region face.
double distance_to(const TriangleMesh& mesh, const Triangle& face, const RegionBoundary& regions, int crack) {
  const std::vector<int>& loop = regions.faces[crack].loop;
  const Vec3& a = regions.vertices[loop[0]];
  Vec3 normal = Vec3::Zero();  // of the polygon, by Newell's sum
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    normal += (regions.vertices[loop[i]] - a).cross(regions.vertices[loop[i + 1]] - a);
  }
  double farthest = 0;
  for (const int vertex : face) farthest = std::max(farthest, plane_distance(mesh.vertices[vertex], a, normal));
  return farthest;
}

double face_area(const TriangleMesh& mesh, const Triangle& face) {
  const Vec3& a = mesh.vertices[face[0]];
  return (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a).norm() / 2;
}

void expect_provenance(const TriangleMesh& body, const RegionBoundary& regions, const CutResult& result) {
  const double tolerance = kOnPlane * bounds(body).diagonal().norm();
  std::vector<double> area(body.faces.size(), 0);
  for (const Fragment& fragment : result.fragments) {
    for (std::size_t i = 0; i < fragment.mesh.faces.size(); ++i) {
      const Triangle& face = fragment.mesh.faces[i];
      const int source = fragment.source_face[i];
      if (source < 0) {
        const RegionBoundary::Face& crack = regions.faces[fragment.crack_face[i]];
        const int beyond = result.fragments[fragment.neighbour[i]].region;
        EXPECT_LE(distance_to(fragment.mesh, face, regions, fragment.crack_face[i]), tolerance);
        EXPECT_EQ(std::minmax(fragment.region, beyond), std::minmax(crack.inside, crack.outside));
        continue;
      }
      const Triangle& parent = body.faces[source];
      const Vec3& a = body.vertices[parent[0]];
      const Vec3 normal = (body.vertices[parent[1]] - a).cross(body.vertices[parent[2]] - a);
      for (const int vertex : face) EXPECT_LE(plane_distance(fragment.mesh.vertices[vertex], a, normal), tolerance);
      area[source] += face_area(fragment.mesh, face);
    }
  }
  for (std::size_t i = 0; i < area.size(); ++i) {
    EXPECT_NEAR(area[i], face_area(body, body.faces[i]), kAreaKept * face_area(body, body.faces[i]));
  }
}

TriangleMesh turned_by(const TriangleMesh& mesh, std::uint64_t seed) {
  const auto random = [&](int i) { return random_unit(seed, 9, i) - 0.5; };
  const Quat rotation = Quat(random(0), random(1), random(2), random(3)).normalized();
  return transformed(mesh, rotation.toRotationMatrix(), {random(4), random(5), random(6)});
}

// Two halves of a padded box, parted by the plane through `height` on the axis.
RegionBoundary halves(const TriangleMesh& body, int axis, double height) {
  const double span = bounds(body).diagonal().norm();
  Vec3 below = Vec3::Zero(), above = Vec3::Zero();
  below[axis] = height - span, above[axis] = height + span;
  Box space = padded(bounds(body));
  space.min()[axis] = height - 2 * span, space.max()[axis] = height + 2 * span;
  return voronoi_regions(space, {below, above}, {0, 1});
}

TEST(Cut, KeepsEverythingOverFamiliesOfShapes) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family.name);
    const RegionBoundary regions = random_regions(family.mesh, 18, 6, 1);
    const CutResult result = cut_silently(family.mesh, regions);
    ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
    EXPECT_GE(result.fragments.size(), 4u);
    EXPECT_EQ(result.nudges, 0);
    EXPECT_EQ(broken_cut(family.mesh, result), "");
    expect_provenance(family.mesh, regions, result);
  }
}

RC_GTEST_PROP(Cut, KeepsEverythingInAnyOrientation, ()) {
  const std::uint64_t seed = *rc::gen::arbitrary<std::uint32_t>();
  const std::vector<Family> all = families();
  const Family& family = all[*rc::gen::inRange<std::size_t>(0, all.size())];
  const int cells = *rc::gen::inRange(2, 14);
  const int regions = *rc::gen::inRange(1, cells + 1);
  const TriangleMesh body = turned_by(family.mesh, seed);
  const CutResult result = cut_silently(body, random_regions(body, cells, regions, seed));
  RC_ASSERT(result.status == CutStatus::ok);
  RC_ASSERT(broken_cut(body, result) == "");
}

TEST(Cut, FragmentsCanBeCutAgain) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family.name);
    const CutResult first = cut_silently(family.mesh, random_regions(family.mesh, 8, 4, 3));
    ASSERT_EQ(first.status, CutStatus::ok) << first.detail;
    for (const Fragment& fragment : first.fragments) {
      const CutResult second = cut_silently(fragment.mesh, random_regions(fragment.mesh, 8, 4, 4));
      ASSERT_EQ(second.status, CutStatus::ok) << second.detail;
      EXPECT_EQ(broken_cut(fragment.mesh, second), "");
    }
  }
}

void expect_whole(const TriangleMesh& body, const CutResult& result, int region) {
  ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
  ASSERT_EQ(result.fragments.size(), 1u);
  EXPECT_EQ(result.fragments[0].mesh.vertices, body.vertices);
  EXPECT_EQ(result.fragments[0].mesh.faces, body.faces);
  EXPECT_EQ(result.fragments[0].region, region);
  EXPECT_EQ(broken_cut(body, result), "");
}

TEST(Cut, OneRegionGivesTheBodyBack) {
  const TriangleMesh body = hollow_sphere(1, 0.2, 2);
  expect_whole(body, cut_silently(body, random_regions(body, 4, 1, 1)), 0);
}

TEST(Cut, RegionsBesideTheBodyGiveNothing) {
  const TriangleMesh body = sphere(1, 2);
  expect_whole(body, cut_silently(body, halves(body, 0, 1.5)), 0);
  expect_whole(body, cut_silently(body, halves(body, 0, -1.5)), 1);
}

TEST(Cut, ARegionMayGiveSeveralFragments) {
  const TriangleMesh body = torus(1, 0.3, 32, 12);
  // Three slabs across the ring: the middle one, |x| < 1/2, holds two separate arms.
  const CutResult result =
      cut_silently(body, voronoi_regions(padded(bounds(body)), {{-1, 0.001, 0}, {0, 0.002, 0}, {1, 0, 0}}, {0, 1, 2}));
  ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
  std::map<int, int> count;
  for (const Fragment& fragment : result.fragments) ++count[fragment.region];
  EXPECT_EQ(count, (std::map<int, int>{{0, 1}, {1, 2}, {2, 1}}));
}

TEST(Cut, AVoidStaysInTheFragmentAroundIt) {
  const TriangleMesh body = hollow_sphere(1, 0.7, 2);
  const CutResult result = cut_silently(body, halves(body, 1, 0.6));
  ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
  ASSERT_EQ(result.fragments.size(), 2u);
  EXPECT_EQ(inspect(result.fragments[0].mesh).shells, 2);
  EXPECT_EQ(inspect(result.fragments[1].mesh).shells, 1);
  EXPECT_EQ(broken_cut(body, result), "");
}

TEST(Cut, CracksMayLieInFacesOfTheBody) {
  const TriangleMesh body = l_shape();
  for (const int axis : {0, 1}) {
    const CutResult result = cut_silently(body, halves(body, axis, 0));
    ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
    EXPECT_GE(result.nudges, 1);
    // Where the crack lies just outside the face, it also cuts a film off.
    std::map<int, double> volume;
    for (const Fragment& fragment : result.fragments) volume[fragment.region] += mass_properties(fragment.mesh).volume;
    EXPECT_NEAR(volume[0], 2, kNudged);
    EXPECT_NEAR(volume[1], 1, kNudged);
    EXPECT_EQ(broken_cut(body, result), "");
  }
}

TEST(Cut, CracksMayPassThroughVerticesAndEdges) {
  for (const TriangleMesh& body : {box({1, 1, 1}), sphere(1, 2), torus(1, 0.3, 32, 12)}) {
    for (int axis = 0; axis < 3; ++axis) {
      const CutResult result = cut_silently(body, halves(body, axis, 0));
      ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
      EXPECT_EQ(broken_cut(body, result), "");
    }
  }
}

// The boxes between planes at `ticks` on every axis; each is a region.
RegionBoundary lattice_regions(const std::vector<double>& ticks) {
  const int points = static_cast<int>(ticks.size()), cells = points - 1;
  RegionBoundary result;
  result.region_count = cells * cells * cells;
  for (int i = 0; i < points * points * points; ++i) {
    result.vertices.push_back({ticks[i % points], ticks[i / points % points], ticks[i / points / points]});
  }
  const auto cell = [&](const std::array<int, 3>& at) {
    const bool exists = std::all_of(at.begin(), at.end(), [&](int k) { return k >= 0 && k < cells; });
    return exists ? at[0] + cells * (at[1] + cells * at[2]) : -1;
  };
  for (int i = 0; i < points * points * points; ++i) {
    const std::array<int, 3> corner = {i % points, i / points % points, i / points / points};
    const std::array<int, 3> step = {1, points, points * points};
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      if (corner[u] == cells || corner[v] == cells) continue;
      std::array<int, 3> below = corner;
      --below[axis];
      RegionBoundary::Face face{{i, i + step[u], i + step[u] + step[v], i + step[v]}, cell(below), cell(corner)};
      if (face.inside < 0) std::swap(face.inside, face.outside), std::reverse(face.loop.begin(), face.loop.end());
      result.faces.push_back(face);
    }
  }
  return result;
}

// Eight cells meet at every vertex and four at every edge; cracks lie in faces of the bodies and pass through edges.
TEST(Cut, CellsMayBeALattice) {
  const RegionBoundary regions = lattice_regions({-2, -0.5, 0, 0.5, 2});
  for (const TriangleMesh& body : {box({1.5, 1.5, 1.5}), box({1, 1, 1}), l_shape(), sphere(0.8, 2)}) {
    const CutResult result = cut_silently(body, regions);
    ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
    EXPECT_EQ(broken_cut(body, result), "");
  }
}

// The faces between boxes of different regions; nothing outside the lattice.
RegionBoundary lattice_of(const std::vector<double>& ticks, const std::vector<int>& region) {
  RegionBoundary result = lattice_regions(ticks);
  for (RegionBoundary::Face& face : result.faces) {
    face.inside = region[face.inside];
    if (face.outside >= 0) face.outside = region[face.outside];
  }
  result.region_count = 2;
  return result;
}

// Regions that touch themselves along edges and at vertices, in every way in which two regions share eight octants.
TEST(Cut, RegionsMayTouchThemselves) {
  const TriangleMesh body = turned_by(sphere(1, 1), 3);
  const Vec3 center = bounds(body).center();
  for (int mask = 0; mask < 256; ++mask) {
    std::vector<int> region(8);
    for (int i = 0; i < 8; ++i) region[i] = mask >> i & 1;
    RegionBoundary regions = lattice_of({-4, 0.05, 4}, region);
    for (Vec3& x : regions.vertices) x += center;
    const CutResult result = cut_silently(body, regions);
    ASSERT_EQ(result.status, CutStatus::ok) << mask << ": " << result.detail;
    EXPECT_EQ(broken_cut(body, result), "") << mask;
  }
}

// Touching edges may also end inside the body at both ends.
TEST(Cut, RegionsMayTouchThemselvesWithin) {
  const TriangleMesh body = turned_by(sphere(1, 1), 3);
  const Vec3 center = bounds(body).center();
  for (int seed = 0; seed < 200; ++seed) {
    std::vector<int> region(27);
    for (int i = 0; i < 27; ++i) region[i] = random_unit(seed, 1, i) < 0.5;
    RegionBoundary regions = lattice_of({-4, -0.31, 0.35, 4}, region);
    for (Vec3& x : regions.vertices) x += center;
    const CutResult result = cut_silently(body, regions);
    ASSERT_EQ(result.status, CutStatus::ok) << seed << ": " << result.detail;
    EXPECT_EQ(broken_cut(body, result), "") << seed;
  }
}

/// Cuts what touches itself again.
struct Again {
  int touching = 0, fragments = 0;
};

void cut_again(const CutResult& first, Again& again) {
  for (const Fragment& fragment : first.fragments) {
    if (!touches_itself(fragment)) continue;
    ++again.touching;
    const CutResult second = cut_silently(fragment.mesh, random_regions(fragment.mesh, 6, 3, again.touching));
    ASSERT_EQ(second.status, CutStatus::ok) << second.detail;
    double volume = 0;
    for (const Fragment& part : second.fragments) {
      EXPECT_EQ(broken_solid(part), "");
      volume += mass_properties(part.mesh).volume;
    }
    EXPECT_EQ(SharedFaces(second.fragments).unmatched(), "");
    EXPECT_NEAR(volume / mass_properties(fragment.mesh).volume, 1, kMovedApart);
    again.fragments += static_cast<int>(second.fragments.size());
  }
}

TEST(Cut, WhatTouchesItselfCanBeCutAgain) {
  const TriangleMesh body = turned_by(sphere(1, 1), 3);
  const Vec3 center = bounds(body).center();
  Again again;
  for (int mask = 0; mask < 256; ++mask) {
    SCOPED_TRACE(mask);
    std::vector<int> region(8);
    for (int i = 0; i < 8; ++i) region[i] = mask >> i & 1;
    RegionBoundary regions = lattice_of({-4, 0.05, 4}, region);
    for (Vec3& x : regions.vertices) x += center;
    cut_again(cut_silently(body, regions), again);
  }
  for (int seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    std::vector<int> region(27);
    for (int i = 0; i < 27; ++i) region[i] = random_unit(seed, 1, i) < 0.5;
    RegionBoundary regions = lattice_of({-4, -0.31, 0.35, 4}, region);
    for (Vec3& x : regions.vertices) x += center;
    cut_again(cut_silently(body, regions), again);
  }
  EXPECT_GE(again.touching, 100);
  EXPECT_GE(again.fragments, 2 * again.touching);
}

TEST(Cut, IsDeterministicAndOrdered) {
  const TriangleMesh body = torus(1, 0.3, 32, 12);
  const RegionBoundary regions = random_regions(body, 20, 10, 5);
  const CutResult a = cut_silently(body, regions), b = cut_silently(body, regions);
  ASSERT_EQ(a.status, CutStatus::ok);
  EXPECT_TRUE(same(a, b));
  for (std::size_t i = 1; i < a.fragments.size(); ++i) EXPECT_LE(a.fragments[i - 1].region, a.fragments[i].region);
}

TEST(Cut, RefusesBrokenBodies) {
  const TriangleMesh good = sphere(1, 2);
  const RegionBoundary regions = random_regions(good, 6, 3, 1);
  TriangleMesh open = good, inverted = good, duplicated = good, missing = good, crossing = good;
  open.faces.pop_back();
  for (Triangle& face : inverted.faces) std::swap(face[1], face[2]);
  duplicated.vertices[duplicated.faces[0][0]] = duplicated.vertices[duplicated.faces[0][1]];
  missing.faces[3][1] = 100000;
  crossing.vertices[0] *= -1.5;
  for (const TriangleMesh& body : {open, inverted, duplicated, missing, crossing, TriangleMesh{}}) {
    const CutResult result = cut_silently(body, regions);
    EXPECT_EQ(result.status, CutStatus::bad_input) << result.detail;
    EXPECT_FALSE(result.detail.empty());
    EXPECT_TRUE(result.fragments.empty());
  }
}

// The face between two regions nearest to the origin.
int middle_face(const RegionBoundary& regions) {
  int best = -1;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < regions.faces.size(); ++i) {
    Vec3 sum = Vec3::Zero();
    for (const int vertex : regions.faces[i].loop) sum += regions.vertices[vertex];
    const double distance = sum.norm() / static_cast<double>(regions.faces[i].loop.size());
    if (regions.faces[i].outside >= 0 && distance < nearest) nearest = distance, best = static_cast<int>(i);
  }
  return best;
}

TEST(Cut, RefusesBrokenRegions) {
  const TriangleMesh body = sphere(1, 2);
  const RegionBoundary good = random_regions(body, 6, 3, 1);
  const int face = middle_face(good);
  RegionBoundary open = good, unknown = good, flat = good, coincident = good, contradicting = good, twice = good;
  open.faces.erase(open.faces.begin() + face);
  unknown.faces[face].inside = 17;
  flat.faces[face].loop.resize(2);
  coincident.vertices[good.faces[face].loop[0]] = good.vertices[good.faces[face].loop[1]];
  std::swap(contradicting.faces[face].inside, contradicting.faces[face].outside);
  twice.faces.push_back(twice.faces[face]);
  for (const RegionBoundary& regions : {open, unknown, flat, coincident, contradicting, twice}) {
    const CutResult result = cut_silently(body, regions);
    EXPECT_EQ(result.status, CutStatus::bad_input);
    EXPECT_FALSE(result.detail.empty());
    EXPECT_TRUE(result.fragments.empty());
  }
}

TEST(Cut, RefusesCracksThatEndInside) {
  const TriangleMesh body = sphere(1, 2);
  const Box half_space(Vec3(-2, -2, -2), Vec3(2, 2, 0.3));
  const CutResult result = cut_silently(body, voronoi_regions(half_space, {{-1, 0, 0}, {1, 0, 0}}, {0, 1}));
  EXPECT_EQ(result.status, CutStatus::bad_input);
  EXPECT_TRUE(result.fragments.empty());
}

TEST(Cut, IgnoresTheHull) {
  const TriangleMesh body = sphere(1, 2);
  RegionBoundary regions = random_regions(body, 6, 3, 1);
  const CutResult with = cut_silently(body, regions);
  std::erase_if(regions.faces, [](const RegionBoundary::Face& face) { return face.outside < 0; });
  const CutResult without = cut_silently(body, regions);
  ASSERT_EQ(without.status, CutStatus::ok) << without.detail;
  ASSERT_EQ(with.fragments.size(), without.fragments.size());
  for (std::size_t i = 0; i < with.fragments.size(); ++i) {
    EXPECT_EQ(with.fragments[i].mesh.vertices, without.fragments[i].mesh.vertices);
  }
}

TEST(Cut, DoesNotDependOnThreads) {
  const TriangleMesh body = sphere(1, 5);
  const RegionBoundary regions = random_regions(body, 60, 30, 2);
  std::vector<CutResult> results;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(cut_silently(body, regions));
    ASSERT_EQ(results.back().status, CutStatus::ok) << results.back().detail;
    EXPECT_TRUE(same(results.front(), results.back())) << threads;
  }
}

TEST(Cut, StopsWhenAsked) {
  class Stopped final : public Progress {
    void report(std::string_view, double) override {}
    bool cancelled() const override { return true; }
  } progress;
  const TriangleMesh body = sphere(1, 2);
  EXPECT_THROW(cut(body, random_regions(body, 6, 3, 1), {}, progress), Error);
}

}  // namespace
}  // namespace sunder::geometry
