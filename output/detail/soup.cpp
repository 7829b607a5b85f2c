#include "output/detail/soup.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "output/detail/sequence_checks.h"

namespace sunder::output::detail {
namespace {

constexpr double kCrease = 40 * std::numbers::pi / 180;

Vec3 vertex_of(const geometry::TriangleMesh& mesh, std::size_t face, std::size_t corner) {
  return mesh.vertices[static_cast<std::size_t>(mesh.faces[face][corner])];
}

double angle_at(const geometry::TriangleMesh& mesh, std::size_t face, std::size_t corner) {
  const Vec3 x = vertex_of(mesh, face, corner);
  const Vec3 a = vertex_of(mesh, face, (corner + 1) % 3) - x, b = vertex_of(mesh, face, (corner + 2) % 3) - x;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Corners of the outside faces by vertex: those of vertex v are corners[first[v]] up to corners[first[v + 1]].
struct CornersByVertex {
  std::vector<std::size_t> first, corners;  ///< a corner is 3 * face + its place in the face
};

CornersByVertex outside_corners(const Piece& piece) {
  CornersByVertex by;
  by.first.assign(piece.mesh.vertices.size() + 1, 0);
  const auto each = [&](const auto& visit) {
    for (std::size_t f = 0; f < piece.mesh.faces.size(); ++f)
      for (std::size_t k = 0; !piece.inside(f) && k < 3; ++k)
        visit(static_cast<std::size_t>(piece.mesh.faces[f][k]), 3 * f + k);
  };
  each([&](std::size_t vertex, std::size_t) { ++by.first[vertex + 1]; });
  for (std::size_t v = 1; v < by.first.size(); ++v) by.first[v] += by.first[v - 1];
  std::vector<std::size_t> next(by.first.begin(), by.first.end() - 1);
  by.corners.resize(by.first.back());
  each([&](std::size_t vertex, std::size_t corner) { by.corners[next[vertex]++] = corner; });
  return by;
}

std::vector<std::array<Vec3, 3>> corner_normals(const Piece& piece) {
  const geometry::TriangleMesh& mesh = piece.mesh;
  if (!piece.surface.normal.empty()) return piece.surface.normal;
  std::vector<Vec3> flat(mesh.faces.size());
  for (std::size_t f = 0; f < flat.size(); ++f) flat[f] = geometry::face_normal(mesh, f);
  const CornersByVertex by = outside_corners(piece);
  std::vector<std::array<Vec3, 3>> normals(mesh.faces.size());
  const double cosine = std::cos(kCrease);
  for (std::size_t f = 0; f < flat.size(); ++f) {
    normals[f].fill(flat[f]);
    for (std::size_t k = 0; !piece.inside(f) && k < 3; ++k) {
      const auto vertex = static_cast<std::size_t>(mesh.faces[f][k]);
      Vec3 sum = Vec3::Zero();
      for (std::size_t i = by.first[vertex]; i < by.first[vertex + 1]; ++i) {
        const std::size_t face = by.corners[i] / 3;
        if (flat[face].dot(flat[f]) > cosine) sum += angle_at(mesh, face, by.corners[i] % 3) * flat[face];
      }
      if (sum.norm() > 0) normals[f][k] = sum.normalized();
    }
  }
  return normals;
}

class Builder {
 public:
  Builder(const Sequence& sequence, const Placement& placement) : sequence_(sequence), placement_(placement) {}

  Soup build(const Frame& frame) {
    for (const PiecePose& pose : frame.poses) coloured_ |= !piece_of(pose).surface.colour.empty();
    std::vector<std::size_t> first;  // vertex of each piece
    for (const PiecePose& pose : frame.poses) {
      first.push_back(soup_.vertices.size());
      for (const Vec3& x : piece_of(pose).mesh.vertices)
        soup_.vertices.push_back((placement_ * (pose.pose * x)).cast<float>());
    }
    for (const bool clear : {false, true}) {
      for (std::size_t i = 0; i < frame.poses.size(); ++i) add(frame.poses[i], first[i], clear);
      if (!clear) soup_.opaque = soup_.triangles.size();
    }
    return std::move(soup_);
  }

 private:
  const Piece& piece_of(const PiecePose& pose) const { return sequence_.pieces[static_cast<std::size_t>(pose.piece)]; }

  std::uint8_t look_index(const Look& look) {
    const auto index = std::find(soup_.looks.begin(), soup_.looks.end(), look) - soup_.looks.begin();
    if (index == std::ssize(soup_.looks)) soup_.looks.push_back(look);
    return static_cast<std::uint8_t>(index);
  }

  void add(const PiecePose& pose, std::size_t first, bool clear) {
    const Piece& piece = piece_of(pose);
    std::vector<std::array<Vec3, 3>> normals;
    for (const auto& [material, faces] : faces_by_material(piece)) {
      const Look look = look_of(piece.surface.material_names[static_cast<std::size_t>(material)], piece.material);
      if (look.clear != clear) continue;
      if (normals.empty()) normals = corner_normals(piece);
      const std::uint8_t index = look_index(look);
      for (const int face : faces) {
        const auto f = static_cast<std::size_t>(face);
        geometry::Triangle triangle = piece.mesh.faces[f];
        for (int& corner : triangle) corner += static_cast<int>(first);
        soup_.triangles.push_back(triangle);
        soup_.look.push_back(index);
        soup_.surface.push_back(2 * piece.id + (piece.inside(f) ? 1 : 0));
        auto& turned = soup_.normal.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) turned[k] = (pose.pose.orientation * normals[f][k]).cast<float>();
        if (coloured_) add_colour(piece, f);
      }
    }
  }

  void add_colour(const Piece& piece, std::size_t face) {
    auto& colour = soup_.colour.emplace_back();
    colour.fill(Rgb::Ones());
    for (std::size_t k = 0; !piece.surface.colour.empty() && k < 3; ++k)
      colour[k] = piece.surface.colour[face][k].head<3>().cast<float>();
  }

  const Sequence& sequence_;
  const Placement& placement_;
  bool coloured_ = false;
  Soup soup_;
};

}  // namespace

Soup soup_of(const Sequence& sequence, const Frame& frame, const Placement& placement) {
  return Builder(sequence, placement).build(frame);
}

}  // namespace sunder::output::detail
