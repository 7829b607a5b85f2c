#include "validation/problem.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "validation/catalogue.h"

namespace sunder::validation {

Check relative(const std::string& what, double value, double reference, double bound) {
  return {what, value, reference, std::abs(value / reference - 1), bound};
}

Check absolute(const std::string& what, double value, double reference, double bound) {
  return {what, value, reference, std::abs(value - reference), bound};
}

Check within(const std::string& what, double value, double least, double most) {
  char interval[64];
  std::snprintf(interval, sizeof interval, ", in [%g, %g]", least, most);
  // 0 inside; not a number stays one.
  const double outside = std::max(least - value, value - most);
  return {what + interval, value, std::clamp(value, least, most), outside > 0 ? outside : value - value, 0};
}

const std::vector<Problem>& problems() {
  static const std::vector<Problem> all = [] {
    std::vector<Problem> list;
    for (const auto& part :
         {elasticity(), damage(), fracture(), size_distributions(), surfaces(), rigid_bodies(), contact()})
      list.insert(list.end(), part.begin(), part.end());
    // Ids are a letter and a number, perhaps with a variant.
    std::stable_sort(list.begin(), list.end(), [](const Problem& a, const Problem& b) {
      return std::pair(a.id[0], std::stoi(a.id.substr(1))) < std::pair(b.id[0], std::stoi(b.id.substr(1)));
    });
    return list;
  }();
  return all;
}

}  // namespace sunder::validation
