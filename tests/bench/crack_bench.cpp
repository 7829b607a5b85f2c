/// How fast cracks are found: ./sunder bench crack [--json FILE].
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include <tbb/global_control.h>

#include "crack/extract.h"
#include "crack/surface_detail.h"
#include "tests/bench/table.h"

namespace sunder::crack {
namespace {

constexpr int points_along = 84;  // 592 704 points in the cube
constexpr int runs = 5;

/// Points at the cell centres of a lattice in the unit cube, three layers of them damaged.
DamageField plane_in_cube(int n) {
  DamageField field;
  field.spacing = 1.0 / n;
  field.cell_size = 2 * field.spacing;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        field.points.push_back(field.spacing * Vec3(i + 0.5, j + 0.5, k + 0.5));
        const bool damaged = std::abs(i - n / 2) <= 1;
        field.damage.push_back(damaged ? 1 : 0);
        field.damage_time.push_back(damaged ? field.points.back().y() : -1);
      }
  return field;
}

struct Timing {
  double seconds = 0;  // median
  Extraction extraction;
};

template <typename Work>
double median_seconds(Work&& work) {
  std::vector<double> seconds;
  for (int run = 0; run < runs; ++run) {
    const auto start = std::chrono::steady_clock::now();
    work();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[runs / 2];
}

Timing time_extraction(const DamageField& field, double nodes_per_point) {
  SilentProgress progress;
  Settings settings;
  settings.node_spacing = nodes_per_point * field.spacing;
  Timing timing;
  timing.seconds = median_seconds([&] {
    timing.extraction = extract(field, {Vec3::Zero(), Vec3::Ones()}, settings, progress);
  });
  return timing;
}

void measure(bench::Table& table) {
  const DamageField field = plane_in_cube(points_along);
  const Timing coarse = time_extraction(field, 2), fine = time_extraction(field, 1);
  table.add("extract_plane_2x_seconds", coarse.seconds,
            "592 704 points, one damaged plane, nodes 2 point spacings apart (goal 0.15)");
  table.add("extract_plane_1x_seconds", fine.seconds, "nodes 1 point spacing apart (goal 0.8)");
  table.add("extract_plane_2x_sites", static_cast<double>(coarse.extraction.sites), "Voronoi sites");
  table.add("extract_plane_1x_sites", static_cast<double>(fine.extraction.sites), "Voronoi sites");
  const double sites = static_cast<double>(fine.extraction.sites) / static_cast<double>(coarse.extraction.sites);
  // Both read the same points; what grows is taken over what grows: 8 times the nodes, `sites` times the sites.
  table.add("extract_growth_over_sites", fine.seconds / coarse.seconds / sites,
            "time ratio over site ratio of the two (goal 1)");
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    table.add("extract_scaling", time_extraction(field, 1).seconds / fine.seconds, "one thread over all");
  }
  const DamageField small = plane_in_cube(points_along / 2);
  table.add("extract_growth_over_points", fine.seconds / time_extraction(small, 1).seconds / 8,
            "8 times the points, over 8 times the time");
  const DetailSettings look = detail_preset("rock", 1);
  SilentProgress progress;
  DetailedBoundary detailed;
  const double seconds = median_seconds([&] {
    detailed = add_surface_detail(coarse.extraction.boundary, {Vec3::Zero(), Vec3::Ones()},
                                  {field.points, field.damage_time, field.spacing}, look, progress);
  });
  table.add("surface_detail_seconds", seconds, "the look 'rock' on the coarser of the two planes");
  table.add("surface_detail_triangles", static_cast<double>(detailed.boundary.faces.size()), "of its crack faces");
}

}  // namespace
}  // namespace sunder::crack

int main(int argc, char** argv) {
  const bool json = argc == 3 && std::strcmp(argv[1], "--json") == 0;
  if (argc != 1 && !json) {
    std::fprintf(stderr, "usage: crack_bench [--json FILE]\n");
    return 2;
  }
  try {
    sunder::bench::Table table;
    sunder::crack::measure(table);
    if (json) table.save(argv[2]);
    return 0;
  } catch (const sunder::Error& error) {
    std::fprintf(stderr, "crack_bench: %s\n", error.what());
    return static_cast<int>(error.kind());
  }
}
