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
      bin_size_(0.5 * radius_),
      cell_size_(cell_size),
      filler_width_(settings.filler_width * cell_size),
      reach_(settings.ahead_reach * cell_size),
      near_(std::max(std::hypot(filler_width_, cell_size), reach_)),
      speed_(settings.speed * p_wave_speed),
      tan_ahead_(std::tan(radians(settings.ahead_angle))),
      cos_parallel_(std::cos(radians(settings.parallel_angle))) {
  std::size_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    size_[a] = static_cast<int>(domain.sizes()[static_cast<Eigen::Index>(a)] / bin_size_) + 1;
    count *= static_cast<std::size_t>(size_[a]);
  }
  bins_.resize(count);
}

std::array<int, 3> CrackFronts::bin(const Vec3& x) const {
  std::array<int, 3> at;
  for (std::size_t a = 0; a < 3; ++a) {
    const Eigen::Index axis = static_cast<Eigen::Index>(a);
    at[a] = std::clamp(static_cast<int>((x[axis] - origin_[axis]) / bin_size_), 0, size_[a] - 1);
  }
  return at;
}

void CrackFronts::add(const Vec3& position, const Vec3& normal, double time) {
  const auto at = bin(position);
  all_.push_back({position, normal, time});
  bins_[static_cast<std::size_t>((at[0] * size_[1] + at[1]) * size_[2] + at[2])].push_back(all_.back());
}

CrackFronts::Sight CrackFronts::sight_of(const Front& front, const Query& query) const {
  const Vec3 d = query.position - front.position;
  const double squared = d.squaredNorm();
  const double off_plane = std::abs(d.dot(front.normal));
  const double in_plane = std::sqrt(std::max(0.0, squared - off_plane * off_plane));
  if (off_plane > in_plane * tan_ahead_) {
    if (off_plane > filler_width_) return {.shields = true};
    return {.fills = in_plane <= cell_size_};
  }
  if (squared > reach_ * reach_) return {};
  const bool arrived = query.time - front.time >= std::sqrt(squared) / speed_;
  return {.ahead = arrived, .early = !arrived};
}

template <class Enough>
bool CrackFronts::scan_list(std::span<const Front> fronts, const Query& query, const Enough& enough,
                            Sight& sight) const {
  for (const Front& front : fronts) {
    if ((query.position - front.position).squaredNorm() > radius_ * radius_) continue;
    if (std::abs(query.normal.dot(front.normal)) < cos_parallel_) continue;
    sight = sight | sight_of(front, query);
    if (enough(sight)) return true;
  }
  return false;
}

template <class Enough>
CrackFronts::Sight CrackFronts::scan(const Query& query, double distance, const Enough& enough) const {
  Sight sight;
  const auto low = bin(query.position - Vec3::Constant(distance));
  const auto high = bin(query.position + Vec3::Constant(distance));
  for (int i = low[0]; i <= high[0]; ++i)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int k = low[2]; k <= high[2]; ++k)
        if (scan_list(bins_[static_cast<std::size_t>((i * size_[1] + j) * size_[2] + k)], query, enough, sight))
          return sight;
  return sight;
}

CrackFronts::Sight CrackFronts::look(const Vec3& position, const Vec3& normal, double time, int first) const {
  const Query query{position, normal, time};
  const auto fills = [](const Sight& s) { return s.fills; };
  if (first > 0) {  // the few new ones: quicker without the bins
    Sight sight;
    scan_list(std::span(all_).subspan(static_cast<std::size_t>(first)), query, fills, sight);
    return sight;
  }
  // A front further than near_ can only shield, and one that shields is as good as many.
  const Sight near = scan(query, near_, fills);
  if (near.fills || near.shields) return near;
  return near | scan(query, radius_, [](const Sight& s) { return s.shields; });
}

Verdict CrackFronts::Sight::verdict() const {
  if (fills) return Verdict::filler;
  if (shields) return Verdict::wait;
  if (ahead) return Verdict::advance;
  return early ? Verdict::wait : Verdict::nucleate;
}

}  // namespace sunder::mpm
