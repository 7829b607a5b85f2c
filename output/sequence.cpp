#include "output/sequence.h"

#include <cmath>
#include <cstdio>

namespace sunder::output {

int frame_at(double time, double frame_rate, int start_frame) {
  constexpr double kRounding = 1e-9;  // of a time that is meant to be a frame's
  return start_frame + static_cast<int>(std::ceil(time * frame_rate - kRounding));
}

std::string fragment_name(const std::string& body, int number) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "_%04d", number);
  return body + digits;
}

std::string outside_material(const std::string& material) { return material + "_outside"; }
std::string inside_material(const std::string& material) { return material + "_inside"; }

}  // namespace sunder::output
