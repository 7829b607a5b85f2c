#include "batch/results.h"

#include <charconv>
#include <fstream>

#include <unistd.h>

#include "core/error.h"
#include "core/resources.h"
#include "output/atomic_file.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::error_code& error) {
  throw Error(ErrorKind::io, path.string() + ": " + error.message());
}

/// One that was killed and that nobody has asked about yet does not.
bool lives(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(in, text);
  const std::size_t state = text.rfind(')') + 2;  // after the name, which may hold anything
  return in && state < text.size() && text[state] != 'Z' && text[state] != 'X';
}

/// "host.pid.id": the process, when it is of this host.
pid_t process_of(const std::string& name) {
  const std::string host = host_name() + ".";
  pid_t process = 0;
  if (name.starts_with(host)) std::from_chars(name.data() + host.size(), name.data() + name.size(), process);
  return process;
}

}  // namespace

fs::path Results::folder(const std::string& id) const { return out_ / "jobs" / id.substr(0, 2) / id; }

// A machine that lost its power may leave names without content.
bool Results::has(const std::string& id) const {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(folder(id) / "result.json", error);
  return !error && size > 0;
}

fs::path Results::begin(const std::string& id) const {
  const fs::path work = working_folders() / (host_name() + "." + std::to_string(getpid()) + "." + id);
  std::error_code error;
  fs::remove_all(work, error);
  output::create_folder(work);
  return work;
}

void Results::commit(const std::string& id, const fs::path& work) const {
  const fs::path target = folder(id);
  output::create_folder(target.parent_path());
  std::error_code error;
  if (!has(id)) remove(id);
  fs::rename(work, target, error);
  if (!error) return;
  std::error_code ignored;
  fs::remove_all(work, ignored);
  if (!has(id)) fail(target, error);
}

void Results::remove(const std::string& id) const {
  std::error_code error;
  const fs::path doomed = working_folders() / (host_name() + "." + std::to_string(getpid()) + ".removed." + id);
  output::create_folder(working_folders());
  fs::rename(folder(id), doomed, error);  // at once: a half-removed result would be taken for a whole one
  if (!error) fs::remove_all(doomed, error);
  if (error && error != std::errc::no_such_file_or_directory) fail(folder(id), error);
}

void Results::remove_abandoned() const {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(working_folders(), ignored)) {
    const pid_t process = process_of(entry.path().filename().string());
    if (process > 0 && !lives(process)) fs::remove_all(entry.path(), ignored);
  }
}

}  // namespace sunder::batch
