#include "geometry/detail/points.h"

#include <limits>

#include <CGAL/Exact_rational.h>
#include <CGAL/Gmpzf.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "geometry/detail/predicates.h"

namespace sunder::geometry::detail {
namespace {

constexpr double kUnit = 0x1p-53;
// Added to every error bound, so that neither its own rounding nor underflow makes it too small.
constexpr double kGrow = 1 + 0x1p-40, kTiny = 1e-290;
// A node whose error bound exceeds this share of its coordinates is rounded from its exact value.
constexpr double kLoose = 64 * kUnit;

/// A number known up to an error: midpoint and radius of an interval.
struct Ball {
  double value, error = 0;
};

Ball rounded(double value, double error) { return {value, (error + kUnit * std::abs(value)) * kGrow + kTiny}; }
Ball operator+(const Ball& a, const Ball& b) { return rounded(a.value + b.value, a.error + b.error); }
Ball operator-(const Ball& a, const Ball& b) { return rounded(a.value - b.value, a.error + b.error); }
Ball operator*(const Ball& a, const Ball& b) {
  return rounded(a.value * b.value, std::abs(a.value) * b.error + (std::abs(b.value) + b.error) * a.error);
}
Ball operator/(const Ball& a, const Ball& b) {
  const double least = std::abs(b.value) - b.error;
  if (!(least > 0)) return {0, std::numeric_limits<double>::infinity()};
  const double value = a.value / b.value;
  return rounded(value, (a.error + std::abs(value) * b.error) * kGrow / least);
}
int sign_or_zero(const Ball& x) { return std::abs(x.value) > x.error ? sign_of(x.value) : 0; }

// Works for every number type: the volume of (a, b, c, d), times six.
template <typename Number>
Number volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // The type of the difference is named: numbers may have expression templates.
  const auto difference = [](double x, double y) -> Number { return Number(x) - Number(y); };
  const Number ux = difference(b.x(), a.x()), uy = difference(b.y(), a.y()), uz = difference(b.z(), a.z());
  const Number vx = difference(c.x(), a.x()), vy = difference(c.y(), a.y()), vz = difference(c.z(), a.z());
  const Number wx = difference(d.x(), a.x()), wy = difference(d.y(), a.y()), wz = difference(d.z(), a.z());
  return ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx);
}

/// Coordinates times a common weight, without error.
template <typename Number>
struct Homogeneous {
  std::array<Number, 3> coordinate;
  Number weight;
};

template <typename Number>
Homogeneous<Number> exact_point(const std::vector<Vec3>& inputs, const Node& node) {
  const auto [p, q] = node.line;
  const auto [a, b, c] = node.plane;
  const Number from = volume<Number>(inputs[a], inputs[b], inputs[c], inputs[p]);
  const Number to = volume<Number>(inputs[a], inputs[b], inputs[c], inputs[q]);
  Homogeneous<Number> result;
  result.weight = from - to;
  for (int axis = 0; axis < 3; ++axis) {
    const Number start(inputs[p][axis]), end(inputs[q][axis]);
    result.coordinate[axis] = start * result.weight + (end - start) * from;
  }
  return result;
}

using Float = CGAL::Gmpzf;  // integers times powers of two: sums and products of doubles without error

Homogeneous<Float> exact_of(const std::vector<Vec3>& positions, const std::vector<Node>& nodes, int id) {
  const int inputs = static_cast<int>(positions.size() - nodes.size());
  if (id >= inputs) return exact_point<Float>(positions, nodes[id - inputs]);
  const Vec3& x = positions[id];
  return {{Float(x[0]), Float(x[1]), Float(x[2])}, Float(1)};
}

int sign_of(const Float& x) { return static_cast<int>(CGAL::sign(x)); }

Ball parameter(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Ball from = volume<Ball>(a, b, c, p), to = volume<Ball>(a, b, c, q);
  return from / (from - to);
}

struct Rounded {
  Vec3 position;
  double error;
};

Rounded exactly_rounded(const std::vector<Vec3>& inputs, const Node& node) {
  using Rational = CGAL::Exact_rational;
  const Homogeneous<Rational> point = exact_point<Rational>(inputs, node);
  Rounded result{Vec3::Zero(), 0};
  for (int axis = 0; axis < 3; ++axis) {
    result.position[axis] = CGAL::to_double(Rational(point.coordinate[axis] / point.weight));
    result.error = std::max(result.error, 4 * kUnit * std::abs(result.position[axis]) + kTiny);
  }
  return result;
}

Rounded round(const std::vector<Vec3>& inputs, const Node& node) {
  const Vec3 &p = inputs[node.line[0]], &q = inputs[node.line[1]];
  const Ball t = parameter(p, q, inputs[node.plane[0]], inputs[node.plane[1]], inputs[node.plane[2]]);
  Rounded result{Vec3::Zero(), 0};
  double size = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Ball start{p[axis]}, end{q[axis]}, x = start + (end - start) * t;
    result.position[axis] = x.value;
    result.error = std::max(result.error, x.error);
    size = std::max({size, std::abs(p[axis]), std::abs(q[axis])});
  }
  return result.error <= kLoose * size ? result : exactly_rounded(inputs, node);
}

// The two coordinates that remain when looking along an axis.
constexpr std::array<std::array<int, 2>, 3> kPlane = {{{1, 2}, {2, 0}, {0, 1}}};

}  // namespace

Points::Points(std::vector<Vec3> inputs, std::vector<Node> nodes)
    : positions_(std::move(inputs)), nodes_(std::move(nodes)), error_(nodes_.size()) {
  const std::size_t first = positions_.size();
  positions_.resize(first + nodes_.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes_.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Rounded node = round(positions_, nodes_[i]);
      positions_[first + i] = node.position;
      error_[i] = node.error;
    }
  });
}

int Points::compare(int axis, int a, int b) const {
  const double difference = positions_[a][axis] - positions_[b][axis];
  const int first = input_count();
  if (a < first && b < first) return detail::sign_of(difference);
  const double error = (a < first ? 0 : error_[a - first]) + (b < first ? 0 : error_[b - first]);
  if (std::abs(difference) > (error + kUnit * std::abs(difference)) * kGrow) return detail::sign_of(difference);
  return exact_compare(axis, a, b);
}

int Points::orientation(int axis, int a, int b, int c) const {
  const auto [x, y] = kPlane[axis];
  const int first = input_count();
  const auto ball = [&](int id, int k) { return Ball{positions_[id][k], id < first ? 0 : error_[id - first]}; };
  if (a < first && b < first && c < first) {
    const Vec3 &p = positions_[a], &q = positions_[b], &r = positions_[c];
    return planar_orientation(p[x], p[y], q[x], q[y], r[x], r[y]);
  }
  const Ball cx = ball(c, x), cy = ball(c, y);
  const int sign = sign_or_zero((ball(a, x) - cx) * (ball(b, y) - cy) - (ball(a, y) - cy) * (ball(b, x) - cx));
  return sign != 0 ? sign : exact_orientation(axis, a, b, c);
}

int Points::exact_compare(int axis, int a, int b) const {
  const auto exact = [&](int id) { return exact_of(positions_, nodes_, id); };
  const auto p = exact(a), q = exact(b);
  return sign_of(Float(p.coordinate[axis] * q.weight - q.coordinate[axis] * p.weight)) * sign_of(p.weight) *
         sign_of(q.weight);
}

int Points::exact_orientation(int axis, int a, int b, int c) const {
  const auto exact = [&](int id) { return exact_of(positions_, nodes_, id); };
  const auto p = exact(a), q = exact(b), r = exact(c);
  const auto [x, y] = kPlane[axis];
  const auto minor = [&](const Homogeneous<Float>& u, const Homogeneous<Float>& v) {
    return Float(u.coordinate[x] * v.coordinate[y] - u.coordinate[y] * v.coordinate[x]);
  };
  const Float determinant = minor(q, r) * p.weight + minor(r, p) * q.weight + minor(p, q) * r.weight;
  return sign_of(determinant) * sign_of(p.weight) * sign_of(q.weight) * sign_of(r.weight);
}

Enclosure crossing(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Ball t = parameter(p, q, a, b, c);
  return {t.value - t.error, t.value + t.error};
}

}  // namespace sunder::geometry::detail
