#include "mpm/front.h"

#include <array>
#include <cmath>
#include <numbers>

namespace sunder::mpm {
namespace {
double radians(double degrees) { return degrees * std::numbers::pi / 180; }
}  // namespace

CrackFronts::CrackFronts(const Box& domain, double cell_size, double p_wave_speed, const FrontSettings& settings)
    : origin_(domain.min()),
      radius_(settings.shield_radius * cell_size),
      cell_size_(cell_size),
      filler_width_(settings.filler_width * cell_size),
      reach_(settings.ahead_reach * cell_size),
      speed_(settings.speed * p_wave_speed),
      tan_ahead_(std::tan(radians(settings.ahead_angle))),
      cos_parallel_(std::cos(radians(settings.parallel_angle))) {
  std::size_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    size_[a] = static_cast<int>(domain.sizes()[static_cast<Eigen::Index>(a)] / radius_) + 1;
    count *= static_cast<std::size_t>(size_[a]);
  }
  bins_.resize(count);
}

std::array<int, 3> CrackFronts::bin(const Vec3& x) const {
  std::array<int, 3> at;
  for (std::size_t a = 0; a < 3; ++a) {
    const Eigen::Index axis = static_cast<Eigen::Index>(a);
    at[a] = std::clamp(static_cast<int>((x[axis] - origin_[axis]) / radius_), 0, size_[a] - 1);
  }
  return at;
}

void CrackFronts::add(const Vec3& position, const Vec3& normal, double time) {
  const auto at = bin(position);
  bins_[static_cast<std::size_t>((at[0] * size_[1] + at[1]) * size_[2] + at[2])].push_back(
      {position, normal, time, count_++});
}

CrackFronts::Sight CrackFronts::look(const Vec3& position, const Vec3& normal, double time, int first) const {
  Sight sight;
  const auto at = bin(position);
  for (int i = std::max(0, at[0] - 1); i <= std::min(size_[0] - 1, at[0] + 1); ++i)
    for (int j = std::max(0, at[1] - 1); j <= std::min(size_[1] - 1, at[1] + 1); ++j)
      for (int k = std::max(0, at[2] - 1); k <= std::min(size_[2] - 1, at[2] + 1); ++k)
        for (const Front& q : bins_[static_cast<std::size_t>((i * size_[1] + j) * size_[2] + k)]) {
          if (q.number < first) continue;
          const Vec3 d = position - q.position;
          const double squared = d.squaredNorm();
          if (squared > radius_ * radius_ || std::abs(normal.dot(q.normal)) < cos_parallel_) continue;
          const double off_plane = std::abs(d.dot(q.normal));
          const double in_plane = std::sqrt(std::max(0.0, squared - off_plane * off_plane));
          if (off_plane > in_plane * tan_ahead_) {
            if (off_plane > filler_width_)
              sight.shields = true;
            else if (in_plane <= cell_size_)
              sight.fills = true;
          } else if (squared <= reach_ * reach_) {
            (time - q.time >= std::sqrt(squared) / speed_ ? sight.ahead : sight.early) = true;
          }
        }
  return sight;
}

Verdict CrackFronts::Sight::verdict() const {
  if (fills) return Verdict::filler;
  if (shields) return Verdict::wait;
  if (ahead) return Verdict::advance;
  return early ? Verdict::wait : Verdict::nucleate;
}

}  // namespace sunder::mpm
