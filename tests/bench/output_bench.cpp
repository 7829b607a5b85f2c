/// How fast a run is written: ./sunder bench output [--json FILE]. A thousand fragments over 240 frames, none of which
/// rests, and (`_resting`) all of which do within half of the run. The baseline of each ratio is a plain write(2) of
/// the same bytes in the same run.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "core/random.h"
#include "crack/shatter.h"
#include "geometry/attributes.h"
#include "geometry/cut.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "output/atomic_file.h"
#include "output/poster.h"
#include "output/writers.h"
#include "tests/bench/table.h"

namespace sunder {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int fragment_count = 1000, frame_count = 240;
constexpr std::size_t frame_stride = 10;  // of the formats with a file for each frame every tenth is written
constexpr double frame_rate = 24;
constexpr int repeats = 5;

Vec3 random_vector(std::uint64_t stream, std::uint64_t i) {
  return Vec3(random_unit(stream, 0, i), random_unit(stream, 1, i), random_unit(stream, 2, i)) - Vec3::Constant(0.5);
}

/// A ball of 20 000 faces and its fragments, with what fragments of a run carry: texture and damage times on cracks.
std::vector<output::Piece> shattered_ball() {
  output::Piece whole;
  whole.name = whole.body = "ball";
  whole.material = "glass";
  whole.mesh = geometry::sphere(0.5, 5);
  whole.source_face.resize(whole.mesh.faces.size());
  std::iota(whole.source_face.begin(), whole.source_face.end(), 0);
  whole.surface.material.resize(whole.mesh.faces.size(), 0);
  whole.surface.material_names = {output::outside_material(whole.material)};
  std::vector<Vec3> sites;
  for (std::uint64_t i = 0; sites.size() < fragment_count; ++i)
    if (const Vec3 x = random_vector(1, i); x.norm() < 0.5) sites.push_back(x);
  SilentProgress progress;
  const geometry::RegionBoundary cells = crack::voronoi_cells(sites, geometry::bounds(whole.mesh), 1, progress);
  const geometry::CutResult cut = geometry::cut(whole.mesh, cells, {}, progress);
  const std::vector<double> times(cells.vertices.size(), 1e-5);
  std::vector<output::Piece> pieces = {whole};
  for (const geometry::Fragment& fragment : cut.fragments) {
    output::Piece piece = whole;
    piece.id = static_cast<int>(pieces.size());
    piece.name = output::fragment_name(whole.name, piece.id);
    piece.parent = 0;
    piece.generation = 1;
    piece.source_face = fragment.source_face;
    geometry::InsideSettings inside;
    inside.material = output::inside_material(whole.material);
    inside.uv = true;
    inside.damage_time = times;
    piece.surface = geometry::carry(whole.mesh, whole.surface, fragment, cells, inside);
    const Vec3 centre = geometry::mass_properties(fragment.mesh).centroid;
    piece.mesh = geometry::transformed(fragment.mesh, Mat3::Identity(), -centre);
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// The fragments fly and turn from the second frame on, each until a time of its own up to `last_rest` [s]: then it
/// rests.
output::Sequence flying_ball(std::vector<output::Piece> pieces, double last_rest) {
  output::Sequence sequence;
  sequence.name = "ball";
  sequence.frame_rate = frame_rate;
  sequence.pieces = std::move(pieces);
  sequence.pieces[0].death_time = 1 / frame_rate;
  for (int f = 0; f < frame_count; ++f) {
    output::Frame frame;
    frame.time = f / frame_rate;
    for (std::uint64_t i = 1; f > 0 && i < sequence.pieces.size(); ++i) {
      const Vec3 velocity = 4 * random_vector(2, i), spin = 20 * random_vector(3, i);
      const double time = std::min(frame.time, last_rest * (0.5 + 0.5 * random_unit(4, 0, i)));
      const Vec3 fall(0, -4.905 * time * time, 0);
      frame.poses.push_back({static_cast<int>(i),
                             {velocity * time + fall, Quat(Eigen::AngleAxisd(spin.norm() * time, spin.normalized()))},
                             time == frame.time ? Twist{velocity, spin} : Twist{}});
    }
    if (f == 0) frame.poses.push_back({0, {}, {}});
    sequence.frames.push_back(std::move(frame));
  }
  for (output::Piece& piece : sequence.pieces)
    if (piece.parent == 0) piece.birth_time = 1 / frame_rate;
  return sequence;
}

/// Glass is what a still takes longest for: one sees through it.
output::Sequence made_of(output::Sequence sequence, const std::string& substance) {
  for (output::Piece& piece : sequence.pieces) {
    piece.material = substance;
    piece.surface.material_names = {output::outside_material(substance)};
    if (piece.parent >= 0) piece.surface.material_names.push_back(output::inside_material(substance));
  }
  return sequence;
}

double seconds_of(const std::function<void()>& work) {
  const auto start = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Files by name with their bytes.
std::vector<std::pair<fs::path, std::string>> contents(const fs::path& folder) {
  std::vector<std::pair<fs::path, std::string>> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::ostringstream text;
    text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    files.emplace_back(entry.path(), text.str());
  }
  return files;
}

void write_plainly(const fs::path& file, const std::string& bytes) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  std::size_t done = 0;
  while (descriptor >= 0 && done < bytes.size()) {
    const ssize_t written = write(descriptor, bytes.data() + done, bytes.size() - done);
    if (written <= 0) break;
    done += static_cast<std::size_t>(written);
  }
  if (descriptor < 0 || close(descriptor) != 0 || done < bytes.size())
    throw Error(ErrorKind::io, "cannot write " + file.string());
}

/// `work` writes into the folder. What it wrote is written plainly as well, in turn, so that both meet the same
/// machine.
void measure(bench::Table& table, const std::string& name, const fs::path& folder, const std::function<void()>& work) {
  std::vector<double> ours, plain;
  double bytes = 0;
  for (int i = 0; i < repeats; ++i) {
    fs::remove_all(folder);
    output::create_folder(folder);
    ours.push_back(seconds_of(work));
    const auto files = contents(folder);
    bytes = 0;
    for (const auto& [file, text] : files) bytes += static_cast<double>(text.size());
    fs::remove_all(folder);
    output::create_folder(folder);
    plain.push_back(seconds_of([&] {
      for (const auto& [file, text] : files) write_plainly(file, text);
    }));
  }
  table.add(name + "_megabytes", bytes / 1e6, "written");
  table.add(name + "_seconds", median(ours), "median of 5");
  table.add(name + "_megabytes_per_second", bytes / 1e6 / median(ours), "");
  table.add(name + "_over_plain_write", median(ours) / median(plain), "ratio of times to write(2) of the same bytes");
}

void measure_all(bench::Table& table) {
  const std::vector<output::Piece> pieces = shattered_ball();
  constexpr double run = frame_count / frame_rate;
  const output::Sequence sequence = flying_ball(pieces, 2 * run), resting = flying_ball(pieces, run / 2);
  const fs::path folder = fs::temp_directory_path() / ("sunder_output_bench_" + std::to_string(getpid()));
  std::size_t faces = 0;
  for (const output::Piece& piece : sequence.pieces) faces += piece.mesh.faces.size();
  table.add("fragments", static_cast<double>(sequence.pieces.size() - 1), "of a ball");
  table.add("faces", static_cast<double>(faces), "of ball and fragments");
  const auto frames = [&](const auto& write) {
    for (std::size_t f = 0; f < sequence.frames.size(); f += frame_stride) write(f);
  };
  measure(table, "glb", folder, [&] { output::write_glb(sequence, folder / "fragments.glb"); });
  measure(table, "glb_resting", folder, [&] { output::write_glb(resting, folder / "fragments.glb"); });
  measure(table, "obj", folder, [&] {
    output::ObjFrames obj;
    frames([&](std::size_t f) { obj.write(sequence, f, folder); });
  });
  measure(table, "ply", folder, [&] { frames([&](std::size_t f) { output::write_ply_frame(sequence, f, folder); }); });
  measure(table, "usda", folder, [&] { output::write_usda(sequence, folder / "fragments.usda"); });
  measure(table, "usda_resting", folder, [&] { output::write_usda(resting, folder / "fragments.usda"); });
  measure(table, "csv", folder, [&] { output::write_transforms_csv(sequence, folder / "transforms.csv"); });
  measure(table, "jsonl", folder, [&] { output::write_transforms_jsonl(sequence, folder / "transforms.jsonl"); });
  for (const std::string substance : {"plaster", "glass"}) {
    const output::Sequence of = made_of(sequence, substance);
    measure(table, "poster_" + substance, folder, [&] { output::write_poster(of, -0.6, folder / "poster.png"); });
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace sunder

int main(int argc, char** argv) {
  const bool json = argc == 3 && std::strcmp(argv[1], "--json") == 0;
  if (argc != 1 && !json) {
    std::fprintf(stderr, "usage: output_bench [--json FILE]\n");
    return 2;
  }
  try {
    sunder::bench::Table table;
    sunder::measure_all(table);
    if (json) table.save(argv[2]);
    return 0;
  } catch (const sunder::Error& error) {
    std::fprintf(stderr, "output_bench: %s\n", error.what());
    return static_cast<int>(error.kind());
  }
}
