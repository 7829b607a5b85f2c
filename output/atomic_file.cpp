#include "output/atomic_file.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"

namespace sunder::output {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, int reason) {
  throw Error(ErrorKind::io, "cannot write " + file.string() + ": " + std::generic_category().message(reason));
}

struct TemporaryFile {
  fs::path path;
  int descriptor = -1;
};

// A name that nobody else has: O_EXCL decides, so that runs may share a folder.
TemporaryFile create_beside(const fs::path& file) {
  std::string stem(".");
  stem.append(file.filename().string()).append(".").append(std::to_string(getpid())).append(".");
  constexpr int kAttempts = 1000;
  for (int i = 0; i < kAttempts; ++i) {
    const fs::path path = file.parent_path() / (stem + std::to_string(i) + ".tmp");
    const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) return {path, descriptor};
    if (errno != EEXIST) fail(file, errno);
  }
  fail(file, EEXIST);
}

/// The temporary file, which takes the place of the file or goes.
class Replacement {
 public:
  explicit Replacement(const fs::path& file) : file_(file), temporary_(create_beside(file)) {}
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;
  ~Replacement() {
    if (temporary_.descriptor >= 0) close(temporary_.descriptor);
    if (!placed_) unlink(temporary_.path.c_str());
  }

  void put(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = write(temporary_.descriptor, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail(file_, written < 0 ? errno : ENOSPC);
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void take_place() {
    // Some file systems report a full disk only here.
    if (close(std::exchange(temporary_.descriptor, -1)) != 0) fail(file_, errno);
    if (rename(temporary_.path.c_str(), file_.c_str()) != 0) fail(file_, errno);
    placed_ = true;
  }

 private:
  fs::path file_;
  TemporaryFile temporary_;
  bool placed_ = false;
};

class Sink : public std::streambuf {
 public:
  explicit Sink(Replacement& to) : to_(to), buffer_(1 << 16) { setp(buffer_.data(), buffer_.data() + buffer_.size()); }

 private:
  std::streamsize xsputn(const char* bytes, std::streamsize size) override {
    if (size < epptr() - pptr()) return std::streambuf::xsputn(bytes, size);
    sync();
    to_.put({bytes, static_cast<std::size_t>(size)});
    return size;
  }
  int_type overflow(int_type c) override {
    sync();
    return traits_type::eq_int_type(c, traits_type::eof()) ? traits_type::not_eof(c)
                                                           : sputc(traits_type::to_char_type(c));
  }
  int sync() override {
    to_.put({pbase(), static_cast<std::size_t>(pptr() - pbase())});
    setp(buffer_.data(), buffer_.data() + buffer_.size());
    return 0;
  }

  Replacement& to_;
  std::vector<char> buffer_;
};

}  // namespace

void require_writable(const fs::path& folder) {
  std::error_code error;
  fs::path there = fs::absolute(folder);
  while (!fs::exists(there, error) && there.has_relative_path()) there = there.parent_path();
  if (!fs::is_directory(there, error)) fail(folder, ENOTDIR);
  const TemporaryFile temporary = create_beside(there / "probe");
  close(temporary.descriptor);
  unlink(temporary.path.c_str());
}

void write_atomically(const fs::path& file, std::string_view bytes) {
  Replacement replacement(file);
  replacement.put(bytes);
  replacement.take_place();
}

void write_atomically(const fs::path& file, const std::function<void(std::ostream&)>& write) {
  Replacement replacement(file);
  Sink sink(replacement);
  std::ostream out(&sink);
  // What put() throws shall not end as a bit of the stream's state.
  out.exceptions(std::ios::badbit);
  write(out);
  out.flush();
  replacement.take_place();
}

void remove_abandoned(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    // .<name>.<process>.<number>.tmp
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.') || entry.path().extension() != ".tmp") continue;
    const fs::path process = entry.path().stem().stem().extension();
    const long id = std::strtol(process.c_str() + (process.empty() ? 0 : 1), nullptr, 10);
    if (id > 0 && kill(static_cast<pid_t>(id), 0) != 0 && errno == ESRCH) fs::remove(entry.path(), error);
  }
}

void create_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(ErrorKind::io, "cannot create the folder " + folder.string() + ": " + error.message());
}

}  // namespace sunder::output
