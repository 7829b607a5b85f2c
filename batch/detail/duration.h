#pragma once
/// Times for people.
#include <cstdio>
#include <string>

namespace sunder::batch::detail {

/// "1.2 s", "34 min", "5.6 h".
inline std::string duration(double seconds) {
  char text[48];
  if (seconds < 90)
    std::snprintf(text, sizeof text, "%.2g s", seconds);
  else if (seconds < 5400)
    std::snprintf(text, sizeof text, "%.0f min", seconds / 60);
  else
    std::snprintf(text, sizeof text, "%.1f h", seconds / 3600);
  return text;
}

}  // namespace sunder::batch::detail
