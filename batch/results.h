#pragma once
/// Where the results of jobs lie: a folder for each, there when its job is finished and not before.
#include <filesystem>
#include <string>

namespace sunder::batch {

/// `out`/jobs/<first two digits of the id>/<id>. Any number of processes, on any number of machines that share the
/// folder, may use it at once: what counts is one rename.
class Results {
 public:
  explicit Results(std::filesystem::path out) : out_(std::move(out)) {}

  std::filesystem::path folder(const std::string& id) const;
  bool has(const std::string& id) const;

  /// An empty folder in which a process works at a job until it calls `commit`. Errors: ErrorKind::io.
  std::filesystem::path begin(const std::string& id) const;

  /// Makes what is in the working folder the result; where another process was faster, its result stays. Errors:
  /// ErrorKind::io.
  void commit(const std::string& id, const std::filesystem::path& work) const;

  /// Takes a result away, so that the job can be done again. Errors: ErrorKind::io.
  void remove(const std::string& id) const;

  /// Removes working folders of processes of this machine that do not live any more.
  void remove_abandoned() const;

 private:
  std::filesystem::path working_folders() const { return out_ / "working"; }

  std::filesystem::path out_;
};

}  // namespace sunder::batch
