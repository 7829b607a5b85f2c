/// What a child process computes comes back; whatever else happens to it is said.
#include "core/child_process.h"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

#include "core/error.h"

namespace sunder {
namespace {

constexpr double kEnough = 60;  // processor time [s]

std::string failure_of(const std::function<std::string()>& work, double seconds = kEnough) {
  try {
    in_child_process(work, seconds);
  } catch (const ChildFailed& failed) {
    return failed.what();
  }
  return "";
}

TEST(ChildProcess, GivesBackAnyBytesOfAnyNumber) {
  const std::string bytes = std::string("a\0b\xff", 4);
  EXPECT_EQ(in_child_process([&] { return bytes; }, kEnough), bytes);
  EXPECT_EQ(in_child_process([] { return std::string(); }, kEnough), "");
  const std::string large(100'000'000, 'x');  // more than a pipe holds
  EXPECT_EQ(in_child_process([&] { return large; }, kEnough), large);
}

TEST(ChildProcess, ChangesNothingHere) {
  int number = 1;
  in_child_process([&] { return std::to_string(++number); }, kEnough);
  EXPECT_EQ(number, 1);
}

TEST(ChildProcess, PassesErrorsOn) {
  try {
    in_child_process([]() -> std::string { throw Error(ErrorKind::mesh, "no triangle"); }, kEnough);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mesh);
    EXPECT_STREQ(error.what(), "no triangle");
  }
  try {
    in_child_process([]() -> std::string { throw std::runtime_error("odd"); }, kEnough);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::internal);
    EXPECT_STREQ(error.what(), "odd");
  }
}

TEST(ChildProcess, SaysHowTheChildEnded) {
  EXPECT_EQ(failure_of([] { return std::raise(SIGSEGV), std::string(); }), "crashed (Segmentation fault)");
  EXPECT_EQ(failure_of([]() -> std::string { std::abort(); }), "crashed (Aborted)");
  EXPECT_EQ(failure_of([]() -> std::string { std::_Exit(3); }), "ended with code 3");
  EXPECT_NE(failure_of([] { return std::raise(SIGKILL), std::string(); }).find("was killed"), std::string::npos);
  EXPECT_THROW(in_child_process([] { return std::raise(SIGINT), std::string(); }, kEnough), Error);
}

TEST(ChildProcess, StopsWhatRunsAway) {
  const auto for_ever = []() -> std::string {
    for (std::atomic<int> turns = 0;;) ++turns;
  };
  EXPECT_EQ(failure_of(for_ever, 1), "took too long");
}

}  // namespace
}  // namespace sunder
