#pragma once
/// Every key that a scene may hold, so that its documentation can be checked against it.
#include <string>
#include <vector>

namespace sunder::pipeline::detail {

struct SectionKeys {
  std::string section;  ///< as written: "[scene]", "[material.<name>]", "[[body]]"
  std::vector<std::string> keys;
};

std::vector<SectionKeys> scene_keys();

}  // namespace sunder::pipeline::detail
