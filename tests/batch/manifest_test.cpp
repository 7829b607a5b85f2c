/// Collecting results, however many.
#include "batch/manifest.h"

#include <gtest/gtest.h>

#include "batch/detail/database.h"
#include "core/error.h"
#include "tests/batch/fabricated.h"
#include "tests/output/scratch_folder.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;
using detail::Database;

Plan plan_of(const output::ScratchFolder& folder, int jobs) {
  std::ofstream(folder / "block.obj") << "v 0 0 0\n";
  std::ofstream(folder / "plan.toml") << "[plan]\nsamples = " << jobs
                                      << "\n[job]\nmesh = \"block.obj\"\ncells = { integer = [2, 99] }\n";
  return load_plan(folder / "plan.toml");
}

TEST(Manifest, SlowManyResultsTakeTheMemoryOfOne) {
  const output::ScratchFolder folder;
  constexpr int kFew = 1000, kMany = 20000;
  const Plan few = plan_of(folder, kFew), many = plan_of(folder, kMany);
  fabricate(many, folder / "many");
  const Collecting of_few = measured_collecting(few, folder / "many"),
                   of_many = measured_collecting(many, folder / "many");
  // Buffers of SQLite (2 MB) and of files may fill; what grew with each of the results would be seen.
  EXPECT_LT(of_many.memory_mb, of_few.memory_mb + 10);
  Database database(folder / "many/manifest.sqlite", Database::Use::read);
  detail::Statement count = database.prepare("SELECT count(*), sum(fragments), (SELECT count(*) FROM piece) FROM job");
  ASSERT_TRUE(count.next());
  EXPECT_EQ(count.integer(0), kMany);
  EXPECT_EQ(count.integer(1), 8 * kMany);
  EXPECT_EQ(count.integer(2), 8 * kMany);
}

TEST(Manifest, HoldsWhatIsThereAndNamesWhatIsMissing) {
  const output::ScratchFolder folder;
  const Plan plan = plan_of(folder, 20);
  fabricate(plan, folder / "out");
  fs::remove_all(Results(folder / "out").folder(plan.job(3).id));
  // A result that a disk has spoilt is as good as none.
  std::ofstream(Results(folder / "out").folder(plan.job(5).id) / "result.json") << "{\"outcome\": \"bro";
  SilentProgress progress;
  const Tally tally = collect(plan, folder / "out", progress);
  EXPECT_EQ(tally.broken, 18u);
  EXPECT_EQ(tally.missing, 2u);
  Database database(folder / "out/manifest.sqlite", Database::Use::read);
  detail::Statement missing =
      database.prepare("SELECT number, cells FROM job WHERE outcome = 'missing' ORDER BY number");
  ASSERT_TRUE(missing.next());
  EXPECT_EQ(missing.integer(0), 3);
  EXPECT_GE(missing.integer(1), 2) << "its parameters are known";
}

TEST(Manifest, AFolderThatCannotBeWrittenIsAnError) {
  const output::ScratchFolder folder;
  SilentProgress progress;
  EXPECT_THROW(collect(plan_of(folder, 2), folder / "none", progress), Error);
}

}  // namespace
}  // namespace sunder::batch
