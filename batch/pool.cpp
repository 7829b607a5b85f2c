#include "batch/pool.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include "core/child_process.h"

namespace sunder::batch {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int look_around = 200;         // between looks at the clock and the keyboard [ms]
constexpr std::size_t last_words = 400;  // of what a process said before it died [bytes]

/// What a worker answers after each job.
struct Answer {
  enum Kind : std::uint8_t { done, failed, cannot_write } kind;
  double seconds, memory_mb;
  std::array<char, 512> message;  ///< of cannot_write
};

/// `call` is read or write, which may do a part at a time. False when the other end is gone.
template <typename Call, typename Byte>
bool transfer(Call call, int file, Byte* at, std::size_t count) {
  while (count > 0) {
    const ssize_t done = call(file, at, count);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    at += done;
    count -= static_cast<std::size_t>(done);
  }
  return true;
}

template <typename Message>
bool send(int file, const Message& message) {
  return transfer(write, file, reinterpret_cast<const char*>(&message), sizeof message);
}

template <typename Message>
bool receive(int file, Message& message) {
  return transfer(read, file, reinterpret_cast<char*>(&message), sizeof message);
}

[[noreturn]] void be_worker(const Plan& plan, const std::filesystem::path& out, int threads, int orders, int answers) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  Worker worker(plan, out);
  std::uint64_t index = 0;
  while (receive(orders, index)) {
    Answer answer{Answer::done, 0, 0, {}};
    try {
      const JobEnd end = worker.work(plan.job(index));
      answer.kind = end.failed ? Answer::failed : Answer::done;
      answer.seconds = end.seconds;
      answer.memory_mb = end.memory_mb;
    } catch (const std::exception& error) {
      answer.kind = Answer::cannot_write;
      std::strncpy(answer.message.data(), error.what(), answer.message.size() - 1);
    }
    if (!send(answers, answer)) break;
  }
  _exit(0);
}

/// A process that works at one job after another.
class Hand {
 public:
  Hand(const Plan& plan, const std::filesystem::path& out, int threads) {
    std::array<int, 2> orders, answers;
    said_ = memfd_create("said", MFD_CLOEXEC);
    if (said_ < 0 || pipe2(orders.data(), O_CLOEXEC) != 0 || pipe2(answers.data(), O_CLOEXEC) != 0) fail();
    const pid_t parent = getpid();
    process_ = fork();
    if (process_ < 0) fail();
    if (process_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);  // nobody would take its answers
      if (getppid() != parent) _exit(1);
      std::signal(SIGINT, SIG_IGN);  // Ctrl-C reaches the whole group; the parent decides
      std::signal(SIGTERM, SIG_DFL);
      for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) dup2(said_, stream);
      close(orders[1]);
      close(answers[0]);
      be_worker(plan, out, threads, orders[0], answers[1]);
    }
    close(orders[0]);
    close(answers[1]);
    orders_ = orders[1];
    answers_ = answers[0];
  }

  ~Hand() {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      wait();
    }
    for (const int file : {orders_, answers_, said_}) close(file);
  }
  Hand(const Hand&) = delete;
  Hand& operator=(const Hand&) = delete;

  bool give(std::uint64_t job) {
    job_ = job;
    since_ = Clock::now();
    return send(orders_, job);
  }
  std::optional<std::uint64_t> job() const { return job_; }
  double seconds() const { return std::chrono::duration<double>(Clock::now() - since_).count(); }
  int answers() const { return answers_; }

  /// Not set: the process is dead.
  std::optional<Answer> answer() {
    Answer answer;
    if (!receive(answers_, answer)) return {};
    job_.reset();
    return answer;
  }

  /// How it died, after answer() found that it did.
  std::string end() {
    const std::string how = ending_of(wait());
    const std::string words = said();
    return "the process " + how + (words.empty() ? "" : "; it said: " + words);
  }

 private:
  [[noreturn]] static void fail() {
    throw Error(ErrorKind::internal, "no process can be started: " + std::generic_category().message(errno));
  }

  int wait() {
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
    process_ = -1;
    return status;
  }

  /// The end of what it printed, on one line.
  std::string said() const {
    std::array<char, last_words> words;
    const off_t size = lseek(said_, 0, SEEK_END);
    const ssize_t count =
        pread(said_, words.data(), words.size(), std::max<off_t>(0, size - static_cast<off_t>(last_words)));
    std::string text(words.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  }

  pid_t process_ = -1;
  int orders_ = -1, answers_ = -1, said_ = -1;
  std::optional<std::uint64_t> job_;
  Clock::time_point since_;
};

class Pool {
 public:
  Pool(const Plan& plan, const std::filesystem::path& out, const std::vector<std::uint64_t>& jobs,
       const PoolSettings& settings, Progress& progress)
      : plan_(plan), out_(out), results_(out), jobs_(jobs), settings_(settings), progress_(progress) {}

  PoolTally run() {
    try {
      work();
    } catch (...) {
      stop();
      throw;
    }
    stop();
    return tally_;
  }

 private:
  void work() {
    while (settled() < jobs_.size()) {
      if (progress_.cancelled()) {
        tally_.interrupted = true;
        break;
      }
      give_out();
      await_answers();
      show();
    }
  }

  void stop() {
    hands_.clear();
    results_.remove_abandoned();
  }

  std::unique_ptr<Hand> new_hand() const { return std::make_unique<Hand>(plan_, out_, settings_.threads_per_job); }
  std::uint64_t settled() const { return tally_.done + tally_.failed; }

  /// How many jobs may be worked at now.
  std::size_t most_at_once() const {
    const auto workers = static_cast<std::size_t>(settings_.workers);
    if (settings_.memory_mb <= 0) return workers;
    if (job_memory_ <= 0) return 1;
    return std::clamp<std::size_t>(static_cast<std::size_t>(settings_.memory_mb / job_memory_), 1, workers);
  }

  void give_out() {
    std::size_t busy = 0;
    for (const auto& hand : hands_) busy += hand->job().has_value();
    const std::size_t most = std::min(most_at_once(), busy + jobs_.size() - next_);
    while (hands_.size() < most) hands_.push_back(new_hand());
    for (auto& hand : hands_) {
      if (busy >= most || next_ >= jobs_.size()) return;
      if (hand->job()) continue;
      hand->give(jobs_[next_++]);
      ++busy;
    }
  }

  void await_answers() {
    std::vector<pollfd> files;
    for (const auto& hand : hands_) files.push_back({hand->answers(), POLLIN, 0});
    if (poll(files.data(), files.size(), look_around) < 0) return;
    for (std::size_t i = 0; i < hands_.size(); ++i) {
      if (files[i].revents != 0)
        take_answer(hands_[i]);
      else if (plan_.job_time_limit > 0 && hands_[i]->job() && hands_[i]->seconds() > plan_.job_time_limit)
        replace(hands_[i], "took longer than the plan's job_time_limit");
    }
  }

  void take_answer(std::unique_ptr<Hand>& hand) {
    if (!hand->job()) return;
    const std::optional<Answer> answer = hand->answer();
    if (!answer) return replace(hand, hand->end());
    if (answer->kind == Answer::cannot_write)
      throw Error(ErrorKind::io,
                  std::string(answer->message.data()) + "; what is done is kept, the same command goes on");
    ++(answer->kind == Answer::failed ? tally_.failed : tally_.done);
    tally_.busy_seconds += answer->seconds;
    job_memory_ = std::max(job_memory_, answer->memory_mb);
  }

  /// What its process could not finish fails.
  void replace(std::unique_ptr<Hand>& hand, const std::string& why) {
    const Job job = plan_.job(*hand->job());
    tally_.busy_seconds += hand->seconds();
    hand.reset();
    if (!results_.has(job.id)) write_failure(job, results_, static_cast<int>(ErrorKind::internal), why);
    ++tally_.failed;
    results_.remove_abandoned();
    hand = new_hand();
  }

  void show() {
    const std::string of = std::to_string(settled()) + " of " + std::to_string(jobs_.size()) + " jobs";
    const double share = static_cast<double>(settled()) / static_cast<double>(jobs_.size());
    progress_.report(of + (tally_.failed > 0 ? ", " + std::to_string(tally_.failed) + " failed" : ""), share);
    progress_.report("total", share);
  }

  const Plan& plan_;
  const std::filesystem::path out_;
  const Results results_;
  const std::vector<std::uint64_t>& jobs_;
  const PoolSettings settings_;
  Progress& progress_;
  std::vector<std::unique_ptr<Hand>> hands_;
  std::size_t next_ = 0;
  double job_memory_ = 0;  ///< the most that one was seen to take [MB]
  PoolTally tally_;
};

}  // namespace

PoolTally work_through(const Plan& plan, const std::filesystem::path& out, const std::vector<std::uint64_t>& jobs,
                       const PoolSettings& settings, Progress& progress) {
  if (jobs.empty()) return {};
  std::signal(SIGPIPE, SIG_IGN);  // a worker that died is noticed when its answer is read
  return Pool(plan, out, jobs, settings, progress).run();
}

}  // namespace sunder::batch
