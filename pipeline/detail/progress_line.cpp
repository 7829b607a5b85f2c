#include "pipeline/detail/progress_line.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace sunder::pipeline::detail {
namespace {

std::string padded(long value, std::size_t width, char fill) {
  const std::string digits = std::to_string(value);
  return std::string(digits.size() < width ? width - digits.size() : 0, fill) + digits;
}

// Rounded down, so that 100 means done.
long percent(double fraction) { return static_cast<long>(std::floor(100 * std::clamp(fraction, 0.0, 1.0))); }

double tenths(double value) { return std::floor(10 * value) / 10; }

}  // namespace

std::optional<double> seconds_left(double elapsed, double total_fraction) {
  constexpr double kLeastSeconds = 1, kLeastFraction = 0.005;  // earlier than this the estimate only jumps about
  if (elapsed < kLeastSeconds || total_fraction < kLeastFraction) return std::nullopt;
  return elapsed * (1 - std::min(total_fraction, 1.0)) / total_fraction;
}

std::string duration_text(double seconds) {
  const long whole = std::lround(seconds);
  if (whole < 60) return std::to_string(whole) + " s";
  const std::string tail = padded(whole % 60, 2, '0');
  if (whole < 3600) return std::to_string(whole / 60) + ":" + tail;
  return std::to_string(whole / 3600) + ":" + padded(whole / 60 % 60, 2, '0') + ":" + tail;
}

std::string bar_line(const ProgressState& state) {
  constexpr std::size_t kWidth = 24;
  const auto filled = static_cast<std::size_t>(kWidth * std::clamp(state.total_fraction, 0.0, 1.0));
  std::string line("[");
  line.append(filled, '#').append(kWidth - filled, ' ').append("] ");
  line += padded(percent(state.total_fraction), 3, ' ') + "%";
  if (!state.stage.empty()) line += "  " + state.stage + " " + std::to_string(percent(state.stage_fraction)) + "%";
  if (state.seconds_left) line += "  " + duration_text(*state.seconds_left) + " left";
  return line;
}

std::string stage_line(const ProgressState& state) {
  return padded(percent(state.total_fraction), 3, ' ') + "%  " + state.stage;
}

std::string json_line(const ProgressState& state) {
  nlohmann::ordered_json line = {{"event", "progress"},
                                 {"stage", state.stage},
                                 {"stage_percent", tenths(100 * state.stage_fraction)},
                                 {"percent", tenths(100 * state.total_fraction)}};
  line["seconds_left"] = state.seconds_left ? nlohmann::ordered_json(tenths(*state.seconds_left)) : nullptr;
  return line.dump();
}

std::string openjd_lines(const ProgressState& state) {
  char text[160];
  std::snprintf(text, sizeof text, "openjd_progress: %.1f", 100 * state.total_fraction);
  std::string lines = text;
  if (state.stage.empty()) return lines;
  std::snprintf(text, sizeof text, "\nopenjd_status: %s %.0f%%", state.stage.c_str(), 100 * state.stage_fraction);
  return lines + text;
}

}  // namespace sunder::pipeline::detail
