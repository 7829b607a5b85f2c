#pragma once
/// Runs the catalogue of validation problems for a user.
#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"

namespace sunder::pipeline {

struct ValidateOptions {
  std::vector<std::string> only;  ///< ids; none: all
  std::filesystem::path json;     ///< file for the results; empty: none
};

/// Prints a table on standard output, a problem at a time, and writes the JSON file at the end. True when every check
/// holds. Errors: ErrorKind::usage for an unknown id, ErrorKind::interrupted between problems (those that are done have
/// been written), ErrorKind::io.
bool validate(const ValidateOptions& options, Progress& progress);

}  // namespace sunder::pipeline
