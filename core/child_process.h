#pragma once
/// Foreign code in a process of its own, so that what crashes or runs away there takes nothing with it.
#include <functional>
#include <stdexcept>
#include <string>

namespace sunder {

/// The child came to no end of its own; the message says how ("crashed (Segmentation fault)").
class ChildFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How a process came to its end, by its status of waitpid: "crashed (Segmentation fault)", "ended with code 3".
std::string ending_of(int status);

/// What `work` returns, computed in a copy of this process that ends with it: nothing else that it changes is seen
/// here, what it prints is dropped. Where no process can be started, it is computed in this one.
/// `processor_seconds`: after so much work the child is stopped [s].
/// Errors: an Error of `work` is thrown here as it was, any other exception as ErrorKind::internal with its message;
/// ChildFailed when the child crashed, was stopped or ran out of its time; ErrorKind::interrupted after Ctrl-C.
std::string in_child_process(const std::function<std::string()>& work, double processor_seconds);

}  // namespace sunder
