/// Files are replaced whole or not at all.
#include "output/atomic_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/output/file_size_limit.h"
#include "tests/output/scratch_folder.h"

namespace sunder::output {
namespace {

std::string complaint(const std::filesystem::path& file, std::string_view bytes) {
  try {
    write_atomically(file, bytes);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    return error.what();
  }
  return "written";
}

TEST(AtomicFile, WritesEveryByteAndNothingElse) {
  const ScratchFolder folder;
  const std::string bytes("a\0b\r\n\xff", 6);
  write_atomically(folder / "file", bytes);
  EXPECT_EQ(read_all(folder / "file"), bytes);
  write_atomically(folder / "file", "");
  EXPECT_EQ(read_all(folder / "file"), "");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, FullDiskLeavesTheOldFile) {
  const ScratchFolder folder;
  write_atomically(folder / "file", "old");
  const std::string large(100'000, 'x');
  std::string message;
  {
    const FileSizeLimit limit(50'000);
    message = complaint(folder / "file", large);
  }
  EXPECT_NE(message.find((folder / "file").string()), std::string::npos) << message;
  EXPECT_NE(message.find("File too large"), std::string::npos) << message;
  EXPECT_EQ(read_all(folder / "file"), "old");
  EXPECT_EQ(folder.file_count(), 1u) << "the temporary file is still there";
}

TEST(AtomicFile, WhatIsStreamedIsWritten) {
  const ScratchFolder folder;
  std::string bytes;
  for (int i = 0; i < 60'000; ++i) bytes.append(std::to_string(i)).append(1, '\0');
  write_atomically(folder / "file", [&](std::ostream& out) {
    for (std::size_t at = 0, size = 1; at < bytes.size(); at += size, size = (7 * size + 1) % 5000 + 1)
      out << std::string_view(bytes).substr(at, size);
  });
  EXPECT_EQ(read_all(folder / "file"), bytes);
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, AStreamThatFailsLeavesTheOldFile) {
  const ScratchFolder folder;
  write_atomically(folder / "file", "old");
  EXPECT_THROW(write_atomically(folder / "file",
                                [](std::ostream& out) {
                                  out << "new";
                                  throw std::runtime_error("no more");
                                }),
               std::runtime_error);
  std::string message;
  {
    const FileSizeLimit limit(50'000);
    try {
      write_atomically(folder / "file", [](std::ostream& out) { out << std::string(200'000, 'x'); });
    } catch (const Error& error) {
      message = error.what();
    }
  }
  EXPECT_NE(message.find("File too large"), std::string::npos) << message;
  EXPECT_EQ(read_all(folder / "file"), "old");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, MissingFolderIsNamed) {
  const ScratchFolder folder;
  const std::string message = complaint(folder / "nowhere" / "file", "text");
  EXPECT_NE(message.find("nowhere/file: No such file or directory"), std::string::npos) << message;
}

TEST(AtomicFile, ATargetThatIsAFolderIsRefused) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "file");
  EXPECT_NE(complaint(folder / "file", "text"), "written");
  EXPECT_EQ(folder.file_count(), 1u);
}

}  // namespace
}  // namespace sunder::output
