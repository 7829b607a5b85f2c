#include <cmath>
#include <sstream>

#include "core/error.h"
#include "geometry/inspect.h"
#include "geometry/load.h"
#include "geometry/mass_properties.h"
#include "geometry/repair.h"
#include "geometry/surface_distance.h"
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

// Factors that bring the mesh's box to the scene's height or size.
Vec3 scale_factors(const MeshChoice& choice, const TriangleMesh& mesh) {
  const Vec3 extent = geometry::bounds(mesh).sizes();
  if (choice.height > 0) return Vec3::Constant(choice.height / extent.y());
  if (choice.size.isZero(0)) return Vec3::Ones();
  return choice.size.cwiseQuotient(extent);
}

// What the file says of its unit and axis counts where the scene says nothing; that it did is worth knowing.
std::string reading_note(const SceneBody& body, const geometry::TexturedMesh& loaded) {
  const geometry::LoadSettings& asked = body.mesh.load;
  const bool unit = !asked.metres_per_unit && loaded.metres_per_unit != 1;
  const bool axis = !asked.up && loaded.up != geometry::UpAxis::y;
  if (!unit && !axis) return "";
  std::ostringstream note;
  note << subject(body) << ": " << body.mesh.file.filename().string() << " states";
  if (unit) note << " that its unit is " << loaded.metres_per_unit << " m";
  if (axis)
    note << (unit ? " and" : "") << " that "
         << "XYZ"[static_cast<int>(loaded.up)] << " points up";
  note << "; unit and up of the scene would override it";
  return note.str();
}

geometry::RepairSettings repair_settings(const MeshChoice& choice, const TriangleMesh& mesh) {
  geometry::RepairSettings settings;
  settings.force_remesh = choice.repair == RepairMode::remesh;
  if (choice.remesh_voxel == 0) return settings;
  // The voxel is meant after scaling; where that stretches, the mean counts.
  const double scale = std::cbrt(scale_factors(choice, mesh).prod());
  settings.remesh_voxel = choice.remesh_voxel / scale / geometry::bounds(mesh).diagonal().norm();
  return settings;
}

BodyMesh repaired(const SceneBody& body, geometry::TexturedMesh loaded) {
  const geometry::RepairSettings settings = repair_settings(body.mesh, loaded.mesh);
  geometry::RepairResult result = geometry::repair(loaded.mesh, settings);
  if (!result.solid) {
    fail_mesh(body, result.before.summary(),
              "repair left: " + result.after.summary() + "; close the mesh in a modelling program");
  }
  if (result.steps.empty()) return {std::move(result.mesh), std::move(loaded.attributes), {}, {}};
  if (loaded.attributes != geometry::SurfaceAttributes{}) {
    // Mended surfaces lie on the old one but for rounding, remeshed ones within a voxel or two of it.
    const double diagonal = geometry::bounds(loaded.mesh).diagonal().norm();
    const double reach = (result.remeshed ? 2 * settings.remesh_voxel : 1e-6) * diagonal;
    loaded.attributes = geometry::transferred(loaded.mesh, loaded.attributes, result.mesh, reach);
  }
  const MeshRepair repair{result.steps, result.remeshed, result.before.volume, result.after.volume,
                          geometry::hausdorff_distance(loaded.mesh, result.mesh)};
  return {std::move(result.mesh), std::move(loaded.attributes), repair, {}};
}

BodyMesh solid_from_file(const SceneBody& body) {
  geometry::TexturedMesh loaded = load(body);
  const std::string note = reading_note(body, loaded);
  BodyMesh result;
  if (body.mesh.repair == RepairMode::off) {
    const geometry::MeshReport report = geometry::inspect(loaded.mesh);
    if (!report.is_solid()) fail_mesh(body, report.summary(), "repair = \"auto\" would try to mend it");
    result = {std::move(loaded.mesh), std::move(loaded.attributes), {}, {}};
  } else {
    result = repaired(body, std::move(loaded));
  }
  result.note = note;
  return result;
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
  // What repair measured was in the file's size.
  const double growth = scale.prod();
  result.repair.volume_before *= growth;
  result.repair.volume_after *= growth;
  result.repair.hausdorff *= scale.maxCoeff();
  const Vec3 offset = body.position - anchor_point(body.anchor, result.mesh);
  result.mesh = geometry::transformed(result.mesh, Mat3::Identity(), offset);
  return result;
}

}  // namespace sunder::pipeline
