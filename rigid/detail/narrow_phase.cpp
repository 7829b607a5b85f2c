#include "rigid/detail/narrow_phase.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "rigid/detail/body.h"
#include "rigid/detail/contact.h"
#include "rigid/detail/convert.h"
#include "rigid/detail/encounters.h"

namespace sunder::rigid::detail {
namespace {

// A point closer than this share of the smaller radius to one of the last step takes over its impulse as a first guess.
constexpr double same_point_share = 0.05;

btManifoldPoint to_point(const Contact& contact, const btTransform& place_a, const btTransform& place_b) {
  const btVector3 on_a = to_bullet(contact.on_a), on_b = to_bullet(contact.on_b);
  btManifoldPoint point(place_a.invXform(on_a), place_b.invXform(on_b), to_bullet(contact.normal), contact.distance);
  point.m_positionWorldOnA = on_a;
  point.m_positionWorldOnB = on_b;
  return point;
}

// The first guess for a point's impulse: that of the nearest old point, which is then used up.
void inherit(btManifoldPoint& point, std::vector<btManifoldPoint>& old, double same_point) {
  auto nearest = old.end();
  double distance = same_point;
  for (auto it = old.begin(); it != old.end(); ++it) {
    const double d = (it->m_localPointA - point.m_localPointA).length();
    if (d < distance) distance = d, nearest = it;
  }
  if (nearest == old.end()) return;
  point.m_appliedImpulse = nearest->m_appliedImpulse;
  old.erase(nearest);
}

// In each manifold the first body has the smaller id and the ground comes second.
class PartsAlgorithm final : public btCollisionAlgorithm {
 public:
  explicit PartsAlgorithm(const btCollisionAlgorithmConstructionInfo& info) : btCollisionAlgorithm(info) {}
  ~PartsAlgorithm() override {
    for (auto& [parts, manifold] : manifolds_) m_dispatcher->releaseManifold(manifold);
  }

  void processCollision(const btCollisionObjectWrapper* first, const btCollisionObjectWrapper* second,
                        const btDispatcherInfo&, btManifoldResult*) override {
    const Body *a = &body_of(*first->getCollisionObject()), *b = &body_of(*second->getCollisionObject());
    if (a->is_ground() || (!b->is_ground() && b->id < a->id)) std::swap(a, b);
    if (b->is_ground())
      collide_with_ground(*a, *b);
    else
      collide(*a, *b);
  }

  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return 1;
  }

  void getAllContactManifolds(btManifoldArray& list) override {
    for (auto& [parts, manifold] : manifolds_) list.push_back(manifold);
  }

 private:
  void collide_with_ground(const Body& a, const Body& ground) {
    const btTransform& place = a.object->getWorldTransform();
    for (int i = 0; i < static_cast<int>(a.parts.size()); ++i)
      fill(a, i, ground, 0, contacts_with_plane(a.parts[i], place, ground.ground_height, a.reach));
  }

  void collide(const Body& a, const Body& b) {
    const btTransform &place_a = a.object->getWorldTransform(), &place_b = b.object->getWorldTransform();
    const double reach = a.reach + b.reach;
    const std::vector<Box> boxes_a = part_bounds(a), boxes_b = part_bounds(b);
    for (int i = 0; i < static_cast<int>(a.parts.size()); ++i) {
      for (int j = 0; j < static_cast<int>(b.parts.size()); ++j) {
        const bool near = boxes_a[i].squaredExteriorDistance(boxes_b[j]) <= reach * reach;
        fill(a, i, b, j, near ? contacts(a.parts[i], place_a, b.parts[j], place_b, reach) : std::vector<Contact>{});
      }
    }
  }

  void fill(const Body& a, int part_a, const Body& b, int part_b, const std::vector<Contact>& list) {
    const auto known = manifolds_.find({part_a, part_b});
    if (list.empty()) {
      if (known == manifolds_.end()) return;
      m_dispatcher->releaseManifold(known->second);
      manifolds_.erase(known);
      return;
    }
    btPersistentManifold*& manifold = manifolds_[{part_a, part_b}];
    if (!manifold) manifold = m_dispatcher->getNewManifold(a.object.get(), b.object.get());
    std::vector<btManifoldPoint> old;
    for (int k = 0; k < manifold->getNumContacts(); ++k) old.push_back(manifold->getContactPoint(k));
    manifold->clearManifold();
    for (const Contact& contact : list) {
      btManifoldPoint point = to_point(contact, a.object->getWorldTransform(), b.object->getWorldTransform());
      point.m_index0 = part_a;
      point.m_index1 = part_b;
      inherit(point, old, same_point_share * std::min(a.radius, b.radius));
      manifold->addManifoldPoint(point, true);
    }
  }

  std::map<std::pair<int, int>, btPersistentManifold*> manifolds_;
};

struct CreateParts final : btCollisionAlgorithmCreateFunc {
  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper*,
                                                 const btCollisionObjectWrapper*) override {
    void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(PartsAlgorithm));
    return new (memory) PartsAlgorithm(info);
  }
};

btDefaultCollisionConstructionInfo room_for_parts() {
  btDefaultCollisionConstructionInfo info;
  info.m_customCollisionAlgorithmMaxElementSize = sizeof(PartsAlgorithm);
  return info;
}

}  // namespace

NarrowPhase::NarrowPhase()
    : btDefaultCollisionConfiguration(room_for_parts()), create_(std::make_unique<CreateParts>()) {}

NarrowPhase::~NarrowPhase() = default;

}  // namespace sunder::rigid::detail
