#pragma once
/// Text with many numbers.
#include <array>
#include <charconv>
#include <string>
#include <string_view>

namespace sunder::output::detail {

/// Of numbers in double precision. Nine significant digits are what a reader with single precision needs to get every
/// bit of it.
enum class Digits { nine, all };

/// Grows at its end; numbers go straight into it. Single precision always has all its digits.
class TextBuffer {
 public:
  explicit TextBuffer(std::size_t capacity = 0, Digits digits = Digits::nine) : digits_(digits) {
    text_.reserve(capacity);
  }

  TextBuffer& operator<<(std::string_view text) {
    text_.append(text);
    return *this;
  }
  TextBuffer& operator<<(int value) { return append(value); }
  TextBuffer& operator<<(long value) { return append(value); }
  TextBuffer& operator<<(float value) { return append(value); }
  TextBuffer& operator<<(double value) {
    return digits_ == Digits::all ? append(value) : append(value, std::chars_format::general, 9);
  }

  void clear() { text_.clear(); }  // keeps its memory
  const std::string& text() const { return text_; }
  std::string take() { return std::move(text_); }

 private:
  template <class... Arguments>
  TextBuffer& append(Arguments... arguments) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), arguments...).ptr;
    text_.append(digits.data(), static_cast<std::size_t>(end - digits.data()));
    return *this;
  }

  Digits digits_;
  std::string text_;
};

}  // namespace sunder::output::detail
