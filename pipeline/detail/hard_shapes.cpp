#include <algorithm>
#include <cmath>
#include <map>

#include "core/random.h"
#include "crack/shatter.h"
#include "geometry/inspect.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "geometry/repair.h"
#include "pipeline/detail/hard_cases.h"

namespace sunder::pipeline::detail {
namespace {

using geometry::TriangleMesh;
using validation::absolute;
using validation::Outcome;
using validation::within;

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const int shift = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const geometry::Triangle& t : b.faces) a.faces.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return a;
}

/// Every face in four.
TriangleMesh subdivided(const TriangleMesh& mesh) {
  TriangleMesh fine;
  fine.vertices = mesh.vertices;
  std::map<std::pair<int, int>, int> middle;
  const auto between = [&](int a, int b) {
    const auto [at, added] = middle.emplace(std::minmax(a, b), static_cast<int>(fine.vertices.size()));
    if (added)
      fine.vertices.push_back(
          0.5 * (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)]));
    return at->second;
  };
  for (const geometry::Triangle& t : mesh.faces) {
    const int x = between(t[0], t[1]), y = between(t[1], t[2]), z = between(t[2], t[0]);
    fine.faces.insert(fine.faces.end(), {{t[0], x, z}, {x, t[1], y}, {z, y, t[2]}, {x, y, z}});
  }
  return fine;
}

/// What repair makes of a broken mesh must be a solid that breaks, or be refused.
void mend_and_break(const TriangleMesh& mesh, const std::string& what, Outcome& outcome) {
  const geometry::RepairResult r = geometry::repair(mesh);
  outcome.checks.push_back(absolute(what + ": mended to a solid", r.solid, 1, 0));
  if (r.solid) sound_fracture(steel_ball_on(r.mesh, hard_glass(), 30), what, outcome);
}

/// S6, the part of meshes.
Outcome broken_meshes() {
  Outcome outcome;
  TriangleMesh soup;
  const TriangleMesh ball = geometry::sphere(0.05, 3);
  for (const geometry::Triangle& t : ball.faces) {
    const int first = static_cast<int>(soup.vertices.size());
    for (const int v : t) soup.vertices.push_back(ball.vertices[static_cast<std::size_t>(v)]);
    soup.faces.push_back({first, first + 1, first + 2});
  }
  mend_and_break(soup, "every face with vertices of its own", outcome);
  TriangleMesh open = ball;
  open.faces.erase(open.faces.begin(), open.faces.begin() + 40);
  mend_and_break(open, "a hole of 40 faces", outcome);
  TriangleMesh doubled = ball;
  doubled.faces.insert(doubled.faces.end(), ball.faces.begin(), ball.faces.begin() + 5);
  mend_and_break(doubled, "five faces twice", outcome);
  TriangleMesh turned = ball;
  for (std::size_t f = 0; f < turned.faces.size(); f += 3) std::swap(turned.faces[f][0], turned.faces[f][1]);
  mend_and_break(turned, "every third face inside out", outcome);
  const TriangleMesh other = geometry::transformed(ball, Mat3::Identity(), Vec3(0.04, 0.01, 0));
  mend_and_break(joined(ball, other), "two balls through each other", outcome);
  return outcome;
}

crack::DamageField field_of(const TriangleMesh& mesh, int count, const std::function<bool(const Vec3&)>& failed) {
  SilentProgress progress;
  const geometry::Samples samples = geometry::sample_solid(mesh, {.count = count}, progress);
  crack::DamageField field{samples.points, {}, {}, samples.spacing, 2 * samples.spacing};
  for (const Vec3& x : samples.points) field.damage.push_back(failed(x) ? 1 : 0);
  return field;
}

/// S7
Outcome damage_everywhere_and_nowhere() {
  const TriangleMesh block = geometry::box(Vec3(0.2, 0.1, 0.1));
  Outcome outcome;
  const auto cut = [&](const std::function<bool(const Vec3&)>& failed) {
    SilentProgress progress;
    return crack_and_cut(block, field_of(block, 4000, failed), {}, 1, progress);
  };
  outcome.checks.push_back(absolute("all particles failed: pieces that a body of powder falls into",
                                    static_cast<double>(cut([](const Vec3&) { return true; }).cut.fragments.size()), 0,
                                    0));
  outcome.checks.push_back(absolute("no particle failed: pieces",
                                    static_cast<double>(cut([](const Vec3&) { return false; }).cut.fragments.size()), 0,
                                    0));
  const double spacing = field_of(block, 4000, [](const Vec3&) { return false; }).spacing;
  const Cracked layer = cut([&](const Vec3& x) { return std::abs(x[0]) < 1.1 * spacing; });
  outcome.checks.push_back(absolute("one layer failed: pieces", static_cast<double>(layer.cut.fragments.size()), 2, 0));
  outcome.checks.push_back(absolute("one layer failed: volume lost [body]", layer.cut.volume_error, 0, 1e-12));
  return outcome;
}

/// S17, cuts: pieces of a cube, each cut in two by a plane through it, a thousand times; always the largest.
Outcome thousand_cuts() {
  struct Piece {
    TriangleMesh mesh;
    double volume;
  };
  const auto smaller = [](const Piece& a, const Piece& b) { return a.volume < b.volume; };
  std::vector<Piece> pieces = {{geometry::box(Vec3::Constant(1)), 1}};
  double failed = 0, open = 0;
  for (std::uint64_t n = 0; n < 1000; ++n) {
    std::pop_heap(pieces.begin(), pieces.end(), smaller);
    const Piece piece = std::move(pieces.back());
    pieces.pop_back();
    const geometry::MassProperties whole = geometry::mass_properties(piece.mesh);
    const Vec3 normal =
        Vec3(random_unit(3, 0, n) - 0.5, random_unit(3, 1, n) - 0.5, random_unit(3, 2, n) - 0.5).normalized();
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    const double reach = 2 * geometry::bounds(piece.mesh).diagonal().norm();
    geometry::RegionBoundary plane;
    for (const auto& [a, b] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)})
      plane.vertices.push_back(whole.centroid + reach * (a * u + b * v));
    plane.faces = {{{0, 1, 2, 3}, 0, 1}};
    plane.region_count = 2;
    SilentProgress progress;
    const geometry::CutResult cut = geometry::cut(piece.mesh, plane, {}, progress);
    failed += cut.fragments.size() < 2;
    if (cut.fragments.size() < 2) pieces.push_back(piece);
    if (cut.fragments.size() >= 2)
      for (const geometry::Fragment& f : cut.fragments) {
        open += !geometry::inspect(f.mesh).is_solid();
        pieces.push_back({f.mesh, geometry::mass_properties(f.mesh).volume});
        std::push_heap(pieces.begin(), pieces.end(), smaller);
      }
    if (cut.fragments.size() < 2) std::push_heap(pieces.begin(), pieces.end(), smaller);
  }
  double volume = 0;
  for (const Piece& p : pieces) volume += p.volume;
  Outcome outcome;
  outcome.checks = {absolute("cuts that failed", failed, 0, 0), absolute("pieces that are not closed", open, 0, 0),
                    within("pieces", static_cast<double>(pieces.size()), 1001, 3000),
                    absolute("their volume [cube]", volume, 1, 1e-12)};
  return outcome;
}

/// S17, generations: the largest piece of each fracture is hit again, harder as it gets smaller and stouter.
Outcome generations() {
  Outcome outcome;
  TriangleMesh mesh = geometry::box(Vec3(0.2, 0.02, 0.2));
  int broken = 0;
  for (int generation = 0; generation < 20; ++generation) {
    FractureInput input = steel_ball_on(mesh, hard_glass(), 40 * std::pow(1.25, generation));
    input.seed = static_cast<std::uint64_t>(generation);
    const FractureOutcome r = sound_fracture(input, "generation " + std::to_string(generation + 1), outcome);
    if (r.pieces.size() < 2) continue;
    ++broken;
    const auto volume = [](const BrokenPiece& p) { return geometry::mass_properties(p.fragment.mesh).volume; };
    const auto largest = std::max_element(r.pieces.begin(), r.pieces.end(),
                                          [&](const auto& a, const auto& b) { return volume(a) < volume(b); });
    mesh = largest->fragment.mesh;
    mesh = geometry::transformed(mesh, Mat3::Identity(), -geometry::mass_properties(mesh).centroid);
  }
  outcome.checks.push_back(within("generations that broke", broken, 5, 20));
  return outcome;
}

/// X5
Outcome needles_and_sheets() {
  Outcome outcome;
  sound_fracture(steel_ball_on(geometry::box(Vec3(0.004, 0.5, 0.004)), hard_glass(), 10), "needle of 4 x 4 x 500 mm",
                 outcome);
  sound_fracture(steel_ball_on(geometry::box(Vec3(1, 0.002, 1)), hard_glass(), 20, 4000), "sheet of 2 mm x 1 m",
                 outcome);
  // Cells much longer than wide: splinters, and slices a thousandth of the body thick.
  const TriangleMesh block = geometry::box(Vec3(1, 1, 1));
  for (const bool slices : {false, true}) {
    std::vector<Vec3> sites;
    for (std::uint64_t n = 0; n < 40; ++n)
      sites.push_back(slices ? Vec3(0.001 * static_cast<double>(n) - 0.02, 0, 0)
                             : Vec3(0.05 * (random_unit(5, 0, n) - 0.5), 0.05 * (random_unit(5, 1, n) - 0.5),
                                    random_unit(5, 2, n) - 0.5));
    SilentProgress progress;
    const auto cells = crack::voronoi_cells(sites, geometry::bounds(block), 1, progress);
    const Cracked c = cut_regions(block, cells, {}, 1, progress);
    double open = 0;
    for (const geometry::Fragment& f : c.cut.fragments) open += !geometry::inspect(f.mesh).is_solid();
    const std::string what = slices ? "slices of a thousandth: " : "splinters: ";
    outcome.checks.push_back(within(what + "pieces", static_cast<double>(c.cut.fragments.size()), 20, 100));
    outcome.checks.push_back(absolute(what + "pieces that are not closed", open, 0, 0));
    outcome.checks.push_back(absolute(what + "volume lost [body]", c.cut.volume_error, 0, 1e-12));
  }
  return outcome;
}

/// X6
Outcome many_shells() {
  Outcome outcome;
  TriangleMesh heap, holes = geometry::box(Vec3(0.4, 0.1, 0.1));
  for (int n = 0; n < 12; ++n) {
    const Vec3 at(0.03 * (n - 5.5), 0, 0);
    heap = joined(heap, geometry::transformed(geometry::sphere(0.012, 3), Mat3::Identity(), at));
    // A turned shell inside of another is a hollow.
    TriangleMesh hollow = geometry::transformed(geometry::sphere(0.012, 3), Mat3::Identity(), at);
    for (geometry::Triangle& t : hollow.faces) std::swap(t[0], t[1]);
    if (n < 11) holes = joined(holes, hollow);
  }
  outcome.checks.push_back(
      absolute("twelve balls that do not touch: a solid", geometry::inspect(heap).is_solid(), 1, 0));
  sound_fracture(steel_ball_on(heap, hard_glass(), 20), "twelve balls that do not touch", outcome);
  outcome.checks.push_back(absolute("block with eleven hollows: a solid", geometry::inspect(holes).is_solid(), 1, 0));
  sound_fracture(steel_ball_on(holes, hard_glass(), 60, 6000), "block with eleven hollows", outcome);
  return outcome;
}

/// X7
Outcome million_faces() {
  Outcome outcome;
  const TriangleMesh ball = subdivided(subdivided(geometry::sphere(0.05, 6)));
  outcome.checks.push_back(within("faces", static_cast<double>(ball.faces.size()), 1e6, 2e6));
  const FractureOutcome r = sound_fracture(steel_ball_on(ball, hard_glass(), 400, 6000), "ball", outcome);
  outcome.checks.push_back(within("pieces", static_cast<double>(r.pieces.size()), 2, 1e4));
  return outcome;
}

}  // namespace

std::vector<validation::Problem> hard_shapes() {
  const std::string sound = "finite, closed, conserving";
  return {
      {"S6b", "Meshes with duplicates, holes, crossings", "mended to a solid that breaks soundly", broken_meshes},
      {"S7", "Everything failed, nothing failed, one layer", "whole, whole, two pieces", damage_everywhere_and_nowhere},
      {"S17", "A thousand cuts, one after the other", sound, thousand_cuts},
      {"S17b", "Twenty generations of fracture", sound, generations},
      {"X5", "Needles, sheets, splinters, slices", sound, needles_and_sheets},
      {"X6", "Bodies of twelve shells", sound, many_shells},
      {"X7", "A mesh of 1.3 million faces", sound, million_faces}};
}

}  // namespace sunder::pipeline::detail
