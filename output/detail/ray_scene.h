#pragma once
/// Where rays meet triangles.
#include <limits>
#include <memory>
#include <span>

#include "output/detail/soup.h"

namespace sunder::output::detail {

struct Ray {
  Vec3f origin, direction;  ///< direction of unit length
  float far = std::numeric_limits<float>::infinity();
};

struct Hit {
  float distance = std::numeric_limits<float>::infinity();
  int triangle = -1;   ///< of the soup; -1: nothing
  float u = 0, v = 0;  ///< barycentric, of the second and third corner

  bool found() const { return triangle >= 0; }
};

/// The same answers for any number of threads. Safe to ask from many threads.
class RayScene {
 public:
  /// Errors: ErrorKind::internal when there is not enough memory.
  explicit RayScene(const Soup& soup);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  enum class Kind { opaque, clear };

  bool has(Kind kind) const;

  /// The first triangle of the kind that each ray meets.
  void trace(std::span<const Ray> rays, Kind kind, std::span<Hit> hits) const;

  /// 1 where a ray meets any triangle of the kind.
  void blocked(std::span<const Ray> rays, Kind kind, std::span<std::uint8_t> answers) const;

 private:
  struct Trees;
  std::unique_ptr<Trees> trees_;
};

}  // namespace sunder::output::detail
