/// Arrays of tasks, and a batch on a real cluster of one machine.
#include "batch/slurm.h"

#include <chrono>
#include <csignal>
#include <numeric>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "batch/plan.h"
#include "core/resources.h"
#include "tests/batch/program.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;

Plan plan_of(const fs::path& folder, const std::string& text) {
  geometry::save_mesh(geometry::box(Vec3(0.04, 0.04, 0.04)), folder / "block.obj");
  std::ofstream(folder / "plan.toml") << text;
  return load_plan(folder / "plan.toml");
}

std::vector<std::uint64_t> first_numbers(std::size_t count) {
  std::vector<std::uint64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::uint64_t{0});
  return numbers;
}

class Submissions : public testing::Test {
 protected:
  std::vector<Submission> of(const std::vector<std::uint64_t>& pending, std::uint64_t largest_index,
                             const JobForecast& forecast = {.seconds = 60, .memory_mb = 1000, .bytes = 0, .tried = 1},
                             int at_once = 0) const {
    return submissions(plan_, folder_ / "it's out", pending, forecast, {10, 2, at_once}, largest_index);
  }

  const output::ScratchFolder folder_;
  const Plan plan_ =
      plan_of(folder_.path(), "[job]\nmesh = \"block.obj\"\ncells = 5\nseed = { from = 1, to = 1000 }\n");
};

TEST_F(Submissions, TasksLastAsLongAsAskedWithRoomInTimeAndMemory) {
  const std::vector<Submission> arrays = of(first_numbers(1000), 1000);
  ASSERT_EQ(arrays.size(), 1u);
  EXPECT_EQ(arrays[0].array, "0-99") << "10 jobs of a minute each";
  EXPECT_EQ(arrays[0].tasks, 100u);
  for (const char* line :
       {"#SBATCH --time=21\n", "#SBATCH --mem=1500M\n", "#SBATCH --cpus-per-task=2\n", "#SBATCH --requeue\n",
        "first=$((0 + SLURM_ARRAY_TASK_ID * 10))\n", "--jobs \"$first-$((first + 9))\"", "it'\\''s out'"})
    EXPECT_NE(arrays[0].script.find(line), std::string::npos) << line << arrays[0].script;
}

TEST_F(Submissions, ArraysAreNoLargerThanTheSiteTakes) {
  const std::vector<Submission> arrays = of(first_numbers(1000), 29);
  ASSERT_EQ(arrays.size(), 4u);
  EXPECT_EQ(arrays[1].array, "0-29");
  EXPECT_EQ(arrays[3].array, "0-9");
  EXPECT_NE(arrays[3].script.find("first=$((900 + "), std::string::npos) << arrays[3].script;
}

TEST_F(Submissions, NameOnlyTasksWithSomethingToDo) {
  const std::vector<Submission> arrays = of({0, 9, 35, 40, 41, 52, 999}, 1000, {60, 1000, 0, 1}, 7);
  ASSERT_EQ(arrays.size(), 1u);
  EXPECT_EQ(arrays[0].array, "0,3-5,99%7");
  EXPECT_EQ(arrays[0].tasks, 5u);
}

TEST_F(Submissions, LongListsOfTasksAreSplit) {
  std::vector<std::uint64_t> every_other;
  for (std::uint64_t i = 0; i < 100'000; i += 20) every_other.push_back(i);
  std::uint64_t tasks = 0;
  for (const Submission& array : of(every_other, 1'000'000)) {
    EXPECT_LE(array.array.size(), 4100u);
    tasks += array.tasks;
  }
  EXPECT_EQ(tasks, every_other.size());
}

/// munge, slurmctld and slurmd of the test's own, on the loopback address. A node has to be this machine by its name.
class Cluster {
 public:
  explicit Cluster(const fs::path& folder) : folder_(folder) {
    for (const char* name : {"state", "spool", "run"}) fs::create_directories(folder_ / name);
    std::ofstream(folder_ / "slurm.conf") << configuration();
    setenv("SLURM_CONF", (folder_ / "slurm.conf").c_str(), 1);
    const std::string munge =
        "head -c 1024 /dev/urandom >key && chmod 400 key && munged --force --key-file=" + at("key") +
        " --socket=" + at("run/munge.socket") + " --pid-file=" + at("run/munge.pid") +
        " --log-file=" + at("munge.log") + " --seed-file=" + at("munge.seed");
    started_ = ended("cd " + folder_.string() + " && " + munge + " && slurmctld");
    start_node();
  }
  ~Cluster() {
    for (const char* name : {"slurmd", "slurmctld", "munge"})
      ended("kill -9 $(cat " + at("run/" + std::string(name) + ".pid") + ")");
    unsetenv("SLURM_CONF");
  }
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  bool runs() const {
    for (int i = 0; i < 300; ++i) {
      if (ended("sinfo --noheader --format=%T").said.find("idle") != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }
  std::string why() const {
    return started_.said + output::read_all(folder_ / "slurmctld.log") + output::read_all(folder_ / "slurmd.log");
  }

  void start_node() const { ended("slurmd"); }
  /// The node and all that works on it stop at once.
  void kill_node() const {
    ended("pkill -9 slurmstepd; kill -9 $(cat " + at("run/slurmd.pid") + "); pkill -9 -f '" +
          folder_.parent_path().string() + ".*[-]-jobs'");
  }

  /// Tasks of a node that fell wait for two minutes before they are started again.
  void hurry() const {
    for (int i = 0;
         i < 600 && ended("squeue --noheader --states=PENDING --format=%r").said.find("BeginTime") == std::string::npos;
         ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ended(
        "for task in $(squeue --noheader --array --states=PENDING --format=%i); do scontrol update JobId=$task "
        "StartTime=now; done");
  }

  /// Until no task is left; a few minutes at most.
  bool finishes() const {
    for (int i = 0; i < 1800; ++i) {
      const Ended queue = ended("squeue --noheader --array");
      if (queue.code == 0 && queue.said.empty()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }

 private:
  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  std::string configuration() const {
    const std::string host = host_name().substr(0, host_name().find('.'));
    // Ports by process, for tests side by side.
    const int port = 20000 + getpid() % 20000;
    return "ClusterName=test\nSlurmctldHost=" + host + "(127.0.0.1)\nSlurmctldPort=" + std::to_string(port) +
           "\nSlurmdPort=" + std::to_string(port + 1) +
           "\nSlurmUser=root\nAuthType=auth/munge\nAuthInfo=socket=" + at("run/munge.socket") +
           "\nCredType=cred/munge\nStateSaveLocation=" + at("state") + "\nSlurmdSpoolDir=" + at("spool") +
           "\nSlurmctldPidFile=" + at("run/slurmctld.pid") + "\nSlurmdPidFile=" + at("run/slurmd.pid") +
           "\nSlurmctldLogFile=" + at("slurmctld.log") + "\nSlurmdLogFile=" + at("slurmd.log") +
           "\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nMpiDefault=none\nSelectType=select/cons_tres\n"
           "SelectTypeParameters=CR_CPU_Memory\nReturnToService=2\nSlurmdTimeout=10\nKillWait=2\nMinJobAge=300\n"
           "SchedulerParameters=sched_interval=1,bf_interval=1\nMaxArraySize=20\nNodeName=" +
           host + " NodeAddr=127.0.0.1 CPUs=2 RealMemory=2000 State=UNKNOWN\nPartitionName=all Nodes=" + host +
           " Default=YES MaxTime=INFINITE State=UP\n";
  }

  const fs::path folder_;
  Ended started_;
};

TEST(SlowSlurm, ABatchThroughTheFallOfANodeIsThatOfOneMachine) {
  if (geteuid() != 0) GTEST_SKIP() << "starting a cluster takes root";
  if (ended("command -v slurmctld slurmd munged").code != 0) GTEST_SKIP() << "there is no Slurm here";
  const output::ScratchFolder folder;
  plan_of(folder.path(),
          "[plan]\nsamples = 24\nkeep = [\"dataset\"]\n[job]\nmesh = \"block.obj\"\ncells = { integer = [2, 60] "
          "}\nheight = "
          "[0.1, 0.2]\n");
  const std::string start = program() + " batch " + (folder / "plan.toml").string() + " --progress off --out ";
  const std::string here = (folder / "here").string(), there = (folder / "there").string();
  ASSERT_EQ(ended(start + here).code, 0);

  const Cluster cluster(folder / "cluster");
  ASSERT_TRUE(cluster.runs()) << cluster.why();
  const std::string on_cluster = start + there + " --engine slurm --task-minutes 0.0001";
  const Ended submitted = ended(on_cluster);
  ASSERT_EQ(submitted.code, 0) << submitted.said;
  EXPECT_NE(submitted.said.find("of 3 arrays"), std::string::npos) << "48 tasks, 20 in an array: " << submitted.said;
  for (int i = 0; i < 600 && !fs::exists(folder / "there/jobs"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  cluster.kill_node();
  const Ended status = ended(start + there + " --engine slurm --status");
  EXPECT_NE(status.said.find("of 48 jobs have a result"), std::string::npos) << status.said;
  EXPECT_NE(status.said.find("tasks PENDING"), std::string::npos) << status.said;
  cluster.start_node();
  cluster.hurry();
  ASSERT_TRUE(cluster.finishes()) << cluster.why();
  // What the node took down with it is submitted again.
  const Ended again = ended(on_cluster);
  EXPECT_EQ(again.code, 0) << again.said;
  ASSERT_TRUE(cluster.finishes());
  const Ended collected = ended(start + there + " --engine slurm --collect");
  EXPECT_EQ(collected.code, 0) << collected.said;
  EXPECT_NE(collected.said.find("48 broken"), std::string::npos) << collected.said;
  EXPECT_TRUE(lasting_files(here) == lasting_files(there));
}

TEST(Slurm, WithoutItTheErrorSaysWhatToDo) {
  const output::ScratchFolder folder;
  plan_of(folder.path(), "[job]\nmesh = \"block.obj\"\ncells = 3\n");
  const std::string start = program() + " batch " + (folder / "plan.toml").string() +
                            " --progress off --engine slurm --out " + (folder / "out").string();
  const Ended end = ended("PATH=/nowhere " + start);
  EXPECT_EQ(end.code, 2);
  EXPECT_NE(end.said.find("--print-script"), std::string::npos) << end.said;
  const Ended script = ended("PATH=/nowhere " + start + " --print-script");
  EXPECT_EQ(script.code, 0) << script.said;
  EXPECT_NE(script.said.find("#SBATCH --time="), std::string::npos) << script.said;
}

}  // namespace
}  // namespace sunder::batch
