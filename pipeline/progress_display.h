#pragma once
/// Shows progress on a terminal (bar, stage, percent, time left) or as JSON lines.
#include <memory>

#include "core/progress.h"

namespace sunder::pipeline {

enum class LogFormat { text, json };

/// Text: a bar on stderr, redrawn at most ten times a second, only when stderr is a terminal; otherwise a line
/// every ten seconds. JSON: lines {"event":"progress","stage":...,"percent":...,"seconds_left":...} on stdout at most
/// twice a second. The overall fraction is what `report("total", fraction)` said last; other stages show beside it.
/// Ctrl-C and SIGTERM make `cancelled()` true; a second Ctrl-C ends the process at once.
std::unique_ptr<Progress> make_progress_display(LogFormat format);

}  // namespace sunder::pipeline
