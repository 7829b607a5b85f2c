/// What a plan says, and what is said of plans that are wrong.
#include "batch/plan.h"

#include <algorithm>
#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "core/error.h"
#include "geometry/load.h"
#include "geometry/primitives.h"
#include "tests/output/scratch_folder.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;

class Plans : public testing::Test {
 protected:
  Plans() {
    for (const char* name : {"a.obj", "b.obj", "c.off"})
      geometry::save_mesh(geometry::box(Vec3::Ones()), folder_ / name);
  }

  fs::path write(const std::string& text) const {
    std::ofstream(folder_ / "plan.toml") << text;
    return folder_ / "plan.toml";
  }
  Plan load(const std::string& text) const { return load_plan(write(text)); }
  Plan load_job(const std::string& lines, const std::string& settings = "") const {
    return load("[plan]\n" + settings + "\n[job]\nmesh = \"a.obj\"\nimpact = \"random\"\nseverity = 5\n" + lines);
  }

  std::string error_of(const std::string& text) const {
    try {
      load(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return "no error";
  }

  const output::ScratchFolder folder_;
};

std::vector<std::string> values(const Plan& plan, const std::string& name) {
  std::vector<std::string> list;
  for (std::uint64_t i = 0; i < plan.size(); ++i) list.push_back(value_of(plan.job(i), name));
  return list;
}

TEST_F(Plans, GridsCountLikeDigitsWithTheSubjectSlowest) {
  const Plan plan = load(
      "[job]\nspeed = [5, 10]\nmesh = [\"a.obj\", \"b.obj\"]\nimpact = \"random\"\nseverity = 5\nmaterial = "
      "[\"glass\", \"porcelain\"]\n");
  EXPECT_EQ(plan.size(), 8u);
  using List = std::vector<std::string>;
  EXPECT_EQ(values(plan, "mesh"), (List{"\"a.obj\"", "\"a.obj\"", "\"a.obj\"", "\"a.obj\"", "\"b.obj\"", "\"b.obj\"",
                                        "\"b.obj\"", "\"b.obj\""}));
  EXPECT_EQ(values(plan, "speed"), (List{"5", "5", "10", "10", "5", "5", "10", "10"}));
  EXPECT_EQ(values(plan, "material"), (List{"\"glass\"", "\"porcelain\"", "\"glass\"", "\"porcelain\"", "\"glass\"",
                                            "\"porcelain\"", "\"glass\"", "\"porcelain\""}));
}

TEST_F(Plans, StepsAreNumbersOrWholeNumbers) {
  EXPECT_EQ(values(load_job("speed = { from = 1, to = 2, steps = 3 }\n"), "speed"),
            (std::vector<std::string>{"1", "1.5", "2"}));
  EXPECT_EQ(values(load_job("seed = { from = 3, to = 5 }\n"), "seed"), (std::vector<std::string>{"3", "4", "5"}));
  EXPECT_EQ(values(load_job("height = { from = 0.01, to = 1.0, steps = 3, log = true }\n"), "height"),
            (std::vector<std::string>{"0.01", "0.1", "1.0"}));
}

TEST_F(Plans, PatternsAreTheFilesThatMatchInOrder) {
  EXPECT_EQ(values(load("[job]\nmesh = [\"*.obj\", \"c.off\"]\ncells = 5\n"), "mesh"),
            (std::vector<std::string>{"\"a.obj\"", "\"b.obj\"", "\"c.off\""}));
  std::ofstream(folder_ / "list.txt") << "# meshes\nb.obj\n\nc.off\n";
  EXPECT_EQ(values(load("[job]\nmesh = { list = \"list.txt\" }\ncells = 5\n"), "mesh"),
            (std::vector<std::string>{"\"b.obj\"", "\"c.off\""}));
}

TEST_F(Plans, DrawnValuesLieInTheirRangesAndRepeat) {
  const std::string lines =
      "speed = { uniform = [5, 6] }\nheight = { log_uniform = [0.01, 1] }\ncut = { choice = [\"exact\", "
      "\"level_set\"] }\nquality = { integer = [1000, 1003] }\n";
  const Plan plan = load_job(lines, "samples = 200");
  EXPECT_EQ(plan.size(), 200u);
  std::set<std::string> cuts, qualities, seeds;
  int low_heights = 0;
  for (std::uint64_t i = 0; i < plan.size(); ++i) {
    const Job job = plan.job(i);
    const double speed = std::stod(value_of(job, "speed")), height = std::stod(value_of(job, "height"));
    EXPECT_TRUE(speed >= 5 && speed < 6) << speed;
    EXPECT_TRUE(height >= 0.01 && height < 1) << height;
    low_heights += height < 0.1;
    cuts.insert(value_of(job, "cut"));
    qualities.insert(value_of(job, "quality"));
    seeds.insert(value_of(job, "seed"));
  }
  EXPECT_NEAR(low_heights, 100, 30) << "half of the decades";  // four standard deviations
  EXPECT_EQ(cuts.size(), 2u);
  EXPECT_EQ(qualities, (std::set<std::string>{"1000", "1001", "1002", "1003"}));
  EXPECT_EQ(seeds.size(), 200u) << "every sample has a seed of its own";
  const Plan again = load_job(lines, "samples = 200"), other = load_job(lines, "samples = 200\nseed = 2");
  for (const std::uint64_t i : {0, 7, 199}) {
    EXPECT_EQ(plan.job(i).parameters, again.job(i).parameters);
    EXPECT_EQ(plan.job(i).id, again.job(i).id);
    EXPECT_NE(plan.job(i).parameters, other.job(i).parameters);
  }
}

TEST_F(Plans, ASampleIsTheSameForEveryCombination) {
  const Plan plan = load_job("material = [\"glass\", \"porcelain\"]\nspeed = { uniform = [1, 20] }\n", "samples = 5");
  for (std::uint64_t i = 0; i < 5; ++i)
    for (const char* name : {"speed", "seed"}) EXPECT_EQ(value_of(plan.job(i), name), value_of(plan.job(i + 5), name));
}

TEST_F(Plans, IdsAreOfParametersAndContents) {
  const std::string text = "[job]\nmesh = [\"a.obj\", \"b.obj\"]\ncells = [5, 6]\n";
  const Plan plan = load(text);
  std::set<std::string> ids;
  for (std::uint64_t i = 0; i < plan.size(); ++i) ids.insert(plan.job(i).id);
  EXPECT_EQ(ids.size(), 4u);
  for (const std::string& id : ids) EXPECT_EQ(id.size(), 16u);
  EXPECT_TRUE(ids.contains(load("[job]\nmesh = [\"b.obj\"]\ncells = [6]\n").job(0).id)) << "another plan, the same job";
  geometry::save_mesh(geometry::box(Vec3(1, 2, 3)), folder_ / "b.obj");
  const Plan changed = load(text);
  EXPECT_EQ(changed.job(0).id, plan.job(0).id);
  EXPECT_NE(changed.job(2).id, plan.job(2).id) << "the mesh has changed";
}

TEST_F(Plans, AMissingMeshIsNoErrorOfThePlan) {
  EXPECT_EQ(load("[job]\nmesh = [\"a.obj\", \"no.obj\"]\ncells = 5\n").size(), 2u);
}

TEST_F(Plans, TooManyJobsToCountAreMany) {
  const Plan plan = load_job("seed = { from = 1, to = 100000 }\nspeed = { from = 1, to = 100000 }\n",
                             "samples = 9000000000000000000");
  EXPECT_EQ(plan.size(), std::numeric_limits<std::uint64_t>::max());
}

struct BadPlan {
  std::string text, says;
};

TEST_F(Plans, MistakesAreNamedWithTheirLine) {
  const std::string job = "[job]\nmesh = \"a.obj\"\n", hit = "impact = \"random\"\nseverity = 5\n";
  const std::vector<BadPlan> plans = {
      {"", "no section [job]"},
      {"[job]\n", "missing key 'mesh'"},
      {"[jobs]\n", "did you mean 'job'"},
      {job, "where is it hit"},
      {job + "impact = \"random\"\n", "how hard"},
      {job + hit + "impulse = 3\n", "not both"},
      {job + hit + "speeed = 3\n", "plan.toml:5: [job]: unknown key 'speeed'; did you mean 'speed'"},
      {job + hit + "speed = [1, -3]\n", "plan.toml:5: [job]: speed: expected a number above 0"},
      {job + hit + "speed = [1, 1]\n", "given twice"},
      {job + hit + "speed = []\n", "empty list"},
      {job + hit + "speed = { from = 3 }\n", "missing key 'to'"},
      {job + hit + "speed = { from = 3, to = 1, steps = 2 }\n", "above 'from'"},
      {job + hit + "speed = { from = 1, to = 2.5 }\n", "missing key 'steps'"},
      {job + hit + "speed = { uniform = [1, 2] }\n", "needs samples"},
      {"[plan]\nsamples = 3\n" + job + hit + "speed = { uniform = [2, 1] }\n", "above the first"},
      {"[plan]\nsamples = 3\n" + job + hit + "speed = { unifrom = [1, 2] }\n", "did you mean 'uniform'"},
      {"[plan]\nsamples = 0\n" + job + hit, "from 1"},
      {"[plan]\nmode = \"fractur\"\n" + job + hit, "did you mean 'fracture'"},
      {"[plan]\nkeep = [\"everything\"]\n" + job + hit, "unknown word"},
      {"[plan]\nkeep = [\"sequence\"]\n" + job + hit, "mode = \"run\""},
      {"[plan]\nkeep = [\"still\"]\npoints = 5\n" + job + hit, "points"},
      {"[job]\nmesh = \"bunnny\"\n" + hit, "unknown mesh"},
      {"[job]\nmesh = \"*.stl\"\n" + hit, "no file matches"},
      {"[job]\nmesh = [\"a.obj\", \"?.obj\"]\n" + hit, "named twice"},
      {job + hit + "cells = 4\n", "leave out"},
      {"[plan]\nmode = \"run\"\n[job]\nscene = \"none.toml\"\n", "no scene file"},
  };
  for (const BadPlan& plan : plans) {
    const std::string message = error_of(plan.text);
    EXPECT_NE(message.find(plan.says), std::string::npos) << plan.text << message;
    EXPECT_NE(message.find("plan.toml:"), std::string::npos) << message;
  }
}

TEST_F(Plans, ScenesVaryByTheirKeys) {
  std::ofstream(folder_ / "drop.toml")
      << "[[body]]\nname = \"cup\"\nmaterial = \"glass\"\nmesh = \"sphere\"\nsize = [0.1, 0.1, 0.1]\n";
  const std::string head = "[plan]\nmode = \"run\"\n[job]\nscene = \"drop.toml\"\n";
  EXPECT_EQ(
      load(head + "quality = [\"draft\", \"preview\"]\n\"body.cup.velocity\" = [[0, -5, 0], [0, -9, 0]]\n").size(), 4u);
  EXPECT_NE(error_of(head + "\"body.cupp.velocity\" = [[0, -5, 0]]\n").find("did you mean 'cup'"), std::string::npos);
  EXPECT_NE(error_of(head + "\"body.cup.velocty\" = [[0, -5, 0]]\n").find("did you mean 'velocity'"),
            std::string::npos);
  EXPECT_NE(error_of(head + "qualty = \"draft\"\n").find("did you mean 'quality'"), std::string::npos);
}

}  // namespace
}  // namespace sunder::batch
