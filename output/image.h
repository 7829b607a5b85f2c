#pragma once
/// Pictures as plain values.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace sunder::output {

/// Rows from the top, left to right; red, green, blue as sRGB.
struct Image {
  int width = 0, height = 0;
  std::vector<std::array<std::uint8_t, 3>> pixels;

  bool operator==(const Image&) const = default;
};

/// The bytes of a PNG file, 8 bits per channel. The image must have pixels, and as many as its size says.
std::string to_png(const Image& image);

}  // namespace sunder::output
