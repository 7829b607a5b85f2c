/// What a renderer gets of the pieces of a frame.
#include "output/detail/soup.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/primitives.h"
#include "tests/output/example_sequence.h"

namespace sunder::output::detail {
namespace {

constexpr double kSingle = 1e-6;  // rounding of numbers of order one

Sequence of_mesh(geometry::TriangleMesh mesh, const Pose& pose = {}) {
  Sequence sequence;
  Piece& piece = sequence.pieces.emplace_back();
  piece.mesh = std::move(mesh);
  piece.material = "plaster";
  piece.source_face.assign(piece.mesh.faces.size(), 0);
  piece.surface.material.assign(piece.mesh.faces.size(), 0);
  piece.surface.material_names = {"plaster_outside"};
  sequence.frames.push_back({0, {{0, pose, {}}}});
  return sequence;
}

Soup soup_of_first_frame(const Sequence& sequence) { return soup_of(sequence, sequence.frames[0], {}); }

double largest_turn(const Soup& soup, const auto& expected) {
  double largest = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      largest = std::max<double>(largest, (soup.normal[t][k] - expected(t, k)).norm());
  return largest;
}

Vec3f flat_normal(const Soup& soup, std::size_t t) {
  const auto vertex = [&](std::size_t k) { return soup.vertices[static_cast<std::size_t>(soup.triangles[t][k])]; };
  return (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).normalized();
}

TEST(Soup, NormalsAreSmoothOnASphereAndFlatOnABox) {
  const Soup sphere = soup_of_first_frame(of_mesh(geometry::sphere(1, 3)));
  const auto radial = [&](std::size_t t, std::size_t k) {
    return Vec3f(sphere.vertices[static_cast<std::size_t>(sphere.triangles[t][k])]);
  };
  // Faces are 8 degrees wide; weights by angle leave a tenth of that at the vertices where five faces meet.
  EXPECT_LT(largest_turn(sphere, radial), 0.8 * std::numbers::pi / 180);
  const Soup box = soup_of_first_frame(of_mesh(geometry::box({1, 2, 3})));
  EXPECT_LT(largest_turn(box, [&](std::size_t t, std::size_t) { return flat_normal(box, t); }), kSingle);
}

TEST(Soup, CrackFacesAreFlatAndDoNotBendTheSkin) {
  Sequence sequence = of_mesh(geometry::sphere(1, 3));
  for (std::size_t f = 0; f < sequence.pieces[0].mesh.faces.size(); f += 2) sequence.pieces[0].source_face[f] = -1;
  const Soup soup = soup_of_first_frame(sequence);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const bool inside = soup.surface[t] % 2 == 1;
    EXPECT_EQ(inside, t % 2 == 0);
    if (!inside) continue;
    for (const Vec3f& normal : soup.normal[t]) EXPECT_LT((normal - flat_normal(soup, t)).norm(), kSingle);
  }
}

TEST(Soup, OwnNormalsAndPlacesTurnWithThePiece) {
  const Pose pose{Vec3(3, -1, 2), Quat(Eigen::AngleAxisd(0.7, Vec3(1, 1, 0).normalized()))};
  Sequence sequence = of_mesh(geometry::box({1, 1, 1}), pose);
  const Vec3 own = Vec3(3, 4, 0) / 5;
  sequence.pieces[0].surface.normal.assign(12, {own, own, own});
  const Placement placement{Vec3(3, -1, 2), 2};
  const Soup soup = soup_of(sequence, sequence.frames[0], placement);
  const Vec3f turned = (pose.orientation * own).cast<float>();
  EXPECT_LT(largest_turn(soup, [&](std::size_t, std::size_t) { return turned; }), kSingle);
  for (const Vec3f& x : soup.vertices) EXPECT_NEAR(x.norm(), std::sqrt(3.0), 2 * kSingle);
}

TEST(Soup, OpaqueTrianglesComeFirst) {
  Sequence sequence = of_mesh(geometry::box({1, 1, 1}));
  sequence.pieces.push_back(sequence.pieces[0]);
  sequence.pieces[0].material = "glass";
  sequence.pieces[0].surface.material_names = {"glass_outside"};
  sequence.pieces[1].id = 1;
  sequence.frames[0].poses.push_back({1, {}, {}});
  const Soup soup = soup_of_first_frame(sequence);
  ASSERT_EQ(soup.triangles.size(), 24u);
  EXPECT_EQ(soup.opaque, 12u);
  for (std::size_t t = 0; t < 24; ++t) {
    EXPECT_EQ(soup.looks[soup.look[t]].clear, t >= soup.opaque);
    EXPECT_EQ(soup.surface[t] / 2, t < soup.opaque ? 1 : 0);
  }
}

}  // namespace
}  // namespace sunder::output::detail
