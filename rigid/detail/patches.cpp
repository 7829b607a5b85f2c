#include "rigid/detail/patches.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

namespace sunder::rigid::detail {
namespace {

auto coordinates(const Vec3& x) { return std::array{x.x(), x.y(), x.z()}; }

auto rank(const ContactSample& s) {
  return std::tuple(s.body_a, s.body_b, s.sub_step, coordinates(s.point), s.impulse);
}

auto rank(const Impact& i) { return std::tuple(i.body_a, i.body_b, coordinates(i.point), i.impulse); }

using Patch = std::vector<ContactSample>;

bool belongs(const Patch& patch, const ContactSample& s) {
  const ContactSample& seed = patch.front();
  return seed.body_a == s.body_a && seed.body_b == s.body_b && (seed.point - s.point).norm() <= s.patch_size;
}

// The rigid motion of the pair is affine in the point, so the mean over one sub-step is the speed at the mean point.
double fastest_approach(const Patch& patch) {
  struct Sum {
    double impulse = 0, speed = 0;
  };
  std::map<int, Sum> sums;
  for (const ContactSample& s : patch) {
    sums[s.sub_step].impulse += s.impulse;
    sums[s.sub_step].speed += s.impulse * s.approach_speed;
  }
  double fastest = 0;
  for (const auto& [sub_step, sum] : sums) fastest = std::max(fastest, sum.speed / sum.impulse);
  return fastest;
}

Impact impact_of(const Patch& patch) {
  Impact impact;
  impact.body_a = patch.front().body_a;
  impact.body_b = patch.front().body_b;
  for (const ContactSample& s : patch) {
    impact.impulse += s.impulse;
    impact.point += s.impulse * s.point;
    impact.normal += s.impulse * s.normal;
    impact.arm_a += s.impulse * s.arm_a;
    impact.arm_b += s.impulse * s.arm_b;
  }
  impact.point /= impact.impulse;
  impact.arm_a /= impact.impulse;
  impact.arm_b /= impact.impulse;
  impact.normal.normalize();
  impact.approach_speed = fastest_approach(patch);
  return impact;
}

}  // namespace

std::vector<Impact> impacts(std::vector<ContactSample> samples, double resting_speed) {
  std::sort(samples.begin(), samples.end(), [](const auto& s, const auto& t) { return rank(s) < rank(t); });
  std::vector<Patch> patches;
  std::size_t pair_begin = 0;
  for (const ContactSample& s : samples) {
    if (patches.empty() || patches.back().front().body_a != s.body_a || patches.back().front().body_b != s.body_b)
      pair_begin = patches.size();
    auto home = std::find_if(patches.begin() + static_cast<std::ptrdiff_t>(pair_begin), patches.end(),
                             [&](const Patch& p) { return belongs(p, s); });
    if (home == patches.end())
      patches.push_back({s});
    else
      home->push_back(s);
  }
  std::vector<Impact> result;
  for (const Patch& patch : patches) {
    Impact impact = impact_of(patch);
    if (impact.approach_speed > resting_speed) result.push_back(impact);
  }
  std::sort(result.begin(), result.end(), [](const auto& i, const auto& j) { return rank(i) < rank(j); });
  return result;
}

}  // namespace sunder::rigid::detail
