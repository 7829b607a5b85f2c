/// Scenes: what a good one gives, and that every bad one names its line and the remedy.
#include "pipeline/scene.h"

#include <fstream>
#include <map>
#include <numbers>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "pipeline/detail/scene_keys.h"

namespace sunder::pipeline {
namespace {

namespace fs = std::filesystem;

// Scenes written by a test, with a catalogue of one small mesh.
struct BadScene {
  std::string text, expected;
};

class SceneTest : public testing::Test {
 protected:
  SceneTest() : folder_(fs::path(testing::TempDir()) / ("sunder_scene_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    write("tetrahedron.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
    write("meshes.toml",
          "[tetra]\nfile = \"tetrahedron.off\"\nup = \"z\"\n[lost]\nfile = \"not_there.off\"\nup = \"y\"\n");
    assets_ = default_assets();
    assets_.meshes = folder_ / "meshes.toml";
    assets_.mesh_cache = folder_;
  }
  ~SceneTest() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  Scene load(const std::string& text) const { return load_scene(write("scene.toml", text), assets_); }

  // The message of the usage error that the scene causes, from the file's name on.
  std::string complaint(const std::string& text) const {
    try {
      load(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      const std::string message = error.what();
      return message.substr(message.find("scene.toml"));
    }
    return "accepted";
  }
  void expect_complaints(const std::vector<BadScene>& scenes) const {
    for (const auto& [text, expected] : scenes) {
      const std::string message = complaint(text);
      EXPECT_NE(message.find(expected), std::string::npos) << text << "gave: " << message;
    }
  }

  fs::path folder_;
  AssetPaths assets_;
};

const std::string kBall = "[[body]]\nname = 'ball'\nmesh = 'sphere'\nheight = 0.1\nmaterial = 'glass'\n";

std::string ball_with(const std::string& line) { return kBall + line + "\n"; }  // the line is number 6

TEST_F(SceneTest, FillsInDefaults) {
  const Scene scene = load(kBall);
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.duration, 2);
  EXPECT_EQ(scene.frame_rate, 24);
  EXPECT_EQ(scene.gravity, Vec3(0, -9.81, 0));
  EXPECT_EQ(scene.quality, Quality::preview);
  EXPECT_FALSE(scene.ground);
  EXPECT_FALSE(scene.fracture.minimum_impulse);
  ASSERT_EQ(scene.bodies.size(), 1u);
  const SceneBody& body = scene.bodies[0];
  EXPECT_EQ(body.line, 1);
  EXPECT_TRUE(body.mesh.file.empty());
  EXPECT_EQ(body.mesh.height, 0.1);
  EXPECT_EQ(body.anchor, Anchor::base);
  EXPECT_EQ(body.material.density, 2500);
  EXPECT_TRUE(body.breakable);
}

TEST_F(SceneTest, OverridesWinOverTheFile) {
  const fs::path file =
      write("scene.toml", kBall + "velocity = [0, 1, 0]\n[scene]\nseed = 3\n[material.own]\nbase = \"glass\"\n");
  const Scene scene = load_scene(file, assets_,
                                 {{"body.ball.velocity", "[0, -5, 0]"},
                                  {"scene.seed", "7"},
                                  {"fracture.spline", "\"cubic\""},
                                  {"material.own.tensile_strength", "1e6"},
                                  {"body.ball.material", "\"own\""}});
  EXPECT_EQ(scene.bodies[0].velocity, Vec3(0, -5, 0));
  EXPECT_EQ(scene.seed, 7u);
  EXPECT_EQ(scene.fracture.spline, mpm::Spline::cubic);
  EXPECT_EQ(scene.bodies[0].material.tensile_strength, 1e6);
  EXPECT_EQ(scene.overrides.size(), 5u);
}

TEST_F(SceneTest, OverridesOfWhatIsNotThereAreRefused) {
  const fs::path file = write("scene.toml", kBall);
  const auto message = [&](const Override& change) -> std::string {
    try {
      load_scene(file, assets_, {change});
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return "accepted";
  };
  const std::vector<std::pair<Override, std::string>> bad = {
      {{"body.bal.velocity", "[0, 0, 0]"}, "did you mean 'ball'"},
      {{"body.ball.velocty", "[0, 0, 0]"}, "did you mean 'velocity'"},
      {{"body.ball.velocity", "7"}, "(with body.ball.velocity = 7)"},
      {{"body.ball.material", "glass"}, "texts need quotes"},
      {{"body.velocity", "[0, 0, 0]"}, "no key of a scene"},
      {{"seed", "1"}, "no key of a scene"},
      {{"material.own.density", "1"}, "has no material 'own'"},
      {{"secne.seed", "1"}, "did you mean 'scene'"}};
  for (const auto& [change, says] : bad)
    EXPECT_NE(message(change).find(says), std::string::npos) << change.key << ": " << message(change);
}

TEST_F(SceneTest, ReadsPathsOfDrivenBodies) {
  const Scene scene = load(kBall +
                           "motion = 'kinematic'\nminimum_impulse = 0.5\n"
                           "path = [{ time = 0, position = [0, 1, 0], rotation = [0, 90, 0] }, { time = 2, position = "
                           "[0, 0, 0] }]\n");
  const SceneBody& ball = scene.bodies[0];
  ASSERT_EQ(ball.path.size(), 2u);
  EXPECT_EQ(ball.position, Vec3(0, 1, 0));
  EXPECT_EQ(ball.minimum_impulse, 0.5);
  EXPECT_EQ(ball.path[1].time, 2);
  EXPECT_EQ(ball.path[1].pose.orientation.coeffs(), ball.path[0].pose.orientation.coeffs()) << "kept when not given";
}

TEST_F(SceneTest, RefusesPathsThatCannotBeFollowed) {
  const std::string driven = kBall + "motion = 'kinematic'\n", keyframe = "{ time = 0, position = [0, 1, 0] }";
  const std::string later = "{ time = 1, position = [0, 0, 0] }";
  EXPECT_EQ(
      complaint(driven + "path = [" + later + ", { time = 2, position = [0, 0, 0] }]"),
      "scene.toml:7: body 'ball': path: 1: the path has a gap before its first keyframe; where the body starts has "
      "time = 0");
  EXPECT_EQ(complaint(driven + "path = [" + keyframe + ", " + keyframe + "]"),
            "scene.toml:7: body 'ball': path: 2: its time has to be later than that of the keyframe before");
  EXPECT_EQ(complaint(driven + "path = [" + keyframe + "]"),
            "scene.toml:7: body 'ball': path: a path has at least two keyframes");
  EXPECT_EQ(complaint(driven + "path = [" + keyframe + ", { position = [0, 0, 0] }]"),
            "scene.toml:7: body 'ball': path: 2: missing key 'time'");
  EXPECT_EQ(complaint(driven + "velocity = [1, 0, 0]\npath = [" + keyframe + ", " + later + "]"),
            "scene.toml:7: body 'ball': give 'velocity' or 'path', not both");
  EXPECT_EQ(complaint(kBall + "path = [" + keyframe + ", " + later + "]"),
            "scene.toml:6: body 'ball': path: only a body with motion = \"kinematic\" follows a path");
  EXPECT_NE(complaint(driven + "path = 3").find("expected an array of tables"), std::string::npos);
}

TEST_F(SceneTest, RefusesThresholdsThatMakeNoSense) {
  EXPECT_EQ(complaint(kBall + "[fracture]\nminimum_impulse = -1\n"),
            "scene.toml:7: [fracture]: minimum_impulse: expected a number that is not negative, found -1");
  EXPECT_EQ(complaint(kBall + "minimum_impulse = -1\n"),
            "scene.toml:6: body 'ball': minimum_impulse: expected a number that is not negative, found -1");
  EXPECT_EQ(complaint(kBall + "[fracture]\ntiny_volume = 0.3\nsmall_volume = 0.2\n"),
            "scene.toml:8: [fracture]: small_volume: has to be at least tiny_volume");
  EXPECT_EQ(complaint(kBall + "[fracture]\ntiny_volume = 0.3\n"),
            "scene.toml:7: [fracture]: tiny_volume: has to be at most small_volume");
  EXPECT_EQ(complaint(kBall + "[fracture]\nmaximum_fragments = -1\n"),
            "scene.toml:7: [fracture]: maximum_fragments: expected an integer from 0 to 2147483647, found -1");
}

constexpr const char* kEverySection = R"(
[scene]
duration = 1
frame_rate = 30.0
start_frame = 1001
seed = 7
gravity = [0, -1.62, 0]
quality = "final"
[ground]
height = -0.5
material = "wood"
[material.sugar]
base = "glass"
tensile_strength = 1e6
[[body]]
name = "tetra-1"
mesh = "tetra"
height = 2
anchor = "centre"
position = [1, 2, 3]
rotation = [90, 0, 0]
velocity = [0, -5, 0]
angular_velocity = [0, 0, 1]
material = "sugar"
breakable = false
motion = "kinematic"
repair = "off"
[fracture]
minimum_impulse = 0.5
minimum_volume = 0.1
maximum_fractures = 2
refracture_delay = 0
damage = "local"
load = "prescribed"
spline = "cubic"
[effects]
fracture = true
secondary_fracture = false
flaws = "on"
scatter_length = 0.02
two_velocity_fields = "off"
surface_detail = "auto"
surface_look = "slate"
hairline_width = 0.001
smallest_detail = 0.1
debris = "on"
debris_size = 0.003
[output]
obj = false
glb = false
page = false
poster = false
)";

TEST_F(SceneTest, ReadsEverySection) {
  const Scene scene = load(kEverySection);
  EXPECT_EQ(scene.duration, 1);
  EXPECT_EQ(scene.frame_rate, 30);
  EXPECT_EQ(scene.start_frame, 1001);
  EXPECT_EQ(scene.seed, 7u);
  EXPECT_EQ(scene.gravity.y(), -1.62);
  EXPECT_EQ(scene.quality, Quality::final);
  ASSERT_TRUE(scene.ground);
  EXPECT_EQ(scene.ground->height, -0.5);
  EXPECT_EQ(scene.ground->material.name, "wood");
  const SceneBody& body = scene.bodies.at(0);
  EXPECT_EQ(body.mesh.file, folder_ / "tetrahedron.off");
  EXPECT_EQ(body.mesh.load.up, geometry::UpAxis::z);
  EXPECT_EQ(body.mesh.repair, RepairMode::off);
  EXPECT_EQ(body.anchor, Anchor::centre);
  EXPECT_EQ(body.position, Vec3(1, 2, 3));
  EXPECT_EQ(body.velocity, Vec3(0, -5, 0));
  EXPECT_EQ(body.angular_velocity, Vec3(0, 0, 1));
  EXPECT_EQ(body.motion, rigid::Motion::kinematic);
  EXPECT_FALSE(body.breakable);
  EXPECT_EQ(body.material.name, "sugar");
  EXPECT_EQ(body.material.tensile_strength, 1e6);
  EXPECT_EQ(body.material.density, 2500);
  EXPECT_EQ(scene.fracture.minimum_impulse, 0.5);
  EXPECT_EQ(scene.fracture.minimum_volume, 0.1);
  EXPECT_EQ(scene.fracture.maximum_fractures, 2);
  EXPECT_EQ(scene.fracture.refracture_delay, 0);
  EXPECT_EQ(scene.fracture.damage, DamageModel::local);
  EXPECT_EQ(scene.fracture.load, LoadModel::prescribed);
  EXPECT_EQ(scene.fracture.spline, mpm::Spline::cubic);
  const EffectSettings& effects = scene.effects;
  EXPECT_EQ(effects.asked.values, (std::array{Ask::on, Ask::off, Ask::on, Ask::off, Ask::automatic, Ask::automatic,
                                              Ask::on, Ask::automatic}));
  EXPECT_EQ(effects.scatter_length, 0.02);
  EXPECT_EQ(effects.surface_look, "slate");
  EXPECT_EQ(effects.hairline_width, 0.001);
  EXPECT_EQ(effects.smallest_detail, 0.1);
  EXPECT_EQ(effects.debris_size, 0.003);
  EXPECT_FALSE(scene.outputs.obj);
  EXPECT_FALSE(scene.outputs.glb);
}

TEST_F(SceneTest, TurnsAboutXThenYThenZ) {
  constexpr double kRounding = 1e-15;  // a few ulp of products of sines
  const Quat q = load(ball_with("rotation = [90, 90, 0]")).bodies[0].orientation;
  // Y goes to Z about X, and on to X about Y.
  EXPECT_LT((q * Vec3::UnitY() - Vec3::UnitX()).norm(), kRounding);
  const Quat r = load(ball_with("rotation = [0, 90, 90]")).bodies[0].orientation;
  // Z goes to X about Y, and on to Y about Z.
  EXPECT_LT((r * Vec3::UnitZ() - Vec3::UnitY()).norm(), kRounding);
}

TEST_F(SceneTest, FindsMeshFilesBesideTheScene) {
  const Scene scene = load("[[body]]\nname='a'\nmesh='./tetrahedron.off'\nunit='mm'\nup='x'\nmaterial='ice'\n");
  EXPECT_EQ(scene.bodies[0].mesh.load.metres_per_unit, 0.001);
  EXPECT_EQ(scene.bodies[0].mesh.load.up, geometry::UpAxis::x);
  EXPECT_TRUE(fs::equivalent(scene.bodies[0].mesh.file, folder_ / "tetrahedron.off"));
}

struct Mistake {
  std::string line, expected;  // a line added to the ball, and what the complaint about it must contain
};

TEST_F(SceneTest, NamesLineAndRemedyOfMistakesInABody) {
  const std::vector<Mistake> mistakes = {
      {"velocty = [0, 0, 0]", "unknown key 'velocty'; did you mean 'velocity'?"},
      {"xyzzy = 1", "unknown key 'xyzzy'; expected one of: name, mesh"},
      {"velocity = 3", "velocity: expected three numbers [x, y, z], found an integer"},
      {"velocity = [1, 2]", "found an array of 2"},
      {"velocity = [1, 'a', 2]", "found a string"},
      {"position = [0, nan, 0]", "finite"},
      {"position = [0, inf, 0]", "finite"},
      {"size = [1, 1, 1]", "not both"},
      {"wall = 0.01", "no wall"},
      {"unit = 'cm'", "only a mesh file has a unit"},
      {"up = 'z'", "is known"},
      {"anchor = 'center'", "unknown word 'center'; did you mean 'centre'?"},
      {"motion = 'static'", "unknown word 'static'"},
      {"breakable = 'no'", "expected true or false, found a string"},
      {"repair = 'on'", "unknown word 'on'"},
  };
  for (const auto& [line, expected] : mistakes) {
    const std::string message = complaint(ball_with(line));
    EXPECT_NE(message.find(expected), std::string::npos) << line << " gave: " << message;
    const bool about_height = expected == "not both";  // the complaint stands at `height`, line 4
    EXPECT_EQ(message.rfind(about_height ? "scene.toml:4: " : "scene.toml:6: ", 0), 0u) << message;
    EXPECT_NE(message.find("body 'ball'"), std::string::npos) << message;
  }
}

TEST_F(SceneTest, NamesLineAndRemedyOfMistakesInSceneAndBodies) {
  const std::vector<BadScene> scenes = {
      {"", "scene.toml:1: the scene has no body"},
      {"[scene]\nduration = 0\n" + kBall, "scene.toml:2: [scene]: duration: expected a number above 0, found 0"},
      {"[scene]\nduration = -1.5\n" + kBall, "above 0, found -1.5"},
      {"[scene]\nduration = 'long'\n" + kBall, "expected a number, found a string"},
      {"[scene]\nduration = 1e9\n" + kBall, "scene.toml:1: [scene]: duration times frame_rate"},
      {"[scene]\nframe_rate = 0\n" + kBall, "scene.toml:2"},
      {"[scene]\nseed = -1\n" + kBall, "expected an integer from 0"},
      {"[scene]\nseed = 1.5\n" + kBall, "expected an integer, found a number"},
      {"[scene]\nstart_frame = 3000000000\n" + kBall, "expected an integer from 0 to"},
      {"[scene]\nquality = 100\n" + kBall, "500"},
      {"[scene]\nquality = 'finl'\n" + kBall, "did you mean 'final'?"},
      {"scene = 3\n" + kBall, "scene.toml:1: expected a section [scene]"},
      {"[scnee]\n" + kBall, "scene.toml:1: scene: unknown key 'scnee'; did you mean 'scene'?"},
      {"[body]\nname = 'a'\n", "scene.toml:1: a body is a section [[body]]"},
      {"body = []\n", "scene.toml:1: a body is a section [[body]]"},
      {kBall + kBall, "scene.toml:6: body name 'ball' is taken: line 1"},
      {"[[body]]\nmesh = 'sphere'\nheight = 1\nmaterial = 'glass'\n", "scene.toml:1: [[body]]: missing key 'name'"},
      {"[[body]]\nname = 'a'\nheight = 1\nmaterial = 'glass'\n", "scene.toml:1: body 'a': missing key 'mesh'"},
      {"[[body]]\nname = 'a'\nmesh = 'sphere'\nheight = 1\n", "scene.toml:1: body 'a': missing key 'material'"},
      {"[[body]]\nname = 'a b'\nmesh = 'sphere'\nheight = 1\nmaterial = 'glass'\n", "scene.toml:2: the name 'a b' may"},
      {"[[body]]\nname = 'a'\nmesh = 'sphere'\nmaterial = 'glass'\n", "scene.toml:3: body 'a': mesh 'sphere' needs a"},
      {"[[body]]\nname = 'a'\nmesh = 'sphere'\nheight = 1\nmaterial = 'glas'\n",
       "scene.toml:5: body 'a': material: unknown material 'glas'; did you mean 'glass'?"},
      {"[[body]]\nname = 'a'\nmesh = 'spere'\nheight = 1\nmaterial = 'glass'\n",
       "scene.toml:3: body 'a': mesh: unknown mesh 'spere'; did you mean 'sphere'?"},
      {"[[body]]\nname = 'a'\nmesh = 'box'\nsize = [1, 0, 1]\nmaterial = 'glass'\n",
       "scene.toml:4: body 'a': size: expected three numbers above 0"},
      {"[[body]]\nname = 'a'\nmesh = 'box'\nheight = 1\nmaterial = 'glass'\n",
       "scene.toml:4: body 'a': height: mesh 'box' takes 'size'"},
      {"[[body]]\nname = 'a'\nmesh = 'cup'\nsize = [1, 1, 1]\nmaterial = 'glass'\n",
       "scene.toml:4: body 'a': size: mesh 'cup' takes 'height'"},
      {"[[body]]\nname = 'a'\nmesh = 'cup'\nheight = 0.1\nwall = 0.09\nmaterial = 'glass'\n",
       "scene.toml:5: body 'a': "},
      {"[[body]]\nname = 'a'\nmesh = 'torus'\nsize = [1, 0.7, 1]\nmaterial = 'glass'\n", "scene.toml:3: body 'a': "},
      {"[[body]]\nname = 'a'\nmesh = 'tetra'\nmaterial = 'glass'\n",
       "scene.toml:3: body 'a': mesh 'tetra' needs a 'height'"},
      {"[[body]]\nname = 'a'\nmesh = 'lost'\nheight = 1\nmaterial = 'glass'\n",
       "scene.toml:3: body 'a': mesh: the file of mesh 'lost' is missing"},
      {"[[body]]\nname = 'a'\nmesh = 'no/such.obj'\nmaterial = 'glass'\n",
       "scene.toml:3: body 'a': mesh: there is no mesh file"},
      {"[[body]]\nname = 'a'\nmesh = 'sphere'\nheight = 1\nmaterial = 'steel'\nbreakable = true\n",
       "scene.toml:6: body 'a': breakable: material 'steel' does not break"},
      {"[[body]]\nname = 'a'\nmesh = 'sphere'\nheight = 1\nmaterial = 'steel'\nmotion = 'fixed'\nvelocity = [1, 0, "
       "0]\n",
       "scene.toml:6: body 'a': motion: a fixed body"},
  };
  expect_complaints(scenes);
}

TEST_F(SceneTest, NamesLineAndRemedyOfMistakesInOtherSections) {
  const std::vector<BadScene> scenes = {
      {"[ground]\nmaterial = 'lava'\n" + kBall, "scene.toml:2: [ground]: material: unknown material 'lava'"},
      {"[fracture]\nminimum_volume = 2\n" + kBall,
       "scene.toml:2: [fracture]: minimum_volume: expected a number from 0 to 1"},
      {"[fracture]\nmaximum_fractures = -1\n" + kBall, "scene.toml:2"},
      {"[effects]\nflaws = 'of'\n" + kBall, "scene.toml:2: [effects]: flaws: unknown word 'of'; did you mean 'off'?"},
      {"[effects]\nhairlines = 0.001\n" + kBall,
       "scene.toml:2: [effects]: hairlines: expected \"off\", \"on\" or \"auto\", found a number"},
      {"[effects]\ndebrs = 'on'\n" + kBall, "scene.toml:2: [effects]: unknown key 'debrs'; did you mean 'debris'?"},
      {"[effects]\nsurface_look = 'rok'\n" + kBall,
       "scene.toml:2: [effects]: surface_look: unknown word 'rok'; did you mean 'rock'?"},
      {"[effects]\nhairline_width = 0\n" + kBall, "scene.toml:2: [effects]: hairline_width: expected a number above 0"},
      {"[effects]\ndebris = 'on'\n" + kBall, "scene.toml:2: [effects]: debris: missing key 'debris_size'"},
      {"[effects]\ndebris = false\ndebris_size = 0.01\n" + kBall,
       "scene.toml:3: [effects]: debris_size: a parameter of debris, switched off"},
      {"[effects]\nhairlines = 'off'\nsurface_detail = 'off'\nsmallest_detail = 0.1\n" + kBall,
       "scene.toml:4: [effects]: smallest_detail: a parameter of surface_detail and hairlines, switched off"},
      {"[material.x]\nbase = 'glass'\nsurface_look = 'glas'\n" + kBall, "did you mean 'glass'?"},
      {"[material.x]\nbase = 'glass'\ndensity = -2\n" + kBall,
       "scene.toml:3: material 'x': density: expected a number above 0, found -2"},
      {"[material.x]\nbase = 'glass'\npoisson_ratio = 0.5\n" + kBall,
       "scene.toml:3: material 'x': poisson_ratio: expected a number above -1 and below 0.5"},
      {"[material.x]\nbase = 'glass'\npoisson_ratio = -1\n" + kBall, "scene.toml:3"},
      {"[material.x]\nbase = 'glas'\n" + kBall, "did you mean 'glass'?"},
      {"[material.x]\ndensity = 1000\n" + kBall, "scene.toml:1: material 'x': missing key 'youngs_modulus'"},
      {"[material.x]\nbase = 'steel'\nbreakable = true\n" + kBall,
       "scene.toml:1: material 'x': missing key 'tensile_strength'"},
      {"[material]\ndensity = 1000\n" + kBall, "scene.toml:2: a material has a name"},
      {"[scene]\nduration = = 2\n", "scene.toml:2: not valid TOML"},
      {"[scene]\nduration = 1\nduration = 2\n" + kBall, "scene.toml:3: not valid TOML"},
  };
  expect_complaints(scenes);
}

TEST_F(SceneTest, MissingFileIsAUsageError) {
  try {
    load_scene(folder_ / "nowhere.toml", assets_);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find("nowhere.toml"), std::string::npos);
  }
}

// The sections of docs/scene.md with the keys in the first column of their tables.
std::map<std::string, std::set<std::string>> documented_keys() {
  std::ifstream in(SUNDER_SOURCE_DIR "/docs/scene.md");
  std::map<std::string, std::set<std::string>> keys;
  std::string section, heading;
  const std::regex row(R"(^\| `([a-z_]+)` \|.*)");
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("##", 0) == 0) section = line.substr(line.find(' ') + 1);
    std::smatch match;
    if (section.rfind("[", 0) == 0 && std::regex_match(line, match, row)) keys[section].insert(match[1]);
  }
  return keys;
}

TEST(SceneDocumentation, ListsExactlyTheKeysThatAreRead) {
  std::map<std::string, std::set<std::string>> known;
  for (const detail::SectionKeys& section : detail::scene_keys())
    known[section.section] = {section.keys.begin(), section.keys.end()};
  EXPECT_EQ(documented_keys(), known);
}

TEST(SceneDocumentation, ItsExampleLoads) {
  std::ifstream in(SUNDER_SOURCE_DIR "/docs/scene.md");
  std::stringstream text;
  text << in.rdbuf();
  const std::string page = text.str(), open = "```toml\n";
  const std::size_t begin = page.find(open) + open.size();
  const fs::path file = fs::path(testing::TempDir()) / ("sunder_example_" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << page.substr(begin, page.find("```", begin) - begin);
  EXPECT_EQ(load_scene(file).bodies.size(), 1u);
  fs::remove(file);
}

TEST(ShippedScenes, AllLoad) {
  if (!fs::is_directory(default_assets().mesh_cache)) GTEST_SKIP() << "the demo meshes are not unpacked";
  int count = 0;
  for (const auto& entry : fs::directory_iterator(SUNDER_SOURCE_DIR "/assets/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_NO_THROW(load_scene(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 6);
}

}  // namespace
}  // namespace sunder::pipeline
