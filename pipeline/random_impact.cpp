#include "pipeline/random_impact.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/error.h"
#include "core/random.h"

namespace sunder::pipeline {
namespace {

constexpr int most_flights = 10000;
constexpr std::uint64_t flight_stream = 0xf119;

struct Flight {
  Vec3 from, direction;
};

/// The numbers 4 * attempt to 4 * attempt + 3 of the stream decide.
Flight random_flight(const Vec3& centre, double radius, std::uint64_t seed, int attempt) {
  const auto unit = [&](int k) {
    return random_unit(seed, flight_stream, static_cast<std::uint64_t>(4 * attempt + k));
  };
  const double z = 2 * unit(0) - 1, turn = 2 * std::numbers::pi * unit(1);
  const double flat = std::sqrt(std::max(0.0, 1 - z * z));
  const Vec3 direction(flat * std::cos(turn), flat * std::sin(turn), z);
  const Vec3 aside = direction.unitOrthogonal(), other = direction.cross(aside);
  const double off = radius * std::sqrt(unit(2)), around = 2 * std::numbers::pi * unit(3);
  return {centre + off * (std::cos(around) * aside + std::sin(around) * other) - 2 * radius * direction, direction};
}

/// Distance along the flight at which it meets the triangle (Moeller and Trumbore 1997).
std::optional<double> meeting(const Flight& flight, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, p = flight.direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0) return {};
  const Vec3 s = flight.from - a;
  const double u = s.dot(p) / determinant;
  if (u < 0 || u > 1) return {};
  const Vec3 q = s.cross(ab);
  const double v = flight.direction.dot(q) / determinant;
  if (v < 0 || u + v > 1) return {};
  return ac.dot(q) / determinant;
}

struct Meeting {
  double distance = std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::Zero();
};

Meeting first_meeting(const Flight& flight, const geometry::TriangleMesh& mesh) {
  Meeting first;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& [a, b, c] = mesh.faces[f];
    const auto distance = meeting(flight, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    if (distance && *distance < first.distance) first = {*distance, geometry::face_normal(mesh, f)};
  }
  return first;
}

}  // namespace

ImpactPoint random_impact(const geometry::TriangleMesh& mesh, double largest_angle, std::uint64_t seed) {
  const Box box = geometry::bounds(mesh);
  const Vec3 centre = box.center();
  double radius = 0;
  for (const Vec3& x : mesh.vertices) radius = std::max(radius, (x - centre).norm());
  for (int attempt = 0; attempt < most_flights; ++attempt) {
    const Flight flight = random_flight(centre, radius, seed, attempt);
    const Meeting meeting = first_meeting(flight, mesh);
    if (std::isinf(meeting.distance) || -flight.direction.dot(meeting.normal) < std::cos(largest_angle)) continue;
    return {flight.from + meeting.distance * flight.direction, flight.direction};
  }
  throw Error(ErrorKind::mesh, "no impactor from outside hits the mesh squarely enough; allow a larger angle");
}

}  // namespace sunder::pipeline
