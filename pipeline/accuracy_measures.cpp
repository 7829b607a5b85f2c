#include "pipeline/accuracy_measures.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "geometry/mass_properties.h"
#include "geometry/surface_distance.h"

namespace sunder::pipeline {
namespace {

constexpr double cells_along_diagonal = 16;

using Cell = std::array<int, 3>;

std::set<Cell> cells_of(const std::vector<Vec3>& points, const Box& box) {
  const double width = box.diagonal().norm() / cells_along_diagonal;
  std::set<Cell> cells;
  for (const Vec3& x : points) {
    const Vec3 at = (x - box.min()) / width;
    cells.insert({static_cast<int>(std::floor(at[0])), static_cast<int>(std::floor(at[1])),
                  static_cast<int>(std::floor(at[2]))});
  }
  return cells;
}

double differing_share(const std::set<Cell>& a, const std::set<Cell>& b) {
  const auto both = std::count_if(a.begin(), a.end(), [&](const Cell& c) { return b.contains(c); });
  const double common = static_cast<double>(both), all = static_cast<double>(a.size() + b.size()) - common;
  return all > 0 ? 1 - common / all : 0;
}

geometry::TriangleMesh crack_of(const crack::Extraction& extraction) {
  geometry::TriangleMesh mesh;
  mesh.vertices = extraction.vertices;
  for (const crack::CrackFace& face : extraction.faces) {
    if (!face.in_body || face.kind == crack::FaceKind::partial) continue;
    for (std::size_t k = 2; k < face.loop.size(); ++k)
      mesh.faces.push_back({face.loop[0], face.loop[k - 1], face.loop[k]});
  }
  return mesh;
}

Vec3 centre_of(const geometry::TriangleMesh& mesh, std::size_t face) {
  Vec3 sum = Vec3::Zero();
  for (const int v : mesh.faces[face]) sum += mesh.vertices[static_cast<std::size_t>(v)] / 3;
  return sum;
}

/// Mean over the area of `from`, by the centres of its faces, and the largest distance to `to` [m].
struct OneWay {
  double mean = 0, largest = 0;
};
OneWay one_way(const geometry::TriangleMesh& from, const geometry::TriangleMesh& to) {
  std::vector<Vec3> centres;
  std::vector<double> areas;
  for (std::size_t f = 0; f < from.faces.size(); ++f) {
    centres.push_back(centre_of(from, f));
    areas.push_back(geometry::face_area(from, f));
  }
  const auto nearest = geometry::nearest_on(to, centres);
  OneWay result;
  for (std::size_t f = 0; f < areas.size(); ++f) {
    result.mean += areas[f] * nearest[f].distance;
    result.largest = std::max(result.largest, nearest[f].distance);
  }
  result.mean /= std::accumulate(areas.begin(), areas.end(), 0.0);
  return result;
}

/// Share of the volume that is in pieces of at most `size`.
double share_up_to(const std::vector<double>& shares, double size) {
  double sum = 0;
  for (const double s : shares) sum += s <= size ? s : 0;
  return sum;
}

/// Area between the two cumulative distributions.
double wasserstein(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> sizes = a;
  sizes.insert(sizes.end(), b.begin(), b.end());
  std::sort(sizes.begin(), sizes.end());
  double area = 0;
  for (std::size_t n = 1; n < sizes.size(); ++n)
    area += std::abs(share_up_to(a, sizes[n - 1]) - share_up_to(b, sizes[n - 1])) * (sizes[n] - sizes[n - 1]);
  return area;
}

}  // namespace

FractureTrace trace_of(const FractureInput& input, const FractureOutcome& outcome) {
  FractureTrace trace;
  trace.box = geometry::bounds(input.mesh);
  trace.volume = geometry::mass_properties(input.mesh).volume;
  const std::vector<Vec3>& points = outcome.own->samples.points;
  for (std::size_t p = 0; p < points.size(); ++p)
    if (outcome.solve.particles[p].damage >= 0.95) trace.failed.push_back(points[p]);
  if (outcome.pieces.size() >= 2) {
    trace.crack = crack_of(outcome.cracked.extraction);
    for (const BrokenPiece& piece : outcome.pieces)
      trace.shares.push_back(geometry::mass_properties(piece.fragment.mesh).volume / trace.volume);
    std::sort(trace.shares.rbegin(), trace.shares.rend());
  } else {
    trace.shares = {1};
  }
  for (std::size_t f = 0; f < trace.crack.faces.size(); ++f) trace.crack_area += geometry::face_area(trace.crack, f);
  if (outcome.solve.energy) trace.dissipated = outcome.solve.energy->fracture;
  for (const mpm::LoadResult& load : outcome.solve.loads) {
    trace.peak_force = std::max(trace.peak_force, load.peak_force);
    trace.impulse += load.impulse;
  }
  return trace;
}

TraceDistance distance(const FractureTrace& a, const FractureTrace& b) {
  TraceDistance d;
  d.damage = differing_share(cells_of(a.failed, a.box), cells_of(b.failed, a.box));
  d.volumes = wasserstein(a.shares, b.shares);
  if (a.crack.faces.empty() || b.crack.faces.empty()) return d;
  const double diagonal = a.box.diagonal().norm();
  const OneWay there = one_way(a.crack, b.crack), back = one_way(b.crack, a.crack);
  d.crack_mean = 0.5 * (there.mean + back.mean) / diagonal;
  d.crack_hausdorff = std::max(there.largest, back.largest) / diagonal;
  return d;
}

}  // namespace sunder::pipeline
