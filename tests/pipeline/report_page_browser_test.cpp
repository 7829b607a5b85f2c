/// The report page in Debian's Chromium: tests/node/report_page.test.mjs, on a run of 27 shards.
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "tests/output/scratch_folder.h"
#include "tests/pipeline/burst.h"

namespace sunder::pipeline {
namespace {

TEST(ReportPageSlow, WorksInABrowser) {
  const output::ScratchFolder folder;
  write_burst({}, folder.path());
  const std::string log = (folder / "browser.log").string();
  const std::string command = "cd " SUNDER_NODE_TESTS " && SUNDER_PAGE=" + folder.path().string() +
                              " node --test --test-reporter=spec report_page.test.mjs >" + log + " 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << output::read_all(log);
  for (const char* width : {"390", "1280", "3840"})
    for (const char* scheme : {"light", "dark"}) {
      const auto picture = folder / ("page_" + std::string(width) + "_" + scheme + ".png");
      EXPECT_TRUE(std::filesystem::exists(picture)) << picture;
    }
}

}  // namespace
}  // namespace sunder::pipeline
