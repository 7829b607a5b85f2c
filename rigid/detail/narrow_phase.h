#pragma once
/// Plugs contacts() into Bullet: one manifold per pair of touching parts.
#include <memory>

#include <btBulletCollisionCommon.h>

namespace sunder::rigid::detail {

class NarrowPhase final : public btDefaultCollisionConfiguration {
 public:
  NarrowPhase();
  ~NarrowPhase() override;
  btCollisionAlgorithmCreateFunc* getCollisionAlgorithmCreateFunc(int, int) override { return create_.get(); }
  btCollisionAlgorithmCreateFunc* getClosestPointsAlgorithmCreateFunc(int, int) override { return create_.get(); }

 private:
  std::unique_ptr<btCollisionAlgorithmCreateFunc> create_;
};

}  // namespace sunder::rigid::detail
