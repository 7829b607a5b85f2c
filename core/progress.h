#pragma once
/// Where a run is. A terminal shows it as a bar, a farm log as JSON lines, a test not at all.
#include <string_view>

#include "core/error.h"

namespace sunder {

class Progress {
 public:
  virtual ~Progress() = default;

  /// `stage` ("solve", "cut", ...) has done `fraction` in [0, 1] of its work. Cheap: call it as often as is convenient.
  virtual void report(std::string_view stage, double fraction) = 0;

  /// True once the user asked to stop.
  virtual bool cancelled() const = 0;

  /// Reports, then throws ErrorKind::interrupted if the user asked to stop.
  void checkpoint(std::string_view stage, double fraction) {
    report(stage, fraction);
    if (cancelled()) throw Error(ErrorKind::interrupted, "interrupted");
  }
};

/// Says nothing and never stops.
class SilentProgress final : public Progress {
 public:
  void report(std::string_view, double) override {}
  bool cancelled() const override { return false; }
};

}  // namespace sunder
