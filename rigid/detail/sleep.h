#pragma once
/// Which bodies rest, and what wakes them. Bodies that touch fall asleep together and wake together; a light or slow
/// touch does not wake a sleeper, which then stands like a fixed body.
#include <vector>

#include "rigid/detail/body.h"
#include "rigid/detail/manifolds.h"

namespace sunder::rigid::detail {

/// A contact of this relative speed [m/s] sets the sleeper faster than it may be at rest.
bool rouses(const Body& sleeper, const Body& other, double speed);

/// Bodies that touch this one or nearly so.
std::vector<BodyId> touching(BodyId id, const std::vector<ContactMemory>& contacts);

/// Wakes the sleepers among `roused` and all that they touch, directly or through others. `bodies` in order of ids.
void wake(const std::vector<BodyId>& roused, const std::vector<ContactMemory>& contacts,
          const std::vector<Body*>& bodies);

/// After a sub-step: counts for how long bodies have been slow and lets those groups sleep in which all have been for
/// long enough. `touching`: pairs that exchanged forces.
void let_sleep(const std::vector<std::pair<Body*, Body*>>& touching, const std::vector<Body*>& bodies,
               double time_step);

}  // namespace sunder::rigid::detail
