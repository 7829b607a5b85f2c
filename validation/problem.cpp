#include "validation/problem.h"

#include <algorithm>
#include <cmath>

#include "validation/catalogue.h"

namespace sunder::validation {

Check relative(const std::string& what, double value, double reference, double bound) {
  return {what, value, reference, std::abs(value / reference - 1), bound};
}

Check absolute(const std::string& what, double value, double reference, double bound) {
  return {what, value, reference, std::abs(value - reference), bound};
}

Check within(const std::string& what, double value, double least, double most) {
  const double outside = std::max({least - value, value - most, value - value});
  return {what, value, std::clamp(value, least, most), outside > 0 ? outside : value - value, 0};
}

const std::vector<Problem>& problems() {
  static const std::vector<Problem> all = [] {
    std::vector<Problem> list;
    for (const auto& part : {elasticity(), damage(), fracture()}) list.insert(list.end(), part.begin(), part.end());
    return list;
  }();
  return all;
}

}  // namespace sunder::validation
