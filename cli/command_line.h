#pragma once
/// The program's commands; main() only calls this.
namespace sunder::cli {

/// Runs the command and returns the exit code: 0 done, else the ErrorKind (2 for a wrong command line). Never throws.
int command_line(int argc, char** argv);

}  // namespace sunder::cli
