#include "geometry/detail/labels.h"

#include <optional>

#include "core/error.h"
#include "geometry/detail/inside.h"
#include "geometry/detail/predicates.h"

namespace sunder::geometry::detail {
namespace {

constexpr int kUnknown = -1;

[[noreturn]] void reject(const char* why) { throw Error(ErrorKind::mesh, why); }

// Cells that meet across an edge of the surface.
DisjointSets joined_cells(const Divided& divided) {
  DisjointSets sets(divided.cell_count());
  const Edges& edges = divided.surface.edges;
  for (int edge = 0; edge < edges.count(); ++edge) {
    for (int slot = 0; slot < divided.slot_count(edge); ++slot) {
      const int first = divided.cell_at(*edges.begin(edge), slot);
      for (const HalfEdge* side = edges.begin(edge) + 1; side != edges.end(edge); ++side) {
        sets.unite(first, divided.cell_at(*side, slot));
      }
    }
  }
  return sets;
}

void set_label(std::vector<int>& labels, int set, int label) {
  if (labels[set] != kUnknown && labels[set] != label) reject("the sides of a crack contradict each other");
  labels[set] = label;
}

// A corner of some face of every set that has no label yet; -1 for sets that have one. Such faces are whole.
std::vector<int> corners_of_unlabelled(const Divided& divided, DisjointSets& sets, const std::vector<int>& labels) {
  std::vector<int> corner(labels.size(), -1);
  for (int face = 0; face < divided.face_count(); ++face) {
    const int set = sets.find(divided.first_cell[face]);
    if (labels[set] == kUnknown && corner[set] < 0) corner[set] = divided.surface.faces[face][0];
  }
  return corner;
}

/// The crack triangle that a segment from a point meets first.
class FirstHit {
 public:
  FirstHit(const CrackComplex& cracks, const Vec3& from, const Vec3& to) : cracks_(cracks) {
    for (std::size_t i = 0; i < cracks.triangles.size() && !unclear_; ++i) test(static_cast<int>(i), from, to);
  }

  /// Empty when nothing is hit, or too little is certain.
  std::optional<int> region() const {
    if (unclear_ || region_ < 0) return std::nullopt;
    return region_;
  }

 private:
  void test(int triangle, const Vec3& from, const Vec3& to) {
    const auto [i, j, k] = cracks_.triangles[triangle];
    const Vec3 &a = cracks_.vertices[i], &b = cracks_.vertices[j], &c = cracks_.vertices[k];
    const int side = orientation(a, b, c, from), other = orientation(a, b, c, to);
    if (side * other > 0) return;
    const int x = orientation(from, to, a, b), y = orientation(from, to, b, c), z = orientation(from, to, c, a);
    if (x * y < 0 || y * z < 0 || x * z < 0) return;
    const Enclosure at = crossing(from, to, a, b, c);
    const bool touches = side * other * x * y * z == 0;
    const bool tie = region_ >= 0 && at.low <= nearest_.high && nearest_.low <= at.high;
    unclear_ |= touches || tie;
    if (region_ >= 0 && nearest_.low <= at.low) return;
    nearest_ = at;
    region_ = cracks_.region({triangle, side > 0 ? 1 : 0});
  }

  const CrackComplex& cracks_;
  Enclosure nearest_{0, 0};
  int region_ = -1;
  bool unclear_ = false;
};

}  // namespace

int region_at(const Vec3& point, const CrackComplex& cracks) {
  constexpr std::size_t kShots = 64;
  const std::size_t count = cracks.triangles.size();
  if (count == 0) return 0;
  for (std::size_t shot = 0; shot < kShots; ++shot) {
    const auto [i, j, k] = cracks.triangles[shot * (count / 2 + 1) % count];
    // A point of the triangle, another one in every round, and a little beyond.
    const double u = 1.0 / (3 + shot), v = 1.0 / (3.5 + 0.5 * shot);
    const Vec3 target = u * cracks.vertices[i] + v * cracks.vertices[j] + (1 - u - v) * cracks.vertices[k];
    const FirstHit hit(cracks, point, point + 1.125 * (target - point));
    if (hit.region()) return *hit.region();
  }
  reject("the region of a part of the body is unclear");
}

std::vector<char> crack_cells_inside(const Arrangement& arrangement, const TriangleMesh& body) {
  const Divided& cracks = arrangement.cracks;
  DisjointSets sets = joined_cells(cracks);
  std::vector<int> labels(cracks.cell_count(), kUnknown);
  for (const auto& [left, right] : arrangement.crack_cells) {
    set_label(labels, sets.find(left), 0);
    set_label(labels, sets.find(right), 1);
  }
  const std::vector<int> corner = corners_of_unlabelled(cracks, sets, labels);
  std::optional<InsideTest> inside;
  for (std::size_t set = 0; set < labels.size(); ++set) {
    if (corner[set] < 0) continue;
    if (!inside) inside.emplace(body);
    labels[set] = (*inside)(arrangement.points[corner[set]]);
  }
  std::vector<char> result(cracks.cell_count());
  for (int cell = 0; cell < cracks.cell_count(); ++cell) result[cell] = static_cast<char>(labels[sets.find(cell)]);
  return result;
}

Labels label(const Arrangement& arrangement, const CrackComplex& near, const CrackComplex& far,
             const std::vector<char>& is_inside) {
  const Divided& body = arrangement.body;
  Labels result{{}, is_inside, joined_cells(body)};
  DisjointSets& sets = result.body_sets;
  std::vector<int> labels(body.cell_count(), kUnknown);
  for (std::size_t i = 0; i < arrangement.segments.size(); ++i) {
    const CrackComplex::Owner& owner = near.owner[arrangement.segments[i].triangle];
    set_label(labels, sets.find(arrangement.body_cells[i][0]), owner.inside);
    set_label(labels, sets.find(arrangement.body_cells[i][1]), owner.outside);
  }
  const std::vector<int> corner = corners_of_unlabelled(body, sets, labels);
  for (std::size_t set = 0; set < labels.size(); ++set) {
    if (corner[set] >= 0) labels[set] = region_at(arrangement.points[corner[set]], far);
  }
  result.region.resize(body.cell_count());
  for (int cell = 0; cell < body.cell_count(); ++cell) result.region[cell] = labels[sets.find(cell)];
  return result;
}

}  // namespace sunder::geometry::detail
