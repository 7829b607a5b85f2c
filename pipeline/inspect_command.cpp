#include "pipeline/inspect_command.h"

#include <iostream>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "geometry/repair.h"
#include "geometry/surface_distance.h"

namespace sunder::pipeline {
namespace {

using Json = nlohmann::ordered_json;
using geometry::MeshReport;

/// The mesh, and for what is no solid what repair makes of it.
struct Verdict {
  geometry::TexturedMesh loaded;
  MeshReport report;
  std::optional<geometry::RepairResult> repair;
  double hausdorff = 0;  ///< between the mesh and the mended one [m]

  const char* word() const { return report.is_solid() ? "solid" : repair->solid ? "mendable" : "hopeless"; }
  int exit_code() const {
    if (report.is_solid()) return 0;
    return repair->solid ? exit_mendable : static_cast<int>(ErrorKind::mesh);
  }
};

Verdict verdict_on(const InspectOptions& options) {
  Verdict verdict{geometry::load_textured_mesh(options.mesh, options.load), {}, {}};
  geometry::TriangleMesh& mesh = verdict.loaded.mesh;
  if (options.height > 0) {
    const double scale = options.height / geometry::bounds(mesh).sizes().y();
    if (!std::isfinite(scale))
      throw Error(ErrorKind::mesh, options.mesh.string() + ": is flat; it cannot be scaled to a height");
    mesh = geometry::transformed(mesh, scale * Mat3::Identity(), Vec3::Zero());
  }
  verdict.report = geometry::inspect(mesh);
  if (verdict.report.is_solid()) return verdict;
  verdict.repair = geometry::repair(mesh);
  if (verdict.repair->solid) verdict.hausdorff = geometry::hausdorff_distance(mesh, verdict.repair->mesh);
  return verdict;
}

Json vector_json(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

Json report_json(const MeshReport& r) {
  return {{"vertices", r.vertices},
          {"faces", r.faces},
          {"shells", r.shells},
          {"boundary_edges", r.boundary_edges},
          {"holes", r.boundary_loops},
          {"non_manifold_edges", r.non_manifold_edges},
          {"non_manifold_vertices", r.non_manifold_vertices},
          {"degenerate_faces", r.degenerate_faces},
          {"duplicate_vertices", r.duplicate_vertices},
          {"self_intersections", r.self_intersections < 0 ? Json() : Json(r.self_intersections)},
          {"inverted_shells", r.inverted_shells},
          {"nested_shells", r.nested_shells},
          {"volume", r.volume},
          {"size", vector_json(r.box.sizes())}};
}

Json verdict_json(const InspectOptions& options, const Verdict& verdict) {
  const geometry::SurfaceAttributes& attributes = verdict.loaded.attributes;
  Json json = {{"file", options.mesh.string()},
               {"verdict", verdict.word()},
               {"summary", verdict.report.summary()},
               {"metres_per_unit", verdict.loaded.metres_per_unit},
               {"up", std::string(1, "xyz"[static_cast<int>(verdict.loaded.up)])},
               {"mesh", report_json(verdict.report)},
               {"carries",
                {{"uv", !attributes.uv.empty()},
                 {"normals", !attributes.normal.empty()},
                 {"colours", !attributes.colour.empty()},
                 {"materials", attributes.material_names}}},
               {"repair", nullptr}};
  if (verdict.repair)
    json["repair"] = {{"solid", verdict.repair->solid},
                      {"steps", verdict.repair->steps},
                      {"remeshed", verdict.repair->remeshed},
                      {"hausdorff", verdict.repair->solid ? Json(verdict.hausdorff) : Json()},
                      {"mesh", report_json(verdict.repair->after)}};
  return json;
}

void say(const InspectOptions& options, const Verdict& verdict) {
  const MeshReport& r = verdict.report;
  const Vec3 size = r.box.sizes();
  std::cout << options.mesh.string() << ": " << r.summary() << "\n"
            << r.vertices << " vertices, " << r.faces << " faces, " << r.shells << " shells (" << r.nested_shells
            << " of them voids), size " << size[0] << " x " << size[1] << " x " << size[2] << " m, volume " << r.volume
            << " m^3\n";
  if (r.self_intersections < 0) std::cout << "self-intersections were not looked for: the faces are no surface yet\n";
  if (!verdict.repair) return;
  const geometry::RepairResult& repair = *verdict.repair;
  std::cout << (repair.solid ? "repair would make it a solid:\n" : "repair cannot make it a solid; it would try:\n");
  for (const std::string& step : repair.steps) std::cout << "  " << step << "\n";
  if (repair.solid)
    std::cout << "volume " << repair.after.volume << " m^3 then, the surface moves by up to " << verdict.hausdorff
              << " m\n";
  else
    std::cout << "what is left: " << repair.after.summary() << "\n";
}

}  // namespace

int inspect_command(const InspectOptions& options) {
  const Verdict verdict = verdict_on(options);
  if (options.json)
    std::cout << verdict_json(options, verdict).dump(2, ' ', false, Json::error_handler_t::replace) << std::endl;
  else
    say(options, verdict);
  return verdict.exit_code();
}

}  // namespace sunder::pipeline
