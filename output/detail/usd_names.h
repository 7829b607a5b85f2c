#pragma once
/// Names as USD allows them.
#include <map>
#include <set>
#include <string>

namespace sunder::output::detail {

/// Gives each name a prim name of its own: what is no letter, digit or underscore becomes one, and so does a digit in
/// front; should two names become one, a number is added to the later.
class UsdNames {
 public:
  const std::string& operator()(const std::string& name);

 private:
  std::map<std::string, std::string> prim_;
  std::set<std::string> taken_;
};

}  // namespace sunder::output::detail
