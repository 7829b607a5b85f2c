#include "output/dataset.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/random.h"
#include "geometry/mass_properties.h"
#include "output/npz.h"

namespace sunder::output {
namespace {

constexpr std::uint64_t point_stream = 0xda7a;

template <typename Vector>
void append(std::vector<float>& list, const Vector& x) {
  for (int k = 0; k < 3; ++k) list.push_back(static_cast<float>(x[k]));
}

Eigen::Matrix4d matrix_of(const Pose& pose, const Vec3& centre) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = pose.orientation.toRotationMatrix();
  m.topRightCorner<3, 1>() = pose.position + pose.orientation * centre;
  return m;
}

/// Sums of what stands before.
std::vector<std::int32_t> offsets(const std::vector<std::int32_t>& counts) {
  std::vector<std::int32_t> sums = {0};
  for (const std::int32_t count : counts) sums.push_back(sums.back() + count);
  return sums;
}

struct Pieces {
  std::vector<float> vertices;
  std::vector<std::int32_t> faces, source, vertex_counts, face_counts;
  std::vector<std::uint8_t> inside;
  std::vector<double> transforms, volumes, masses, areas, inside_areas;

  void add(const Piece& piece, const PiecePose& pose, const Vec3& centre) {
    const auto first = static_cast<std::int32_t>(vertices.size() / 3);
    for (const Vec3& x : piece.mesh.vertices) append(vertices, (x - centre).eval());
    for (std::size_t f = 0; f < piece.mesh.faces.size(); ++f) {
      for (const int vertex : piece.mesh.faces[f]) faces.push_back(first + vertex);
      source.push_back(piece.source_face[f]);
      inside.push_back(piece.inside(f) ? 1 : 0);
    }
    vertex_counts.push_back(static_cast<std::int32_t>(piece.mesh.vertices.size()));
    face_counts.push_back(static_cast<std::int32_t>(piece.mesh.faces.size()));
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> m = matrix_of(pose.pose, centre);
    transforms.insert(transforms.end(), m.data(), m.data() + m.size());
    volumes.push_back(piece.volume);
    masses.push_back(piece.mass);
    areas.push_back(piece.area);
    inside_areas.push_back(piece.inside_area);
  }

  void write(Npz& npz) const {
    const std::size_t count = volumes.size();
    npz.add("vertices", {vertices.size() / 3, 3}, vertices);
    npz.add("faces", {faces.size() / 3, 3}, faces);
    npz.add("vertex_offsets", {count + 1}, offsets(vertex_counts));
    npz.add("face_offsets", {count + 1}, offsets(face_counts));
    npz.add("face_inside", {inside.size()}, inside);
    npz.add("face_source", {source.size()}, source);
    npz.add("transforms", {count, 4, 4}, transforms);
    npz.add("volumes", {count}, volumes);
    npz.add("masses", {count}, masses);
    npz.add("areas", {count}, areas);
    npz.add("inside_areas", {count}, inside_areas);
  }
};

struct Points {
  std::vector<float> points, normals;
  std::vector<std::int32_t> piece;
  std::vector<std::uint8_t> inside;

  void add(const Piece& from, std::int32_t number, std::size_t face, const Pose& pose, double u, double v) {
    const auto& [a, b, c] = from.mesh.faces[face];
    const double root = std::sqrt(u);
    const Vec3 x =
        (1 - root) * from.mesh.vertices[a] + root * (1 - v) * from.mesh.vertices[b] + root * v * from.mesh.vertices[c];
    append(points, (pose.position + pose.orientation * x).eval());
    append(normals, (pose.orientation * geometry::face_normal(from.mesh, face)).eval());
    piece.push_back(number);
    inside.push_back(from.inside(face) ? 1 : 0);
  }

  void write(Npz& npz) const {
    npz.add("points", {piece.size(), 3}, points);
    npz.add("point_normals", {piece.size(), 3}, normals);
    npz.add("point_piece", {piece.size()}, piece);
    npz.add("point_inside", {piece.size()}, inside);
  }
};

Points drawn_points(const Sequence& sequence, const Frame& frame, int count, std::uint64_t seed) {
  std::vector<std::pair<std::int32_t, std::size_t>> faces;
  std::vector<double> sums;
  double sum = 0;
  for (std::size_t p = 0; p < frame.poses.size(); ++p) {
    const Piece& piece = sequence.pieces[static_cast<std::size_t>(frame.poses[p].piece)];
    for (std::size_t f = 0; f < piece.mesh.faces.size(); ++f) {
      faces.emplace_back(static_cast<std::int32_t>(p), f);
      sums.push_back(sum += geometry::face_area(piece.mesh, f));
    }
  }
  Points points;
  for (int i = 0; i < count && sum > 0; ++i) {
    const auto unit = [&](int k) { return random_unit(seed, point_stream, static_cast<std::uint64_t>(3 * i + k)); };
    const auto at = std::upper_bound(sums.begin(), sums.end() - 1, sum * unit(0)) - sums.begin();
    const auto& [p, f] = faces[static_cast<std::size_t>(at)];
    const PiecePose& pose = frame.poses[static_cast<std::size_t>(p)];
    points.add(sequence.pieces[static_cast<std::size_t>(pose.piece)], p, f, pose.pose, unit(1), unit(2));
  }
  return points;
}

}  // namespace

std::string pieces_npz(const Sequence& sequence, std::size_t frame, int points, std::uint64_t seed) {
  Pieces pieces;
  for (const PiecePose& pose : sequence.frames[frame].poses) {
    const Piece& piece = sequence.pieces[static_cast<std::size_t>(pose.piece)];
    pieces.add(piece, pose, geometry::mass_properties(piece.mesh).centroid);
  }
  Npz npz;
  pieces.write(npz);
  if (points > 0) drawn_points(sequence, sequence.frames[frame], points, seed).write(npz);
  return npz.bytes();
}

std::string mesh_npz(const geometry::TriangleMesh& mesh) {
  std::vector<float> vertices;
  std::vector<std::int32_t> faces;
  for (const Vec3& x : mesh.vertices) append(vertices, x);
  for (const auto& face : mesh.faces) faces.insert(faces.end(), face.begin(), face.end());
  Npz npz;
  npz.add("vertices", {mesh.vertices.size(), 3}, vertices);
  npz.add("faces", {mesh.faces.size(), 3}, faces);
  return npz.bytes();
}

}  // namespace sunder::output
