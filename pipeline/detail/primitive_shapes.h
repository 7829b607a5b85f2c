#pragma once
/// The shapes that a scene names instead of a file.
#include <span>
#include <string_view>

#include "geometry/mesh.h"
#include "pipeline/scene.h"

namespace sunder::pipeline::detail {

/// How a scene dimensions a primitive, and what makes it.
struct PrimitiveShape {
  std::string_view name;
  bool by_size = false;    ///< takes `size`
  bool by_height = false;  ///< takes `height`
  double wall_share = 0;   ///< default `wall` as a share of the height; 0: takes no wall
  geometry::TriangleMesh (*make)(const Vec3& size, double wall) = nullptr;  ///< by_height alone: size.y() is the height
};

std::span<const PrimitiveShape> primitive_shapes();

/// Null when `name` is no primitive.
const PrimitiveShape* find_primitive(std::string_view name);

/// Generates the mesh that the choice describes, centred on its bounding box. Errors: ErrorKind::usage for impossible
/// dimensions.
geometry::TriangleMesh make_primitive(const PrimitiveShape& shape, const MeshChoice& choice);

}  // namespace sunder::pipeline::detail
