#pragma once
/// One moment of a run as text.
#include <optional>
#include <string>

namespace sunder::pipeline::detail {

struct ProgressState {
  std::string stage;
  double stage_fraction = 0;           ///< of the stage, in [0, 1]
  double total_fraction = 0;           ///< of the run, in [0, 1]
  std::optional<double> seconds_left;  ///< of the run; not known at its start
};

/// Time left if the rest goes as fast as what is done: elapsed * (1 - f) / f. Nothing before there is something to go
/// by.
std::optional<double> seconds_left(double elapsed, double total_fraction);

/// "9 s", "2:05", "1:02:05".
std::string duration_text(double seconds);

/// "[#######             ]  35%  solve 80%  2:05 left".
std::string bar_line(const ProgressState& state);

/// "35%  solve".
std::string stage_line(const ProgressState& state);

/// {"event":"progress","stage":"solve","percent":35.2,"seconds_left":125}.
std::string json_line(const ProgressState& state);

/// "openjd_progress: 35.2", and if a stage is known a second line "openjd_status: solve 80%".
std::string openjd_lines(const ProgressState& state);

}  // namespace sunder::pipeline::detail
