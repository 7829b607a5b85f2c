#pragma once
/// Shows progress on a terminal (bar, stage, percent, time left) or as JSON lines.
#include <memory>
#include <string>

#include "core/progress.h"

namespace sunder::pipeline {

enum class LogFormat { text, json };
enum class ProgressFormat { by_log, openjd, off };

struct LogSettings {
  LogFormat format = LogFormat::text;                ///< of what happens
  ProgressFormat progress = ProgressFormat::by_log;  ///< of how far it is
};

/// Text: a bar on stderr, redrawn at most ten times a second, only when stderr is a terminal; otherwise a line
/// every ten seconds. JSON: lines {"event":"progress","stage":...,"percent":...,"seconds_left":...} on stdout at most
/// twice a second. The overall fraction is what `report("total", fraction)` said last; other stages show beside it.
/// openjd: the lines "openjd_progress: 12.3" and "openjd_status: solve 80%" of Open Job Description on stdout, at most
/// once a second. Ctrl-C and SIGTERM make `cancelled()` true; a second Ctrl-C ends the process at once.
std::unique_ptr<Progress> make_progress_display(const LogSettings& log);

/// "openjd_fail: ..." on one line.
std::string openjd_failure(const std::string& message);

}  // namespace sunder::pipeline
