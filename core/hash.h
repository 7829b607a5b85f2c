#pragma once
/// Short names for long texts.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

namespace sunder {

/// FNV-1a over everything it is given. Not for secrets.
class Hash {
 public:
  void add(std::string_view bytes) {
    for (const char c : bytes) value_ = (value_ ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  }
  void add(double number) { add({reinterpret_cast<const char*>(&number), sizeof number}); }

  /// What the file holds; nothing where there is none.
  void add_file(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    add(text.view());
  }

  std::uint64_t value() const { return value_; }
  /// Sixteen hexadecimal digits.
  std::string digits() const {
    std::string text(16, '0');
    for (std::size_t i = 0; i < 16; ++i) text[15 - i] = "0123456789abcdef"[value_ >> (4 * i) & 15];
    return text;
  }

 private:
  std::uint64_t value_ = 14695981039346656037ULL;
};

}  // namespace sunder
