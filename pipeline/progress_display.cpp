#include "pipeline/progress_display.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <string>

#include <unistd.h>

#include "pipeline/detail/progress_line.h"

namespace sunder::pipeline {
namespace {

// A signal handler can reach nothing but a global of this type.
std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void request_stop(int) {
  if (stop_requested.exchange(true)) _exit(static_cast<int>(ErrorKind::interrupted));
}

// Takes over Ctrl-C and SIGTERM while it lives.
class StopSignals {
 public:
  StopSignals() {
    stop_requested = false;
    interrupt_before_ = std::signal(SIGINT, request_stop);
    terminate_before_ = std::signal(SIGTERM, request_stop);
  }
  ~StopSignals() {
    std::signal(SIGINT, interrupt_before_);
    std::signal(SIGTERM, terminate_before_);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

 private:
  void (*interrupt_before_)(int);
  void (*terminate_before_)(int);
};

// Keeps the state that all displays share; a stage may report from any thread.
class Display : public Progress {
 public:
  void report(std::string_view stage, double fraction) final {
    const std::lock_guard lock(mutex_);
    const bool total = stage == "total";
    if (total) {
      state_.total_fraction = fraction;
    } else {
      state_.stage = stage;
      state_.stage_fraction = fraction;
    }
    const auto now = std::chrono::steady_clock::now();
    const bool due = std::chrono::duration<double>(now - shown_).count() >= interval_;
    const bool finished = total && fraction >= 1;
    if (!wants(due, finished)) return;
    shown_ = now;
    state_.seconds_left =
        detail::seconds_left(std::chrono::duration<double>(now - start_).count(), state_.total_fraction);
    show(state_);
  }

  bool cancelled() const final { return stop_requested; }

 protected:
  explicit Display(double interval) : interval_(interval) {}

 private:
  virtual bool wants(bool due, bool finished) const = 0;
  virtual void show(const detail::ProgressState& state) = 0;

  StopSignals signals_;
  std::mutex mutex_;
  detail::ProgressState state_;
  double interval_;  // between two showings [s]
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point shown_;  // long ago
};

class TerminalBar final : public Display {
 public:
  TerminalBar() : Display(0.1) {}
  ~TerminalBar() override { std::fputs("\r\x1b[K", stderr); }

 private:
  bool wants(bool due, bool finished) const override { return due || finished; }
  void show(const detail::ProgressState& state) override {
    std::fprintf(stderr, "\r%s\x1b[K", detail::bar_line(state).c_str());
    std::fflush(stderr);
  }
};

// For logs that people read: a line now and then.
class LogLines final : public Display {
 public:
  LogLines() : Display(10) {}

 private:
  bool wants(bool due, bool finished) const override { return due || finished; }
  void show(const detail::ProgressState& state) override {
    std::fprintf(stderr, "%s\n", detail::stage_line(state).c_str());
  }
};

class JsonLines final : public Display {
 public:
  JsonLines() : Display(0.5) {}

 private:
  bool wants(bool due, bool finished) const override { return due || finished; }
  void show(const detail::ProgressState& state) override {
    std::printf("%s\n", detail::json_line(state).c_str());
    std::fflush(stdout);
  }
};

class OpenJobDescriptionLines final : public Display {
 public:
  OpenJobDescriptionLines() : Display(1) {}

 private:
  bool wants(bool due, bool finished) const override { return due || finished; }
  void show(const detail::ProgressState& state) override {
    std::printf("%s\n", detail::openjd_lines(state).c_str());
    std::fflush(stdout);
  }
};

// Signals stop the run all the same.
class NoDisplay final : public Display {
 public:
  NoDisplay() : Display(0) {}

 private:
  bool wants(bool, bool) const override { return false; }
  void show(const detail::ProgressState&) override {}
};

}  // namespace

std::string openjd_failure(const std::string& message) {
  std::string line = "openjd_fail: " + message;
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

std::unique_ptr<Progress> make_progress_display(const LogSettings& log) {
  if (log.progress == ProgressFormat::off) return std::make_unique<NoDisplay>();
  if (log.progress == ProgressFormat::openjd) return std::make_unique<OpenJobDescriptionLines>();
  if (log.format == LogFormat::json) return std::make_unique<JsonLines>();
  if (isatty(STDERR_FILENO)) return std::make_unique<TerminalBar>();
  return std::make_unique<LogLines>();
}

}  // namespace sunder::pipeline
