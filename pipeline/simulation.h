#pragma once
/// The bodies of a running scene, and what happens to them step by step.
#include <map>
#include <vector>

#include "core/progress.h"
#include "output/sequence.h"
#include "pipeline/fracture.h"
#include "pipeline/handover.h"
#include "pipeline/lifecycle.h"
#include "pipeline/report.h"
#include "pipeline/run.h"
#include "pipeline/scene.h"
#include "rigid/world.h"

namespace sunder::pipeline {

/// A body of the world that stands for a piece.
struct Live {
  int piece = 0;
  int origin = 0;                                        ///< index of the scene's body it comes from
  RigidPart part;                                        ///< in the piece's frame
  Vec3 start = Vec3::Zero();                             ///< of a body of the scene: its first position
  double last_solve = -1e300;                            ///< [s]
  std::shared_ptr<const Particles> particles = nullptr;  ///< of its last solve, in the piece's frame
};

/// The hit that would first break a body.
struct RehearsedHit {
  std::string body;
  double time = 0;      ///< [s]
  double severity = 0;  ///< impulse over the least one that could open a crack through the body
  FractureInput input;
};

/// What a simulation has made of its scene so far, beside the world: together they are all of its state.
struct SimulationState {
  output::Sequence sequence;
  Report report;
  std::map<rigid::BodyId, Live> live;
  std::vector<double> original_volume;  ///< by scene body
  std::vector<int> fracture_count;      ///< by scene body, with all its fragments
  int families = 0, fragment_count = 0;
};

class Simulation {
 public:
  /// Places the scene's bodies. Errors: ErrorKind::mesh, ErrorKind::usage (overlap at the start).
  Simulation(const Scene& scene, const RunOptions& options, Progress& progress);
  /// Goes on from where another one was.
  Simulation(const Scene& scene, const RunOptions& options, const rigid::World::State& world, SimulationState state);

  /// Time of the next step's end [s].
  double time() const { return world_.time(); }
  /// Advances the world by one step; bodies that were hit hard enough break within it. After ErrorKind::interrupted the
  /// step can be taken again, to the same result.
  void step(Progress& progress);
  /// Goes on without breaking anything until that many bodies were hit so that they would break, or to the end of the
  /// scene, and leaves the simulation as it was.
  std::vector<RehearsedHit> rehearse(int most_hits, Progress& progress);
  /// Adds the present poses to the sequence.
  void record_frame();

  const output::Sequence& sequence() const { return state_.sequence; }
  output::Sequence take_sequence() { return std::move(state_.sequence); }
  Report& report() { return state_.report; }
  const EffectPlan& effects() const { return effects_; }
  int steps_per_frame() const { return steps_per_frame_; }
  const SimulationState& state() const { return state_; }
  rigid::World::State world_state() const { return world_.state(); }

 private:
  using Hulls = std::vector<geometry::TriangleMesh>;
  /// The impacts that one body takes in one step.
  struct Hit {
    rigid::BodyId body = 0;
    std::vector<rigid::Impact> impacts;  ///< with the body as `body_a`
    double impulse = 0, severity = 0;
  };

  static Hulls hulls_of(const output::Piece& piece, SizeClass size);
  RigidPart make_piece(const SceneBody& body);
  void place(int index, const RigidPart& part, Hulls hulls);
  void plan_effects_of_bodies();
  void note_speed(const output::Piece& piece, double speed);
  std::vector<rigid::Impact> step_world();
  std::vector<RehearsedHit> rehearse_step();
  void require_no_overlap() const;
  rigid::BodyId add_body(const output::Piece& piece, const Live& live, Hulls hulls, const Pose& pose,
                         const Twist& twist, int family);
  std::vector<Hit> breaking_hits(const std::vector<rigid::Impact>& impacts, double now) const;
  bool may_break(const Live& live, double now) const;
  rigid::Motion motion_of(const Live& live) const;
  double free_mass(rigid::BodyId id) const;
  RigidPart world_part(rigid::BodyId id) const;
  double energy_of(rigid::BodyId id) const;
  double energy_of(const std::vector<rigid::BodyId>& ids) const;
  double minimum_impulse(const Live& live, double partner_mass) const;
  const output::Piece& piece_of(const Live& live) const;
  const SceneBody& origin_of(const Live& live) const { return scene_.bodies[static_cast<std::size_t>(live.origin)]; }
  double share_of(const Live& live) const;
  SizeClass size_of(const Live& live) const;
  void drive_bodies();
  void break_bodies(const std::vector<Hit>& hits, Progress& progress);
  FractureInput fracture_input(const Hit& hit, std::size_t number, std::vector<rigid::BodyId>& partner_ids) const;
  void settle(const Hit& hit, const FractureInput& input, const FractureOutcome& outcome,
              const std::vector<rigid::BodyId>& partners);
  void account(const FractureRecord& record, const FractureOutcome& outcome);
  std::vector<output::Piece> pieces_of(const Live& parent, const FractureOutcome& outcome,
                                       std::vector<RigidPart>& parts) const;
  std::vector<Push> pushes_of(const Hit& hit, const FractureOutcome& outcome,
                              const std::vector<rigid::BodyId>& partners);
  void meet_partners(const Hit& hit, const std::vector<Push>& pushes);
  void push_partners(const Hit& hit, const std::vector<Push>& pushes);
  Momentum momentum_of(const std::vector<rigid::BodyId>& ids, const Vec3& about) const;
  std::vector<Twist> twists_of(const FractureOutcome& outcome, const std::vector<RigidPart>& parts,
                               const rigid::BodyState& state, const Momentum& delivered) const;
  void remove(rigid::BodyId id);
  std::vector<rigid::BodyId> add_pieces(const Live& parent, const FractureOutcome& outcome,
                                        const std::vector<output::Piece>& pieces, const std::vector<RigidPart>& parts,
                                        const Pose& pose, const std::vector<Twist>& twists);
  void hand_over(const Hit& hit, const FractureOutcome& outcome, const std::vector<rigid::BodyId>& partners,
                 FractureRecord& record);
  void note_coarse_grid(const Material& material, const FractureRecord& record);

  const Scene& scene_;
  const RunOptions& options_;
  int steps_per_frame_;
  rigid::World world_;
  EffectPlan effects_;
  SimulationState state_;
};

}  // namespace sunder::pipeline
