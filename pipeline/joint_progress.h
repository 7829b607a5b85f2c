#pragma once
/// One progress for works that run side by side.
#include <deque>
#include <mutex>
#include <vector>

#include "core/progress.h"

namespace sunder::pipeline {

/// Reports the mean of what the parts report, under the stage that reported last, one report at a time.
class JointProgress {
 public:
  JointProgress(Progress& whole, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) parts_.emplace_back(*this);
    whole_ = &whole;
  }
  Progress& part(std::size_t i) { return parts_[i]; }

 private:
  class Part final : public Progress {
   public:
    explicit Part(JointProgress& joint) : joint_(joint) {}
    void report(std::string_view stage, double fraction) override {
      const std::lock_guard lock(joint_.mutex_);
      fraction_ = fraction;
      double sum = 0;
      for (const Part& part : joint_.parts_) sum += part.fraction_;
      joint_.whole_->report(stage, sum / static_cast<double>(joint_.parts_.size()));
    }
    bool cancelled() const override { return joint_.whole_->cancelled(); }

   private:
    JointProgress& joint_;
    double fraction_ = 0;
  };

  Progress* whole_ = nullptr;
  std::mutex mutex_;
  std::deque<Part> parts_;
};

}  // namespace sunder::pipeline
