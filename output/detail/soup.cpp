#include "output/detail/soup.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

#include "output/detail/sequence_checks.h"

namespace sunder::output::detail {
namespace {

constexpr double kCrease = 40 * std::numbers::pi / 180;

Vec3 vertex_of(const geometry::TriangleMesh& mesh, std::size_t face, std::size_t corner) {
  return mesh.vertices[static_cast<std::size_t>(mesh.faces[face][corner])];
}

/// Between the edges at each corner.
std::array<double, 3> angles(const geometry::TriangleMesh& mesh, std::size_t face) {
  std::array<double, 3> result;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 x = vertex_of(mesh, face, k);
    const Vec3 a = vertex_of(mesh, face, (k + 1) % 3) - x, b = vertex_of(mesh, face, (k + 2) % 3) - x;
    result[k] = std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return result;
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
  std::vector<std::array<double, 3>> angle(mesh.faces.size());
  for (std::size_t f = 0; f < flat.size(); ++f) {
    flat[f] = geometry::face_normal(mesh, f);
    angle[f] = angles(mesh, f);
  }
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
        if (flat[face].dot(flat[f]) > cosine) sum += angle[face][by.corners[i] % 3] * flat[face];
      }
      if (sum.norm() > 0) normals[f][k] = sum.normalized();
    }
  }
  return normals;
}

/// Faces of one piece that look alike.
struct Part {
  Look look;
  std::vector<int> faces;
  std::size_t first = 0;  ///< triangle of the soup
};

/// What a piece needs of the soup.
struct Share {
  const Piece* piece = nullptr;
  Pose pose;
  std::size_t first_vertex = 0;
  std::vector<Part> parts;
};

class Builder {
 public:
  Builder(const Sequence& sequence, const Frame& frame, const Placement& placement) : placement_(placement) {
    for (const PiecePose& pose : frame.poses) {
      const Piece& piece = sequence.pieces[static_cast<std::size_t>(pose.piece)];
      Share& share = shares_.emplace_back(Share{&piece, pose.pose, 0, {}});
      for (auto& [material, faces] : faces_by_material(piece)) {
        const std::string& name = piece.surface.material_names[static_cast<std::size_t>(material)];
        share.parts.push_back({look_of(name, piece.material), std::move(faces)});
      }
    }
  }

  Soup build() {
    lay_out();
    tbb::parallel_for(std::size_t{0}, shares_.size(), [this](std::size_t i) { fill(shares_[i]); });
    return std::move(soup_);
  }

 private:
  void lay_out() {
    std::size_t vertices = 0, triangles = 0;
    bool coloured = false;
    for (Share& share : shares_) {
      share.first_vertex = vertices;
      vertices += share.piece->mesh.vertices.size();
      coloured = coloured || !share.piece->surface.colour.empty();
    }
    for (const bool clear : {false, true}) {
      for (Share& share : shares_)
        for (Part& part : share.parts) {
          if (part.look.clear != clear) continue;
          part.first = triangles;
          triangles += part.faces.size();
          if (std::find(soup_.looks.begin(), soup_.looks.end(), part.look) == soup_.looks.end())
            soup_.looks.push_back(part.look);
        }
      if (!clear) soup_.opaque = triangles;
    }
    soup_.vertices.resize(vertices);
    soup_.triangles.resize(triangles);
    soup_.normal.resize(triangles);
    soup_.look.resize(triangles);
    soup_.surface.resize(triangles);
    if (coloured) soup_.colour.resize(triangles, {Rgb::Ones(), Rgb::Ones(), Rgb::Ones()});
  }

  void fill(const Share& share) {
    const Piece& piece = *share.piece;
    const Mat3 rotation = share.pose.orientation.toRotationMatrix();
    for (std::size_t v = 0; v < piece.mesh.vertices.size(); ++v)
      soup_.vertices[share.first_vertex + v] =
          (placement_ * (share.pose.position + rotation * piece.mesh.vertices[v])).cast<float>();
    const std::vector<std::array<Vec3, 3>> normals = corner_normals(piece);
    for (const Part& part : share.parts) {
      const auto look = std::find(soup_.looks.begin(), soup_.looks.end(), part.look) - soup_.looks.begin();
      for (std::size_t i = 0; i < part.faces.size(); ++i) {
        const auto face = static_cast<std::size_t>(part.faces[i]);
        const std::size_t t = part.first + i;
        for (std::size_t k = 0; k < 3; ++k) {
          soup_.triangles[t][k] = piece.mesh.faces[face][k] + static_cast<int>(share.first_vertex);
          soup_.normal[t][k] = (rotation * normals[face][k]).cast<float>();
          if (!piece.surface.colour.empty()) soup_.colour[t][k] = piece.surface.colour[face][k].head<3>().cast<float>();
        }
        soup_.look[t] = static_cast<std::uint8_t>(look);
        soup_.surface[t] = 2 * piece.id + (piece.inside(face) ? 1 : 0);
      }
    }
  }

  const Placement& placement_;
  std::vector<Share> shares_;
  Soup soup_;
};

}  // namespace

Soup soup_of(const Sequence& sequence, const Frame& frame, const Placement& placement) {
  return Builder(sequence, frame, placement).build();
}

}  // namespace sunder::output::detail
