#include "core/error.h"
#include "geometry/inspect.h"
#include "geometry/load.h"
#include "geometry/repair.h"
#include "pipeline/detail/primitive_shapes.h"
#include "pipeline/scene.h"

namespace sunder::pipeline {
namespace {

using geometry::TriangleMesh;

std::string subject(const SceneBody& body) {
  if (body.line == 0) return body.name;  // not from a scene
  return "body '" + body.name + "' (line " + std::to_string(body.line) + ")";
}

[[noreturn]] void fail_mesh(const SceneBody& body, const std::string& defect, const std::string& remedy) {
  throw Error(ErrorKind::mesh,
              subject(body) + ": mesh " + body.mesh.file.string() + " is not a solid: " + defect + "; " + remedy);
}

geometry::TexturedMesh load(const SceneBody& body) {
  try {
    return geometry::load_textured_mesh(body.mesh.file, body.mesh.load);
  } catch (const Error& error) {
    throw Error(error.kind(), subject(body) + ": " + error.what());
  }
}

BodyMesh solid_from_file(const SceneBody& body) {
  geometry::TexturedMesh loaded = load(body);
  if (!body.mesh.allow_repair) {
    const geometry::MeshReport report = geometry::inspect(loaded.mesh);
    if (!report.is_solid()) fail_mesh(body, report.summary(), "repair = \"auto\" would try to mend it");
    return {std::move(loaded.mesh), std::move(loaded.attributes), {}};
  }
  const geometry::RepairSettings settings;
  geometry::RepairResult repaired = geometry::repair(loaded.mesh, settings);
  if (!repaired.solid) {
    fail_mesh(body, repaired.before.summary(),
              "repair left: " + repaired.after.summary() + "; close the mesh in a modelling program");
  }
  if (!repaired.steps.empty() && loaded.attributes != geometry::SurfaceAttributes{}) {
    // Mended surfaces lie on the old one but for rounding, remeshed ones within a voxel or two of it.
    const double diagonal = geometry::bounds(loaded.mesh).diagonal().norm();
    const double reach = (repaired.remeshed ? 2 * settings.remesh_voxel : 1e-6) * diagonal;
    loaded.attributes = geometry::transferred(loaded.mesh, loaded.attributes, repaired.mesh, reach);
  }
  return {std::move(repaired.mesh), std::move(loaded.attributes), std::move(repaired.steps)};
}

// Factors that bring the mesh's box to the scene's height or size.
Vec3 scale_factors(const MeshChoice& choice, const TriangleMesh& mesh) {
  const Vec3 extent = geometry::bounds(mesh).sizes();
  if (choice.height > 0) return Vec3::Constant(choice.height / extent.y());
  if (choice.size.isZero(0)) return Vec3::Ones();
  return choice.size.cwiseQuotient(extent);
}

Vec3 anchor_point(Anchor anchor, const TriangleMesh& mesh) {
  if (anchor == Anchor::origin) return Vec3::Zero();
  const Box box = geometry::bounds(mesh);
  const Vec3 centre = box.center();
  return anchor == Anchor::centre ? centre : Vec3(centre.x(), box.min().y(), centre.z());
}

}  // namespace

BodyMesh body_mesh(const SceneBody& body) {
  BodyMesh result;
  Vec3 scale = Vec3::Ones();
  if (const detail::PrimitiveShape* shape = detail::find_primitive(body.mesh.name); shape && body.mesh.file.empty()) {
    result.mesh = detail::make_primitive(*shape, body.mesh);
  } else {
    result = solid_from_file(body);
    scale = scale_factors(body.mesh, result.mesh);
  }
  const Mat3 linear = body.orientation.toRotationMatrix() * scale.asDiagonal();
  result.mesh = geometry::transformed(result.mesh, linear, Vec3::Zero());
  geometry::transform_normals(result.attributes, linear);
  const Vec3 offset = body.position - anchor_point(body.anchor, result.mesh);
  result.mesh = geometry::transformed(result.mesh, Mat3::Identity(), offset);
  return result;
}

}  // namespace sunder::pipeline
