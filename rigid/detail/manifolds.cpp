#include "rigid/detail/manifolds.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "rigid/detail/convert.h"
#include "rigid/detail/encounters.h"

namespace sunder::rigid::detail {
namespace {

constexpr std::size_t pairs_per_task = 16;

Box widened(const Box& box, double margin) {
  return Box(box.min() - Vec3::Constant(margin), box.max() + Vec3::Constant(margin));
}

void collide_with_ground(Body& a, Body& ground, std::vector<Manifold>& list) {
  const btTransform& place = a.object->getWorldTransform();
  for (int i = 0; i < static_cast<int>(a.parts.size()); ++i) {
    auto touching = contacts_with_plane(a.parts[static_cast<std::size_t>(i)], place, ground.ground_height, a.reach);
    if (!touching.empty()) list.push_back({{a.id, ground_id, i, 0}, &a, &ground, std::move(touching)});
  }
}

void collide(Body& a, Body& b, std::vector<Manifold>& list) {
  const btTransform &place_a = a.object->getWorldTransform(), &place_b = b.object->getWorldTransform();
  const double reach = a.reach + b.reach;
  const auto near = [&](const Box& x, const Box& y) { return x.squaredExteriorDistance(y) <= reach * reach; };
  std::vector<std::size_t> parts_b;
  for (std::size_t j = 0; j < b.parts.size(); ++j)
    if (near(a.box, b.part_boxes[j])) parts_b.push_back(j);
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    if (!near(a.part_boxes[i], b.box)) continue;
    for (const std::size_t j : parts_b) {
      if (!near(a.part_boxes[i], b.part_boxes[j])) continue;
      auto touching = contacts(a.parts[i], place_a, b.parts[j], place_b, reach);
      if (touching.empty()) continue;
      list.push_back({{a.id, b.id, static_cast<int>(i), static_cast<int>(j)}, &a, &b, std::move(touching)});
    }
  }
}

/// Boxes of turned bodies are too large at their corners.
bool spheres_are_near(const Body& a, const Body& b) {
  const btVector3 apart = a.object->getCenterOfMassPosition() - b.object->getCenterOfMassPosition();
  return apart.length() <= a.radius + b.radius + a.reach + b.reach;
}

}  // namespace

std::vector<BodyPair> near_pairs(const std::vector<Body*>& bodies, const Body* ground) {
  std::vector<Box> boxes;
  for (const Body* body : bodies) boxes.push_back(widened(body->box, body->reach));
  std::vector<BodyPair> pairs = touching(boxes);
  std::erase_if(pairs, [&](const BodyPair& p) {
    return !spheres_are_near(*bodies[static_cast<std::size_t>(p.first)], *bodies[static_cast<std::size_t>(p.second)]);
  });
  for (std::size_t i = 0; ground && i < bodies.size(); ++i)
    if (boxes[i].min().y() <= ground->ground_height) pairs.emplace_back(static_cast<int>(i), ground_index);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<Manifold> manifolds_of(const std::vector<BodyPair>& pairs, const std::vector<Body*>& bodies, Body* ground) {
  std::vector<std::vector<Manifold>> by_pair(pairs.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pairs.size(), pairs_per_task), [&](const auto& range) {
    for (std::size_t k = range.begin(); k < range.end(); ++k) {
      Body& a = *bodies[static_cast<std::size_t>(pairs[k].first)];
      if (pairs[k].second == ground_index)
        collide_with_ground(a, *ground, by_pair[k]);
      else
        collide(a, *bodies[static_cast<std::size_t>(pairs[k].second)], by_pair[k]);
    }
  });
  std::vector<Manifold> all;
  for (auto& list : by_pair) std::move(list.begin(), list.end(), std::back_inserter(all));
  return all;
}

const ContactMemory* find(const std::vector<ContactMemory>& memory, const PartPair& pair) {
  const auto found = std::lower_bound(memory.begin(), memory.end(), pair,
                                      [](const ContactMemory& m, const PartPair& p) { return m.pair < p; });
  return found != memory.end() && found->pair == pair ? &*found : nullptr;
}

}  // namespace sunder::rigid::detail
