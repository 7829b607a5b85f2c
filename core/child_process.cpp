#include "core/child_process.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <string_view>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.h"

namespace sunder {
namespace {

/// A file without a name: unlike a pipe it takes any number of bytes before anyone reads.
class Letter {
 public:
  Letter() : file_(memfd_create("sunder", MFD_CLOEXEC)) {}
  ~Letter() {
    if (file_ >= 0) close(file_);
  }
  Letter(const Letter&) = delete;
  Letter& operator=(const Letter&) = delete;
  bool is_open() const { return file_ >= 0; }

  bool write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::write(file_, bytes.data(), bytes.size());
      if (count < 0 && errno != EINTR) return false;
      bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    }
    return true;
  }

  std::string read() const {
    std::string bytes(static_cast<std::size_t>(std::max<off_t>(lseek(file_, 0, SEEK_END), 0)), '\0');
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t count = pread(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
      if (count == 0 || (count < 0 && errno != EINTR)) throw ChildFailed("its result was lost");
      done += static_cast<std::size_t>(std::max<ssize_t>(count, 0));
    }
    return bytes;
  }

 private:
  int file_;
};

// First byte: 0, or the kind of an Error whose message follows.
constexpr char kDone = 0;

bool write_outcome(Letter& letter, const std::function<std::string()>& work) {
  const auto write_error = [&](ErrorKind kind, const char* message) {
    return letter.write(std::string(1, static_cast<char>(kind))) && letter.write(message);
  };
  try {
    const std::string result = work();
    return letter.write({&kDone, 1}) && letter.write(result);
  } catch (const Error& error) {
    return write_error(error.kind(), error.what());
  } catch (const std::exception& error) {
    return write_error(ErrorKind::internal, error.what());
  }
}

[[noreturn]] void be_child(Letter& letter, const std::function<std::string()>& work, double processor_seconds) {
  for (const int signal : {SIGINT, SIGTERM, SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL}) std::signal(signal, SIG_DFL);
  const int nowhere = open("/dev/null", O_WRONLY);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  const rlimit no_core = {.rlim_cur = 0, .rlim_max = 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const auto seconds = static_cast<rlim_t>(std::ceil(std::max(processor_seconds, 1.0)));
  const rlimit time = {.rlim_cur = seconds, .rlim_max = seconds + 1};
  setrlimit(RLIMIT_CPU, &time);
  _exit(write_outcome(letter, work) ? 0 : 1);  // not exit: what ends a program belongs to the parent
}

int status_of(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return status;
}

bool was_interrupted(int status) {
  return WIFSIGNALED(status) && (WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM);
}

}  // namespace

std::string ending_of(int status) {
  if (!WIFSIGNALED(status)) return "ended with code " + std::to_string(WEXITSTATUS(status));
  if (WTERMSIG(status) == SIGXCPU) return "took too long";
  if (WTERMSIG(status) == SIGKILL) return "was killed, as systems do that run out of memory";
  return std::string("crashed (") + strsignal(WTERMSIG(status)) + ")";
}

std::string in_child_process(const std::function<std::string()>& work, double processor_seconds) {
  Letter letter;
  const pid_t child = letter.is_open() ? fork() : -1;
  if (child < 0) return work();
  if (child == 0) be_child(letter, work, processor_seconds);
  const int status = status_of(child);
  if (was_interrupted(status)) throw Error(ErrorKind::interrupted, "interrupted");
  std::string bytes = letter.read();
  if (status != 0 || bytes.empty()) throw ChildFailed(ending_of(status));
  const char kind = bytes.front();
  bytes.erase(0, 1);
  if (kind != kDone) throw Error(static_cast<ErrorKind>(kind), bytes);
  return bytes;
}

}  // namespace sunder
