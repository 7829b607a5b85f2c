#pragma once
/// Between Eigen and Bullet.
#include <LinearMath/btTransform.h>

#include "core/types.h"

namespace sunder::rigid::detail {

inline Vec3 to_eigen(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
inline Quat to_eigen(const btQuaternion& q) { return {q.w(), q.x(), q.y(), q.z()}; }
inline Mat3 to_eigen(const btMatrix3x3& m) {
  Mat3 result;
  for (int i = 0; i < 3; ++i) result.row(i) = to_eigen(m[i]).transpose();
  return result;
}
inline btVector3 to_bullet(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline btQuaternion to_bullet(const Quat& q) { return {q.x(), q.y(), q.z(), q.w()}; }

}  // namespace sunder::rigid::detail
