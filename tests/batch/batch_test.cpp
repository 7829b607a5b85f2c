/// Plans that are worked through: what is there afterwards, and what is after whatever can happen in between.
#include "batch/batch.h"

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "batch/detail/database.h"
#include "tests/batch/program.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;
using detail::Database;
using nlohmann::json;

class Batch : public testing::Test {
 protected:
  Batch() { geometry::save_mesh(geometry::box(Vec3(0.04, 0.04, 0.04)), folder_ / "block.obj"); }

  std::string write(const std::string& text, const std::string& name = "plan.toml") const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  fs::path out(const std::string& name = "out") const { return folder_ / name; }
  std::string command(const std::string& plan, const std::string& more = "", const std::string& to = "out") const {
    return program() + " batch " + plan + " --progress off --out " + out(to).string() + " " + more;
  }
  Ended run(const std::string& plan, const std::string& more = "", const std::string& to = "out") const {
    return ended(command(plan, more, to));
  }
  std::int64_t ask(const std::string& sql, const std::string& to = "out") const {
    Database database(out(to) / "manifest.sqlite", Database::Use::read);
    detail::Statement answer = database.prepare(sql);
    return answer.next() ? answer.integer(0) : -1;
  }

  const output::ScratchFolder folder_;
};

const std::string shatters = "[job]\nmesh = \"block.obj\"\ncells = [3, 4, 5]\nseed = { from = 1, to = 2 }\n";

TEST_F(Batch, LeavesAResultForEveryJobAndAManifest) {
  const Ended end = run(write(shatters));
  EXPECT_EQ(end.code, 0) << end.said;
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE outcome = 'broken'"), 6);
  EXPECT_EQ(ask("SELECT sum(fragments) FROM job"), 2 * (3 + 4 + 5));
  EXPECT_EQ(ask("SELECT count(*) FROM piece"), 24);
  EXPECT_EQ(ask("SELECT count(*) FROM piece WHERE closed"), 24);
  EXPECT_EQ(ask("SELECT jobs FROM by_cells WHERE cells = 4"), 2);
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE seconds > 0 AND host IS NOT NULL"), 6);
  std::ifstream lines(out() / "manifest.jsonl");
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const json job = json::parse(line);
    EXPECT_EQ(job.at("job"), count);
    const fs::path folder = out() / job.at("folder").get<std::string>();
    for (const json& file : job.at("files")) {
      const fs::path path = folder / file.at("name").get<std::string>();
      EXPECT_EQ(fs::file_size(path), file.at("bytes").get<std::uintmax_t>());
      EXPECT_EQ(ended("sha256sum " + path.string()).said.substr(0, 64), file.at("sha256"));
    }
    EXPECT_TRUE(fs::exists(folder / "pieces.npz") && fs::exists(folder / "still.png") &&
                fs::exists(folder / "log.txt"));
    EXPECT_TRUE(fs::exists(out() / job.at("original").get<std::string>()));
  }
  EXPECT_EQ(count, 6);
}

TEST_F(Batch, AgainDoesNothingAndMoreDoesWhatIsNew) {
  ASSERT_EQ(run(write(shatters)).code, 0);
  std::map<std::string, fs::file_time_type> times;
  for (const auto& entry : fs::recursive_directory_iterator(out() / "jobs"))
    if (entry.is_regular_file()) times[entry.path()] = entry.last_write_time();
  EXPECT_EQ(run(write("[job]\nmesh = \"block.obj\"\ncells = [2, 3, 4, 5]\nseed = [1, 2]\n")).code, 0);
  for (const auto& [file, time] : times) EXPECT_EQ(fs::last_write_time(file), time) << file;
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE outcome = 'broken'"), 8);
}

TEST_F(Batch, ABrokenMeshNeverStopsTheRest) {
  std::ofstream(folder_ / "broken.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const std::string plan = write("[job]\nmesh = [\"broken.obj\", \"none.obj\", \"block.obj\"]\ncells = [3, 4]\n");
  const Ended end = run(plan);
  EXPECT_EQ(end.code, 7) << end.said;
  EXPECT_NE(end.said.find("4 failed"), std::string::npos) << end.said;
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE outcome = 'broken'"), 2);
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE outcome = 'failed' AND error_code = 3 AND error LIKE '%broken.obj%'"),
            2);
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE error_code = 5 AND error LIKE '%none.obj: no such file%'"), 2);
  EXPECT_EQ(ask("SELECT max(jobs) FROM failures"), 2);
  // Failures are kept, and tried again only on request.
  const auto first = lasting_files(out());
  EXPECT_EQ(run(plan).code, 7);
  EXPECT_EQ(lasting_files(out()), first);
  geometry::save_mesh(geometry::box(Vec3(0.04, 0.05, 0.04)), folder_ / "none.obj");
  EXPECT_EQ(run(plan, "--retry").code, 7) << "the broken one is still there";
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE outcome = 'broken'"), 4);
}

TEST_F(Batch, WorkersAndThreadsDoNotChangeABit) {
  const std::string plan = write(
      "[plan]\nkeep = [\"dataset\", \"obj\", \"glb\", \"cracks\"]\npoints = 100\n[job]\nmesh = \"block.obj\"\nimpact = "
      "\"random\"\nseverity = [50, 500]\nquality = 1000\nseed = [1, 2]\n");
  ASSERT_EQ(run(plan, "--workers 1", "one").code, 0);
  ASSERT_EQ(run(plan, "--workers 3 --threads 2", "three").code, 0);
  const auto one = lasting_files(out("one"));
  EXPECT_GE(one.size(), 4u * 4);
  EXPECT_TRUE(one == lasting_files(out("three")));
  EXPECT_GT(ask("SELECT sum(fragments) FROM job", "one"), 0) << "something broke";
}

TEST_F(Batch, AJobThatTakesTooLongFails) {
  const std::string plan = write(
      "[plan]\njob_time_limit = 0.3\n[job]\nmesh = \"block.obj\"\nimpact = \"random\"\nseverity = 50\nquality = [500, "
      "200000]\n");
  const Ended end = run(plan);
  EXPECT_EQ(end.code, 7) << end.said;
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE outcome = 'failed' AND error LIKE '%job_time_limit%'"), 1);
}

/// A job of some seconds, to be disturbed.
const std::string long_job =
    "[job]\nmesh = \"block.obj\"\nimpact = \"random\"\nseverity = 50\nquality = 40000\nseed = [1, 2, 3]\n";

pid_t started(const std::string& command) {
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", ("exec " + command + " >/dev/null 2>&1").c_str(), nullptr);
    _exit(127);
  }
  return child;
}

int waited(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Until a condition holds; a minute at most.
template <typename Condition>
bool comes_true(const Condition& condition) {
  for (int i = 0; i < 6000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

TEST_F(Batch, ASecondBatchInTheFolderIsRefused) {
  const pid_t first = started(command(write(long_job)));
  ASSERT_TRUE(comes_true([&] { return fs::exists(out() / "working"); }));
  const Ended second = run(write(shatters));
  EXPECT_EQ(second.code, 2);
  EXPECT_NE(second.said.find("another batch works in this folder"), std::string::npos) << second.said;
  kill(first, SIGKILL);
  waited(first);
}

TEST_F(Batch, CtrlCEndsCleanlyAndTheSameCommandGoesOn) {
  const std::string plan = write(shatters);
  ASSERT_EQ(run(plan, "", "whole").code, 0);
  const pid_t child = started(command(write(long_job, "long.toml"), "--workers 2"));
  ASSERT_TRUE(comes_true([&] { return fs::exists(out() / "working") && !fs::is_empty(out() / "working"); }));
  kill(child, SIGINT);
  EXPECT_EQ(waited(child), 130);
  EXPECT_TRUE(fs::is_empty(out() / "working")) << "nothing half done is left";
  EXPECT_FALSE(fs::exists(out() / "jobs"));
  EXPECT_EQ(run(plan).code, 0);
  EXPECT_TRUE(lasting_files(out()) == lasting_files(out("whole")));
}

/// The processes that work for another one.
std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> children;
  std::ifstream in("/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) + "/children");
  for (pid_t child; in >> child;) children.push_back(child);
  return children;
}

TEST_F(Batch, AWorkerThatIsKilledFailsItsJobAlone) {
  const pid_t child = started(command(write(long_job), "--workers 1"));
  ASSERT_TRUE(comes_true([&] { return fs::exists(out() / "working") && !fs::is_empty(out() / "working"); }));
  const std::vector<pid_t> workers = children_of(child);
  ASSERT_EQ(workers.size(), 1u);
  kill(workers.front(), SIGSEGV);
  EXPECT_EQ(waited(child), 7);
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE outcome = 'failed' AND error LIKE '%Segmentation fault%'"), 1);
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE outcome IN ('broken', 'whole')"), 2);
}

TEST_F(Batch, AVeryLargePlanAsksFirst) {
  const std::string plan =
      write("[plan]\nsamples = 1000000000\n[job]\nmesh = \"block.obj\"\nimpact = \"random\"\nseverity = 50\n");
  const Ended end = run(plan);
  EXPECT_EQ(end.code, 2);
  EXPECT_NE(end.said.find("1000000000 jobs"), std::string::npos) << end.said;
  EXPECT_NE(end.said.find("--yes"), std::string::npos) << end.said;
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(Batch, ADryRunListsAndPredictsAndWritesNothing) {
  const Ended end = run(write(shatters), "--dry-run");
  EXPECT_EQ(end.code, 0) << end.said;
  for (const char* part : {"cells=3", "seed=2", "6 jobs, 0 of them done", "of processor time", "MB", "on disk"})
    EXPECT_NE(end.said.find(part), std::string::npos) << part << ": " << end.said;
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(Batch, ResultsOfAnotherBuildAreNotMixedUp) {
  const std::string plan = write(shatters);
  ASSERT_EQ(run(plan).code, 0);
  std::ofstream(out() / "batch.json") << json{{"build", "0.0.9 (abc)"}};
  const Ended end = run(plan);
  EXPECT_EQ(end.code, 2);
  EXPECT_NE(end.said.find("0.0.9 (abc)"), std::string::npos) << end.said;
}

TEST_F(Batch, ScenesAreRun) {
  std::ofstream(folder_ / "drop.toml")
      << "[scene]\nduration = 0.05\n[ground]\n[[body]]\nname = \"block\"\nmaterial = \"glass\"\nmesh = \"box\"\n"
         "size = [0.1, 0.1, 0.1]\nrotation = [30, 20, 10]\nposition = [0, 0.05, 0]\n";
  const std::string plan = write(
      "[plan]\nmode = \"run\"\nkeep = [\"sequence\", \"still\"]\n[job]\nscene = \"drop.toml\"\nquality = 1000\n"
      "\"body.block.velocity\" = [[0, -0.01, 0], [0, -30, 0]]\n");
  const Ended end = run(plan);
  EXPECT_EQ(end.code, 0) << end.said;
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE outcome = 'whole' AND \"body.block.velocity\" = '[0,-0.01,0]'"), 1);
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE fragments > 1 AND \"body.block.velocity\" = '[0,-30,0]'"), 1);
  EXPECT_GT(ask("SELECT count(*) FROM file WHERE name LIKE 'run/%.obj'"), 0);
  EXPECT_EQ(ask("SELECT count(*) FROM file WHERE name = 'still.png'"), 2);
}

TEST_F(Batch, SlowAFullDiskStopsItAndARoomierOneFinishesIt) {
  const fs::path disk = folder_ / "disk";
  fs::create_directory(disk);
  const auto on_disk = [&](const std::string& command) {
    return ended("unshare --user --map-root-user --mount sh -c 'mount -t tmpfs -o size=200k none " + disk.string() +
                 " && " + command + "'");
  };
  if (on_disk("true").code != 0) GTEST_SKIP() << "no file systems of its own here";
  const std::string plan =
      write("[plan]\nkeep = [\"dataset\"]\n[job]\nmesh = \"block.obj\"\ncells = { from = 100, to = 130 }\n");
  const std::string start = command(plan, "", "disk/out");
  const Ended end =
      on_disk("{ " + start + "; echo code $?; ls " + (disk / "out/working").string() +
              " | wc -l; mount -o remount,size=60M none " + disk.string() + "; " + start + "; echo code $?; }");
  EXPECT_NE(end.said.find("No space left on device; what is done is kept"), std::string::npos) << end.said;
  EXPECT_NE(end.said.find("code 5\n0\n"), std::string::npos) << end.said;
  EXPECT_NE(end.said.find("31 broken"), std::string::npos) << end.said;
  EXPECT_NE(end.said.find("code 0\n"), std::string::npos) << end.said;
}

/// All of the 200 jobs are killed with the program again and again, until they are done.
TEST_F(Batch, SlowKilledAtRandomMomentsItComesToTheSame) {
  const std::string plan = write(
      "[plan]\nsamples = 100\nkeep = [\"dataset\"]\n[job]\nmesh = \"block.obj\"\ncells = { integer = [2, 40] }\nheight "
      "= "
      "[0.1, 0.2]\n");
  ASSERT_EQ(run(plan, "", "whole").code, 0);
  std::mt19937 random(7);
  int kills = 0, code = -1;
  while (code != 0) {
    const pid_t child = started(command(plan, "--workers 2"));
    std::this_thread::sleep_for(std::chrono::milliseconds(40 + random() % 250));
    // Every other time a worker as well, which the program would take for a crash if it lived on.
    if (kills % 2 == 1)
      for (const pid_t worker : children_of(child)) kill(worker, SIGSTOP), kill(child, SIGKILL), kill(worker, SIGKILL);
    kill(child, SIGKILL);
    code = waited(child);
    ++kills;
    ASSERT_LT(kills, 1000);
  }
  EXPECT_GT(kills, 3) << "it was disturbed";
  EXPECT_EQ(ask("SELECT count(*) FROM job WHERE outcome = 'broken'"), 200);
  EXPECT_TRUE(lasting_files(out()) == lasting_files(out("whole")));
  EXPECT_TRUE(fs::is_empty(out() / "working"));
}

}  // namespace
}  // namespace sunder::batch
