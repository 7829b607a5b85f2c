#include "crack/detail/relief.h"

#include "crack/detail/clearance.h"
#include "crack/detail/crossings.h"

namespace sunder::crack::detail {

namespace {

constexpr double steepest = 1.0;
constexpr double least_cosine = 0.3;
constexpr int halvings = 8;      // of a vertex, before it goes back to where it was
constexpr double sliver = 0.01;  // height over longest edge: the normal of a flatter triangle means nothing

class Settling {
 public:
  Settling(const FineMesh& mesh, const Sheets& sheets, const std::vector<Vec3>& normals, std::vector<double> heights)
      : mesh_(mesh),
        sheets_(sheets),
        normals_(normals),
        checked_(heights.size(), 0),
        times_lowered_(heights.size(), 0) {
    relief_.height = std::move(heights);
    relief_.vertices = mesh.vertices;
    for (const auto& [a, b, c] : mesh.faces) {
      const Vec3 u = mesh.vertices[b] - mesh.vertices[a], v = mesh.vertices[c] - mesh.vertices[a];
      const Vec3 n = u.cross(v);
      const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
      flat_normal_.push_back(n.norm() > sliver * longest ? Vec3(n.normalized()) : Vec3::Zero());
    }
    apply();
  }

  /// Every pass lowers some vertex, and a vertex only so many times: it ends.
  void settle(Progress& progress) {
    for (int pass = 0;; ++pass) {
      progress.checkpoint("detail", 0.7 + 0.3 * (1 - 1.0 / (1 + pass)));
      std::vector<int> bad = folded();
      if (bad.empty()) bad = crossing();
      if (bad.empty()) break;
      if (!lower(bad)) break;
      apply();
    }
    for (int times : times_lowered_) relief_.lowered += times > 0;
  }

  Relief take() { return std::move(relief_); }

 private:
  void apply() {
    limit_slope(mesh_, sheets_.edges, steepest, relief_.height);
    for (std::size_t v = 0; v < relief_.height.size(); ++v)
      relief_.vertices[v] = mesh_.vertices[v] + relief_.height[v] * normals_[v];
  }

  bool moved(int f) const {
    const auto& [a, b, c] = mesh_.faces[f];
    return relief_.height[a] != 0 || relief_.height[b] != 0 || relief_.height[c] != 0;
  }

  std::vector<int> folded() const {
    std::vector<int> result;
    for (int f = 0; f < static_cast<int>(mesh_.faces.size()); ++f) {
      if (!moved(f) || flat_normal_[f].isZero()) continue;
      const auto& [a, b, c] = mesh_.faces[f];
      const auto& x = relief_.vertices;
      const Vec3 n = (x[b] - x[a]).cross(x[c] - x[a]);
      if (!(n.dot(flat_normal_[f]) > least_cosine * n.norm())) result.push_back(f);
    }
    return result;
  }

  /// Only triangles that moved since the last time can have come to cross another one.
  std::vector<int> crossing() {
    std::vector<char> moves(mesh_.faces.size(), 0);
    for (std::size_t f = 0; f < moves.size(); ++f)
      for (int v : mesh_.faces[f]) moves[f] |= relief_.height[v] != checked_[v];
    checked_ = relief_.height;
    std::vector<int> result;
    for (const auto& [f, g] : crossings(mesh_, relief_.vertices, moves)) {
      result.push_back(f);
      result.push_back(g);
    }
    return result;
  }

  /// False if nothing was left to lower.
  bool lower(const std::vector<int>& faces) {
    std::vector<int> vertices;
    for (int f : faces) vertices.insert(vertices.end(), mesh_.faces[f].begin(), mesh_.faces[f].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    bool any = false;
    for (int v : vertices) {
      if (relief_.height[v] == 0) continue;
      any = true;
      relief_.height[v] = ++times_lowered_[v] > halvings ? 0 : relief_.height[v] / 2;
    }
    return any;
  }

  const FineMesh& mesh_;
  const Sheets& sheets_;
  const std::vector<Vec3>& normals_;
  std::vector<Vec3> flat_normal_;  // of triangles before they move; zero for slivers
  std::vector<double> checked_;    // heights at the last check of crossings
  std::vector<int> times_lowered_;
  Relief relief_;
};

}  // namespace

Relief displaced(const FineMesh& mesh, const Sheets& sheets, const std::vector<Vec3>& normals,
                 std::vector<double> heights, Progress& progress) {
  Settling settling(mesh, sheets, normals, std::move(heights));
  settling.settle(progress);
  return settling.take();
}

}  // namespace sunder::crack::detail
