#include "tests/pipeline/burst.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "geometry/primitives.h"
#include "output/atomic_file.h"
#include "output/sequence.h"
#include "output/writers.h"
#include "pipeline/report.h"
#include "pipeline/report_page.h"

namespace sunder::pipeline {
namespace {

constexpr double burst_radius = 0.1;  // of the ball [m]

// The k-th of n points that fill the ball evenly: a Fibonacci spiral whose radius grows by the cube root.
Vec3 shard_centre(int k, int n) {
  const double share = (k + 0.5) / n;
  const double polar = std::acos(1 - 2 * std::fmod(share * 7.3, 1.0)), turn = 2.399963 * k;
  return 0.85 * burst_radius * std::cbrt(share) *
         Vec3(std::sin(polar) * std::cos(turn), std::cos(polar), std::sin(polar) * std::sin(turn));
}

// Faces that look at the middle of the ball are on cracks, which broke the later the farther out they are.
void split_surface(output::Piece& piece, const Vec3& centre) {
  piece.surface.material_names = {"porcelain_outside", "porcelain_inside"};
  for (const geometry::Triangle& face : piece.mesh.faces) {
    Vec3 middle = Vec3::Zero();
    std::array<double, 3> times{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& vertex = piece.mesh.vertices[static_cast<std::size_t>(face[k])];
      middle += vertex / 3;
      times[k] = 1e-4 * (centre + vertex).norm() / burst_radius;
    }
    const bool inside = piece.parent >= 0 && middle.dot(centre) < 0;
    piece.source_face.push_back(inside ? -1 : 0);
    piece.surface.material.push_back(inside ? 1 : 0);
    piece.surface.damage_time.push_back(inside ? times : std::array<double, 3>{-1, -1, -1});
  }
}

output::Piece burst_piece(int id, const Vec3& centre, double radius, int subdivisions) {
  output::Piece piece;
  piece.id = id;
  piece.parent = id == 0 ? -1 : 0;
  piece.generation = id == 0 ? 0 : 1;
  piece.body = "ball";
  piece.name = id == 0 ? "ball" : output::fragment_name("ball", id);
  piece.material = "porcelain";
  piece.closed = true;
  piece.mesh = geometry::sphere(radius, subdivisions);
  piece.volume = 4 * std::numbers::pi / 3 * radius * radius * radius;
  piece.area = 4 * std::numbers::pi * radius * radius;
  piece.mass = 2400 * piece.volume;
  split_surface(piece, centre);
  return piece;
}

// Whole in the first tenth of the frames; shards are of many sizes.
output::Sequence burst_sequence(const Burst& burst) {
  output::Sequence sequence;
  sequence.name = "burst";
  sequence.frame_rate = burst.frame_rate;
  const int first = std::max(1, burst.frames / 10);
  const double birth = first / burst.frame_rate;
  sequence.pieces.push_back(burst_piece(0, Vec3::Zero(), burst_radius, 4));
  sequence.pieces[0].death_time = birth;
  const double spacing = 1.6 * burst_radius / std::cbrt(burst.shards);
  for (int k = 0; k < burst.shards; ++k) {
    const double size = 0.25 + 0.3 * std::abs(std::sin(12.9898 * k));
    sequence.pieces.push_back(
        burst_piece(k + 1, shard_centre(k, burst.shards), size * spacing, burst.subdivisions + k % 2));
    sequence.pieces.back().birth_time = birth;
  }
  const Vec3 middle(0, 2 * burst_radius, 0);
  for (int f = 0; f < burst.frames; ++f) {
    output::Frame frame{f / burst.frame_rate, {}};
    if (f < first) frame.poses.push_back({0, {middle, Quat::Identity()}, {}});
    const double t = frame.time - birth;
    for (int k = 0; f >= first && k < burst.shards; ++k) {
      const Vec3 centre = shard_centre(k, burst.shards);
      Vec3 place = middle + centre + t * 12 * centre - Vec3(0, 4.9 * t * t, 0);
      place.y() = std::max(place.y(), 0.2 * spacing);
      const double angle = std::min(t, 0.4) * (3 + k % 7);
      frame.poses.push_back({k + 1, {place, Quat(Eigen::AngleAxisd(angle, Vec3(1, k % 3, 1).normalized()))}, {}});
    }
    sequence.frames.push_back(frame);
  }
  return sequence;
}

Report burst_report(const Burst& burst) {
  Report report;
  report.scene = "burst";
  report.quality = "draft";
  report.seed = 7;
  report.threads = 2;
  report.fingerprint = "0123456789abcdef";
  report.effects = effect_records({}, {});
  FractureRecord fracture;
  fracture.body = "ball";
  fracture.time = std::max(1, burst.frames / 10) / burst.frame_rate;
  fracture.fragments = burst.shards;
  fracture.particles = 6000;
  fracture.steps = 900;
  fracture.energy = mpm::EnergyLedger{};
  fracture.energy->work = 8;
  fracture.energy->kinetic = 5;
  fracture.band_width = 0.012;
  fracture.admissible_length = 0.0014;
  fracture.tensile_strength = 45e6;
  fracture.propagation_strength = 13e6;
  fracture.stopped_by = "quiet";
  report.fractures = {fracture};
  report.seconds = {.total = 3, .setup = 0.3, .rigid = 0.2, .sample = 0.1, .solve = 1.4, .extract = 0.3, .cut = 0.4};
  report.fallbacks["cut_retried"] = 2;
  report.notes = {"a note with <markup> & signs"};
  return report;
}

}  // namespace

void write_burst(const Burst& burst, const std::filesystem::path& folder) {
  output::create_folder(folder);
  const output::Sequence sequence = burst_sequence(burst);
  output::write_glb(sequence, folder / "fragments.glb");
  output::write_atomically(folder / "report.json", to_json(burst_report(burst), sequence));
  output::write_atomically(folder / "scene.toml", "# A burst.\n[ground]\nheight = 0\n");
  write_report_page(folder);
}

}  // namespace sunder::pipeline
