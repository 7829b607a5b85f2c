#pragma once
/// Arrays for NumPy.
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

namespace sunder::output {

/// Named arrays in one compressed file, as numpy.savez_compressed writes and numpy.load reads it. The same arrays give
/// the same bytes.
class Npz {
 public:
  /// `values` row by row; their number is the product of `shape` (asserted). Names are those of members of the loaded
  /// object, each used once.
  void add(const std::string& name, std::initializer_list<std::size_t> shape, std::span<const float> values);
  void add(const std::string& name, std::initializer_list<std::size_t> shape, std::span<const double> values);
  void add(const std::string& name, std::initializer_list<std::size_t> shape, std::span<const std::int32_t> values);
  void add(const std::string& name, std::initializer_list<std::size_t> shape, std::span<const std::uint8_t> values);

  /// The file. Errors: ErrorKind::internal when there is not the memory to compress.
  std::string bytes() const;

 private:
  struct Member {
    std::string name, data;
  };
  std::vector<Member> members_;
};

}  // namespace sunder::output
