#pragma once
/// How bodies move and hit (Bullet, double precision).
#include <cstdint>
#include <memory>
#include <vector>

#include "core/types.h"
#include "geometry/mesh.h"

namespace sunder::rigid {

/// Never reused in one world.
using BodyId = int;
constexpr BodyId ground_id = -1;

enum class Motion { dynamic, fixed, kinematic };

/// A body to be added. Its frame has its origin at the centre of mass.
struct BodySetup {
  std::vector<geometry::TriangleMesh> hulls;  ///< convex parts in the body's frame [m]
  double mass = 1;                            ///< [kg]; ignored unless dynamic
  Mat3 inertia = Mat3::Identity();            ///< about the centre of mass in body axes [kg m^2]
  Pose pose;
  Twist twist;
  Motion motion = Motion::dynamic;
  double restitution = 0.3;  ///< of the pair: product of both
  double friction = 0.5;     ///< of the pair: geometric mean of both
  /// Bodies of one family (the fragments of one fracture) may start in overlap: their collision hulls bulge over the
  /// common crack faces. Such an initial overlap is tolerated and shrinks as they part, instead of pushing them apart.
  /// 0: no family.
  int family = 0;
};

struct BodyState {
  Pose pose;
  Twist twist;
};

/// Two bodies and the parts (hulls) of theirs that touch; the ground is always the second.
struct PartPair {
  BodyId body_a = 0, body_b = 0;
  int part_a = 0, part_b = 0;
  auto operator<=>(const PartPair&) const = default;
};

/// What one step leaves to the next of two parts that touch or nearly so.
struct ContactMemory {
  struct Point {
    Vec3 on_a = Vec3::Zero();  ///< in the principal axes of the first body [m]
    double impulse = 0;        ///< first guess for the next step [N s]
  };
  PartPair pair;
  double tolerated = 0;  ///< overlap that contact does not push apart [m]
  std::vector<Point> points;
};

/// One contact patch of one step: all contact points of a pair of bodies that lie together.
struct Impact {
  BodyId body_a = 0, body_b = 0;  ///< body_b may be ground_id
  Vec3 point = Vec3::Zero();      ///< impulse-weighted mean of the contact points, world [m]
  Vec3 normal = Vec3::Zero();     ///< unit, from b towards a: the push on a
  /// From the centres of mass to the point at the moment of contact, which may lie anywhere within the step; of the
  /// ground: zero [m].
  Vec3 arm_a = Vec3::Zero(), arm_b = Vec3::Zero();
  double impulse = 0;         ///< normal impulse of the step, a gets +impulse * normal [N s]
  double approach_speed = 0;  ///< normal speed of approach of the two bodies at `point` before the step, > 0 [m/s]
};

/// What steps cost.
struct StepWork {
  long steps = 0;
  long sub_steps = 0;       ///< of all groups of bodies that can meet
  long body_sub_steps = 0;  ///< bodies times sub-steps
  long contacts = 0;        ///< contact points given to the solver
  double search_seconds = 0, solve_seconds = 0;
  StepWork& operator+=(const StepWork& other);
};

struct WorldSettings {
  Vec3 gravity = Vec3(0, -9.81, 0);  ///< [m/s^2]
  double time_step = 1.0 / 480;      ///< [s]
  bool has_ground = false;
  double ground_height = 0;  ///< plane y = ground_height [m]
  double ground_restitution = 0.3, ground_friction = 0.6;
  /// Contacts that approach slower than this do not count as impacts (resting contact) [m/s].
  double resting_speed = 0.1;
};

/// Owns all bodies. Steps are deterministic: fixed step, contacts in the order of the bodies' ids, one solver thread;
/// contacts are searched on all threads, with results that do not depend on their number. There is no hidden state: see
/// Snapshot.
class World {
 public:
  explicit World(const WorldSettings& settings);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// Errors: ErrorKind::usage for a mass or inertia that is not positive and finite, or for no hull.
  BodyId add(const BodySetup& setup);
  void remove(BodyId id);
  BodyState state(BodyId id) const;
  void set_state(BodyId id, const BodyState& state);
  /// Gives a kinematic body the motion that brings it to `pose` by the end of the next step. Errors:
  /// ErrorKind::internal for a body that is not kinematic.
  void drive(BodyId id, const Pose& pose);
  double mass(BodyId id) const;
  Mat3 world_inertia(BodyId id) const;
  /// In order of their ids.
  std::vector<BodyId> bodies() const;
  double time() const;

  /// Advances by one time step and returns its impacts, ordered by ids and then by point.
  std::vector<Impact> step();
  /// Of the last step.
  const StepWork& work() const;

  /// Where everything is, and all that the past leaves to the next step: poses, velocities, rest, contacts, the time.
  struct Snapshot {
    struct Rest {
      bool asleep = false;
      double quiet_time = 0;  ///< for how long it has been slow [s]
      double last_step = 0;   ///< length of its last sub-step [s]
      bool newborn = false;   ///< has not taken its first step
    };
    double time = 0;
    std::vector<BodyId> ids;
    std::vector<BodyState> states;
    std::vector<Quat> turns;  ///< of the principal axes, which round differently from those of `states`
    std::vector<Rest> rests;
    std::vector<ContactMemory> contacts;
  };
  Snapshot snapshot() const;
  /// Takes steps back. A body that was added or removed in between stays as it is. Without such bodies the steps that
  /// follow are those that followed the snapshot, bit for bit.
  void restore(const Snapshot& snapshot);

  /// The whole world as a value: `World(settings, world.state())` goes on like the world itself, bit for bit.
  struct State {
    std::vector<BodySetup> setups;  ///< by place in snapshot.ids
    Snapshot snapshot;
    BodyId next_id = 0;
  };
  State state() const;
  World(const WorldSettings& settings, const State& state);

  /// Deepest overlap of any two bodies, or a body and the ground, where it is not tolerated (see BodySetup::family)
  /// [m]. For checks of the initial state: a pair of ids with its depth, deepest first.
  struct Overlap {
    BodyId body_a = 0, body_b = 0;
    double depth = 0;
  };
  std::vector<Overlap> overlaps() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sunder::rigid
