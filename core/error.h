#pragma once
/// The one exception that a user sees. Its kind is the exit code of the program (docs/running.md lists them).
#include <stdexcept>
#include <string>

namespace sunder {

enum class ErrorKind {
  internal = 1,       ///< a defect of Sunder
  usage = 2,          ///< wrong command line or scene
  mesh = 3,           ///< a mesh that cannot be used
  unstable = 4,       ///< the simulation could not be kept stable
  io = 5,             ///< a file could not be read or written
  jobs_failed = 7,    ///< some jobs of a batch failed, or are missing
  interrupted = 130,  ///< Ctrl-C
};

/// The message says what is wrong, where (file, line, body) and what to do about it.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind error_kind, const std::string& message) : std::runtime_error(message), kind_(error_kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace sunder
