#include "mpm/front.h"

#include <cmath>
#include <numbers>

namespace sunder::mpm {
namespace {
double radians(double degrees) { return degrees * std::numbers::pi / 180; }
}  // namespace

CrackFronts::CrackFronts(const Box& domain, double cell_size, double p_wave_speed, const FrontSettings& settings)
    : radius_(settings.shield_radius * cell_size),
      cell_size_(cell_size),
      filler_width_(settings.filler_width * cell_size),
      reach_(settings.ahead_reach * cell_size),
      near_(std::max(std::hypot(filler_width_, cell_size), reach_)),
      speed_(settings.speed * p_wave_speed),
      tan_ahead_(std::tan(radians(settings.ahead_angle))),
      cos_parallel_(std::cos(radians(settings.parallel_angle))),
      bins_(domain, 0.5 * radius_) {}

void CrackFronts::add(const Vec3& position, const Vec3& normal, double time) {
  all_.push_back({position, normal, time, count()});
  bins_.bin(position).push_back(all_.back());
}

CrackFronts::Place CrackFronts::place(const Vec3& d, const Vec3& front_normal) const {
  const double squared = d.squaredNorm();
  if (squared > radius_ * radius_) return Place::away;
  const double off_plane = std::abs(d.dot(front_normal));
  const double in_plane = std::sqrt(std::max(0.0, squared - off_plane * off_plane));
  if (off_plane <= in_plane * tan_ahead_) return squared > reach_ * reach_ ? Place::away : Place::ahead;
  if (off_plane > filler_width_) return Place::beside;
  return in_plane <= cell_size_ ? Place::in_band : Place::away;
}

bool CrackFronts::reaches(const Vec3& front, const Vec3& front_normal, const Vec3& position) const {
  const Place at = place(position - front, front_normal);
  return at == Place::in_band || at == Place::ahead;
}

CrackFronts::Sight CrackFronts::sight_of(const Front& front, const Query& query) const {
  if (std::abs(query.normal.dot(front.normal)) < cos_parallel_) return {};
  const Vec3 d = query.position - front.position;
  switch (place(d, front.normal)) {
    case Place::away:
      break;
    case Place::in_band:
      return {.fills = true};
    case Place::beside:
      return {.shields = true, .shielder = front.number};
    case Place::ahead:
      const bool arrived = query.time - front.time >= d.norm() / speed_;
      return {.ahead = arrived, .early = !arrived};
  }
  return {};
}

template <class Enough>
bool CrackFronts::scan_list(std::span<const Front> fronts, const Query& query, const Enough& enough,
                            Sight& sight) const {
  for (const Front& front : fronts) {
    sight = sight | sight_of(front, query);
    if (enough(sight)) return true;
  }
  return false;
}

template <class Enough>
CrackFronts::Sight CrackFronts::scan(const Query& query, double distance, const Enough& enough) const {
  Sight sight;
  MaterialBins<std::vector<Front>>::visit(bins_, query.position, distance, [&](const std::vector<Front>& fronts) {
    return scan_list(fronts, query, enough, sight);
  });
  return sight;
}

CrackFronts::Sight CrackFronts::look(const Vec3& position, const Vec3& normal, double time, int first) const {
  Sight sight;
  scan_list(
      std::span(all_).subspan(static_cast<std::size_t>(first)), {position, normal, time, 0},
      [](const Sight& s) { return s.fills; }, sight);
  return sight;
}

CrackFronts::Sight CrackFronts::look(const Vec3& position, const Vec3& normal, double time, const Hint& hint) const {
  const Query query{position, normal, time, 0};
  Sight near;
  if (!hint.far) near = scan(query, near_, [](const Sight& s) { return s.fills; });
  if (near.fills || near.shields) return near;
  // A front further than that can only shield, and one that shields is as good as many.
  if (hint.shielder >= 0) near = near | sight_of(all_[static_cast<std::size_t>(hint.shielder)], query);
  if (near.shields) return near;
  return near | scan(query, radius_, [](const Sight& s) { return s.shields; });
}

Verdict CrackFronts::Sight::verdict() const {
  if (fills) return Verdict::filler;
  if (shields) return Verdict::wait;
  if (ahead) return Verdict::advance;
  return early ? Verdict::wait : Verdict::nucleate;
}

}  // namespace sunder::mpm
