#pragma once
/// Bullet's world with our own contact search, contact preparation and time integration.
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include <btBulletDynamicsCommon.h>

#include "rigid/detail/body.h"
#include "rigid/detail/patches.h"

namespace sunder::rigid::detail {

/// Two bodies and the parts of theirs that touch; the ground is always the second.
struct PartPair {
  BodyId body_a, body_b;
  int part_a, part_b;
  auto operator<=>(const PartPair&) const = default;
};

/// Overlap that contact does not push apart [m].
using Tolerances = std::map<PartPair, double>;

class Dynamics final : public btDiscreteDynamicsWorld {
 public:
  Dynamics(btDispatcher* dispatcher, btBroadphaseInterface* broadphase, btConstraintSolver* solver,
           btCollisionConfiguration* configuration, Tolerances& tolerances, ContactLog& log, double last_step);

  /// Sets the gravity of the step of this length that comes next.
  void kick(double time_step);
  double last_step() const { return last_step_; }

  void updateAabbs() override;

 protected:
  void saveKinematicState(btScalar) override {}         // would overwrite the velocities that the user set
  void predictUnconstraintMotion(btScalar) override {}  // no damping, and nothing reads the prediction
  void createPredictiveContacts(btScalar) override {}   // contacts() looks ahead by itself
  void solveConstraints(btContactSolverInfo& info) override;
  void integrateTransforms(btScalar time_step) override;
  void updateActivationState(btScalar time_step) override;

 private:
  /// A contact point during the solve, with what the solver must not see and what it forgets.
  struct Prepared {
    btPersistentManifold* manifold;
    btManifoldPoint* point;
    Vec3 normal;
    double approach, distance;  ///< before the step
    double gap = 0;             ///< distance beyond what is tolerated [m]
    double pull = 0;            ///< acceleration towards each other [m/s^2]
    double closing = 0;         ///< approach speed with the pull of the step
    double hit_time = 0;        ///< after the start of the step
    bool acts = false, hits = false;
  };

  double kick_time(double time_step) const;
  Vec3 acceleration_of(const Body& body) const;
  double tolerated(const btPersistentManifold& manifold);
  void prepare(btPersistentManifold& manifold, double time_step);
  void keep_first_hits();
  void apply(const Prepared& p, double time_step);
  void move_to_hits();
  void harvest();

  Tolerances& tolerances_;
  Tolerances next_tolerances_;
  ContactLog& log_;
  double last_step_;
  std::vector<Prepared> prepared_;
};

/// Everything of Bullet that depends on history: made afresh, it behaves like any other made from the same bodies.
class Simulation {
 public:
  /// `last_step`: length of the (sub-)step that led here [s].
  Simulation(const WorldSettings& settings, double last_step, Tolerances& tolerances, ContactLog& log);
  ~Simulation();

  void insert(Body& body);
  /// Wakes whatever might have rested on the body.
  void erase(Body& body);
  void wake_neighbours(Body& body);
  void advance(double time_step);
  double last_step() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace sunder::rigid::detail
