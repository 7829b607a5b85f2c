#pragma once
/// One sub-step of all bodies: contacts are found, prepared, solved by Bullet's sequential impulses, and bodies moved.
/// All that one sub-step leaves to the next lies open in the memory of contacts and in the bodies, so a world that is
/// put together from them goes on to the same bits.
#include <memory>
#include <vector>

#include <btBulletDynamicsCommon.h>

#include "rigid/detail/body.h"
#include "rigid/detail/manifolds.h"
#include "rigid/detail/patches.h"
#include "rigid/detail/sleep.h"

namespace sunder::rigid::detail {

class Dynamics {
 public:
  explicit Dynamics(const Vec3& gravity);

  /// `bodies` in order of their ids, all of one group; `ground` may be null; `memory` of contacts among them, in order
  /// of its pairs. Adds to the log and to the work.
  void advance(const std::vector<Body*>& bodies, Body* ground, double time_step, std::vector<ContactMemory>& memory,
               ContactLog& log, StepWork& work);

 private:
  /// A contact point during the solve, with what the solver must not see and what it forgets.
  struct Prepared {
    btPersistentManifold* manifold;
    btManifoldPoint* point;
    Vec3 normal;
    double approach, distance;  ///< before the step
    double speed = 0;           ///< of the two bodies against each other at the point [m/s]
    double gap = 0;             ///< distance beyond what is tolerated [m]
    double pull = 0;            ///< acceleration towards each other [m/s^2]
    double now = 0;             ///< approach speed at the start of the step; velocities are those of half a step before
    double closing = 0;         ///< approach speed with the pull of the step
    double hit_time = 0;        ///< after the start of the step
    bool acts = false, hits = false;
  };
  /// What a sub-step works on.
  struct Step {
    const std::vector<Body*>& bodies;
    Body* ground;
    double length;
    std::vector<ContactMemory>& memory;
    ContactLog& log;
  };

  Vec3 acceleration_of(const Body& body) const;
  Vec3 gain(const Body& body, double time) const;
  void find_contacts(const Step& step);
  std::vector<Call> calls(const Step& step) const;
  void load(const Step& step);
  void prepare(btPersistentManifold& manifold, double tolerance, const Step& step);
  void keep_first_hits();
  void apply(const Prepared& p, const Step& step);
  void move_to_hits(const Step& step);
  void solve(const Step& step);
  void run_solver(const std::vector<Body*>& awake, double length);
  void harvest(const Step& step);

  Vec3 gravity_;
  btSequentialImpulseConstraintSolver solver_;
  btContactSolverInfo info_;
  std::vector<Manifold> found_;
  std::vector<std::unique_ptr<btPersistentManifold>> manifolds_;  ///< used from the front, kept for the next sub-step
  std::vector<ContactMemory> next_contacts_;                      ///< of `manifolds_`, one each
  std::size_t used_ = 0;
  std::vector<Prepared> prepared_;
};

}  // namespace sunder::rigid::detail
