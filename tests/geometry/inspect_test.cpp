#include "geometry/inspect.h"

#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "geometry/primitives.h"
#include "tests/geometry/shapes.h"

namespace sunder::geometry {
namespace {

TriangleMesh open_cube() {
  TriangleMesh cube = box({1, 1, 1});
  cube.faces.resize(cube.faces.size() - 2);
  return cube;
}

TEST(Inspect, EmptyMesh) {
  const MeshReport report = inspect({});
  EXPECT_FALSE(report.is_solid());
  EXPECT_EQ(report.summary(), "empty: no faces");
}

TEST(Inspect, Cube) {
  const MeshReport report = inspect(box({1, 2, 3}));
  EXPECT_TRUE(report.is_solid());
  EXPECT_EQ(report.shells, 1);
  EXPECT_DOUBLE_EQ(report.volume, 6);
  EXPECT_EQ(report.box.max(), Vec3(0.5, 1, 1.5));
  EXPECT_EQ(report.summary(), "closed solid");
}

TEST(Inspect, SingleTriangle) {
  const MeshReport report = inspect({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  EXPECT_EQ(report.boundary_edges, 3);
  EXPECT_EQ(report.boundary_loops, 1);
  EXPECT_EQ(report.summary(), "open: 3 boundary edges in 1 hole");
}

TEST(Inspect, OpenCube) {
  const MeshReport report = inspect(open_cube());
  EXPECT_EQ(report.boundary_edges, 4);
  EXPECT_EQ(report.boundary_loops, 1);
  EXPECT_EQ(report.self_intersections, 0);
  EXPECT_FALSE(report.is_solid());
}

TEST(Inspect, InvertedCube) {
  const MeshReport report = inspect(inside_out(box({1, 1, 1})));
  EXPECT_EQ(report.inverted_shells, 1);
  EXPECT_EQ(report.summary(), "1 inverted shell");
}

TEST(Inspect, CrossingCubes) {
  const MeshReport report = inspect(together(box({1, 1, 1}), moved(box({1, 1, 1}), {0.5, 0.4, 0.3})));
  EXPECT_EQ(report.shells, 2);
  EXPECT_GT(report.self_intersections, 0);
  EXPECT_FALSE(report.is_solid());
}

TEST(Inspect, FaceThroughItsOwnShell) {
  TriangleMesh spiked = sphere(1, 2);
  spiked.vertices[0] *= -3;  // a vertex pulled out through the far side
  const MeshReport report = inspect(spiked);
  EXPECT_EQ(report.shells, 1);
  EXPECT_GT(report.self_intersections, 0);
}

TEST(Inspect, RepeatedFaces) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.faces.push_back(mesh.faces[0]);
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(report.non_manifold_edges, 3);
  EXPECT_EQ(report.self_intersections, -1);
}

TEST(Inspect, NonManifoldEdge) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.vertices.emplace_back(2, 2, 2);
  mesh.faces.push_back({mesh.faces[0][0], mesh.faces[0][1], 8});
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(report.non_manifold_edges, 1);
  EXPECT_EQ(report.boundary_edges, 2);
}

TEST(Inspect, NeighboursThatTurnOppositeWays) {
  TriangleMesh mesh = box({1, 1, 1});
  std::swap(mesh.faces[0][0], mesh.faces[0][1]);
  EXPECT_EQ(inspect(mesh).non_manifold_edges, 3);
}

TEST(Inspect, CubesThatShareAVertex) {
  // Corner 7 of the first cube is corner 0 of the second.
  TriangleMesh mesh = together(box({1, 1, 1}), moved(box({1, 1, 1}), {1, 1, 1}));
  for (Triangle& face : mesh.faces) {
    for (int& vertex : face) vertex = vertex == 8 ? 7 : vertex;
  }
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(report.non_manifold_vertices, 1);
  EXPECT_EQ(report.non_manifold_edges, 0);
  EXPECT_EQ(report.shells, 2);
}

TEST(Inspect, BadPositionsAndIndices) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.vertices[7].y() = std::numeric_limits<double>::quiet_NaN();
  mesh.faces.push_back({0, 1, 99});
  mesh.faces.push_back({0, 1, -1});
  mesh.faces.push_back({0, 1, 1});
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(report.bad_vertices, 1);
  EXPECT_GE(report.degenerate_faces, 3);
  EXPECT_EQ(report.self_intersections, -1);
  EXPECT_TRUE(report.box.min().allFinite());
  EXPECT_FALSE(report.is_solid());
}

TEST(Inspect, FaceOfZeroArea) {
  // The side from vertex 0 to vertex 1 of a tetrahedron has a vertex in its middle that only a sliver uses.
  const TriangleMesh mesh{{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
                          {{0, 2, 1}, {0, 4, 3}, {4, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 1, 4}}};
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(report.degenerate_faces, 1);
  EXPECT_EQ(report.boundary_edges, 0);
}

TEST(Inspect, FlatSheetIsNoSolid) {
  const MeshReport report = inspect({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}});
  EXPECT_FALSE(report.is_solid());
}

TEST(Inspect, NestedShellsAlternate) {
  const TriangleMesh hollow = hollow_sphere(1, 0.2, 2);
  EXPECT_TRUE(inspect(hollow).is_solid());
  EXPECT_EQ(inspect(hollow).summary(), "closed solid of 2 shells");
  EXPECT_TRUE(inspect(together(hollow, sphere(0.5, 2))).is_solid());
  EXPECT_EQ(inspect(together(hollow, inside_out(sphere(0.5, 2)))).inverted_shells, 1);
  EXPECT_EQ(inspect(together(sphere(1, 2), sphere(0.5, 2))).inverted_shells, 1);
}

RC_GTEST_PROP(Inspect, SolidsStaySolidUnderSimilarities, ()) {
  const Mat3 map = std::exp(arbitrary_real(-7, 7)) * arbitrary_rotation();
  const MeshReport report = inspect(transformed(arbitrary_shape(), map, arbitrary_vector(5)));
  RC_ASSERT(report.is_solid());
}

}  // namespace
}  // namespace sunder::geometry
