/// Every writer on a disk that is too small: an error that names the file, and nothing half written.
#include <functional>
#include <map>

#include <gtest/gtest.h>

#include "core/error.h"
#include "output/writers.h"
#include "tests/output/example_sequence.h"
#include "tests/output/file_size_limit.h"
#include "tests/output/scratch_folder.h"

namespace sunder::output {
namespace {

namespace fs = std::filesystem;

std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) files[entry.path().filename()] = read_all(entry.path());
  return files;
}

using Write = std::function<void(const Sequence&, const fs::path& folder)>;

/// A run that grows: first three frames, then a fourth for which there is no room, then room.
void expect_nothing_half_written(const std::string& file, const Write& write) {
  SCOPED_TRACE(file);
  const ScratchFolder folder;
  Sequence sequence = attributed_sequence();
  const std::vector<Frame> frames = sequence.frames;
  const auto write_frames = [&](std::size_t count) {
    sequence.frames.assign(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(count));
    write(sequence, folder.path());
  };
  for (const std::size_t count : {1u, 2u, 3u}) write_frames(count);
  const auto before = contents(folder.path());
  try {
    const FileSizeLimit limit(300);
    write_frames(4);
    FAIL() << "written";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_EQ(std::string(error.what()), "cannot write " + (folder / file).string() + ": File too large");
  }
  EXPECT_EQ(contents(folder.path()), before);
  write_frames(4);
  EXPECT_NE(contents(folder.path()), before);
}

TEST(FailedWrite, LeavesEarlierFramesAndNothingElse) {
  ObjFrames obj;
  expect_nothing_half_written("example.0011.obj", [&](const Sequence& sequence, const fs::path& folder) {
    obj.write(sequence, sequence.frames.size() - 1, folder);
  });
  expect_nothing_half_written("example.0011.ply", [](const Sequence& sequence, const fs::path& folder) {
    write_ply_frame(sequence, sequence.frames.size() - 1, folder);
  });
}

TEST(FailedWrite, LeavesTheFileOfTheWholeRunAsItWas) {
  using WriteFile = void (*)(const Sequence&, const fs::path& file);
  const std::map<std::string, WriteFile> writers = {{"fragments.glb", write_glb},
                                                    {"fragments.usda", write_usda},
                                                    {"transforms.csv", write_transforms_csv},
                                                    {"transforms.jsonl", write_transforms_jsonl}};
  for (const auto& [file, write] : writers)
    expect_nothing_half_written(
        file, [&, &name = file, &write_file = write](const Sequence& sequence, const fs::path& folder) {
          write_file(sequence, folder / name);
        });
}

}  // namespace
}  // namespace sunder::output
