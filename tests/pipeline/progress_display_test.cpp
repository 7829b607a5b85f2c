/// What a terminal, a log and a farm see of a run, and how it is stopped.
#include "pipeline/progress_display.h"

#include <csignal>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/detail/progress_line.h"

namespace sunder::pipeline {
namespace {

TEST(ProgressLine, EstimatesTheTimeLeft) {
  EXPECT_EQ(detail::seconds_left(30, 0.25), 90);
  EXPECT_EQ(detail::seconds_left(30, 1), 0);
  EXPECT_FALSE(detail::seconds_left(0.01, 0.5));
  EXPECT_FALSE(detail::seconds_left(100, 0));
}

TEST(ProgressLine, WritesDurations) {
  EXPECT_EQ(detail::duration_text(8.6), "9 s");
  EXPECT_EQ(detail::duration_text(59.6), "1:00");
  EXPECT_EQ(detail::duration_text(125), "2:05");
  EXPECT_EQ(detail::duration_text(3725), "1:02:05");
}

TEST(ProgressLine, DrawsTheBar) {
  EXPECT_EQ(detail::bar_line({"solve", 0.8, 0.5, 125}), "[############            ]  50%  solve 80%  2:05 left");
  EXPECT_EQ(detail::bar_line({"", 0, 0, {}}), "[                        ]   0%");
  EXPECT_EQ(detail::bar_line({"cut", 0.999, 0.999, 0}).substr(26, 4), "  99") << "100 means done";
  EXPECT_EQ(detail::bar_line({"cut", 1, 1.5, 0}), "[########################] 100%  cut 100%  0 s left");
}

TEST(ProgressLine, SpeaksOpenJobDescription) {
  EXPECT_EQ(detail::openjd_lines({"solve", 0.8, 0.5, 125}), "openjd_progress: 50.0\nopenjd_status: solve 80%");
  EXPECT_EQ(detail::openjd_lines({"", 0, 1, 0}), "openjd_progress: 100.0");
  EXPECT_EQ(openjd_failure("no room\nleft"), "openjd_fail: no room left");
}

TEST(ProgressDisplay, OpenJobDescriptionLinesEndAtAHundred) {
  testing::internal::CaptureStdout();
  {
    const auto display = make_progress_display({LogFormat::text, ProgressFormat::openjd});
    for (int i = 0; i <= 100; ++i) {
      display->report("solve", i / 100.0);
      display->report("total", i / 100.0);
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(),
            "openjd_progress: 0.0\nopenjd_status: solve 0%\nopenjd_progress: 100.0\nopenjd_status: solve 100%\n");
}

TEST(ProgressDisplay, CanBeOffAndStillStops) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  {
    const auto display = make_progress_display({LogFormat::json, ProgressFormat::off});
    display->report("total", 1);
    std::raise(SIGTERM);
    EXPECT_TRUE(display->cancelled());
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");
}

TEST(ProgressDisplay, JsonLinesAreThrottledAndEndAtAHundred) {
  testing::internal::CaptureStdout();
  {
    const auto display = make_progress_display({LogFormat::json});
    for (int i = 0; i < 1000; ++i) {
      display->report("solve", i / 1000.0);
      display->report("total", i / 1000.0);
    }
    display->report("total", 1);
  }
  std::istringstream lines(testing::internal::GetCapturedStdout());
  int count = 0;
  nlohmann::json last;
  for (std::string line; std::getline(lines, line); ++count) last = nlohmann::json::parse(line);
  EXPECT_GE(count, 2);
  EXPECT_LT(count, 10) << "2 a second; 2000 reports take milliseconds";
  EXPECT_EQ(last["event"], "progress");
  EXPECT_EQ(last["stage"], "solve");
  EXPECT_EQ(last["percent"], 100);
  EXPECT_TRUE(last["seconds_left"].is_null());
}

TEST(ProgressDisplay, ALogGetsALineNowAndThen) {
  testing::internal::CaptureStderr();
  {
    const auto display = make_progress_display({LogFormat::text});
    for (const char* stage : {"solve", "solve", "cut", "solve", "cut"}) display->report(stage, 0.5);
    display->report("total", 0.25);
    display->report("total", 1);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "  0%  solve\n100%  cut\n")
      << "the first line, none within ten seconds, the end";
}

TEST(ProgressDisplay, SignalsCancel) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto display = make_progress_display({LogFormat::json});
    EXPECT_FALSE(display->cancelled()) << "a new display starts afresh";
    std::raise(signal);
    EXPECT_TRUE(display->cancelled());
    testing::internal::CaptureStdout();
    EXPECT_THROW(display->checkpoint("solve", 0.5), Error);
    testing::internal::GetCapturedStdout();
  }
}

TEST(ProgressDisplayDeathTest, ASecondSignalEndsTheProcess) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        const auto display = make_progress_display({LogFormat::json});
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      testing::ExitedWithCode(130), "");
}

}  // namespace
}  // namespace sunder::pipeline
