#include "validation/detail/cracks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace sunder::validation::detail {

std::vector<Failure> failures(const Specimen& specimen) {
  std::vector<Failure> list;
  for (int id = 0; id < specimen.body.size(); ++id) {
    const mpm::PointState p = specimen.body.point(id);
    if (p.damage >= mpm::failed_damage && p.damage_time > 0) list.push_back({p.material_position, p.damage_time});
  }
  return list;
}

std::vector<CrackSlice> slices(const std::vector<Failure>& failures, const Vec3& origin, const Vec3& direction,
                               double slice) {
  const Vec3 left(-direction[1], direction[0], 0);
  std::map<int, CrackSlice> bins;
  for (const Failure& f : failures) {
    const double x = (f.position - origin).dot(direction), y = (f.position - origin).dot(left);
    CrackSlice& bin = bins[static_cast<int>(std::floor(x / slice))];
    bin.x += x;
    bin.y += y;
    bin.first = bin.count == 0 ? f.time : std::min(bin.first, f.time);
    ++bin.count;
  }
  std::vector<CrackSlice> list;
  for (const auto& [index, bin] : bins) list.push_back({bin.x / bin.count, bin.y / bin.count, bin.first, bin.count});
  return list;
}

CrackLine line_through(const std::vector<CrackSlice>& slices) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  CrackLine line;
  for (const CrackSlice& s : slices) {
    n += 1, x += s.x, y += s.y, xx += s.x * s.x, xy += s.x * s.y;
    line.deviation = std::max(line.deviation, std::abs(s.y));
  }
  line.tilt = std::atan((n * xy - x * y) / (n * xx - x * x)) * 180 / std::numbers::pi;
  return line;
}

double crack_speed(const std::vector<CrackSlice>& slices) {
  constexpr std::size_t window = 4;
  std::vector<double> speeds;
  for (std::size_t n = window; n < slices.size(); ++n)
    speeds.push_back((slices[n].x - slices[n - window].x) / std::abs(slices[n].first - slices[n - window].first));
  std::sort(speeds.begin(), speeds.end());
  return speeds.empty() ? std::numeric_limits<double>::quiet_NaN() : speeds[(speeds.size() - 1) * 99 / 100];
}

std::vector<double> pieces(const Specimen& specimen, double reach, const std::function<bool(const Vec3&)>& counted) {
  std::map<std::pair<int, int>, std::vector<int>> bins;
  const auto bin_of = [&](const Vec3& x) {
    return std::pair(static_cast<int>(std::floor(x[0] / reach)), static_cast<int>(std::floor(x[1] / reach)));
  };
  double all = 0;
  for (int id = 0; id < specimen.body.size(); ++id) {
    const Vec3 x = specimen.body.material_position(id);
    if (!counted(x)) continue;
    ++all;
    if (specimen.body.point(id).damage < mpm::failed_damage) bins[bin_of(x)].push_back(id);
  }
  std::vector<double> sizes;
  std::vector<int> open;
  // Points leave their bins when a piece takes them.
  const auto take_near = [&](const Vec3& x) {
    const auto [i, j] = bin_of(x);
    for (int n = 0; n < 9; ++n)
      if (const auto at = bins.find({i - 1 + n / 3, j - 1 + n % 3}); at != bins.end())
        std::erase_if(at->second, [&](int id) {
          if ((specimen.body.material_position(id) - x).norm() > reach) return false;
          open.push_back(id);
          return true;
        });
  };
  for (auto& [at, ids] : bins)
    while (!ids.empty()) {
      open = {ids.back()};
      ids.pop_back();
      std::size_t next = 0;
      for (; next < open.size(); ++next) take_near(specimen.body.material_position(open[next]));
      sizes.push_back(static_cast<double>(open.size()) / all);
    }
  std::sort(sizes.rbegin(), sizes.rend());
  return sizes;
}

double rayleigh_speed(const mpm::Material& material) {
  const double shear = std::sqrt(material.shear_modulus() / material.density);
  const double ratio = std::pow(shear / material.p_wave_speed(), 2);
  double low = 0.5, high = 1;
  while (high - low > 1e-12) {
    const double s = 0.5 * (low + high), q = s * s;
    // Negative below the root.
    const double value = (2 - q) * (2 - q) - 4 * std::sqrt((1 - q) * (1 - ratio * q));
    (value < 0 ? low : high) = s;
  }
  return low * shear;
}

double plane_modulus(const mpm::Material& m) { return m.youngs_modulus / (1 - m.poisson_ratio * m.poisson_ratio); }

double strength_of_band(const mpm::Material& m, const mpm::SolveSettings& settings, double h, double ratio) {
  return std::sqrt(2 * m.youngs_modulus * m.fracture_energy * ratio / (settings.band_width * h));
}

}  // namespace sunder::validation::detail
