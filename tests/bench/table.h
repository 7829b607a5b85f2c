#pragma once
/// What a benchmark prints: one line per number, and the same numbers by key as JSON.
#include <cstdio>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "core/error.h"

namespace sunder::bench {

class Table {
 public:
  void add(const std::string& key, double value, const std::string& what) {
    std::printf("%-38s %12.5g   %s\n", key.c_str(), value, what.c_str());
    std::fflush(stdout);
    json_[key] = value;
  }
  /// Errors: ErrorKind::io.
  void save(const char* file) const {
    std::ofstream out(file);
    if (!(out << json_.dump(2) << "\n")) throw Error(ErrorKind::io, std::string("cannot write ") + file);
  }

 private:
  nlohmann::ordered_json json_;
};

}  // namespace sunder::bench
