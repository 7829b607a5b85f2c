#pragma once
/// Which bodies rest, and what wakes them. Each body falls asleep by itself, so that one fragment that still rolls does
/// not keep a heap awake; sleepers that touch wake together. A light or slow touch wakes no sleeper, which then stands
/// like a fixed body.
#include <vector>

#include "rigid/detail/body.h"
#include "rigid/detail/manifolds.h"

namespace sunder::rigid::detail {

/// Two bodies that exchanged forces in a sub-step.
struct Touch {
  Body* a = nullptr;
  Body* b = nullptr;
  bool deep = false;  ///< they overlap by more than rest allows
};

/// Overlap [m] beyond which two bodies do not rest.
double deepest_rest(const Body& a, const Body& b);

/// A body that is to wake, and how fast what touches it would set it in motion [m/s].
struct Call {
  BodyId id = 0;
  double speed = 0;
};

/// Of the sleeper, by a contact at this relative speed with the other body; 0 unless it sleeps and the other is awake.
double speed_set(const Body& sleeper, const Body& other, double speed);

/// A call of infinite speed to each body that touches this one or nearly so.
std::vector<Call> call_neighbours(BodyId id, const std::vector<ContactMemory>& contacts);

/// Wakes the sleepers that are called to more than their slow speed, and lets each call its neighbours at half the
/// speed: a hit wakes a chain of bodies within one sub-step, and the tremble of one in a heap wakes few. `bodies` in
/// order of ids. True when one woke.
bool wake(std::vector<Call> calls, const std::vector<ContactMemory>& contacts, const std::vector<Body*>& bodies);

/// Speed of a call to bodies that overlap: it wakes a few, so that they make room.
double make_room(const Body& sleeper);

/// After a sub-step: counts for how long bodies have been slow, and lets those sleep that have been for long enough
/// while nothing that moves touches them and they do not overlap.
void let_sleep(const std::vector<Touch>& touching, const std::vector<Body*>& bodies, double time_step);

}  // namespace sunder::rigid::detail
