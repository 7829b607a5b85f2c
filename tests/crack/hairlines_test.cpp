/// Partial cracks as gaps: what the cut makes of them, and which of them are left out.
#include "crack/hairlines.h"

#include <numbers>

#include <gtest/gtest.h>

#include "crack/detail/panels.h"
#include "geometry/inspect.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "tests/crack/shapes.h"

namespace sunder::crack::test {
namespace {

constexpr int n = 24;
constexpr double h = 1.0 / n;
constexpr double jitter = 0.25;        // of the points, in spacings
constexpr double width = 0.02 * h;     // of the gaps: far below the faces, so few panels are left out
constexpr double end = 0.6;            // of the wavy sheet
constexpr double volume_kept = 1e-12;  // geometry::CutSettings
constexpr double area_bound = 0.3;     // gaps close at the rim, and rim panels that need room are left out
constexpr double halving_bound = 0.15;

double wave(const Vec3& x) { return x.z() - 0.5 - 0.1 * std::sin(5 * x.x()); }

geometry::TriangleMesh body() {
  return geometry::transformed(geometry::box(Vec3::Ones()), Mat3::Identity(), Vec3::Constant(0.5));
}

Extraction extracted(const Inside& damaged, std::uint64_t seed = 1) {
  return run(cloud(unit_cube(), h, everywhere, damaged, jitter, seed));
}

Extraction wavy_sheet(std::uint64_t seed = 1) {
  return extracted([](const Vec3& x) { return std::abs(wave(x)) < 1.5 * h && x.x() < end; }, seed);
}

/// A crack through the cube, and a partial one that branches off it.
Extraction crack_with_branch() {
  return extracted([](const Vec3& x) {
    return std::abs(x.z() - 0.3) < 1.5 * h || (std::abs(x.x() - 0.5) < 1.5 * h && x.z() > 0.3 && x.z() < 0.75);
  });
}

double partial_area_in_body(const Extraction& extraction) {
  double area = 0;
  for (const CrackFace& face : extraction.faces) {
    const std::vector<Vec3> polygon = clipped(polygon_of(extraction, face), unit_cube());
    if (face.kind == FaceKind::partial && polygon.size() >= 3) area += area_vector(polygon).norm();
  }
  return area;
}

/// The unit cube, cut along an extraction with hairlines.
struct Shown {
  Hairlines lines;
  geometry::RegionBoundary boundary;
  geometry::CutResult cut;
  double kept = 0, gap = 0;  // volumes

  Shown(const Extraction& extraction, double gap_width) : boundary(extraction.boundary) {
    lines = add_hairlines(extraction, gap_width, boundary);
    SilentProgress progress;
    cut = geometry::cut(body(), boundary, {}, progress);
    for (const geometry::Fragment& fragment : cut.fragments)
      (fragment.region < lines.first_gap ? kept : gap) += geometry::mass_properties(fragment.mesh).volume;
  }

  bool ok() const { return cut.status == geometry::CutStatus::ok; }
  bool all_closed() const {
    return std::all_of(cut.fragments.begin(), cut.fragments.end(), [](const geometry::Fragment& fragment) {
      return geometry::is_closed_two_manifold(fragment.mesh);
    });
  }
};

TEST(Hairlines, AWavySheetBecomesAGapOfItsWidthTimesItsArea) {
  const Extraction extraction = wavy_sheet();
  ASSERT_EQ(extraction.region_count, 1);
  const Shown shown(extraction, width);
  ASSERT_TRUE(shown.ok()) << shown.cut.detail;
  EXPECT_EQ(shown.lines.first_gap, 1);
  EXPECT_GE(shown.lines.gaps, 1);
  EXPECT_EQ(shown.boundary.region_count, 1 + shown.lines.gaps);
  EXPECT_EQ(shown.lines.faces + shown.lines.left_out, count(extraction, FaceKind::partial));
  EXPECT_TRUE(shown.all_closed());
  EXPECT_NEAR(shown.kept + shown.gap, 1, volume_kept);
  EXPECT_GT(shown.gap, 0);
  const double whole = width * partial_area_in_body(extraction);
  EXPECT_NEAR(shown.gap, whole, area_bound * whole);
}

TEST(Hairlines, HalfTheWidthIsHalfTheVolume) {
  const Extraction extraction = wavy_sheet();
  const Shown wide(extraction, width), narrow(extraction, width / 2);
  ASSERT_TRUE(wide.ok() && narrow.ok()) << wide.cut.detail << narrow.cut.detail;
  EXPECT_NEAR(narrow.gap, wide.gap / 2, halving_bound * wide.gap / 2);
  EXPECT_GE(narrow.lines.faces, wide.lines.faces);
}

TEST(Hairlines, TheyOpenIntoTheBodyWithoutDividingIt) {
  const Shown shown(wavy_sheet(), width);
  ASSERT_TRUE(shown.ok()) << shown.cut.detail;
  int pieces = 0;
  for (const geometry::Fragment& fragment : shown.cut.fragments) pieces += fragment.region < shown.lines.first_gap;
  EXPECT_EQ(pieces, 1);
}

TEST(Hairlines, WithoutPartialFacesThereIsNothingToAdd) {
  const Extraction extraction = extracted([](const Vec3& x) { return std::abs(x.z() - 0.5 - 0.37 * h) < 1.5 * h; });
  ASSERT_EQ(extraction.region_count, 2);
  Extraction clean = extraction;
  std::erase_if(clean.faces, [](const CrackFace& face) { return face.kind == FaceKind::partial; });
  geometry::RegionBoundary boundary = clean.boundary;
  const Hairlines lines = add_hairlines(clean, width, boundary);
  EXPECT_EQ(lines.gaps, 0);
  EXPECT_EQ(lines.faces, 0);
  EXPECT_EQ(lines.left_out, 0);
  EXPECT_EQ(lines.first_gap, 2);
  EXPECT_EQ(boundary.vertices, clean.boundary.vertices);
  EXPECT_EQ(boundary.faces.size(), clean.boundary.faces.size());
  EXPECT_EQ(boundary.region_count, 2);
}

TEST(Hairlines, NothingDamagedIsOneRegionWithoutGaps) {
  geometry::RegionBoundary boundary;
  const Hairlines lines = add_hairlines(extracted(nowhere), width, boundary);
  EXPECT_EQ(lines.gaps, 0);
  EXPECT_EQ(boundary.region_count, 1);
  EXPECT_TRUE(boundary.faces.empty());
}

TEST(Hairlines, ACrackThroughTheBodyAndItsPartialBranchBothShow) {
  const Extraction extraction = crack_with_branch();
  ASSERT_EQ(extraction.region_count, 2);
  ASSERT_GT(count(extraction, FaceKind::partial), 0);
  const Shown shown(extraction, width);
  ASSERT_TRUE(shown.ok()) << shown.cut.detail;
  EXPECT_EQ(shown.lines.first_gap, 2);
  EXPECT_GT(shown.lines.faces, count(extraction, FaceKind::partial) / 2);
  EXPECT_GT(shown.gap, 0);
  EXPECT_TRUE(shown.all_closed());
  EXPECT_NEAR(shown.kept + shown.gap, 1, volume_kept);

  // The crack faces are those without gaps, in front of the new ones.
  const auto& without = extraction.boundary;
  ASSERT_GT(shown.boundary.faces.size(), without.faces.size());
  for (std::size_t i = 0; i < without.faces.size(); ++i) {
    ASSERT_EQ(shown.boundary.faces[i].loop, without.faces[i].loop);
    ASSERT_EQ(shown.boundary.faces[i].inside, without.faces[i].inside);
    ASSERT_EQ(shown.boundary.faces[i].outside, without.faces[i].outside);
  }
  SilentProgress progress;
  const geometry::CutResult plain = geometry::cut(body(), without, {}, progress);
  std::map<int, double> volumes;  // by region; a gap is in the region around it
  for (const geometry::Fragment& fragment : plain.fragments)
    volumes[fragment.region] += geometry::mass_properties(fragment.mesh).volume;
  for (const geometry::Fragment& fragment : shown.cut.fragments) {
    if (fragment.region >= shown.lines.first_gap) continue;
    volumes[fragment.region] -= geometry::mass_properties(fragment.mesh).volume;
  }
  double lost = 0;
  for (const auto& [region, volume] : volumes) {
    EXPECT_GE(volume, -volume_kept);
    lost += volume;
  }
  EXPECT_NEAR(lost, shown.gap, volume_kept);
}

TEST(Hairlines, TheySurviveOnABoundaryWithMoreVertices) {
  // As surface detail makes it: the extraction's vertices first, then others.
  const Extraction extraction = crack_with_branch();
  geometry::RegionBoundary finer = extraction.boundary, plain = extraction.boundary;
  for (int i = 0; i < 5; ++i) finer.vertices.push_back(Vec3::Constant(3 + i));
  add_hairlines(extraction, width, finer);
  add_hairlines(extraction, width, plain);
  ASSERT_EQ(finer.faces.size(), plain.faces.size());
  for (std::size_t f = 0; f < plain.faces.size(); ++f)
    for (std::size_t i = 0; i < plain.faces[f].loop.size(); ++i)
      ASSERT_EQ(finer.vertices[static_cast<std::size_t>(finer.faces[f].loop[i])],
                plain.vertices[static_cast<std::size_t>(plain.faces[f].loop[i])]);
}

TEST(Hairlines, NeverMakeAnInvalidFragment) {
  constexpr double spacing = 1.0 / 12;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const DamageField field = cloud(
        unit_cube(), spacing, everywhere,
        [&](const Vec3& x) { return std::abs(wave(x)) < 1.5 * spacing && x.x() < end; }, jitter, seed);
    const Extraction extraction = run(field);
    long shown_before = 0;
    for (const double share : {0.3, 0.1, 2e-2, 1e-3, 1e-4}) {  // the first leave little room
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", width " << share << " spacings");
      const Shown shown(extraction, share * spacing);
      ASSERT_TRUE(shown.ok()) << shown.cut.detail;
      EXPECT_TRUE(shown.all_closed());
      EXPECT_NEAR(shown.kept + shown.gap, 1, volume_kept);
      EXPECT_EQ(shown.gap > 0, shown.lines.faces > 0);
      EXPECT_GE(shown.lines.faces, shown_before);  // narrower gaps have more room
      shown_before = shown.lines.faces;
    }
    EXPECT_GT(shown_before, 0);
  }
}

using detail::Panel;

/// Unit squares in the plane z = 0: panel i covers x from i to i + 1.
std::vector<Vec3> strip_vertices(int squares) {
  std::vector<Vec3> vertices;
  for (int i = 0; i <= squares; ++i)
    for (int j = 0; j < 2; ++j) vertices.emplace_back(i, j, 0);
  return vertices;
}

std::vector<Panel> strip_panels(int squares) {
  std::vector<Panel> panels;
  for (int i = 0; i < squares; ++i) panels.push_back({{2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1}, 0});
  return panels;
}

TEST(Panels, AShortEdgeTakesItsPanelsAlong) {
  std::vector<Vec3> vertices = strip_vertices(3);
  vertices[4] = vertices[2] + Vec3(1e-3, 0, 0);  // the middle panel's lower edge
  const std::vector<Panel> panels = detail::without_short_edges(strip_panels(3), vertices, 1e-2);
  ASSERT_EQ(panels.size(), 3u);
  EXPECT_EQ(panels[1].loop, (std::vector<int>{2, 5, 3}));
  EXPECT_EQ(panels[2].loop, (std::vector<int>{2, 6, 7, 5}));
  EXPECT_EQ(detail::without_short_edges(strip_panels(3), vertices, 1e-4)[1].loop.size(), 4u);
}

TEST(Panels, AThinPanelGoesAndItsNeighboursMeet) {
  std::vector<Vec3> vertices = strip_vertices(3);
  vertices[4] = vertices[2] + Vec3(1e-3, 0, 0);
  vertices[5] = vertices[3] + Vec3(1e-3, 0, 0);
  const std::vector<Panel> panels = detail::without_short_edges(strip_panels(3), vertices, 1e-2);
  ASSERT_EQ(panels.size(), 2u);
  const auto by_edge = detail::panels_by_edge(panels);
  EXPECT_EQ(by_edge.at({2, 3}), (std::vector<int>{0, 1}));
  EXPECT_EQ(detail::find_sheets(panels, by_edge).count, 1);
}

TEST(Panels, OfTwoPanelsBetweenTheSameCornersOneStays) {
  std::vector<Vec3> vertices = strip_vertices(1);
  vertices.emplace_back(0.5, 0.5, 0.1);
  vertices.emplace_back(0.5, 0.5, 0.1 + 1e-3);
  const std::vector<Panel> panels = {{{0, 2, 4}, 0}, {{2, 0, 5}, 0}, {{2, 3, 4}, 0}};
  const std::vector<Panel> kept = detail::without_short_edges(panels, vertices, 1e-2);
  EXPECT_EQ(kept.size(), 3u);  // nothing joins the tops
  const std::vector<Panel> joined =
      detail::without_short_edges({{{0, 2, 4}, 0}, {{2, 0, 5}, 0}, {{4, 2, 5}, 0}}, vertices, 1e-2);
  ASSERT_EQ(joined.size(), 1u);
  EXPECT_EQ(joined[0].loop, (std::vector<int>{0, 2, 4}));
}

TEST(Panels, ABranchGoesAndTheStraightCrackStays) {
  std::vector<Vec3> vertices = strip_vertices(2);
  std::vector<Panel> panels = strip_panels(2);
  vertices.emplace_back(1.2, 0, 1);
  vertices.emplace_back(1.2, 1, 1);
  panels.insert(panels.begin(), Panel{{2, 6, 7, 3}, 0});
  const std::vector<Panel> kept = detail::without_branches(panels, vertices);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].loop, panels[1].loop);
  EXPECT_EQ(kept[1].loop, panels[2].loop);
}

TEST(Panels, PanelsTurnToFitTheirSheet) {
  std::vector<Panel> panels = strip_panels(3);
  std::reverse(panels[1].loop.begin(), panels[1].loop.end());
  const detail::Sheets sheets = detail::find_sheets(panels, detail::panels_by_edge(panels));
  EXPECT_EQ(sheets.count, 1);
  EXPECT_EQ(sheets.turned, (std::vector<int>{0, 1, 0}));
  EXPECT_TRUE(sheets.one_sided.empty());
}

/// A band of squares around the Z axis of which the section turns by `half_turns` half turns.
Extraction band(int squares, int half_turns) {
  Extraction extraction;
  for (int i = 0; i < squares; ++i) {
    const double around = 2 * std::numbers::pi * i / squares, tilt = std::numbers::pi * half_turns * i / squares;
    const Vec3 out(std::cos(around), std::sin(around), 0);
    const Vec3 across = std::cos(tilt) * out + std::sin(tilt) * Vec3::UnitZ();
    for (const double side : {-0.1, 0.1})
      extraction.vertices.push_back(Vec3::Constant(0.5) + 0.3 * out + side * across);
  }
  for (int i = 0; i < squares; ++i) {
    const bool twisted = i + 1 == squares && half_turns % 2 != 0;
    const int next = 2 * ((i + 1) % squares);
    CrackFace face;
    face.loop = {2 * i, next + (twisted ? 1 : 0), next + (twisted ? 0 : 1), 2 * i + 1};
    face.kind = FaceKind::partial;
    extraction.faces.push_back(face);
  }
  return extraction;
}

/// A square sheet of 4 x 4 panels across the middle of the cube, at this height.
void add_square(Extraction& extraction, double height) {
  const int first = static_cast<int>(extraction.vertices.size());
  for (int i = 0; i <= 4; ++i)
    for (int j = 0; j <= 4; ++j) extraction.vertices.emplace_back(0.3 + 0.1 * i, 0.3 + 0.1 * j, height);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const int a = first + 5 * i + j;
      CrackFace face;
      face.loop = {a, a + 5, a + 6, a + 1};
      face.kind = FaceKind::partial;
      extraction.faces.push_back(face);
    }
}

TEST(Hairlines, SheetsNearerThanTheGapsAreWideLoseThePanelsThatWouldCross) {
  constexpr double apart = 0.01;
  Extraction extraction;
  add_square(extraction, 0.5);
  // Tilted: gaps 1.5 times as wide as the least distance cross on one side only.
  add_square(extraction, 0.5 + apart);
  for (std::size_t v = 25; v < 50; ++v) extraction.vertices[v].z() += 0.02 * (extraction.vertices[v].x() - 0.3);
  const Shown narrow(extraction, apart / 2), wide(extraction, 1.5 * apart);
  ASSERT_TRUE(narrow.ok()) << narrow.cut.detail;
  EXPECT_EQ(narrow.lines.left_out, 0);
  EXPECT_EQ(narrow.lines.gaps, 2);
  ASSERT_TRUE(wide.ok()) << wide.cut.detail;
  EXPECT_GT(wide.lines.left_out, 0);
  EXPECT_GT(wide.lines.faces, 0);
  EXPECT_TRUE(wide.all_closed());
}

/// The cube in two parts at z = 0.5, and a sheet so far above the crack.
Extraction parts_with_sheet(double apart) {
  Extraction extraction;
  add_square(extraction, 0.5 + apart);
  extraction.region_count = 2;
  for (CrackFace& face : extraction.faces) face.region_a = face.region_b = 1;
  geometry::RegionBoundary boundary{extraction.vertices, {}, 2};
  const int first = static_cast<int>(boundary.vertices.size());
  for (const double z : {-0.5, 0.5, 1.5})
    for (const Vec3& corner : {Vec3(-0.5, -0.5, z), Vec3(1.5, -0.5, z), Vec3(1.5, 1.5, z), Vec3(-0.5, 1.5, z)})
      boundary.vertices.push_back(corner);
  const auto quad = [&](int a, int b, int c, int d, int inside, int outside) {
    boundary.faces.push_back({{first + a, first + b, first + c, first + d}, inside, outside});
  };
  quad(4, 5, 6, 7, 0, 1);
  quad(3, 2, 1, 0, 0, -1);
  quad(8, 9, 10, 11, 1, -1);
  for (int i = 0; i < 4; ++i) {
    quad(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i, 0, -1);
    quad(4 + i, 4 + (i + 1) % 4, 8 + (i + 1) % 4, 8 + i, 1, -1);
  }
  extraction.boundary = boundary;
  extraction.vertices = boundary.vertices;
  return extraction;
}

TEST(Hairlines, ASheetThatDetailMovedTheCrackPastIsLeftOut) {
  const Extraction extraction = parts_with_sheet(0.01);
  for (const bool past : {false, true}) {
    geometry::RegionBoundary moved = extraction.boundary;
    for (Vec3& x : moved.vertices)
      if (x.z() == 0.5) x.z() = past ? 0.53 : 0.48;
    const Hairlines lines = add_hairlines(extraction, 1e-3, moved);
    EXPECT_EQ(lines.gaps, past ? 0 : 1);
    EXPECT_EQ(lines.left_out, past ? 16 : 0);
    SilentProgress progress;
    const geometry::CutResult cut = geometry::cut(body(), moved, {}, progress);
    EXPECT_EQ(cut.status, geometry::CutStatus::ok) << cut.detail;
  }
}

TEST(Hairlines, APanelThatWouldReachThroughACrackBetweenRegionsIsLeftOut) {
  constexpr double apart = 0.01;
  const Extraction extraction = parts_with_sheet(apart);
  const Shown narrow(extraction, apart), wide(extraction, 4 * apart);
  ASSERT_TRUE(narrow.ok()) << narrow.cut.detail;
  EXPECT_EQ(narrow.lines.left_out, 0);
  EXPECT_EQ(narrow.lines.gaps, 1);
  ASSERT_TRUE(wide.ok()) << wide.cut.detail;
  EXPECT_GT(wide.lines.left_out, 0);
  EXPECT_NEAR(wide.kept + wide.gap, 1, volume_kept);
}

TEST(Hairlines, ATwoSidedBandIsOneGap) {
  const Shown shown(band(24, 0), 1e-3);
  ASSERT_TRUE(shown.ok()) << shown.cut.detail;
  EXPECT_EQ(shown.lines.gaps, 1);
  EXPECT_EQ(shown.lines.left_out, 0);
  EXPECT_TRUE(shown.all_closed());
  EXPECT_GT(shown.gap, 0);
}

TEST(Hairlines, AMoebiusBandIsOpenedWhereItComesBackToItself) {
  const Extraction extraction = band(24, 1);
  std::vector<Panel> panels = detail::shown_panels(extraction);
  EXPECT_FALSE(detail::find_sheets(panels, detail::panels_by_edge(panels)).one_sided.empty());
  const Shown shown(extraction, 1e-3);
  ASSERT_TRUE(shown.ok()) << shown.cut.detail;
  EXPECT_GE(shown.lines.left_out, 1);
  EXPECT_LE(shown.lines.left_out, 4);  // the seam, and what its loss makes too narrow
  EXPECT_TRUE(shown.all_closed());
  EXPECT_GT(shown.gap, 0);
  EXPECT_NEAR(shown.kept + shown.gap, 1, volume_kept);
}

}  // namespace
}  // namespace sunder::crack::test
