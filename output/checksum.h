#pragma once
/// Whether a file is still what was written.
#include <filesystem>
#include <string>

namespace sunder::output {

/// SHA-256 as 64 hexadecimal digits, as `sha256sum` prints it. Errors: ErrorKind::io.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace sunder::output
