#include "geometry/detail/profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sunder::geometry::detail {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double kArcStep = std::numbers::pi / 12;
// Arcs are divided finer than straight pieces, or wide ones would show.
constexpr double kArcShare = 0.5;
// An arc may use this share of a side, so that arcs at both ends of it never touch.
constexpr double kSideShare = 0.49;

Vec2 point(const Corner& corner) { return {corner.radius, corner.height}; }
Vec2 left(const Vec2& direction) { return {-direction.y(), direction.x()}; }
double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

struct Bend {
  Vec2 in, out;     // unit directions of the sides before and after
  double turn = 0;  // signed, positive to the left
};

Bend bend(const Corner& before, const Corner& corner, const Corner& after) {
  Bend result{(point(corner) - point(before)).normalized(), (point(after) - point(corner)).normalized()};
  result.turn = std::atan2(cross(result.in, result.out), result.in.dot(result.out));
  return result;
}

void append_arc(std::vector<Vec2>& points, const Corner& before, const Corner& corner, const Corner& after,
                double step) {
  const auto [in, out, turn] = bend(before, corner, after);
  const double room =
      kSideShare * std::min((point(corner) - point(before)).norm(), (point(after) - point(corner)).norm());
  const double half_tangent = std::tan(std::abs(turn) / 2);
  const double radius = std::min(corner.fillet, room / half_tangent);
  if (!(radius > 0)) return points.push_back(point(corner));
  const Vec2 start = point(corner) - radius * half_tangent * in;
  const Vec2 to_center = (turn > 0 ? radius : -radius) * left(in);
  const double turn_step = std::min(kArcStep, step / radius);
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(turn) / turn_step)));
  for (int i = 0; i <= steps; ++i) {
    points.push_back(start + to_center - Eigen::Rotation2Dd(turn * i / steps) * to_center);
  }
}

}  // namespace

std::vector<ProfilePoint> rounded(const std::vector<Corner>& corners, double step) {
  std::vector<Vec2> points = {point(corners.front())};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    append_arc(points, corners[i - 1], corners[i], corners[i + 1], kArcShare * step);
  points.push_back(point(corners.back()));
  std::vector<ProfilePoint> result = {{points[0].x(), points[0].y()}};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec2 side = points[i] - points[i - 1];
    const int pieces = std::max(1, static_cast<int>(std::ceil(side.norm() / step)));
    for (int k = 1; k <= pieces; ++k) {
      const Vec2 x = k == pieces ? points[i] : Vec2(points[i - 1] + side * k / pieces);
      result.push_back({x.x(), x.y()});
    }
  }
  return result;
}

std::vector<Corner> offset_left(const std::vector<Corner>& corners, double distance) {
  std::vector<Corner> result = corners;
  result.front().height += distance;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const auto [in, out, turn] = bend(corners[i - 1], corners[i], corners[i + 1]);
    // The mitre: along the bisector of the two side normals.
    const Vec2 normal = left(in) + left(out);
    const Vec2 moved = point(corners[i]) + normal * (2 * distance / normal.squaredNorm());
    const double fillet = std::max(0.0, corners[i].fillet - std::copysign(distance, turn));
    result[i] = {moved.x(), moved.y(), fillet};
  }
  const Corner& last = corners.back();
  const Vec2 end = point(last) + distance * left((point(last) - point(corners[corners.size() - 2])).normalized());
  result.back() = {end.x(), end.y(), last.fillet};
  return result;
}

}  // namespace sunder::geometry::detail
