#include "geometry/detail/crossings.h"

#include <cstdint>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "core/error.h"
#include "geometry/detail/predicates.h"

namespace sunder::geometry::detail {
namespace {

[[noreturn]] void reject_touch() { throw Error(ErrorKind::mesh, "a crack touches the body without crossing it"); }

// A node by name: the edge and what it pierces. Nodes on edges of the body come first, edge by edge.
using Key = std::uint64_t;
constexpr Key kOnCrackEdge = Key{1} << 63;
Key body_edge_key(int edge, int triangle) { return static_cast<Key>(edge) << 32 | static_cast<Key>(triangle); }
Key crack_edge_key(int edge, int face) { return kOnCrackEdge | body_edge_key(edge, face); }

struct Contact {
  int face, triangle;
  Key start, end;
};

/// One face of the body against one crack triangle.
class Pair {
 public:
  Pair(const std::vector<Vec3>& points, const Triangle& face, const Triangle& triangle)
      : points_(points), face_(face), triangle_(triangle) {}

  bool apart() {
    const auto same = [](const std::array<int, 3>& s) { return s[0] != 0 && s[0] == s[1] && s[1] == s[2]; };
    for (int k = 0; k < 3; ++k) of_face_[k] = side(triangle_, face_[k]);
    if (same(of_face_)) return true;
    for (int k = 0; k < 3; ++k) of_triangle_[k] = side(face_, triangle_[k]);
    return same(of_triangle_);
  }

  bool pierced_by_face_edge(int i) {
    const int from = of_face_[i], to = of_face_[(i + 1) % 3];
    return from * to <= 0 && pierces(from, to, turn(i, 0), turn(i, 1), turn(i, 2));
  }
  bool pierced_by_crack_edge(int j) {
    const int from = of_triangle_[j], to = of_triangle_[(j + 1) % 3];
    return from * to <= 0 && pierces(from, to, turn(0, j), turn(1, j), turn(2, j));
  }

  /// Whether the segment starts where this edge pierces, see Segment.
  bool face_edge_starts(int i) const { return of_face_[i] < 0; }
  bool crack_edge_starts(int j) const { return of_triangle_[j] > 0; }

 private:
  int side(const Triangle& plane, int point) const {
    return orientation(points_[plane[0]], points_[plane[1]], points_[plane[2]], points_[point]);
  }

  int turn(int i, int j) {
    int& known = turns_[i][j];
    if (known == kUnknown) {
      known = orientation(points_[face_[i]], points_[face_[(i + 1) % 3]], points_[triangle_[j]],
                          points_[triangle_[(j + 1) % 3]]);
    }
    return known;
  }

  static bool pierces(int from, int to, int a, int b, int c) {
    if (from == 0 && to == 0) reject_touch();
    if (a * b < 0 || b * c < 0 || a * c < 0) return false;
    if (from == 0 || to == 0 || a == 0 || b == 0 || c == 0) reject_touch();
    return true;
  }

  static constexpr int kUnknown = 2;
  const std::vector<Vec3>& points_;
  const Triangle &face_, &triangle_;
  std::array<int, 3> of_face_{}, of_triangle_{};
  std::array<std::array<int, 3>, 3> turns_{{{2, 2, 2}, {2, 2, 2}, {2, 2, 2}}};
};

void add_contact(const std::vector<Vec3>& inputs, const Surface& body, const Surface& cracks, int face, int triangle,
                 std::vector<Contact>& contacts) {
  Pair pair(inputs, body.faces[face], cracks.faces[triangle]);
  if (pair.apart()) return;
  Key start = 0, end = 0;
  int starts = 0, ends = 0;
  const auto take = [&](bool is_start, Key key) { is_start ? (start = key, ++starts) : (end = key, ++ends); };
  for (int k = 0; k < 3; ++k) {
    if (pair.pierced_by_face_edge(k)) {
      take(pair.face_edge_starts(k), body_edge_key(body.edges.of_face[face][k], triangle));
    }
    if (pair.pierced_by_crack_edge(k)) {
      take(pair.crack_edge_starts(k), crack_edge_key(cracks.edges.of_face[triangle][k], face));
    }
  }
  if (starts == 0 && ends == 0) return;
  if (starts != 1 || ends != 1) throw Error(ErrorKind::mesh, "a crack crosses a face without two ends");
  contacts.push_back({face, triangle, start, end});
}

std::vector<Contact> find_contacts(const std::vector<Vec3>& inputs, const Surface& body, const BoxTree& tree,
                                   const Surface& cracks) {
  constexpr std::size_t kBlock = 64;
  const std::size_t count = cracks.faces.size(), blocks = (count + kBlock - 1) / kBlock;
  std::vector<std::vector<Contact>> of_block(blocks);
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
      const Triangle& t = cracks.faces[i];
      tree.visit(TriangleTest(inputs[t[0]], inputs[t[1]], inputs[t[2]]),
                 [&](int face) { add_contact(inputs, body, cracks, face, static_cast<int>(i), of_block[block]); });
    }
  });
  std::vector<Contact> contacts;
  for (const std::vector<Contact>& part : of_block) contacts.insert(contacts.end(), part.begin(), part.end());
  return contacts;
}

/// Lists by a number of each item; items keep their order.
template <typename ListOf>
Lists grouped(int lists, int items, const ListOf& list_of, int first_item = 0) {
  Lists result;
  result.first.assign(lists + 1, 0);
  for (int i = 0; i < items; ++i) ++result.first[list_of(i) + 1];
  for (int i = 0; i < lists; ++i) result.first[i + 1] += result.first[i];
  result.items.resize(items);
  std::vector<int> next(result.first.begin(), result.first.end() - 1);
  for (int i = 0; i < items; ++i) result.items[next[list_of(i)]++] = first_item + i;
  return result;
}

std::vector<Key> sorted_keys(const std::vector<Contact>& contacts) {
  std::vector<Key> keys;
  keys.reserve(2 * contacts.size());
  for (const Contact& contact : contacts) keys.insert(keys.end(), {contact.start, contact.end});
  tbb::parallel_sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

int edge_of(Key key) { return static_cast<int>((key & ~kOnCrackEdge) >> 32); }
int other_of(Key key) { return static_cast<int>(key & 0xffffffff); }

}  // namespace

Crossings find_crossings(const std::vector<Vec3>& inputs, const Surface& body, const BoxTree& tree,
                         const Surface& cracks) {
  const std::vector<Contact> contacts = find_contacts(inputs, body, tree, cracks);
  const std::vector<Key> keys = sorted_keys(contacts);
  const int first = static_cast<int>(inputs.size()), count = static_cast<int>(keys.size());
  const int on_body = static_cast<int>(std::lower_bound(keys.begin(), keys.end(), kOnCrackEdge) - keys.begin());
  Crossings result;
  result.nodes.resize(count);
  for (int i = 0; i < count; ++i) {
    const Surface &of_edge = i < on_body ? body : cracks, &of_plane = i < on_body ? cracks : body;
    result.nodes[i] = {of_edge.edges.ends[edge_of(keys[i])], of_plane.faces[other_of(keys[i])]};
  }
  const auto point_of = [&](Key key) {
    return first + static_cast<int>(std::lower_bound(keys.begin(), keys.end(), key) - keys.begin());
  };
  result.segments.resize(contacts.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, contacts.size(), 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Contact& contact = contacts[i];
      result.segments[i] = {contact.face, contact.triangle, point_of(contact.start), point_of(contact.end)};
    }
  });
  const int segments = static_cast<int>(contacts.size());
  result.on_body_edge = grouped(
      body.edges.count(), on_body, [&](int i) { return edge_of(keys[i]); }, first);
  result.on_crack_edge = grouped(
      cracks.edges.count(), count - on_body, [&](int i) { return edge_of(keys[on_body + i]); }, first + on_body);
  result.on_face = grouped(static_cast<int>(body.faces.size()), segments, [&](int i) { return contacts[i].face; });
  result.on_triangle =
      grouped(static_cast<int>(cracks.faces.size()), segments, [&](int i) { return contacts[i].triangle; });
  return result;
}

}  // namespace sunder::geometry::detail
