#include "geometry/attributes.h"

#include <cmath>
#include <map>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/error.h"
#include "geometry/detail/mean_value.h"
#include "geometry/level_set_cut.h"
#include "geometry/primitives.h"
#include "tests/geometry/cut_checks.h"
#include "tests/geometry/shapes.h"
#include "tests/geometry/voronoi_regions.h"

namespace sunder::geometry {
namespace {

// Bodies, functions and their gradients are of size 1 and cut points are rounded to 1e-16, so what is linear stays so
// within this.
constexpr double kLinear = 1e-12;
// Relative. A sliver's area is a difference of products of its (unit) coordinates, so its error is absolute.
constexpr double kArea = 1e-12;

/// A function that is linear in space, so in every face.
struct Linear {
  Eigen::Matrix<double, 2, 3> gradient;
  Uv operator()(const Vec3& x) const { return gradient * x + Uv(0.3, -0.7); }
};

Linear some_linear() {
  Linear f;
  f.gradient << 0.3, -0.8, 0.5, 1.1, 0.2, -0.4;
  return f;
}

Vec3 flat_normal(const TriangleMesh& mesh, const Triangle& face) {
  const Vec3& a = mesh.vertices[face[0]];
  return (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a).normalized();
}

SurfaceAttributes textured(const TriangleMesh& mesh, const Linear& f) {
  SurfaceAttributes result;
  result.material_names = {"glaze", "base"};
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const auto& [a, b, c] = mesh.faces[i];
    result.uv.push_back({f(mesh.vertices[a]), f(mesh.vertices[b]), f(mesh.vertices[c])});
    const Vec3 normal = flat_normal(mesh, mesh.faces[i]);
    // Tilted differently at every corner, as smooth normals are.
    result.normal.push_back(
        {(normal + 0.1 * Vec3::UnitX()).normalized(), normal, (normal + 0.2 * Vec3::UnitY()).normalized()});
    result.material.push_back(i % 2);
  }
  return result;
}

double uv_area(const std::array<Uv, 3>& uv) {
  const Uv p = uv[1] - uv[0], q = uv[2] - uv[0];
  return std::abs(p.x() * q.y() - p.y() * q.x()) / 2;
}

double area(const TriangleMesh& mesh, const Triangle& face) {
  const Vec3& a = mesh.vertices[face[0]];
  return (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a).norm() / 2;
}

std::vector<TriangleMesh> families() {
  return {box({1, 0.6, 0.3}), sphere(0.5, 2), torus(0.4, 0.15, 24, 10), cup(0.1, 0.006), hollow_sphere(0.5, 0.1, 2)};
}

// What is wrong with the outside of a fragment of a body with linear uv.
std::string broken_outside(const TriangleMesh& body, const SurfaceAttributes& of_body, const Linear& f,
                           const Fragment& fragment, const SurfaceAttributes& got) {
  for (std::size_t i = 0; i < fragment.mesh.faces.size(); ++i) {
    const int source = fragment.source_face[i];
    if (source < 0) continue;
    if (got.material[i] != of_body.material[source]) return "material";
    for (int k = 0; k < 3; ++k) {
      const Vec3& x = fragment.mesh.vertices[fragment.mesh.faces[i][k]];
      if (!((got.uv[i][k] - f(x)).norm() <= kLinear)) return "uv is not the function";
      if (!(std::abs(got.normal[i][k].norm() - 1) <= kLinear)) return "normal is not of unit length";
      for (int j = 0; j < 3; ++j) {
        if (x != body.vertices[body.faces[source][j]]) continue;
        if (got.uv[i][k] != of_body.uv[source][j]) return "uv of a corner of the body changed";
        if (got.normal[i][k] != of_body.normal[source][j]) return "normal of a corner of the body changed";
      }
    }
  }
  return "";
}

std::string broken_inside(const Fragment& fragment, const SurfaceAttributes& got) {
  for (std::size_t i = 0; i < fragment.mesh.faces.size(); ++i) {
    if (fragment.source_face[i] >= 0) continue;
    if (got.material_names[got.material[i]] != "inside") return "material";
    const double in_space = area(fragment.mesh, fragment.mesh.faces[i]);
    if (!(std::abs(uv_area(got.uv[i]) - in_space) <= kArea)) return "areas differ";
    // Rounding turns slivers.
    if (in_space > 1e-8 && !(got.normal[i][0].dot(flat_normal(fragment.mesh, fragment.mesh.faces[i])) > 1 - 1e-9)) {
      return "normal does not point outward";
    }
  }
  return "";
}

/// Of corners on cracks, by crack face and number of the point.
struct Corner {
  Uv uv;
  Vec3 normal;
  double time;
};

std::string disagreement(const std::vector<Fragment>& fragments, const std::vector<SurfaceAttributes>& attributes) {
  std::map<std::array<int, 3>, Corner> known;
  int met = 0;
  for (std::size_t f = 0; f < fragments.size(); ++f) {
    const Fragment& fragment = fragments[f];
    for (std::size_t i = 0; i < fragment.mesh.faces.size(); ++i) {
      if (fragment.crack_face[i] < 0) continue;
      for (int k = 0; k < 3; ++k) {
        const int id = fragment.vertex_id[fragment.mesh.faces[i][k]];
        const Corner corner{attributes[f].uv[i][k], attributes[f].normal[i][k], attributes[f].damage_time[i][k]};
        for (const int side : {fragment.region, fragments[fragment.neighbour[i]].region}) {
          const auto [at, added] = known.emplace(std::array{fragment.crack_face[i], id, side}, corner);
          if (added) continue;
          ++met;
          if (at->second.uv != corner.uv || at->second.time != corner.time) return "neighbours differ";
          if (at->second.normal != corner.normal && at->second.normal != -corner.normal) return "normals differ";
        }
      }
    }
  }
  return met > 0 ? "" : "nothing compared";
}

std::vector<double> times_of(const RegionBoundary& regions, const Vec3& gradient) {
  std::vector<double> times;
  for (const Vec3& x : regions.vertices) times.push_back(10 + gradient.dot(x));
  return times;
}

TEST(Attributes, ComeOverTheCutOfFamiliesOfShapes) {
  const Linear f = some_linear();
  for (const TriangleMesh& body : families()) {
    const SurfaceAttributes of_body = textured(body, f);
    const RegionBoundary regions = random_regions(body, 18, 6, 1);
    const std::vector<double> times = times_of(regions, {0.5, -0.25, 1});
    const CutResult result = cut_silently(body, regions);
    ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
    ASSERT_EQ(result.nudges, 0);
    std::vector<SurfaceAttributes> all;
    for (const Fragment& fragment : result.fragments) {
      all.push_back(carry(body, of_body, fragment, regions, {.damage_time = times}));
      ASSERT_TRUE(fits(all.back(), fragment.mesh));
      EXPECT_EQ(broken_outside(body, of_body, f, fragment, all.back()), "");
      EXPECT_EQ(broken_inside(fragment, all.back()), "");
      EXPECT_EQ(all.back().material_names, (std::vector<std::string>{"glaze", "base", "inside"}));
    }
    EXPECT_EQ(disagreement(result.fragments, all), "");
  }
}

RC_GTEST_PROP(Attributes, ComeOverAnyCut, ()) {
  const TriangleMesh body = transformed(arbitrary_shape(), 0.5 * arbitrary_rotation(), arbitrary_vector(0.2));
  Linear f = some_linear();
  for (int axis = 0; axis < 3; ++axis) f.gradient.col(axis) = arbitrary_vector(1).head<2>();
  const SurfaceAttributes of_body = textured(body, f);
  const int cells = *rc::gen::inRange(2, 12);
  const RegionBoundary regions =
      random_regions(body, cells, *rc::gen::inRange(1, cells + 1), *rc::gen::arbitrary<std::uint32_t>());
  const CutResult result = cut_silently(body, regions);
  RC_PRE(result.status == CutStatus::ok && result.nudges == 0);
  for (const Fragment& fragment : result.fragments) {
    const SurfaceAttributes got = carry(body, of_body, fragment, regions);
    RC_ASSERT(broken_outside(body, of_body, f, fragment, got) == "");
    RC_ASSERT(broken_inside(fragment, got) == "");
  }
}

TEST(Attributes, AnUncutBodyKeepsItsOwnBitForBit) {
  const TriangleMesh body = hollow_sphere(0.5, 0.1, 2);
  const RegionBoundary regions = random_regions(body, 4, 1, 1);
  const CutResult result = cut_silently(body, regions);
  ASSERT_EQ(result.fragments.size(), 1u);
  const SurfaceAttributes of_body = textured(body, some_linear());
  const std::vector<double> times(regions.vertices.size(), 1);
  const InsideSettings all{.uv = true, .normal = true, .damage_time = times};
  EXPECT_TRUE(carry(body, of_body, result.fragments[0], regions, all) == of_body);
  EXPECT_TRUE(carry(body, {}, result.fragments[0], regions, all) == SurfaceAttributes{});
}

TEST(Attributes, ColoursStayWithinThoseOfTheirFace) {
  const TriangleMesh body = sphere(0.5, 2);
  SurfaceAttributes of_body;
  for (std::size_t i = 0; i < body.faces.size(); ++i) {
    of_body.colour.push_back({Colour(1, 0, 0, 1), Colour(0, 1, 0, 1), Colour(0, 0, 1, 1)});
  }
  const RegionBoundary regions = random_regions(body, 18, 18, 1);
  int between = 0;
  for (const Fragment& fragment : cut_silently(body, regions).fragments) {
    for (const std::array<Colour, 3>& face : carry(body, of_body, fragment, regions).colour) {
      for (const Colour& colour : face) {
        EXPECT_GE(colour.minCoeff(), 0);
        EXPECT_LE(colour.maxCoeff(), 1);
        EXPECT_EQ(colour.w(), 1);
        if (colour == Colour::Ones()) continue;  // on a crack
        EXPECT_NEAR(colour.head<3>().sum(), 1, kLinear);
        between += (colour.head<3>().array() > 0).count() > 1;
      }
    }
  }
  EXPECT_GT(between, 100) << "cuts pass between corners";
}

TEST(Attributes, NormalsHaveUnitLengthBetweenOppositeOnes) {
  const TriangleMesh body = box({1, 1, 1});
  SurfaceAttributes of_body;
  for (std::size_t i = 0; i < body.faces.size(); ++i) {
    of_body.normal.push_back({Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitX()});
  }
  // Cuts edges in the middle, where the normals of their ends cancel.
  const RegionBoundary halves = voronoi_regions(padded(bounds(body)), {{-0.25, 0, 0}, {0.25, 0, 0}}, {0, 1});
  int between = 0;
  for (const Fragment& fragment : cut_silently(body, halves).fragments) {
    for (const std::array<Vec3, 3>& face : carry(body, of_body, fragment, halves).normal) {
      for (const Vec3& normal : face) {
        EXPECT_NEAR(normal.norm(), 1, kLinear);
        between += std::abs(normal.x()) != 1;
      }
    }
  }
  EXPECT_GT(between, 0);
}

TEST(Attributes, ABodyWithoutAnyGetsMaterialsAndWhatIsAsked) {
  const TriangleMesh body = box({1, 0.6, 0.3});
  const RegionBoundary regions = random_regions(body, 8, 4, 2);
  for (const Fragment& fragment : cut_silently(body, regions).fragments) {
    const SurfaceAttributes plain = carry(body, {}, fragment, regions);
    EXPECT_TRUE(plain.uv.empty() && plain.normal.empty() && plain.damage_time.empty());
    EXPECT_EQ(plain.material_names, (std::vector<std::string>{"outside", "inside"}));
    const SurfaceAttributes asked = carry(body, {}, fragment, regions, {.uv = true, .normal = true});
    ASSERT_TRUE(fits(asked, fragment.mesh));
    EXPECT_EQ(broken_inside(fragment, asked), "");
    for (std::size_t i = 0; i < fragment.mesh.faces.size(); ++i) {
      EXPECT_EQ(asked.material[i], fragment.source_face[i] < 0 ? 1 : 0);
      if (fragment.source_face[i] < 0) continue;
      EXPECT_EQ(asked.uv[i][2], Uv(0, 0));
      EXPECT_EQ(asked.normal[i][0], flat_normal(body, body.faces[fragment.source_face[i]]));
    }
  }
}

TEST(Attributes, FragmentsOfFragmentsShareTheInsideMaterial) {
  const TriangleMesh body = sphere(0.5, 2);
  const SurfaceAttributes of_body = textured(body, some_linear());
  const RegionBoundary first = random_regions(body, 8, 4, 3);
  const Fragment piece = cut_silently(body, first).fragments[0];
  const std::vector<double> times(first.vertices.size(), 0.5);
  const SurfaceAttributes of_piece = carry(body, of_body, piece, first, {.damage_time = times});
  const RegionBoundary second = random_regions(piece.mesh, 8, 4, 4);
  for (const Fragment& fragment : cut_silently(piece.mesh, second).fragments) {
    const SurfaceAttributes got = carry(piece.mesh, of_piece, fragment, second);
    EXPECT_EQ(got.material_names, (std::vector<std::string>{"glaze", "base", "inside"}));
    for (std::size_t i = 0; i < fragment.mesh.faces.size(); ++i) {
      const int source = fragment.source_face[i];
      const bool old_crack = source >= 0 && piece.source_face[source] < 0;
      EXPECT_EQ(got.material[i] == 2, source < 0 || old_crack);
      EXPECT_NEAR(got.damage_time[i][1], old_crack ? 0.5 : -1, kLinear);
    }
  }
}

// Times that are linear in space come out so on plane triangles; in between them neighbours agree along edges.
TEST(Attributes, DamageTimesAreInterpolated) {
  const TriangleMesh body = sphere(0.5, 3);
  RegionBoundary regions = random_regions(body, 12, 6, 5);
  RegionBoundary triangles = regions;
  triangles.faces.clear();
  for (const RegionBoundary::Face& face : regions.faces) {
    for (std::size_t i = 1; i + 1 < face.loop.size(); ++i) {
      triangles.faces.push_back({{face.loop[0], face.loop[i], face.loop[i + 1]}, face.inside, face.outside});
    }
  }
  const Vec3 gradient(0.5, -0.25, 1);
  const std::vector<double> times = times_of(triangles, gradient);
  const CutResult result = cut_silently(body, triangles);
  ASSERT_EQ(result.status, CutStatus::ok) << result.detail;
  for (const Fragment& fragment : result.fragments) {
    const SurfaceAttributes got = carry(body, {}, fragment, triangles, {.damage_time = times});
    for (std::size_t i = 0; i < fragment.mesh.faces.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const double wanted = 10 + gradient.dot(fragment.mesh.vertices[fragment.mesh.faces[i][k]]);
        // Times are about 10; flat triangles of the fans lose digits.
        EXPECT_NEAR(got.damage_time[i][k], fragment.source_face[i] < 0 ? wanted : -1, 1e-9);
      }
    }
  }
}

TEST(Attributes, UnknownDamageTimesAreLeftOut) {
  const TriangleMesh body = sphere(0.5, 2);
  const RegionBoundary regions = random_regions(body, 8, 4, 3);
  std::vector<double> times(regions.vertices.size(), -1);
  const Fragment piece = cut_silently(body, regions).fragments[0];
  for (const auto& of_face : carry(body, {}, piece, regions, {.damage_time = times}).damage_time) {
    EXPECT_EQ(of_face, (std::array<double, 3>{-1, -1, -1}));
  }
  for (std::size_t i = 0; i < times.size(); i += 2) times[i] = 3;
  for (const auto& of_face : carry(body, {}, piece, regions, {.damage_time = times}).damage_time) {
    for (const double time : of_face) EXPECT_TRUE(time == -1 || std::abs(time - 3) < kLinear) << time;
  }
}

TEST(Attributes, TexturePlanesMayBeGiven) {
  const TriangleMesh body = box({1, 0.6, 0.3});
  const RegionBoundary regions = random_regions(body, 8, 4, 2);
  const std::vector<Vec3> normals = face_normals(regions), one(regions.faces.size(), Vec3::UnitX());
  for (const Fragment& fragment : cut_silently(body, regions).fragments) {
    const InsideSettings own{.uv = true, .texture_normal = normals};
    EXPECT_TRUE(carry(body, {}, fragment, regions, own) == carry(body, {}, fragment, regions, {.uv = true}));
    const SurfaceAttributes flat = carry(body, {}, fragment, regions, {.uv = true, .texture_normal = one});
    for (std::size_t i = 0; i < fragment.mesh.faces.size(); ++i) {
      if (fragment.source_face[i] >= 0) continue;
      const Vec3& x = fragment.mesh.vertices[fragment.mesh.faces[i][0]];
      EXPECT_NEAR(flat.uv[i][0].y(), x.y(), kLinear);
      EXPECT_NEAR(std::abs(flat.uv[i][0].x()), std::abs(x.z()), kLinear);
    }
  }
}

TEST(Attributes, LevelSetFragmentsHaveThemToo) {
  const TriangleMesh body = sphere(0.5, 3);
  const Linear f = some_linear();
  const RegionBoundary regions = random_regions(body, 4, 3, 1);
  SilentProgress progress;
  const double voxel = 0.02;
  const CutResult result = level_set_cut(body, regions, {voxel}, progress);
  ASSERT_GE(result.fragments.size(), 2u);
  for (const Fragment& fragment : result.fragments) {
    const SurfaceAttributes got = carry(body, textured(body, f), fragment, regions);
    ASSERT_TRUE(fits(got, fragment.mesh));
    for (std::size_t i = 0; i < fragment.mesh.faces.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const Vec3& x = fragment.mesh.vertices[fragment.mesh.faces[i][k]];
        if (fragment.source_face[i] < 0) {
          EXPECT_TRUE(got.uv[i][k].allFinite());
        } else {
          // A corner may lie a few voxels beside the face that is nearest to its triangle.
          EXPECT_LT((got.uv[i][k] - f(x)).norm(), 4 * voxel * f.gradient.norm());
        }
      }
    }
  }
}

TEST(Attributes, RefusesWhatDoesNotFit) {
  const TriangleMesh body = box({1, 1, 1});
  const RegionBoundary regions = random_regions(body, 4, 2, 1);
  const Fragment piece = cut_silently(body, regions).fragments[0];
  SurfaceAttributes short_uv = textured(body, some_linear()), nameless = short_uv;
  short_uv.uv.pop_back();
  nameless.material_names.pop_back();
  EXPECT_THROW(carry(body, short_uv, piece, regions), Error);
  EXPECT_THROW(carry(body, nameless, piece, regions), Error);
  const std::vector<double> one_time = {1};
  EXPECT_THROW(carry(body, {}, piece, regions, {.damage_time = one_time}), Error);
  EXPECT_THROW(carry(sphere(1, 0), {}, cut_silently(sphere(1, 3), regions).fragments[0], regions), Error);
}

RC_GTEST_PROP(MeanValue, ReproducesLinearFunctions, ()) {
  const int count = *rc::gen::inRange(3, 9);
  std::vector<Uv> loop;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * (i + arbitrary_real(0, 0.8)) / count;
    loop.push_back({std::cos(angle), std::sin(angle)});
  }
  // Anywhere inside, on an edge or at a vertex.
  const int at = *rc::gen::inRange(0, count);
  const double along = *rc::gen::elementOf(std::vector<double>{0, 0.3, 1});
  const Uv on_edge = loop[at] + along * (loop[(at + 1) % count] - loop[at]);
  Uv x = on_edge;
  if (*rc::gen::arbitrary<bool>()) {
    Uv centre = Uv::Zero();
    for (const Uv& vertex : loop) centre += vertex / count;
    x += arbitrary_real(0, 1) * (centre - x);
  }
  const std::vector<double> weights = detail::mean_value_weights(loop, x);
  Uv sum = Uv::Zero();
  double total = 0;
  for (int i = 0; i < count; ++i) {
    RC_ASSERT(weights[i] > -1e-9);
    sum += weights[i] * loop[i];
    total += weights[i];
  }
  RC_ASSERT(std::abs(total - 1) < 1e-12);
  // Vertices of the loop may be as close as 0.02 to each other, which costs digits.
  RC_ASSERT((sum - x).norm() < 1e-9);
}

}  // namespace
}  // namespace sunder::geometry
