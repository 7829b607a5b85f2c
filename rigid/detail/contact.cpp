#include "rigid/detail/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include "rigid/detail/convert.h"

namespace sunder::rigid::detail {
namespace {

constexpr double band = 0.05;  // of the smaller part's radius: points this far above the deepest still count
constexpr double face_preference =
    1e-3;  // of the smaller part's radius: a face may be this much worse than an edge pair
constexpr double missed_depth =
    0.01;  // of the smaller part's radius: what the points on a face may be short of the full depth
// EPA stops at about 1e-4 of the size, so a tighter check would send every overlap through the search over all faces.
constexpr double witness_accuracy = 1e-3;
constexpr double axis_cone = 0.9;  // cosine within which a face is tried in place of the axis found

// A part at its place in the world.
struct Placed {
  const Hull& hull;
  Mat3 rotation;
  Vec3 origin;

  Vec3 point(int i) const { return origin + rotation * hull.points[i]; }

  // Index of the point furthest along a world direction.
  int extreme(const Vec3& direction) const {
    const Vec3 local = rotation.transpose() * direction;
    int best = 0;
    double furthest = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < static_cast<int>(hull.points.size()); ++i)
      if (const double along = local.dot(hull.points[i]); along > furthest) furthest = along, best = i;
    return best;
  }

  Vec3 middle() const { return origin + rotation * hull.middle; }

  const HullFace& face_along(const Vec3& direction) const {
    const Vec3 local = rotation.transpose() * direction;
    return *std::max_element(hull.faces.begin(), hull.faces.end(), [&](const HullFace& f, const HullFace& g) {
      return f.normal.dot(local) < g.normal.dot(local);
    });
  }
};

Placed placed(const Hull& hull, const btTransform& place) {
  return {hull, to_eigen(place.getBasis()), to_eigen(place.getOrigin())};
}

// A direction from b towards a with the gap along it: never more than the true signed distance, and equal to it for the
// best one.
struct Axis {
  Vec3 normal = Vec3::Zero();
  double gap = -std::numeric_limits<double>::infinity();
};

Axis axis_along(const Placed& a, const Placed& b, const Vec3& normal) {
  return {normal, normal.dot(a.point(a.extreme(-normal)) - b.point(b.extreme(normal)))};
}

void improve(Axis& best, const Axis& other) {
  if (other.gap > best.gap) best = other;
}

// A direction along which the parts are further apart than `reach`, or the last one tried. Most pairs whose boxes meet
// are found apart this way, at a tenth of what their distance costs. Chung and Wang, "Quick collision detection of
// polytopes in virtual environments" (1996).
Axis quick_separation(const Placed& a, const Placed& b) {
  constexpr int most_turns = 6;
  Vec3 direction = a.middle() - b.middle();
  direction = direction.norm() > 0 ? direction.normalized() : Vec3::UnitY();
  Axis axis;
  for (int turn = 0; turn < most_turns; ++turn) {
    const Vec3 nearest = a.point(a.extreme(-direction)) - b.point(b.extreme(direction));
    axis = {direction, direction.dot(nearest)};
    if (axis.gap >= 0 || !(nearest.norm() > 0)) break;
    const Vec3 away = nearest.normalized();
    direction = (direction - 2 * direction.dot(away) * away).normalized();
  }
  return axis;
}

// Directions of the part's edges, each once.
std::vector<Vec3> edge_directions(const Placed& part) {
  std::vector<Vec3> edges;
  for (const HullFace& face : part.hull.faces)
    for (std::size_t k = 0; k < face.loop.size(); ++k) {
      const int from = face.loop[k], to = face.loop[(k + 1) % face.loop.size()];
      if (from < to) edges.push_back(part.point(to) - part.point(from));
    }
  return edges;
}

// By the separating axis theorem: slow, for where GJK and EPA come to no end. Bodies that just touch leave them without
// a direction too, and often; there the edges, which can only say that bodies are less deep, are not worth the time.
Axis best_axis(const Placed& a, const Placed& b, double worth) {
  Axis best;
  for (const HullFace& f : a.hull.faces) improve(best, axis_along(a, b, -(a.rotation * f.normal)));
  for (const HullFace& f : b.hull.faces) improve(best, axis_along(a, b, b.rotation * f.normal));
  if (best.gap > -worth) return best;
  const std::vector<Vec3> of_b = edge_directions(b);
  for (const Vec3& e : edge_directions(a))
    for (const Vec3& f : of_b) {
      const Vec3 normal = e.cross(f);
      if (!(normal.norm() > 1e-9 * e.norm() * f.norm())) continue;  // parallel edges: a face is as good
      improve(best, axis_along(a, b, normal.normalized()));
      improve(best, axis_along(a, b, -normal.normalized()));
    }
  return best;
}

struct Separation {
  Axis axis;
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();
};

Separation separation(const Placed& a, const btTransform& place_a, const Placed& b, const btTransform& place_b,
                      double reach) {
  Separation result;
  const Axis quick = quick_separation(a, b);
  if (quick.gap > reach) {
    result.axis = quick;
    return result;
  }
  // The solver starts from a direction in the axes of the first shape.
  const btVector3 guess = to_bullet(a.rotation.transpose() * quick.normal);
  btGjkEpaSolver2::sResults found;
  const bool apart = btGjkEpaSolver2::Distance(a.hull.shape.get(), place_a, b.hull.shape.get(), place_b, guess, found);
  if (apart && found.distance > reach) {
    result.axis.gap = found.distance;
    return result;
  }
  const bool known =
      (apart && found.distance > 1e-9 * a.hull.radius) ||
      btGjkEpaSolver2::Penetration(a.hull.shape.get(), place_a, b.hull.shape.get(), place_b, guess, found, false);
  // The solver leaves its normal in the axes of the first shape.
  const Vec3 normal = a.rotation * to_eigen(found.normal);
  if (known && std::abs(normal.norm() - 1) < 1e-6) {
    improve(result.axis, axis_along(a, b, normal.normalized()));
    improve(result.axis, axis_along(a, b, -normal.normalized()));
    result.on_a = to_eigen(found.witnesses[0]);
    result.on_b = to_eigen(found.witnesses[1]);
  }
  // Bodies that touch exactly leave GJK and EPA without a direction; the gap along what they return then differs from
  // the distance.
  const double accuracy = witness_accuracy * std::min(a.hull.radius, b.hull.radius);
  if (!(std::abs(result.axis.gap - found.distance) < accuracy)) {
    result.axis = best_axis(a, b, missed_depth * std::min(a.hull.radius, b.hull.radius));
    result.on_a = a.point(a.extreme(-result.axis.normal));
    result.on_b = result.on_a - result.axis.gap * result.axis.normal;
  }
  return result;
}

// Sutherland-Hodgman against one plane: keeps normal . (x - origin) <= 0.
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, const Vec3& origin, const Vec3& normal) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double dp = normal.dot(p - origin), dq = normal.dot(q - origin);
    if (dp <= 0) kept.push_back(p);
    if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) kept.push_back(p + (q - p) * (dp / (dp - dq)));
  }
  return kept;
}

// The facing face of `other`, clipped to the prism over `face` of `base`, with its heights over that face.
struct Footprint {
  std::vector<Vec3> points;
  std::vector<double> heights;
};

Footprint footprint(const Placed& base, const HullFace& face, const Placed& other) {
  const Vec3 normal = base.rotation * face.normal;
  std::vector<Vec3> polygon;
  for (int i : other.face_along(-normal).loop) polygon.push_back(other.point(i));
  for (std::size_t k = 0; k < face.loop.size() && !polygon.empty(); ++k) {
    const Vec3 p = base.point(face.loop[k]), q = base.point(face.loop[(k + 1) % face.loop.size()]);
    polygon = clipped(polygon, p, (q - p).cross(normal));
  }
  Footprint print{polygon, {}};
  const double offset = face.offset + normal.dot(base.origin);
  for (const Vec3& p : polygon) print.heights.push_back(normal.dot(p) - offset);
  return print;
}

bool is_deeper(const Contact& p, const Contact& q) { return p.distance < q.distance; }

double area_with(const Contact& p, const Contact& q, const Contact& r) {
  return (q.on_b - p.on_b).cross(r.on_b - p.on_b).norm();
}

// Moves the candidate with the largest score to place k of the list.
template <class Score>
void pick(std::vector<Contact>& list, std::size_t k, Score score) {
  auto best = list.begin() + static_cast<std::ptrdiff_t>(k);
  for (auto it = best; it != list.end(); ++it)
    if (score(*it) > score(*best)) best = it;
  std::swap(list[k], *best);
}

// Four points that carry what all carry: the deepest, the furthest from it, and the two that span the largest areas on
// either side.
std::vector<Contact> reduced(std::vector<Contact> list, double width) {
  if (list.empty()) return list;
  pick(list, 0, [](const Contact& c) { return -c.distance; });
  const double deepest = list[0].distance;
  std::erase_if(list, [&](const Contact& c) { return c.distance > deepest + width; });
  if (list.size() <= 4) return list;
  pick(list, 1, [&](const Contact& c) { return (c.on_b - list[0].on_b).norm(); });
  pick(list, 2, [&](const Contact& c) { return area_with(list[0], list[1], c); });
  pick(list, 3, [&](const Contact& c) {
    return area_with(list[0], list[1], c) + area_with(list[1], list[2], c) + area_with(list[2], list[0], c);
  });
  list.resize(4);
  return list;
}

// Points of a contact on a face of `base`; `side` is +1 if `base` is b (whose face normal points at a) and -1 if it is
// a.
std::vector<Contact> face_contacts(const Placed& base, const HullFace& face, const Placed& other, double side) {
  const Vec3 normal = base.rotation * face.normal;
  const Footprint print = footprint(base, face, other);
  std::vector<Contact> list;
  for (std::size_t i = 0; i < print.points.size(); ++i) {
    const Vec3 foot = print.points[i] - print.heights[i] * normal;
    if (side > 0)
      list.push_back({print.points[i], foot, normal, print.heights[i]});
    else
      list.push_back({foot, print.points[i], -normal, print.heights[i]});
  }
  return list;
}

}  // namespace

std::vector<Contact> contacts(const Hull& a, const btTransform& place_a, const Hull& b, const btTransform& place_b,
                              double reach) {
  const Placed pa = placed(a, place_a), pb = placed(b, place_b);
  const Separation found = separation(pa, place_a, pb, place_b, reach);
  if (found.axis.gap > reach) return {};
  const double size = std::min(a.radius, b.radius);
  const HullFace &face_a = pa.face_along(-found.axis.normal), &face_b = pb.face_along(found.axis.normal);
  const Axis axis_a = axis_along(pa, pb, -(pa.rotation * face_a.normal));
  const Axis axis_b = axis_along(pa, pb, pb.rotation * face_b.normal);
  const bool b_is_base = axis_b.gap >= axis_a.gap - 1e-6 * size;
  const Axis& face_axis = b_is_base ? axis_b : axis_a;
  std::vector<Contact> list;
  if (face_axis.gap >= found.axis.gap - face_preference * size && face_axis.normal.dot(found.axis.normal) > axis_cone)
    list = b_is_base ? face_contacts(pb, face_b, pa, 1) : face_contacts(pa, face_a, pb, -1);
  // Edges against edges, and corners that the prism over the face cuts off: the pair of points that GJK or EPA found.
  const auto deepest = std::min_element(list.begin(), list.end(), is_deeper);
  if (list.empty() || deepest->distance > found.axis.gap + missed_depth * size) {
    const Vec3 middle = (found.on_a + found.on_b) / 2, half = found.axis.normal * (found.axis.gap / 2);
    list.push_back({middle + half, middle - half, found.axis.normal, found.axis.gap});
  }
  return reduced(std::move(list), band * size);
}

std::vector<Contact> contacts_with_plane(const Hull& a, const btTransform& place_a, double height, double reach) {
  const Placed pa = placed(a, place_a);
  std::vector<Contact> list;
  for (int i = 0; i < static_cast<int>(a.points.size()); ++i) {
    const Vec3 p = pa.point(i);
    if (p.y() - height <= reach) list.push_back({p, Vec3(p.x(), height, p.z()), Vec3::UnitY(), p.y() - height});
  }
  return reduced(std::move(list), band * a.radius);
}

}  // namespace sunder::rigid::detail
