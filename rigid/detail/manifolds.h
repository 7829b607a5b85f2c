#pragma once
/// All places where bodies touch or are about to, and what of them outlasts a sub-step.
#include <array>
#include <vector>

#include "rigid/detail/body.h"
#include "rigid/detail/contact.h"

namespace sunder::rigid::detail {

/// The contacts of two parts. The ground is always the second body; otherwise the first has the smaller id.
struct Manifold {
  PartPair pair;
  Body* a = nullptr;
  Body* b = nullptr;
  std::vector<Contact> contacts;
};

/// Index pairs (first < second) of `bodies`, and of a body and the ground as (index, ground_index), whose boxes come
/// within their reaches of each other, in order.
constexpr int ground_index = -1;
using BodyPair = std::pair<int, int>;
std::vector<BodyPair> near_pairs(const std::vector<Body*>& bodies, const Body* ground);

/// Manifolds of the pairs, in the order of their part pairs. Pairs are worked on by all threads.
std::vector<Manifold> manifolds_of(const std::vector<BodyPair>& pairs, const std::vector<Body*>& bodies, Body* ground);

/// Null when nothing is remembered of the pair.
const ContactMemory* find(const std::vector<ContactMemory>& memory, const PartPair& pair);

}  // namespace sunder::rigid::detail
