#include <cmath>
#include <sstream>

#include "core/random.h"
#include "pipeline/checkpoint.h"
#include "pipeline/detail/hard_cases.h"
#include "pipeline/simulation.h"

namespace sunder::pipeline::detail {
namespace {

using validation::absolute;
using validation::Outcome;
using validation::within;

std::string scene(const std::string& head, const std::string& bodies) {
  return "[scene]\nquality = \"draft\"\n" + head + "\n" + bodies;
}

std::string body(const std::string& name, const std::string& mesh, const Vec3& size, const Vec3& place,
                 const std::string& more) {
  std::ostringstream text;
  text << "[[body]]\nname = \"" << name << "\"\nmesh = \"" << mesh << "\"\nsize = [" << size[0] << ", " << size[1]
       << ", " << size[2] << "]\nanchor = \"centre\"\nposition = [" << place[0] << ", " << place[1] << ", " << place[2]
       << "]\n"
       << more << "\n";
  return text.str();
}

/// S10 and X2: heavy on light and light on heavy, each of a material that breaks and one that does not.
Outcome mass_ratios() {
  Outcome outcome;
  // Spheres of one material: the ratio of masses is the cube of that of sizes.
  for (const double size : {10.0, 100.0}) {
    std::ostringstream ratio;
    ratio << "mass ratio " << size * size * size;
    const double small = 0.02, large = size * small;
    sound_run(scene("duration = 0.5", body("heavy", "sphere", Vec3::Constant(large), Vec3(0, large, 0),
                                           "material = \"steel\"\nvelocity = [0, -4, 0]") +
                                          body("light", "sphere", Vec3::Constant(small), Vec3(0, 0.5 * small, 0),
                                               "material = \"glass\"") +
                                          "[ground]\n"),
              ratio.str() + ", the heavy one falls on the light one", outcome);
    sound_run(scene("duration = 0.5",
                    body("heavy", "sphere", Vec3::Constant(large), Vec3(0, 0.5 * large, 0), "material = \"glass\"") +
                        body("light", "sphere", Vec3::Constant(small), Vec3(0, large + small, 0),
                             "material = \"steel\"\nvelocity = [0, -20, 0]") +
                        "[ground]\n"),
              ratio.str() + ", the light one hits the heavy one", outcome);
  }
  return outcome;
}

std::string falling_plate(const std::string& head, double drop_speed = 6) {
  std::ostringstream speed;
  speed << "material = \"glass\"\nrotation = [20, 0, 10]\nvelocity = [0, " << -drop_speed << ", 0]";
  return scene(head, body("plate", "box", Vec3(0.3, 0.01, 0.3), Vec3(0, 0.12, 0), speed.str()) + "[ground]\n");
}

/// X9
Outcome gravities() {
  Outcome outcome;
  for (const char* g : {"0", "-9810", "9810"})
    sound_run(falling_plate(std::string("duration = 0.3\ngravity = [0, ") + g + ", 0]"), std::string("gravity ") + g,
              outcome);
  return outcome;
}

/// X8
Outcome empty_scenes() {
  Outcome outcome;
  outcome.checks.push_back(
      refused("no body", ErrorKind::usage, "no body", [] { load_text("[scene]\nduration = 1\n"); }));
  outcome.checks.push_back(
      refused("duration 0", ErrorKind::usage, "duration", [] { load_text(falling_plate("duration = 0")); }));
  outcome.checks.push_back(refused("ten million frames", ErrorKind::usage, "frame_rate",
                                   [] { load_text(falling_plate("duration = 1e5\nframe_rate = 100")); }));
  outcome.checks.push_back(refused("a body without size", ErrorKind::usage, "size", [] {
    load_text(scene("", body("a", "box", Vec3(1, 0, 1), Vec3::Zero(), "material = \"glass\"")));
  }));
  sound_run(scene("duration = 0.2", body("alone", "box", Vec3::Constant(0.1), Vec3::Zero(), "material = \"glass\"")),
            "one body and no ground", outcome);
  return outcome;
}

/// X10. Pieces of steel poured on the ground, for ten thousand steps: what lies keeps lying.
Outcome rubble() {
  std::string bodies = "[ground]\n";
  for (int n = 0; n < 60; ++n) {
    const auto u = [&](std::uint64_t stream) { return random_unit(11, stream, static_cast<std::uint64_t>(n)); };
    const Vec3 size = 0.04 * Vec3(0.5 + u(0), 0.5 + u(1), 0.5 + u(2));
    std::ostringstream more;
    more << "material = \"steel\"\nrotation = [" << 360 * u(3) << ", " << 360 * u(4) << ", 0]";
    bodies += body("piece_" + std::to_string(n), "box", size,
                   Vec3(0.08 * (n % 4), 0.06 + 0.09 * (n / 16), 0.08 * (n / 4 % 4)), more.str());
  }
  Outcome outcome;
  // 240 steps a second.
  const RunResult r = sound_run(scene("duration = 42", bodies), "60 pieces of steel, 10^4 steps", outcome);
  outcome.checks.push_back(within("steps", static_cast<double>(r.report.motion.work.steps), 1e4, 1e6));
  double fastest = 0, lowest = 0;
  for (const output::PiecePose& p : r.sequence.frames.back().poses) {
    fastest = std::max(fastest, p.twist.linear.norm());
    lowest = std::min(lowest, p.pose.position.y());
  }
  outcome.checks.push_back(within("fastest piece in the end [m/s]", fastest, 0, 0.01));
  outcome.checks.push_back(within("lowest piece in the end [m]", lowest, 0, 1));
  return outcome;
}

/// S18
Outcome restarts() {
  Outcome outcome;
  stopped_run(falling_plate("duration = 0.2", 9), 6, outcome);
  return outcome;
}

/// X12. Contradictions that a user writes by mistake.
Outcome wrong_units() {
  Outcome outcome;
  // Millimetres taken for metres: a plate of 300 m falls by its own size.
  sound_run(scene("duration = 1", body("plate", "box", Vec3(300, 10, 300), Vec3(0, 8, 0),
                                       "material = \"glass\"\nvelocity = [0, -10, 0]") +
                                      "[ground]\n"),
            "plate of 300 m", outcome);
  sound_run(scene("duration = 0.002\nframe_rate = 50000", body("grain", "box", Vec3::Constant(1e-4), Vec3(0, 1e-4, 0),
                                                               "material = \"glass\"\nvelocity = [0, -30, 0]") +
                                                              "[ground]\n"),
            "grain of 0.1 mm", outcome);
  outcome.checks.push_back(refused("bodies in each other", ErrorKind::usage, "overlaps", [] {
    Outcome ignored;
    sound_run(
        scene("duration = 0.1", body("a", "box", Vec3::Constant(0.1), Vec3::Zero(), "material = \"glass\"") +
                                    body("b", "box", Vec3::Constant(0.1), Vec3(0.02, 0, 0), "material = \"glass\"")),
        "", ignored);
  }));
  return outcome;
}

}  // namespace

std::vector<validation::Problem> hard_scenes() {
  const std::string sound = "finite, closed, conserving, no energy from nowhere",
                    or_refused = "sound, or refused by name";
  return {
      {"S10", "Mass ratios of 10^3 and 10^6", sound, mass_ratios},
      {"S18", "A run stopped in the middle of its fractures, again and again", "goes on to the same bits", restarts},
      {"X8", "Scenes without bodies, time or size", or_refused, empty_scenes},
      {"X9", "Gravity 0, 1000 g down and up", sound, gravities},
      {"X10", "Rubble for 10^4 steps", sound, rubble},
      {"X12", "Millimetres taken for metres, and worse", or_refused, wrong_units}};
}

}  // namespace sunder::pipeline::detail
