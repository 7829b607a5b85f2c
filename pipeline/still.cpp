#include "pipeline/still.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/random.h"
#include "core/stopwatch.h"
#include "crack/shatter.h"
#include "geometry/inspect.h"
#include "geometry/load_points.h"
#include "geometry/mass_properties.h"
#include "geometry/sample.h"
#include "geometry/surface_distance.h"
#include "output/atomic_file.h"
#include "output/fragments_table.h"
#include "output/writers.h"
#include "pipeline/crack_writer.h"
#include "pipeline/detail/mesh_catalogue.h"
#include "pipeline/detail/piece_mesh.h"
#include "pipeline/fracture.h"

namespace sunder::pipeline {
namespace {

constexpr int candidates_per_cell = 16;  // points of a lattice in the body, among which the sites are drawn
constexpr double points_per_box = 8;     // of the boxes that measure how densely points lie
constexpr double far_off = 0.05;         // of the body's diagonal: a point so far from the surface was hardly meant
constexpr const char* impactor = "steel";

SceneBody body_of(const StillOptions& options) {
  const AssetPaths assets = default_assets();
  SceneBody body;
  body.name = options.mesh.stem().string();
  body.anchor = Anchor::origin;
  body.mesh = {options.mesh.string(), options.mesh, options.load, Vec3::Zero(), options.height, 0};
  const detail::MeshCatalogue catalogue = detail::load_catalogue(assets.meshes);
  if (const auto known = catalogue.find(options.mesh.string()); known != catalogue.end()) {
    body.mesh.file = assets.mesh_cache / known->second.file;
    body.mesh.load.up = known->second.up;
  }
  return body;
}

Material find_material(const std::string& name) {
  const MaterialLibrary library = load_materials(default_assets().materials);
  const auto found = library.find(name);
  if (found != library.end()) return found->second;
  std::string known;
  for (const auto& [other, material] : library) known.append(known.empty() ? "" : ", ").append(other);
  throw Error(ErrorKind::usage, "there is no material '" + name + "'; known: " + known);
}

/// The body, and its fragments when there are any.
output::Sequence still_sequence(const SceneBody& body, const BodyMesh& source, const Cracked& cracked, double density) {
  output::Sequence sequence;
  sequence.name = body.name;
  sequence.frames.resize(1);
  const auto add = [&](output::Piece piece) {
    piece.birth_position = detail::measured(piece, density).centre;
    piece.id = static_cast<int>(sequence.pieces.size());
    if (piece.parent >= 0 || cracked.cut.fragments.empty()) sequence.frames[0].poses.push_back({piece.id, {}, {}});
    sequence.pieces.push_back(std::move(piece));
  };
  const output::Piece whole = detail::whole_piece(body.name, body.material.name, source.mesh, source.attributes);
  add(whole);
  if (!cracked.cut.fragments.empty()) sequence.pieces[0].death_time = 0;
  for (const geometry::Fragment& fragment : cracked.cut.fragments) {
    output::Piece piece = detail::fragment_piece(whole, fragment, cracked);
    piece.name = output::fragment_name(body.name, static_cast<int>(sequence.pieces.size()) - 1);
    add(std::move(piece));
  }
  return sequence;
}

/// Pieces of an earlier call would be taken for those of this one.
void remove_stale_pieces(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".obj") std::filesystem::remove(entry.path());
}

void write_pieces(const output::Sequence& sequence, const std::filesystem::path& out, double& seconds) {
  const Stopwatch watch(seconds);
  const std::filesystem::path folder = out / "fragments";
  output::create_folder(folder);
  remove_stale_pieces(folder);
  for (const output::PiecePose& pose : sequence.frames[0].poses) {
    const output::Piece& piece = sequence.pieces[static_cast<std::size_t>(pose.piece)];
    output::write_obj_piece(piece, folder / (piece.name + ".obj"));
  }
  output::write_glb(sequence, out / "fragments.glb");
  output::write_fragments_csv(sequence, out / "fragments.csv");
}

Report report_of(const StillOptions& options, const std::string& name) {
  Report report;
  report.scene = name;
  report.seed = options.seed;
  return report;
}

void note_source(Report& report, const SceneBody& body, const BodyMesh& source) {
  if (!source.repair.steps.empty()) report.repairs.push_back({body.name, source.repair});
  if (!source.note.empty()) report.notes.push_back(source.note);
}

void finish(StillResult& result, const std::filesystem::path& out, double total) {
  result.report.seconds.total = total;
  output::write_atomically(out / "report.json", to_json(result.report, result.sequence));
}

/// Random points in the solid, by drawing from a fine lattice.
std::vector<Vec3> random_points(const geometry::TriangleMesh& mesh, int count, std::uint64_t seed, Progress& progress) {
  const geometry::Samples samples =
      geometry::sample_solid(mesh, {.count = count * candidates_per_cell, .jitter = 0.5, .seed = seed}, progress);
  std::vector<std::pair<std::uint64_t, Vec3>> drawn;
  for (const Vec3& x : samples.points) drawn.emplace_back(random_word(seed, 0xce115, drawn.size()), x);
  std::sort(drawn.begin(), drawn.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  drawn.resize(std::min(drawn.size(), static_cast<std::size_t>(count)));
  std::vector<Vec3> points;
  for (const auto& [key, x] : drawn) points.push_back(x);
  return points;
}

/// What the options ask of a body of this box, by the rules of scenes. The command breaks it, whatever its material.
struct Asked {
  Scene scene;
  EffectPlan plan;
  CrackChoice crack;

  Asked(const StillOptions& options, const SceneBody& body, Quality quality, const Box& box) {
    scene.duration = 0;
    scene.quality = quality;
    scene.bodies = {body};
    scene.bodies[0].material.breakable = true;
    scene.fracture = options.fracture;
    scene.effects = options.effects;
    const double size = box.sizes().maxCoeff();
    plan = plan_effects(scene, {size});
    crack = crack_choice(scene, plan, body.material, size);
  }
};

double impulse_of(const FractureOptions& options, const geometry::TriangleMesh& mesh, const Material& material) {
  if (options.severity == 0) return options.impulse;
  const double volume = geometry::mass_properties(mesh).volume;
  return options.severity * breaking_impulse(material.density * volume, volume, material, options.speed);
}

FractureInput fracture_input(const FractureOptions& options, const geometry::TriangleMesh& mesh,
                             const Material& material, Report& report) {
  const Material ball = find_material(impactor);
  const geometry::SurfacePoint target = geometry::nearest_on(mesh, {&*options.at, 1}).front();
  const Vec3 normal = geometry::face_normal(mesh, static_cast<std::size_t>(target.face));
  if (target.distance > far_off * geometry::bounds(mesh).diagonal().norm())
    report.notes.push_back("--at lies " + std::to_string(target.distance) +
                           " m off the surface; the nearest point of the surface was hit (are the units right?)");
  const double mass = impulse_of(options, mesh, material) / options.speed;
  mpm::Load load;
  load.point = target.point;
  load.outward = options.direction ? (-options.direction->normalized()).eval() : normal;
  if (!(load.outward.dot(normal) > 0.05))
    throw Error(ErrorKind::usage,
                "--direction points out of the surface at --at; the impactor has to come from outside");
  load.approach_speed = options.speed;
  const double ball_radius = std::cbrt(3 * mass / (4 * std::numbers::pi * ball.density));
  const double body_radius = geometry::bounds(mesh).sizes().maxCoeff() / 2;
  load.pair.effective_radius = 1 / (1 / ball_radius + 1 / body_radius);
  load.pair.effective_modulus =
      mpm::effective_modulus(material.youngs_modulus, material.poisson_ratio, ball.youngs_modulus, ball.poisson_ratio);
  load.pair.contact_pressure = std::min(material.contact_pressure, ball.contact_pressure);
  FractureInput input;
  input.mesh = mesh;
  input.material = material;
  input.loads = {load};
  input.partners = {{mass}};
  input.particles = options.quality.particles;
  input.seed = input.solve.seed = options.seed;
  return input;
}

void add_fallbacks(Report& report, const Fallbacks& fallbacks) {
  for (const auto& [name, count] : fallbacks) report.fallbacks[name] += count;
}

StillImpact impact_of(const mpm::Load& load, double mass) {
  return {load.point, -load.outward, mass * load.approach_speed, load.approach_speed,
          mass * load.approach_speed * load.approach_speed / 2};
}

/// What an impact does, with the record of its solve.
Cracked hit(const FractureOptions& options, const geometry::TriangleMesh& mesh, const SceneBody& body,
            StillResult& result, Progress& progress) {
  Report& report = result.report;
  const Asked asked(options, body, options.quality, geometry::bounds(mesh));
  const FractureInput input = as_asked(fracture_input(options, mesh, body.material, report), asked.scene, asked.plan);
  result.impact = impact_of(input.loads.front(), input.partners.front().mass);
  FractureOutcome outcome = fracture(input, progress);
  FractureRecord record = record_of(input, outcome);
  record.body = body.name;
  record.impulse = result.impact->impulse;
  record.fragments = outcome.pieces.size() > 1 ? static_cast<int>(outcome.pieces.size()) : 0;
  add_fallbacks(report, outcome.fallbacks);
  const std::vector<std::string>& troubles = outcome.cracked.troubles;
  report.notes.insert(report.notes.end(), troubles.begin(), troubles.end());
  report.particle_steps = record.particles * record.steps;
  report.quality = name_of(options.quality);
  report.seconds.sample = record.seconds.sample;
  report.seconds.solve = record.seconds.solve;
  report.seconds.extract = record.seconds.extract;
  report.seconds.cut = record.seconds.cut;
  report.fractures.push_back(record);
  report.effects = effect_records(asked.plan, record.effects);
  report.extract = record_of(outcome.cracked.extraction);
  report.extract->points = record.particles;
  report.extract->point_spacing = outcome.own->samples.spacing;
  return std::move(outcome.cracked);
}

Cracked shatter(const FractureOptions& options, const geometry::TriangleMesh& mesh, const SceneBody& body,
                Report& report, Progress& progress) {
  const std::vector<Vec3> sites = random_points(mesh, options.cells, options.seed, progress);
  const geometry::RegionBoundary cells = crack::voronoi_cells(sites, geometry::bounds(mesh), options.seed, progress);
  const Asked asked(options, body, options.quality, geometry::bounds(mesh));
  Cracked cracked = cut_regions(mesh, cells, asked.crack, options.seed, progress);
  report.effects = effect_records(asked.plan, work_of(cracked));
  report.seconds.extract = cracked.extract_seconds;
  report.seconds.cut = cracked.cut_seconds;
  report.cut_volume_error = cracked.cut.volume_error;
  report.notes = cracked.troubles;
  add_fallbacks(report, cracked.fallbacks);
  return cracked;
}

/// Mean distance of points, from how many lie in boxes that hold a few each. Half empty boxes at the border make it a
/// few percent too large.
double spacing_of(const std::vector<Vec3>& points) {
  Box box;
  for (const Vec3& x : points) box.extend(x);
  const double diagonal = box.diagonal().norm();
  if (!(diagonal > 0)) throw Error(ErrorKind::usage, "all points lie at the same place");
  for (double width = diagonal / std::cbrt(static_cast<double>(points.size())) / 4;; width *= 1.25) {
    std::vector<std::array<std::int64_t, 3>> boxes;
    for (const Vec3& x : points) {
      const Vec3 at = (x - box.min()) / width;
      boxes.push_back(
          {static_cast<std::int64_t>(at.x()), static_cast<std::int64_t>(at.y()), static_cast<std::int64_t>(at.z())});
    }
    std::sort(boxes.begin(), boxes.end());
    const double count = static_cast<double>(std::unique(boxes.begin(), boxes.end()) - boxes.begin());
    const double share = static_cast<double>(points.size()) / count;
    if (share >= points_per_box || count <= 1) return width / std::cbrt(share);
  }
}

crack::DamageField damage_field(const ExtractOptions& options, const geometry::TriangleMesh& mesh) {
  geometry::DamagedPoints cloud = geometry::load_points(options.points);
  for (Vec3& x : cloud.points) x *= options.load.metres_per_unit.value_or(1);
  crack::DamageField field;
  const double count = static_cast<double>(cloud.points.size());
  field.spacing =
      mesh.faces.empty() ? spacing_of(cloud.points) : std::cbrt(geometry::mass_properties(mesh).volume / count);
  field.cell_size = 2 * field.spacing;
  field.points = std::move(cloud.points);
  field.damage = std::move(cloud.damage);
  field.damage_time = std::move(cloud.damage_time);
  return field;
}

}  // namespace

StillBody load_still_body(const FractureOptions& options) {
  StillBody still{body_of(options), {}};
  still.body.material = find_material(options.material);
  if (options.cells == 0 && !still.body.material.breakable)
    throw Error(ErrorKind::usage, "material '" + options.material + "' does not break");
  still.source = body_mesh(still.body);
  return still;
}

double breaking_impulse(double mass, double volume, const Material& material, double speed) {
  // p = sqrt(2 m E) with the reduced mass m = mass b / (mass + b) of the impactor's mass b = p / speed, solved for p.
  const double energy = crack_through_energy(material, volume);
  return speed / 2 * (std::sqrt(mass * mass + 8 * energy * mass / (speed * speed)) - mass);
}

StillResult break_still_body(const StillBody& still, const FractureOptions& options, Progress& progress) {
  const bool hits = options.at && (options.impulse > 0 || options.severity > 0) && options.speed > 0;
  if (options.cells == 0 && !hits)
    throw Error(ErrorKind::usage, "a hit needs --at, and a positive --impulse and --speed");
  StillResult result;
  result.report = report_of(options, still.body.name);
  note_source(result.report, still.body, still.source);
  Cracked cracked = options.cells > 0 ? shatter(options, still.source.mesh, still.body, result.report, progress)
                                      : hit(options, still.source.mesh, still.body, result, progress);
  result.sequence = still_sequence(still.body, still.source, cracked, still.body.material.density);
  result.cracks = std::move(cracked.extraction);
  return result;
}

StillResult fracture_mesh(const FractureOptions& options, Progress& progress) {
  StillResult result;
  double total = 0;
  {
    const Stopwatch watch(total);
    const StillBody body = load_still_body(options);
    output::create_folder(options.out);
    result = break_still_body(body, options, progress);
    if (options.cells == 0) write_crack_surface(result.cracks, options.out / "cracks.ply");
    write_pieces(result.sequence, options.out, result.report.seconds.write);
  }
  finish(result, options.out, total);
  return result;
}

StillResult extract_points(const ExtractOptions& options, Progress& progress) {
  StillResult result;
  double total = 0;
  {
    const Stopwatch watch(total);
    BodyMesh source;
    SceneBody body;
    body.name = options.points.stem().string();
    if (!options.mesh.empty()) {
      body = body_of(options);
      source = body_mesh(body);
    }
    const geometry::TriangleMesh& mesh = source.mesh;
    const crack::DamageField field = damage_field(options, mesh);
    output::create_folder(options.out);
    result.report = report_of(options, body.name);
    note_source(result.report, body, source);
    const Asked asked(options, body, Quality::preview,
                      mesh.faces.empty() ? mpm::box_of(field.points) : geometry::bounds(mesh));
    Cracked cracked = mesh.faces.empty() ? extract_only(field, asked.crack, options.seed, progress)
                                         : crack_and_cut(mesh, field, asked.crack, options.seed, progress);
    result.report.effects = effect_records(asked.plan, work_of(cracked));
    result.report.extract = record_of(cracked.extraction);
    result.report.extract->point_spacing = field.spacing;
    result.report.seconds.extract = cracked.extract_seconds;
    result.report.seconds.cut = cracked.cut_seconds;
    result.report.cut_volume_error = cracked.cut.volume_error;
    result.report.notes = cracked.troubles;
    add_fallbacks(result.report, cracked.fallbacks);
    write_crack_surface(cracked.extraction, options.out / "cracks.ply");
    if (!mesh.faces.empty()) {
      body.material.name = "material";
      result.sequence = still_sequence(body, source, cracked, 1);
      write_pieces(result.sequence, options.out, result.report.seconds.write);
    }
  }
  finish(result, options.out, total);
  return result;
}

}  // namespace sunder::pipeline
