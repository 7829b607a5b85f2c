#pragma once
/// Numbers 64-bit keys in the order in which they first appear (open addressing, no erasure).
#include <cassert>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/types.h"

namespace sunder::crack::detail {

class IndexTable {
 public:
  explicit IndexTable(std::size_t expected = 0) { rehash(2 * expected + 16); }

  int size() const { return size_; }

  /// The number of a key, -1 if it has none.
  int find(std::uint64_t key) const {
    for (std::size_t i = slot(key);; i = (i + 1) & mask_) {
      if (slots_[i].number < 0) return -1;
      if (slots_[i].key == key) return slots_[i].number;
    }
  }

  /// The number of a key; the next free one is given to a new key.
  int insert(std::uint64_t key) {
    std::size_t i = slot(key);
    for (; slots_[i].number >= 0; i = (i + 1) & mask_)
      if (slots_[i].key == key) return slots_[i].number;
    slots_[i] = {key, size_};
    if (2 * static_cast<std::size_t>(++size_) > slots_.size()) rehash(2 * slots_.size());
    return size_ - 1;
  }

 private:
  struct Slot {
    std::uint64_t key = 0;
    int number = -1;
  };

  /// Two multiplications: all bits of the key have to reach the low bits, or neighbouring cells share slots.
  std::size_t slot(std::uint64_t key) const {
    const std::uint64_t spread = key * 0x9E3779B97F4A7C15ULL;
    return ((spread ^ spread >> 32) * 0xD6E8FEB86659FD93ULL >> 32) & mask_;
  }

  void rehash(std::size_t wanted) {
    std::size_t n = 16;
    while (n < wanted) n *= 2;
    const std::vector<Slot> old = std::exchange(slots_, std::vector<Slot>(n));
    mask_ = n - 1;
    for (const Slot& s : old) {
      if (s.number < 0) continue;
      std::size_t i = slot(s.key);
      while (slots_[i].number >= 0) i = (i + 1) & mask_;
      slots_[i] = s;
    }
  }

  std::vector<Slot> slots_;
  std::size_t mask_ = 0;
  int size_ = 0;
};

using GridCell = Eigen::Vector3i;

constexpr int largest_cell = (1 << 20) - 2;  ///< cell coordinates must lie within plus and minus this

/// A cell of a grid as a key.
inline std::uint64_t cell_key(const GridCell& cell) {
  assert(cell.cwiseAbs().maxCoeff() <= largest_cell + 1);
  const auto part = [&](int axis) { return static_cast<std::uint64_t>(cell[axis] + (1 << 20)); };
  return part(0) << 42 | part(1) << 21 | part(2);
}

inline GridCell cell_of(const Vec3& x, double width) { return (x / width).array().floor().cast<int>(); }

/// An undirected edge as a key.
inline std::uint64_t edge_key(int a, int b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint64_t>(std::max(a, b));
}

}  // namespace sunder::crack::detail
