#include "output/sequence.h"

#include <cstdio>

namespace sunder::output {

std::string fragment_name(const std::string& body, int number) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "_%04d", number);
  return body + digits;
}

std::string outside_material(const std::string& material) { return material + "_outside"; }
std::string inside_material(const std::string& material) { return material + "_inside"; }

}  // namespace sunder::output
