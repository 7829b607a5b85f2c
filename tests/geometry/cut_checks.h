#pragma once
/// What must hold after every cut.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "geometry/cut.h"
#include "geometry/detail/embedding.h"
#include "geometry/inspect.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry {

// Every cut point is rounded once, by about 1e-16 of the body's size, and errors of many points cancel. First and
// second moments weigh them with distances and are compared less strictly.
constexpr double kVolumeKept = 1e-12, kMomentsKept = 1e-9;

inline CutResult cut_silently(const TriangleMesh& body, const RegionBoundary& regions) {
  SilentProgress progress;
  return cut(body, regions, {}, progress);
}

/// chi = V - E + F of the faces' edges and vertices.
inline int euler_characteristic(const TriangleMesh& mesh) {
  std::set<std::pair<int, int>> edges;
  std::set<int> vertices;
  for (const Triangle& face : mesh.faces) {
    for (int k = 0; k < 3; ++k) {
      edges.insert(std::minmax({face[k], face[(k + 1) % 3]}));
      vertices.insert(face[k]);
    }
  }
  return static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.faces.size());
}

inline Mat3 inertia_about(const MassProperties& part, const Vec3& point) {
  const Vec3 r = part.centroid - point;
  return part.inertia + part.volume * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
}

/// Several vertices stand for one point.
inline bool touches_itself(const Fragment& fragment) {
  std::vector<int> ids = fragment.vertex_id;
  std::sort(ids.begin(), ids.end());
  return std::adjacent_find(ids.begin(), ids.end()) != ids.end();
}

inline TriangleMesh welded_by_id(const Fragment& fragment) {
  TriangleMesh result = fragment.mesh;
  std::map<int, int> first;
  for (Triangle& face : result.faces) {
    for (int& vertex : face) vertex = first.emplace(fragment.vertex_id[vertex], vertex).first->second;
  }
  return result;
}

inline std::string broken_solid(const Fragment& fragment) {
  const std::size_t faces = fragment.mesh.faces.size();
  if (fragment.source_face.size() != faces || fragment.crack_face.size() != faces ||
      fragment.neighbour.size() != faces || fragment.vertex_id.size() != fragment.mesh.vertices.size()) {
    return "provenance does not fit the mesh";
  }
  const MeshReport report = inspect(fragment.mesh);
  if (touches_itself(fragment)) {
    if (!is_closed_two_manifold(fragment.mesh)) return report.summary();
    const TriangleMesh welded = welded_by_id(fragment);
    const detail::BoxTree tree(welded.vertices, welded.faces);
    if (detail::intersects_itself(welded, tree)) return "intersects itself";
  } else if (!report.is_solid()) {
    return report.summary();
  }
  const int chi = euler_characteristic(fragment.mesh);
  if (chi % 2 != 0 || chi > 2 * report.shells) return "Euler characteristic " + std::to_string(chi);
  return "";
}

inline std::string lost_moments(const TriangleMesh& body, const std::vector<Fragment>& fragments) {
  const MassProperties whole = mass_properties(body);
  double volume = 0;
  Vec3 moment = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
  for (const Fragment& fragment : fragments) {
    const MassProperties part = mass_properties(fragment.mesh);
    volume += part.volume;
    moment += part.volume * (part.centroid - whole.centroid);
    inertia += inertia_about(part, whole.centroid);
  }
  const double size = bounds(body).diagonal().norm();
  const double lost = std::abs(volume - whole.volume) / whole.volume;
  if (!(lost <= kVolumeKept)) return "volume differs by " + std::to_string(lost * 1e12) + "e-12";
  if (!(moment.norm() <= kMomentsKept * whole.volume * size)) return "centroids do not add up";
  if (!((inertia - whole.inertia).norm() <= kMomentsKept * whole.inertia.norm())) return "inertias do not add up";
  return "";
}

/// The fragment has this very face turned round: by number of its points, and bit for bit.
class SharedFaces {
 public:
  explicit SharedFaces(const std::vector<Fragment>& fragments) : fragments_(fragments) {
    for (const Fragment& fragment : fragments) {
      faces_.emplace_back();
      for (std::size_t i = 0; i < fragment.mesh.faces.size(); ++i) {
        if (fragment.crack_face[i] >= 0) faces_.back()[key(fragment, i)] = fragment.crack_face[i];
      }
    }
  }

  std::string unmatched() const {
    std::map<int, Vec3> position;
    for (std::size_t i = 0; i < fragments_.size(); ++i) {
      const Fragment& fragment = fragments_[i];
      for (std::size_t v = 0; v < fragment.vertex_id.size(); ++v) {
        const auto [known, added] = position.emplace(fragment.vertex_id[v], fragment.mesh.vertices[v]);
        if (known->second != fragment.mesh.vertices[v]) return "one number for two positions";
      }
      for (std::size_t face = 0; face < fragment.mesh.faces.size(); ++face) {
        const int crack = fragment.crack_face[face], other = fragment.neighbour[face];
        if ((crack < 0) != (other < 0) || (crack < 0) == (fragment.source_face[face] < 0)) return "sources contradict";
        if (crack < 0) continue;
        auto [a, b, c] = key(fragment, face);
        const auto found = faces_[other].find(turned_to_lowest({a, c, b}));
        if (found == faces_[other].end() || found->second != crack) return "a face is missing in the neighbour";
      }
    }
    std::set<std::array<double, 3>> distinct;
    for (const auto& [id, x] : position) distinct.insert({x.x(), x.y(), x.z()});
    return distinct.size() == position.size() ? "" : "two numbers for one position";
  }

 private:
  static Triangle turned_to_lowest(Triangle face) {
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    return face;
  }
  static Triangle key(const Fragment& fragment, std::size_t face) {
    Triangle ids = fragment.mesh.faces[face];
    for (int& vertex : ids) vertex = fragment.vertex_id[vertex];
    return turned_to_lowest(ids);
  }

  const std::vector<Fragment>& fragments_;
  std::vector<std::map<Triangle, int>> faces_;
};

/// What is wrong with a cut that claims to be ok; empty if nothing is.
inline std::string broken_cut(const TriangleMesh& body, const CutResult& result) {
  for (const Fragment& fragment : result.fragments) {
    const std::string wrong = broken_solid(fragment);
    if (!wrong.empty()) return wrong;
  }
  for (std::size_t i = 1; i < result.fragments.size(); ++i) {
    if (result.fragments[i].region < result.fragments[i - 1].region) return "fragments are not ordered by region";
  }
  const std::string lost = lost_moments(body, result.fragments);
  return lost.empty() ? SharedFaces(result.fragments).unmatched() : lost;
}

inline bool same(const CutResult& a, const CutResult& b) {
  if (a.fragments.size() != b.fragments.size()) return false;
  for (std::size_t i = 0; i < a.fragments.size(); ++i) {
    const Fragment &x = a.fragments[i], &y = b.fragments[i];
    if (x.mesh.vertices != y.mesh.vertices || x.mesh.faces != y.mesh.faces) return false;
    if (x.source_face != y.source_face || x.region != y.region || x.crack_face != y.crack_face) return false;
    if (x.neighbour != y.neighbour || x.vertex_id != y.vertex_id) return false;
  }
  return true;
}

}  // namespace sunder::geometry
