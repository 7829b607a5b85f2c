#pragma once
/// Wall-clock time of a scope.
#include <chrono>

namespace sunder {

/// Adds the seconds between its construction and destruction to a sum.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds), start_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_;
};

/// How much of something was done, and how long that took.
struct Effort {
  long count = 0;
  double seconds = 0;  ///< wall-clock
  Effort& operator+=(const Effort& other) {
    count += other.count;
    seconds += other.seconds;
    return *this;
  }
};

}  // namespace sunder
