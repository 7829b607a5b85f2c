#pragma once
/// Runs the catalogue of validation problems, or the hard cases, for a user.
#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"

namespace sunder::pipeline {

struct ValidateOptions {
  bool hard = false;                   ///< the hard cases (pipeline/hard_cases.h) instead of the catalogue
  std::vector<std::string> only = {};  ///< ids; none: all
  std::vector<int> resolutions = {};   ///< of the studies, instead of their own; needs `only`
  std::filesystem::path json = {};     ///< file for the results; empty: none
  std::filesystem::path svg = {};      ///< the overview of error against time; empty: none
  std::filesystem::path html = {};     ///< the same as a page with charts; empty: none
};

/// Prints a table on standard output, a problem at a time, and writes the files at the end. True when every check
/// and every order of convergence holds. Errors: ErrorKind::usage for an unknown id or resolutions that cannot be,
/// ErrorKind::interrupted between problems (those that are done have been written), ErrorKind::io.
bool validate(const ValidateOptions& options, Progress& progress);

}  // namespace sunder::pipeline
