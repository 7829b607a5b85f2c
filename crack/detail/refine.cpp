#include "crack/detail/refine.h"

#include <string>

namespace sunder::crack::detail {

namespace {

using geometry::Triangle;

/// Midpoints of the edges that are split in a round.
class Midpoints {
 public:
  Midpoints(std::vector<Vec3>& vertices, const Sizing& sizing) : vertices_(vertices), sizing_(sizing) {}

  /// The vertex that splits an edge, -1 where it stays.
  int operator()(int a, int b) {
    if (!sizing_.too_long(vertices_[a], vertices_[b])) return -1;
    const int number = table_.insert(edge_key(a, b));
    if (number == static_cast<int>(ids_.size())) {
      ids_.push_back(static_cast<int>(vertices_.size()));
      vertices_.push_back((vertices_[a] + vertices_[b]) / 2);
    }
    return ids_[number];
  }

  bool any() const { return !ids_.empty(); }

 private:
  std::vector<Vec3>& vertices_;
  const Sizing& sizing_;
  IndexTable table_;
  std::vector<int> ids_;
};

/// Calls emit(triangle) for the parts of `t`; `m` holds the vertices that split its edges 01, 12 and 20.
template <typename Emit>
void split(const std::vector<Vec3>& x, const Triangle& t, const Triangle& m, Emit&& emit) {
  const int count = (m[0] >= 0) + (m[1] >= 0) + (m[2] >= 0);
  if (count == 0) return emit(t);
  if (count == 3) {
    for (int i = 0; i < 3; ++i) emit(Triangle{t[i], m[i], m[(i + 2) % 3]});
    return emit(m);
  }
  int i = 0;  // one split edge: 01 of the turned triangle; two: 01 and 12
  while (count == 1 ? m[i] < 0 : m[(i + 2) % 3] >= 0) ++i;
  const int a = t[i], b = t[(i + 1) % 3], c = t[(i + 2) % 3], ab = m[i], bc = m[(i + 1) % 3];
  if (count == 1) {
    emit(Triangle{a, ab, c});
    return emit(Triangle{ab, b, c});
  }
  emit(Triangle{ab, b, bc});
  if ((x[a] - x[bc]).squaredNorm() <= (x[ab] - x[c]).squaredNorm()) {
    emit(Triangle{a, ab, bc});
    emit(Triangle{a, bc, c});
  } else {
    emit(Triangle{a, ab, c});
    emit(Triangle{ab, bc, c});
  }
}

/// One round; false when nothing was too long.
bool halve_long_edges(FineMesh& mesh, const Sizing& sizing) {
  Midpoints midpoint(mesh.vertices, sizing);
  FineMesh next;
  next.faces.reserve(2 * mesh.faces.size());
  next.source.reserve(2 * mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Triangle& t = mesh.faces[f];
    const Triangle m = {midpoint(t[0], t[1]), midpoint(t[1], t[2]), midpoint(t[2], t[0])};
    split(mesh.vertices, t, m, [&](const Triangle& part) {
      next.faces.push_back(part);
      next.source.push_back(mesh.source[f]);
    });
  }
  if (!midpoint.any()) return false;
  mesh.faces = std::move(next.faces);
  mesh.source = std::move(next.source);
  return true;
}

void halve_all(FineMesh& mesh, const Sizing& sizing, int most, Progress& progress) {
  while (halve_long_edges(mesh, sizing)) {
    progress.checkpoint("detail", 0.1);
    if (mesh.faces.size() > static_cast<std::size_t>(most))
      throw Error(ErrorKind::usage, "surface detail: edges of " + std::to_string(sizing.edge) + " m make more than " +
                                        std::to_string(most) + " triangles of the cracks; use a longer edge length");
  }
}

/// The triangles of one source face, with their neighbours across edges inside it.
class Patch {
 public:
  Patch(const std::vector<Vec3>& x, Triangle* faces, int count) : x_(x), faces_(faces), across_(3 * count, -1) {
    struct HalfEdge {
      std::uint64_t key;
      int corner;
    };
    std::vector<HalfEdge> edges;
    edges.reserve(3 * count);
    for (int c = 0; c < 3 * count; ++c) edges.push_back({edge_key(from(c), to(c)), c});
    std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
      return a.key != b.key ? a.key < b.key : a.corner < b.corner;
    });
    for (std::size_t i = 1; i < edges.size(); ++i)
      if (edges[i].key == edges[i - 1].key) join(edges[i - 1].corner, edges[i].corner);
  }

  /// Flips until all inner edges are locally Delaunay. Rounding cannot keep it going for ever: flips are counted.
  void flip_all() {
    std::vector<int> open;
    for (int c = static_cast<int>(across_.size()) - 1; c >= 0; --c)
      if (across_[c] > c) open.push_back(c);
    std::size_t left = 20 * across_.size();
    while (!open.empty() && left-- > 0) {
      const int c = open.back();
      open.pop_back();
      if (across_[c] < 0 || !wants_flip(c)) continue;
      const int d = across_[c];
      flip(c, d);
      for (int e : {next(c), next(next(c)), next(d), next(next(d)), c, d})
        if (across_[e] >= 0) open.push_back(e);
    }
  }

 private:
  static int next(int c) { return c % 3 == 2 ? c - 2 : c + 1; }
  int& vertex(int c) { return faces_[c / 3][c % 3]; }
  int from(int c) { return vertex(c); }
  int to(int c) { return vertex(next(c)); }
  int apex(int c) { return vertex(next(next(c))); }
  void join(int c, int d) {
    if (c >= 0) across_[c] = d;
    if (d >= 0) across_[d] = c;
  }

  /// Do the two angles opposite to the edge add up to more than a half turn? With the areas of what a flip would make.
  bool wants_flip(int c) {
    const Vec3 &a = x_[from(c)], &b = x_[to(c)], &p = x_[apex(c)], &q = x_[apex(across_[c])];
    const Vec3 at_p = (a - p).cross(b - p), at_q = (b - q).cross(a - q);
    const double sin_p = at_p.norm(), sin_q = at_q.norm();
    const double cos_p = (a - p).dot(b - p), cos_q = (a - q).dot(b - q);
    const double scale = (a - p).norm() * (b - p).norm() * (a - q).norm() * (b - q).norm();
    if (sin_p * cos_q + cos_p * sin_q > -1e-9 * scale) return false;
    const Vec3 up = at_p + at_q;
    const double left = up.dot((q - p).cross(b - p)), right = up.dot((a - p).cross(q - p));
    return std::min(left, right) > 1e-6 * up.squaredNorm();
  }

  /// Triangles (a, b, p) and (b, a, q) become (q, b, p) and (p, a, q).
  void flip(int c, int d) {
    const int p = apex(c), q = apex(d);
    const int bp = across_[next(c)], pa = across_[next(next(c))], aq = across_[next(d)], qb = across_[next(next(d))];
    const int a = from(c), b = to(c);
    const int c1 = next(c), c2 = next(c1), d1 = next(d), d2 = next(d1);
    vertex(c) = q, vertex(c1) = b, vertex(c2) = p;
    vertex(d) = p, vertex(d1) = a, vertex(d2) = q;
    join(c, qb), join(c1, bp), join(c2, d2);
    join(d, pa), join(d1, aq);
  }

  const std::vector<Vec3>& x_;
  Triangle* faces_;
  std::vector<int> across_;  // per corner: the opposite half-edge, -1 on the border
};

}  // namespace

bool Sizing::too_long(const Vec3& a, const Vec3& b) const {
  const double squared = (a - b).squaredNorm();
  if (squared <= edge * edge) return false;
  const double length = std::sqrt(squared);
  const double beyond = box.exteriorDistance(Vec3((a + b) / 2)) - length / 2;
  return length > edge + growth * std::max(0.0, beyond);
}

FineMesh triangulated(const geometry::RegionBoundary& boundary) {
  FineMesh mesh{boundary.vertices, {}, {}};
  for (int f = 0; f < static_cast<int>(boundary.faces.size()); ++f) {
    const std::vector<int>& loop = boundary.faces[f].loop;
    if (loop.size() == 3) {
      mesh.faces.push_back({loop[0], loop[1], loop[2]});
      mesh.source.push_back(f);
      continue;
    }
    const int middle = static_cast<int>(mesh.vertices.size());
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      sum += mesh.vertices[loop[i]];
      mesh.faces.push_back({loop[i], loop[(i + 1) % loop.size()], middle});
      mesh.source.push_back(f);
    }
    mesh.vertices.push_back(sum / static_cast<double>(loop.size()));
  }
  return mesh;
}

void flip_to_delaunay(FineMesh& mesh) {
  for (std::size_t first = 0, last = 0; first < mesh.faces.size(); first = last) {
    while (last < mesh.faces.size() && mesh.source[last] == mesh.source[first]) ++last;
    if (last - first > 1) Patch(mesh.vertices, &mesh.faces[first], static_cast<int>(last - first)).flip_all();
  }
}

void refine(FineMesh& mesh, const Sizing& sizing, int most, Progress& progress) {
  halve_all(mesh, sizing, most, progress);
  flip_to_delaunay(mesh);
  halve_all(mesh, sizing, most, progress);
}

}  // namespace sunder::crack::detail
