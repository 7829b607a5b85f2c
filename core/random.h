#pragma once
/// Random numbers by name: a pure function of (seed, stream, index), so results depend neither on order nor on threads.
#include <cstdint>

namespace sunder {

/// SplitMix64 finaliser (Steele, Lea, Flood 2014): a bijection of 64-bit words with full avalanche.
constexpr std::uint64_t mix(std::uint64_t z) {
  z += 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

/// Word number `index` of stream `stream` under `seed`.
constexpr std::uint64_t random_word(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return mix(mix(mix(seed) ^ stream) ^ index);
}

/// Uniform in [0, 1) with 53 random bits.
constexpr double random_unit(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return static_cast<double>(random_word(seed, stream, index) >> 11) * 0x1.0p-53;
}

}  // namespace sunder
