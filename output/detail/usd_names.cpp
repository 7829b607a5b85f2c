#include "output/detail/usd_names.h"

#include <string_view>

namespace sunder::output::detail {
namespace {

constexpr std::string_view kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_0123456789";

std::string identifier(const std::string& name) {
  std::string result;
  for (const char c : name) result.push_back(kAllowed.find(c) == std::string_view::npos ? '_' : c);
  const bool digit_first = !result.empty() && result[0] >= '0' && result[0] <= '9';
  return result.empty() || digit_first ? "_" + result : result;
}

}  // namespace

const std::string& UsdNames::operator()(const std::string& name) {
  const auto [entry, is_new] = prim_.try_emplace(name);
  if (!is_new) return entry->second;
  const std::string base = identifier(name);
  std::string prim = base;
  for (int number = 2; !taken_.insert(prim).second; ++number) prim = base + "_" + std::to_string(number);
  return entry->second = prim;
}

}  // namespace sunder::output::detail
