#include "rigid/detail/body.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Eigenvalues>

#include "core/error.h"
#include "rigid/detail/convert.h"

namespace sunder::rigid::detail {
namespace {

// Bullet's own lengths are meant for bodies of a metre; these scale with the body.
constexpr double largest_stride = 0.5;  // of the radius
constexpr double stride_share = 0.5;    // of the thickness, but not below the next
constexpr double least_stride = 0.25;   // of the radius
// A body slower than this share of sqrt(gravity * radius) may fall asleep.
constexpr double sleep_share = 0.02;

[[noreturn]] void refuse(BodyId id, const std::string& what) {
  throw Error(ErrorKind::usage, "rigid body " + std::to_string(id) + ": " + what);
}

void check_mass(BodyId id, const BodySetup& setup) {
  if (!(std::isfinite(setup.mass) && setup.mass > 0)) refuse(id, "its mass has to be positive and finite");
  if (!setup.inertia.allFinite()) refuse(id, "its inertia has to be finite");
  const double scale = setup.inertia.cwiseAbs().maxCoeff();
  if ((setup.inertia - setup.inertia.transpose()).cwiseAbs().maxCoeff() > 1e-9 * scale)
    refuse(id, "its inertia has to be symmetric");
}

void check_motion(BodyId id, const BodySetup& setup) {
  const bool finite = setup.pose.position.allFinite() && setup.pose.orientation.coeffs().allFinite() &&
                      setup.twist.linear.allFinite() && setup.twist.angular.allFinite();
  if (!finite) refuse(id, "its pose and velocity have to be finite");
  if (std::abs(setup.pose.orientation.norm() - 1) > 1e-6) refuse(id, "its orientation has to be a unit quaternion");
  if (!(setup.restitution >= 0 && setup.restitution <= 1)) refuse(id, "its restitution has to lie in [0, 1]");
  if (!(std::isfinite(setup.friction) && setup.friction >= 0)) refuse(id, "its friction must not be negative");
}

// Principal axes; an inertia that is diagonal already keeps its axes to the bit.
void diagonalise(Body& body) {
  const Mat3 symmetric = (body.inertia + body.inertia.transpose()) / 2;
  const Mat3 rest = symmetric - Mat3(symmetric.diagonal().asDiagonal());
  body.moments = symmetric.diagonal();
  if (rest.cwiseAbs().maxCoeff() > 1e-12 * symmetric.cwiseAbs().maxCoeff()) {
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(symmetric);
    Mat3 axes = solver.eigenvectors();
    if (axes.determinant() < 0) axes.col(2) *= -1;
    body.moments = solver.eigenvalues();
    body.principal = Quat(axes).normalized();
  }
  if (!(body.moments.minCoeff() > 1e-12 * body.moments.maxCoeff())) refuse(body.id, "its inertia has to be positive");
}

void add_parts(Body& body, const BodySetup& setup) {
  const Mat3 to_principal = body.principal.conjugate().toRotationMatrix();
  double thickness = 0;
  for (const geometry::TriangleMesh& mesh : setup.hulls) {
    const bool finite =
        std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& x) { return x.allFinite(); });
    if (!finite) refuse(body.id, "its collision hulls have to be finite");
    if (auto hull = make_hull(mesh, to_principal)) {
      for (const Vec3& x : hull->points) body.radius = std::max(body.radius, x.norm());
      thickness = std::max(thickness, hull->thickness);
      body.parts.push_back(std::move(*hull));
    }
  }
  if (body.parts.empty()) refuse(body.id, "it needs at least one collision hull with a volume");
  body.stride = std::min(largest_stride * body.radius, std::max(stride_share * thickness, least_stride * body.radius));
}

std::unique_ptr<btCollisionShape> joint_shape(Body& body) {
  auto compound = std::make_unique<btCompoundShape>(false, static_cast<int>(body.parts.size()));
  for (Hull& part : body.parts) compound->addChildShape(btTransform::getIdentity(), part.shape.get());
  compound->setMargin(0);
  return compound;
}

std::unique_ptr<btRigidBody> make_object(Body& body) {
  const btVector3 moments = body.is_dynamic() ? to_bullet(body.moments) : btVector3(0, 0, 0);
  btRigidBody::btRigidBodyConstructionInfo info(body.is_dynamic() ? body.mass : 0, nullptr, body.shape.get(), moments);
  auto object = std::make_unique<btRigidBody>(info);
  object->setUserPointer(&body);
  // Free rotation is integrated in Dynamics::integrateTransforms.
  object->setFlags(0);
  if (body.motion == Motion::kinematic)
    object->setCollisionFlags((object->getCollisionFlags() & ~btCollisionObject::CF_STATIC_OBJECT) |
                              btCollisionObject::CF_KINEMATIC_OBJECT);
  return object;
}

}  // namespace

std::unique_ptr<Body> make_body(BodyId id, const BodySetup& setup, const Vec3& gravity) {
  auto body = std::make_unique<Body>();
  body->id = id;
  body->motion = setup.motion;
  check_motion(id, setup);
  if (body->is_dynamic()) {
    check_mass(id, setup);
    body->mass = setup.mass;
    body->inertia = setup.inertia;
    diagonalise(*body);
  }
  body->restitution = setup.restitution;
  body->friction = setup.friction;
  body->newborn = setup.family != 0;
  add_parts(*body, setup);
  body->shape = joint_shape(*body);
  body->object = make_object(*body);
  body->slow_speed = sleep_share * std::sqrt(gravity.norm() * body->radius);
  place(*body, {setup.pose, setup.twist});
  return body;
}

std::unique_ptr<Body> make_ground(const WorldSettings& settings) {
  auto body = std::make_unique<Body>();
  body->restitution = settings.ground_restitution;
  body->friction = settings.ground_friction;
  body->ground_height = settings.ground_height;
  body->radius = body->reach = body->stride = std::numeric_limits<double>::infinity();
  body->shape = std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0), settings.ground_height);
  body->shape->setMargin(0);
  body->object = make_object(*body);
  return body;
}

void set_asleep(Body& body, bool asleep) {
  body.asleep = asleep;
  body.quiet_time = 0;
  if (!body.is_dynamic()) return;
  const bool fixed = asleep;
  body.object->setMassProps(fixed ? 0 : body.mass, fixed ? btVector3(0, 0, 0) : to_bullet(body.moments));
  body.object->updateInertiaTensor();
  if (!asleep) return;
  body.object->setLinearVelocity(btVector3(0, 0, 0));
  body.object->setAngularVelocity(btVector3(0, 0, 0));
}

bool is_slow(const Body& body) {
  return body.object->getLinearVelocity().length() < body.slow_speed &&
         body.object->getAngularVelocity().length() < body.slow_speed / body.radius;
}

BodyState state_of(const Body& body) {
  BodyState state;
  state.pose.position = to_eigen(body.object->getWorldTransform().getOrigin());
  state.pose.orientation = (body.turn * body.principal.conjugate()).normalized();
  state.twist.linear = to_eigen(body.object->getLinearVelocity());
  state.twist.angular = to_eigen(body.object->getAngularVelocity());
  return state;
}

void place(Body& body, const BodyState& state) {
  set_place(body, state.pose.position, (state.pose.orientation * body.principal).normalized());
  const bool moves = body.motion != Motion::fixed;
  body.object->setLinearVelocity(moves ? to_bullet(state.twist.linear) : btVector3(0, 0, 0));
  body.object->setAngularVelocity(moves ? to_bullet(state.twist.angular) : btVector3(0, 0, 0));
  if (body.motion == Motion::kinematic) body.asleep = state.twist.linear.isZero(0) && state.twist.angular.isZero(0);
}

void set_place(Body& body, const Vec3& position, const Quat& turn) {
  body.turn = turn;
  body.object->setCenterOfMassTransform(btTransform(to_bullet(turn), to_bullet(position)));
}

Mat3 world_inertia(const Body& body) {
  const Mat3 turn = state_of(body).pose.orientation.toRotationMatrix();
  return turn * body.inertia * turn.transpose();
}

Body* find_body(const std::vector<Body*>& bodies, BodyId id) {
  const auto found =
      std::lower_bound(bodies.begin(), bodies.end(), id, [](const Body* b, BodyId wanted) { return b->id < wanted; });
  return found != bodies.end() && (*found)->id == id ? *found : nullptr;
}

Box bounds(const Body& body) {
  btVector3 low, high;
  body.shape->getAabb(body.object->getWorldTransform(), low, high);
  return Box(to_eigen(low), to_eigen(high));
}

}  // namespace sunder::rigid::detail
