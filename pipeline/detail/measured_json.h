#pragma once
/// What every file of measurements says of where and how it was measured.
#include <string>

#include <nlohmann/json.hpp>

namespace sunder::pipeline::detail {

/// JSON has no word for what is not a number: null.
nlohmann::ordered_json number_json(double x);

/// `processor`, `threads`, `memory_gb`, `version`, `git`.
nlohmann::ordered_json machine_json();
/// "Intel(R) Xeon(R), 2 threads, 24 GB; version 0.1.0 (1dfab99)".
std::string machine_sentence();

/// A page in one file around `body`, readable without network and on light and dark ground.
std::string measured_page(const std::string& title, const std::string& body);

}  // namespace sunder::pipeline::detail
