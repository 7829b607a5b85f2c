/// docs/accuracy.md and docs/stability.md are what the committed measurements give.
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

TEST(MeasuredDocs, AreWhatTheMeasurementsGive) {
  const std::string command = "python3 " SUNDER_SOURCE_DIR "/tools/measured_docs.py --check";
  EXPECT_EQ(std::system(command.c_str()), 0) << "run tools/measured_docs.py";
}
