/// The looks of tools/detail_pictures.py: one wavy crack through a block, plain and with every preset, as OBJ files in
/// the given folder. Says how long each took.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "crack/surface_detail.h"

namespace {

using namespace sunder;

constexpr double pi = std::numbers::pi;
constexpr int cells = 100;  // of the sheet, along a side

/// A sheet across the unit block.
double sheet(double x, double z) {
  return 0.5 + 0.035 * std::sin(2.1 * pi * x + 0.4) * std::cos(1.7 * pi * z) + 0.015 * std::sin(3.3 * pi * z + 1 + x);
}

/// When a front from one corner arrives: it spreads with a speed that varies from place to place.
double arrival(double x, double z) {
  const double r = std::hypot(x + 0.05, z - 0.35);
  return r * (1 + 0.05 * std::sin(9 * x + 4 * z) + 0.025 * std::sin(17 * z - 6 * x));
}

/// The sheet between two regions that fill the block, enlarged by 0.12.
geometry::RegionBoundary split_block() {
  geometry::RegionBoundary regions;
  regions.region_count = 2;
  const auto corner = [](int i) { return -0.12 + 1.24 * i / cells; };
  for (int i = 0; i <= cells; ++i)
    for (int k = 0; k <= cells; ++k) regions.vertices.emplace_back(corner(i), sheet(corner(i), corner(k)), corner(k));
  const auto id = [](int i, int k) { return i * (cells + 1) + k; };
  for (int i = 0; i < cells; ++i)
    for (int k = 0; k < cells; ++k) {
      regions.faces.push_back({{id(i, k), id(i, k + 1), id(i + 1, k + 1)}, 0, 1});
      regions.faces.push_back({{id(i, k), id(i + 1, k + 1), id(i + 1, k)}, 0, 1});
    }
  return regions;
}

crack::DamageTimes damage() {
  crack::DamageTimes times;
  times.spacing = 0.025;
  for (double x = times.spacing / 2; x < 1; x += times.spacing)
    for (double y = times.spacing / 2; y < 1; y += times.spacing)
      for (double z = times.spacing / 2; z < 1; z += times.spacing) {
        times.points.emplace_back(x, y, z);
        times.time.push_back(std::abs(y - sheet(x, z)) < times.spacing ? 1e-4 * arrival(x, z) : -1);
      }
  return times;
}

void write(const std::filesystem::path& path, const geometry::RegionBoundary& regions) {
  std::ofstream out(path);
  out.precision(7);
  for (const Vec3& x : regions.vertices) out << "v " << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  for (const auto& face : regions.faces)
    out << "f " << face.loop[0] + 1 << ' ' << face.loop[1] + 1 << ' ' << face.loop[2] + 1 << '\n';
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return std::fprintf(stderr, "usage: detail_gallery FOLDER\n"), 2;
  const std::filesystem::path folder = arguments[1];
  std::filesystem::create_directories(folder);
  const geometry::RegionBoundary regions = split_block();
  const crack::DamageTimes times = damage();
  const Box body(Vec3::Zero(), Vec3::Ones());
  SilentProgress progress;
  write(folder / "none.obj", regions);
  for (const std::string& name : crack::detail_preset_names()) {
    const crack::DetailSettings settings = crack::detail_preset(name, 1);
    const auto start = std::chrono::steady_clock::now();
    const crack::DetailedBoundary result = crack::add_surface_detail(regions, body, times, settings, progress);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    write(folder / (name + ".obj"), result.boundary);
    std::printf("%-9s %7zu triangles %6d lines %6d raised %6ld limited %5ld lowered, height %.4f of %.4f, %.3f s\n",
                name.c_str(), result.boundary.faces.size(), result.lines, result.raised_lines, result.limited,
                result.lowered, result.largest_height, settings.height, took.count());
  }
}
