#include "output/detail/vertex_arrays.h"

#include <algorithm>

namespace sunder::output::detail {
namespace {

// What a corner carries beside its vertex; kinds that are not used stay equal everywhere.
struct Corner {
  std::array<float, 2> uv{};
  std::array<float, 3> normal{};
  std::array<float, 4> colour{};
  float damage_time = -1;

  bool operator==(const Corner&) const = default;
};

template <class Carries>
bool any_corner(const std::vector<int>& faces, const Carries& carries) {
  return std::any_of(faces.begin(), faces.end(), [&](int face) {
    for (std::size_t k = 0; k < 3; ++k)
      if (carries(static_cast<std::size_t>(face), k)) return true;
    return false;
  });
}

class Builder {
 public:
  Builder(const Piece& piece, const std::vector<int>& faces, bool uv)
      : piece_(piece), newest_(piece.mesh.vertices.size(), -1) {
    const geometry::SurfaceAttributes& surface = piece.surface;
    has_uv_ = uv;
    has_normal_ = !surface.normal.empty();
    has_colour_ = !surface.colour.empty();
    has_time_ = !surface.damage_time.empty() &&
                any_corner(faces, [&](std::size_t face, std::size_t k) { return surface.damage_time[face][k] >= 0; });
  }

  VertexArrays build(const std::vector<int>& faces) {
    arrays_.corner.reserve(3 * faces.size());
    for (const int face : faces)
      for (std::size_t k = 0; k < 3; ++k)
        arrays_.corner.push_back(index_of(piece_.mesh.faces[static_cast<std::size_t>(face)][k],
                                          corner_at(static_cast<std::size_t>(face), k)));
    for (const Corner& corner : corners_) {
      if (has_uv_) arrays_.uv.push_back(corner.uv);
      if (has_normal_) arrays_.normal.push_back(corner.normal);
      if (has_colour_) arrays_.colour.push_back(corner.colour);
      if (has_time_) arrays_.damage_time.push_back(corner.damage_time);
    }
    return std::move(arrays_);
  }

 private:
  Corner corner_at(std::size_t face, std::size_t k) const {
    const geometry::SurfaceAttributes& surface = piece_.surface;
    Corner corner;
    if (has_uv_ && !surface.uv.empty())
      corner.uv = {static_cast<float>(surface.uv[face][k].x()), static_cast<float>(surface.uv[face][k].y())};
    if (has_normal_) {
      Eigen::Map<Eigen::Vector3f>(corner.normal.data()) = surface.normal[face][k].cast<float>();
    }
    if (has_colour_) Eigen::Map<Eigen::Vector4f>(corner.colour.data()) = surface.colour[face][k].cast<float>();
    if (has_time_) corner.damage_time = static_cast<float>(surface.damage_time[face][k]);
    return corner;
  }

  // Corners at one vertex form a chain, of which few are longer than two.
  std::uint32_t index_of(int vertex, const Corner& corner) {
    int& newest = newest_[static_cast<std::size_t>(vertex)];
    for (int at = newest; at >= 0; at = older_[static_cast<std::size_t>(at)])
      if (corners_[static_cast<std::size_t>(at)] == corner) return static_cast<std::uint32_t>(at);
    older_.push_back(newest);
    newest = static_cast<int>(corners_.size());
    corners_.push_back(corner);
    arrays_.vertex.push_back(vertex);
    return static_cast<std::uint32_t>(newest);
  }

  const Piece& piece_;
  bool has_uv_ = false, has_normal_ = false, has_colour_ = false, has_time_ = false;
  std::vector<int> newest_, older_;
  std::vector<Corner> corners_;
  VertexArrays arrays_;
};

}  // namespace

bool has_texture(const Piece& piece, const std::vector<int>& faces) {
  const auto& uv = piece.surface.uv;
  return !uv.empty() && any_corner(faces, [&](std::size_t face, std::size_t k) { return !uv[face][k].isZero(0); });
}

VertexArrays vertex_arrays(const Piece& piece, const std::vector<int>& faces, bool uv) {
  return Builder(piece, faces, uv).build(faces);
}

}  // namespace sunder::output::detail
