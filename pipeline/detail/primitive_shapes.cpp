#include "pipeline/detail/primitive_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "geometry/primitives.h"

namespace sunder::pipeline::detail {
namespace {

using geometry::TriangleMesh;

TriangleMesh stretched(const TriangleMesh& unit, const Vec3& size) {
  return geometry::transformed(unit, size.asDiagonal(), Vec3::Zero());
}

void require_equal(double a, double b, const char* message) {
  // Sizes come from decimals in a file: equal as written means equal here.
  if (a != b) throw Error(ErrorKind::usage, message);
}

TriangleMesh make_torus(const Vec3& size, double) {
  require_equal(size.x(), size.z(), "a torus is round: size = [diameter, tube diameter, diameter]");
  return geometry::torus((size.x() - size.y()) / 2, size.y() / 2);
}

TriangleMesh make_hollow_sphere(const Vec3& size, double wall) {
  require_equal(size.maxCoeff(), size.minCoeff(), "a hollow sphere is round: size = [diameter, diameter, diameter]");
  return geometry::hollow_sphere(size.x() / 2, wall);
}

constexpr std::array<PrimitiveShape, 10> kShapes = {{
    {"box", true, false, 0, [](const Vec3& size, double) { return geometry::box(size); }},
    {"plate", true, false, 0, [](const Vec3& size, double) { return geometry::box(size); }},
    {"sphere", true, true, 0, [](const Vec3& size, double) { return stretched(geometry::sphere(0.5), size); }},
    {"cylinder", true, false, 0, [](const Vec3& size, double) { return stretched(geometry::cylinder(0.5, 1), size); }},
    {"torus", true, false, 0, make_torus},
    {"hollow_sphere", true, true, 0.05, make_hollow_sphere},
    {"cup", false, true, 0.06, [](const Vec3& size, double wall) { return geometry::cup(size.y(), wall); }},
    {"pot", false, true, 0.05, [](const Vec3& size, double wall) { return geometry::pot(size.y(), wall); }},
    {"goblet", false, true, 0.015, [](const Vec3& size, double wall) { return geometry::goblet(size.y(), wall); }},
    {"column", false, true, 0, [](const Vec3& size, double) { return geometry::column(size.y()); }},
}};

}  // namespace

std::span<const PrimitiveShape> primitive_shapes() { return kShapes; }

const PrimitiveShape* find_primitive(std::string_view name) {
  const auto found =
      std::find_if(kShapes.begin(), kShapes.end(), [&](const auto& shape) { return shape.name == name; });
  return found == kShapes.end() ? nullptr : &*found;
}

TriangleMesh make_primitive(const PrimitiveShape& shape, const MeshChoice& choice) {
  const Vec3 size = choice.height > 0 ? Vec3::Constant(choice.height) : choice.size;
  const double wall = choice.wall > 0 ? choice.wall : shape.wall_share * size.y();
  return shape.make(size, wall);
}

}  // namespace sunder::pipeline::detail
