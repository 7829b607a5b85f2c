/// What NumPy reads from our arrays.
#include "output/npz.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "output/atomic_file.h"

namespace sunder::output {
namespace {

namespace fs = std::filesystem;

Npz example() {
  Npz npz;
  npz.add("vertices", {2, 3}, std::vector<float>{0, 1, 2, 3, 4, 5.5f});
  npz.add("volumes", {2}, std::vector<double>{0.1, 1e-300});
  npz.add("faces", {1, 3}, std::vector<std::int32_t>{0, -1, 2'000'000'000});
  npz.add("inside", {4}, std::vector<std::uint8_t>{0, 1, 255, 7});
  npz.add("none", {0, 3}, std::vector<float>{});
  return npz;
}

std::string said_by(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  std::string said;
  std::array<char, 256> piece;
  while (std::size_t count = std::fread(piece.data(), 1, piece.size(), pipe)) said.append(piece.data(), count);
  pclose(pipe);
  return said;
}

TEST(Npz, IsWhatNumPyReads) {
  const fs::path file = fs::path(testing::TempDir()) / ("sunder_" + std::to_string(getpid()) + ".npz");
  write_atomically(file, example().bytes());
  const std::string said =
      said_by("/usr/bin/python3 -c \"import numpy; a = numpy.load('" + file.string() +
              "'); print([(k, a[k].dtype.str, a[k].shape, a[k].ravel().tolist()) for k in a.files])\" 2>&1");
  fs::remove(file);
  EXPECT_EQ(said,
            "[('vertices', '<f4', (2, 3), [0.0, 1.0, 2.0, 3.0, 4.0, 5.5]), ('volumes', '<f8', (2,), [0.1, 1e-300]), "
            "('faces', '<i4', (1, 3), [0, -1, 2000000000]), ('inside', '|u1', (4,), [0, 1, 255, 7]), "
            "('none', '<f4', (0, 3), [])]\n");
}

TEST(Npz, IsTheSameBytesAgain) {
  const std::string first = example().bytes();
  EXPECT_EQ(first, example().bytes());
  EXPECT_EQ(first.substr(0, 2), "PK");
}

TEST(Npz, CompressesWhatRepeats) {
  Npz npz;
  npz.add("zeros", {100'000}, std::vector<double>(100'000));
  EXPECT_LT(npz.bytes().size(), 10'000u);
}

}  // namespace
}  // namespace sunder::output
