#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include "validation/catalogue.h"
#include "validation/detail/cracks.h"
#include "validation/detail/parts.h"
#include "validation/specimen.h"

namespace sunder::validation {
namespace {

using detail::CrackSlice;
using std::numbers::pi;

constexpr double width = 0.1;  ///< of all plates here, which are squares [m]

mpm::Material brittle(const mpm::SolveSettings& settings, double h) {
  mpm::Material m{.density = 2450, .youngs_modulus = 32e9, .poisson_ratio = 0.2, .fracture_energy = 3};
  m.tensile_strength = detail::strength_of_band(m, settings, h, 5);
  return m;
}

/// Tada: K = Y sigma sqrt(pi a).
double tada(double s) { return 1.12 - 0.231 * s + 10.55 * s * s - 21.72 * s * s * s + 30.39 * s * s * s * s; }

/// Stress at which an edge crack of length `crack` runs [Pa].
double griffith(const mpm::Material& m, double crack) {
  return std::sqrt(detail::plane_modulus(m) * m.fracture_energy / (pi * crack)) / tada(crack / width);
}

SpecimenSettings plane_settings(Damage damage) {
  SpecimenSettings settings;
  settings.damage = damage;
  settings.plane_strain = true;
  settings.viscosity = settings.solve.viscosity;
  return settings;
}

/// Plane strain, edge crack of a quarter of the width, pulled until the crack is through. B5 pulls slowly.
struct EdgeCrack {
  double strength = 0;    ///< largest mean stress over that of Griffith
  double dissipated = 0;  ///< by damage, over G_f x area
  double band = 0;        ///< mean thickness of the damage [h]
  std::vector<CrackSlice> path;
  double h = 0, rayleigh_speed = 0;
  double particle_steps = 0;

  double speed() const { return detail::crack_speed(path) / rayleigh_speed; }
};

struct EdgeCrackSettings {
  int cells = 64;
  double angle = 0;                        ///< of the plate to the grid [degrees]
  double transits = 6;                     ///< of a P wave before the stress of Griffith is reached
  bool traction = false;                   ///< pulled by forces on its edges instead of grips
  std::optional<double> above_nodes = {};  ///< of the crack over a plane of nodes [h]; default: as it comes
};

/// Grips that hold nodes one by one along the turned edges y = 0 and y = width; they hold along the edge as well.
std::vector<mpm::HeldRegion> oblique_grips(const Mat3& turn, double h, const Vec3& pull) {
  std::vector<mpm::HeldRegion> held;
  const int reach = static_cast<int>(2 * width / h);
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j) {
      const Vec3 node = h * Vec3(i, j, 0), x = turn.transpose() * node;
      const bool low = x[1]<0.5001 * h, high = x[1]> width - 0.5001 * h;
      if (!(low || high) || x[1] < -2 * h || x[1] > width + 2 * h || x[0] < -2 * h || x[0] > width + 2 * h) continue;
      const Vec3 half(0.1 * h, 0.1 * h, 1);
      held.push_back({Box(node - half, node + half), low ? Vec3(-pull) : pull, {true, true, false}});
    }
  return held;
}

std::vector<mpm::HeldRegion> straight_grips(double h, const Vec3& pull, const std::array<bool, 3>& axes) {
  const Vec3 far = Vec3::Constant(1);
  return {{Box(-far, Vec3(1, 0.5001 * h, 1)), -pull, axes}, {Box(Vec3(-1, width - 0.5001 * h, -1), far), pull, axes}};
}

/// Forces on the outermost points of both edges of a plate.
class EdgeForces {
 public:
  EdgeForces(const Specimen& specimen, double h) {
    for (int id = 0; id < specimen.body.size(); ++id) {
      const double y = specimen.body.material_position(id)[1];
      if (y < 0.5 * h) low_.push_back(id);
      if (y > width - 0.5 * h) high_.push_back(id);
    }
  }
  void pull(double force, Specimen& specimen) const {
    const double impulse = force * specimen.time_step();
    for (int id : low_) specimen.body.push(id, Vec3(0, -impulse / static_cast<double>(low_.size()), 0));
    for (int id : high_) specimen.body.push(id, Vec3(0, impulse / static_cast<double>(high_.size()), 0));
  }

 private:
  std::vector<int> low_, high_;
};

EdgeCrack pull_edge_crack(const EdgeCrackSettings& wanted) {
  constexpr double crack = width / 4;
  const double h = width / wanted.cells;
  SpecimenSettings settings = plane_settings(Damage::front);
  const mpm::Material m = brittle(settings.solve, h);
  // The tip is at the end of the seeds below.
  const double stress = griffith(m, crack + 0.5 * h), transit = width / m.p_wave_speed(),
               rate = stress / detail::plane_modulus(m) / (wanted.transits * transit);
  const Mat3 turn = Eigen::AngleAxisd(wanted.angle * pi / 180, Vec3::UnitZ()).toRotationMatrix();
  const Vec3 pull(0, 0.5 * rate * width, 0);
  const bool turned = wanted.angle != 0;
  settings.held = turned ? oblique_grips(turn, h, turn * pull) : straight_grips(h, pull, {false, true, false});
  if (turned) settings.anchor = Vec3::Zero();
  if (wanted.above_nodes) settings.anchor = Vec3(0, 0.5 * width - *wanted.above_nodes * h, 0);
  if (wanted.traction) settings.held.clear();
  Mat3 gradient = Mat3::Zero();
  gradient(1, 1) = rate;
  const Vec3 middle(0, 0.5 * width, 0), shift = turn * middle;
  settings.motion = [&](const Vec3& x) {
    return mpm::Motion{turn * gradient * turn.transpose() * (x - shift), turn * gradient * turn.transpose()};
  };
  const auto off_plane = [&](const Vec3& x) { return std::abs(x[1] - 0.5 * width); };
  Lattice lattice = plane(
      Box(Vec3::Zero(), Vec3(width, width, 0)), h, [&](const Vec3& x) { return x[0] > crack || off_plane(x) > h; },
      0.2);
  for (Vec3& x : lattice.points) x = turn * x;
  Specimen specimen(lattice, m, settings);
  specimen.crack(
      [&](const Vec3& place) {
        const Vec3 x = turn.transpose() * place;
        return x[0] < crack + 0.5 * h && off_plane(x) < 0.6 * h;
      },
      turn.col(1));
  const long seeds = specimen.failed();
  const EdgeForces edges(specimen, h);

  EdgeCrack result;
  const Vec3 along = turn.col(0);
  double reach = 0;
  while (reach < width - 0.6 * h && specimen.time() < 4 * wanted.transits * transit) {
    const double applied = rate * specimen.time() * detail::plane_modulus(m);
    for (int n = 0; n < 50; ++n)
      specimen.step([&](Specimen& s) {
        if (wanted.traction) edges.pull(applied * width * h, s);
      });
    // Forces only grow: what counts is when the crack runs.
    if (wanted.traction && reach < crack + 0.1 * width) result.strength = applied / stress;
    if (!wanted.traction && !turned)
      result.strength = std::max(result.strength, specimen.force(1)[1] / (width * h) / stress);
    for (const auto& f : detail::failures(specimen)) reach = std::max(reach, f.position.dot(along));
  }
  const double area = (width - crack) * h;
  result.dissipated = specimen.dissipated() / (m.fracture_energy * area);
  result.band = static_cast<double>(specimen.failed() - seeds) * lattice.particle_volume / area / h;
  result.path = detail::slices(detail::failures(specimen), shift + crack * along, along, h);
  result.h = h;
  result.rayleigh_speed = detail::rayleigh_speed(m);
  result.particle_steps = specimen.particle_steps();
  if (reach < width - 0.6 * h) result.strength = std::numeric_limits<double>::quiet_NaN();
  return result;
}

EdgeCrack pull_by_tractions(int cells) {
  return pull_edge_crack({.cells = cells, .transits = 12, .traction = true, .above_nodes = 0.25});
}

StudyPoint strength_error(int cells) {
  const EdgeCrack r = pull_by_tractions(cells);
  return {std::abs(r.strength - 1), r.particle_steps};
}

/// B5. Tada's plate is pulled by tractions: its ends may turn. No front factor gives G_f here and in the double
/// cantilever of B14 at once; at 0.8 the plate is at 0.67 to 0.87 of it (48 to 96 cells) and the
/// cantilever at 0.9 to 1.1.
Outcome edge_crack() {
  Outcome outcome;
  double least = 1e9, most = 0;
  for (int cells : {48, 96}) {
    const EdgeCrack r = pull_by_tractions(cells);
    const std::string name = std::to_string(cells) + " cells";
    outcome.checks.push_back(relative("strength, " + name + " [Griffith]", r.strength, 1, 0.2));
    outcome.particle_steps += r.particle_steps;
    least = std::min(least, r.strength);
    most = std::max(most, r.strength);
    if (cells != 96) continue;
    outcome.checks.push_back(
        relative("energy per crack area, by its strength (wanted: 0.15) [G_f]", r.strength * r.strength, 1, 0.4));
    outcome.checks.push_back(within("thickness of the damage [h]", r.band, 1, 2.5));
  }
  outcome.checks.push_back(relative("strength, 96 over 48 cells [1]", most / least, 1, 0.1));
  return outcome;
}

/// B5b. A crack in a plane of nodes is stronger, since the points beside it, which the crack shields, hold each other
/// by the nodes between them: the grid must be known to do this, and by how much.
Outcome place_on_grid() {
  Outcome outcome;
  const EdgeCrack between = pull_edge_crack({.cells = 48}), on = pull_edge_crack({.cells = 48, .above_nodes = 0});
  outcome.checks.push_back(
      relative("strength, in a plane of nodes over between them [1]", on.strength / between.strength, 1, 0.25));
  outcome.checks.push_back(within("dissipated by damage [G_f x area]", between.dissipated, 0.2, 1));
  outcome.particle_steps = between.particle_steps + on.particle_steps;
  return outcome;
}

/// B6
Outcome straight_path() {
  Outcome outcome;
  for (double angle : {0.0, 20.0, 45.0}) {
    const EdgeCrack r = pull_edge_crack({.cells = 48, .angle = angle});
    const auto line = detail::line_through(r.path);
    const std::string name =
        angle == 0 ? "along the grid: " : std::to_string(static_cast<int>(angle)) + " degrees off the grid: ";
    outcome.checks.push_back(absolute(name + "tilt [degrees]", line.tilt, 0, angle == 0 ? 3 : 8));
    // Off the grid the catalogue bounds the tilt only.
    outcome.checks.push_back(absolute(name + "deviation [h]", line.deviation / r.h, 0, angle == 0 ? 1.5 : 2.5));
    outcome.checks.push_back(
        within(name + "way of the crack [width]", r.path.empty() ? 0 : r.path.back().x / width, 0.72, 0.76));
    outcome.particle_steps += r.particle_steps;
  }
  return outcome;
}

/// Direction of the line through the failures within [least, most] of a tip, to the left of `along` [degrees]: where a
/// crack leaves its tip is known to about a cell only, so the tip is not on the line.
double direction_from(const Vec3& tip, const Vec3& along, const std::vector<detail::Failure>& failures, double least,
                      double most) {
  std::vector<Vec3> near;
  Vec3 mean = Vec3::Zero();
  for (const auto& f : failures)
    if (const double r = (f.position - tip).norm(); r >= least && r <= most) near.push_back(f.position - tip);
  for (const Vec3& d : near) mean += d / static_cast<double>(near.size());
  double xx = 0, xy = 0, yy = 0;
  for (const Vec3& d : near) {
    const double x = along.dot(d - mean), y = along.cross(d - mean)[2];
    xx += x * x, xy += x * y, yy += y * y;
  }
  const double axis = 0.5 * std::atan2(2 * xy, xx - yy), towards = std::atan2(along.cross(mean)[2], along.dot(mean));
  // Of its two senses the one away from the tip.
  return (std::cos(axis - towards) < 0 ? axis + (axis < 0 ? pi : -pi) : axis) * 180 / pi;
}

/// A slit two cells wide with points that have failed at its tips.
struct Slit {
  Vec3 from, to;
  bool open_at_start = false;  ///< it begins at an edge: no tip there
  double h = 0;

  Vec3 along() const { return (to - from).normalized(); }
  double beyond(const Vec3& x) const {
    const double s = (x - from).dot(along());
    return std::max(-s, s - (to - from).norm());
  }
  double beside(const Vec3& x) const { return std::abs(along().cross(x - from)[2]); }
  bool solid(const Vec3& x) const { return beyond(x) > 0 || beside(x) > h; }
  bool tip(const Vec3& x) const {
    return beside(x) < 0.6 * h && beyond(x) < 0.5 * h && !(open_at_start && (x - from).dot(along()) < 0);
  }
  std::vector<Vec3> tips() const { return open_at_start ? std::vector<Vec3>{to} : std::vector<Vec3>{from, to}; }
};

struct Kink {
  double angle = 0;     ///< to the right of the slit, at the tip whose crack is the longest [degrees]
  double grown = 0;     ///< [m]
  double mirrored = 0;  ///< share of the failures that lie to the left of the slit
  double particle_steps = 0;
};

/// The failures nearer to this tip than to the other, and how far they got.
void measure(const Slit& slit, const Vec3& tip, const std::vector<detail::Failure>& failed, double most, Kink& kink) {
  std::vector<detail::Failure> own;
  double grown = 0, mirrored = 0;
  const Vec3 along = tip == slit.to ? slit.along() : Vec3(-slit.along()), other = tip == slit.to ? slit.from : slit.to;
  for (const auto& f : failed) {
    const Vec3 d = f.position - tip;
    if (d.norm() > (f.position - other).norm()) continue;
    own.push_back(f);
    grown = std::max(grown, d.norm());
    mirrored += along.cross(d)[2] > 2 * slit.h;
  }
  if (grown <= kink.grown) return;
  kink.grown = grown;
  kink.mirrored = mirrored / static_cast<double>(own.size());
  kink.angle = -direction_from(tip, along, own, 2 * slit.h, most);
}

/// Pulls or shears a plate with a slit, whose velocity gradient is given, until a crack of length `wanted` has grown.
Kink grow_kink(const Slit& slit, const Mat3& gradient, double wanted, bool clamped) {
  SpecimenSettings settings = plane_settings(Damage::front);
  const mpm::Material m = brittle(settings.solve, slit.h);
  const Vec3 pull = 0.5 * width * gradient.col(1), centre(0.5 * width, 0.5 * width, 0);
  settings.held = straight_grips(slit.h, pull, {clamped, true, false});
  settings.motion = [&](const Vec3& x) { return mpm::Motion{gradient * (x - centre), gradient}; };
  const Lattice lattice = plane(
      Box(Vec3::Zero(), Vec3(width, width, 0)), slit.h, [&](const Vec3& x) { return slit.solid(x); }, 0.2);
  Specimen specimen(lattice, m, settings);
  const Vec3 normal(-slit.along()[1], slit.along()[0], 0);
  specimen.crack([&](const Vec3& x) { return slit.tip(x); }, normal);
  Kink result;
  const double latest = 20 * width / m.p_wave_speed();
  while (result.grown < wanted && specimen.time() < latest) {
    for (int n = 0; n < 20; ++n) specimen.step();
    const auto failed = detail::failures(specimen);
    measure(slit, slit.to, failed, wanted, result);
    if (!slit.open_at_start) measure(slit, slit.from, failed, wanted, result);
  }
  result.particle_steps = specimen.particle_steps();
  return result;
}

/// B7. The upper half moves along the slit against the lower one: the crack turns into the lower half, away from the
/// side in compression. It starts at 70 degrees and bends towards the 45 degrees of the far field.
void sheared_slit(double h, Outcome& outcome) {
  constexpr double crack = 0.5 * width;
  const mpm::Material m = brittle({}, h);
  Mat3 gradient = Mat3::Zero();
  gradient(0, 1) = griffith(m, crack) / m.shear_modulus() * m.p_wave_speed() / width;
  const Kink k = grow_kink({Vec3(-h, 0.5 * width, 0), Vec3(crack, 0.5 * width, 0), true, h}, gradient, crack / 4, true);
  outcome.checks.push_back(absolute("shear: kink [degrees]", k.angle, 70.53, 12));
  outcome.checks.push_back(within("shear: length of the kink [crack]", k.grown / crack, 0.25, 0.35));
  outcome.checks.push_back(absolute("shear: share of it on the side in compression [1]", k.mirrored, 0, 0.05));
  outcome.particle_steps += k.particle_steps;
}

/// A slit inside of the plate at 45 degrees to the tension.
void inclined_slit(double h, Outcome& outcome) {
  constexpr double half = 0.15 * width;
  const mpm::Material m = brittle({}, h);
  const Vec3 centre(0.5 * width, 0.5 * width, 0), arm = half * Vec3(1, 1, 0).normalized();
  Mat3 gradient = Mat3::Zero();
  gradient(1, 1) = griffith(m, half) / detail::plane_modulus(m) * 0.5 * m.p_wave_speed() / width;
  const Kink k = grow_kink({centre - arm, centre + arm, false, h}, gradient, 0.5 * half, false);
  outcome.checks.push_back(absolute("slit at 45 degrees in tension: kink [degrees]", k.angle, 53.13, 10));
  outcome.checks.push_back(within("slit at 45 degrees: length of the kink [half slit]", k.grown / half, 0.5, 0.8));
  outcome.particle_steps += k.particle_steps;
}

Outcome kinks() {
  Outcome outcome;
  sheared_slit(width / 64, outcome);
  inclined_slit(width / 64, outcome);
  return outcome;
}

/// B10. Pulled ever faster. Cracks that start ahead of the tip would count as speed.
Outcome speeds() {
  Outcome outcome;
  for (double transits : {6.0, 2.0, 0.5}) {
    const EdgeCrack r = pull_edge_crack({.cells = 48, .transits = transits});
    char name[96];
    std::snprintf(name, sizeof name, "edge crack, Griffith's stress after %g transits: speed [c_R]", transits);
    outcome.checks.push_back(within(name, r.speed(), 0.05, 1));
    outcome.particle_steps += r.particle_steps;
  }
  const EdgeCrack oblique = pull_edge_crack({.cells = 48, .angle = 20});
  outcome.checks.push_back(within("edge crack, 20 degrees off the grid: speed [c_R]", oblique.speed(), 0.05, 1));
  outcome.particle_steps += oblique.particle_steps;
  return outcome;
}

}  // namespace

std::vector<Problem> fracture() {
  std::vector<Problem> list = {
      {"B5", "Edge crack in a plate, brittle (band 5 l_max): strength", "Tada, Paris, Irwin; Griffith", edge_crack,
       Study{"strength [Griffith]", "cells across the plate", {24, 48, 96}, {}, strength_error}},
      {"B5b", "The same between grips, by its place on the grid", "Tada, Paris, Irwin; Griffith", place_on_grid},
      {"B6", "Path of a mode I crack, also off the grid", "symmetry", straight_path},
      {"B7", "Kink of a crack in shear and in inclined tension", "maximum hoop stress: 70.5 and 53.1 degrees", kinks},
      {"B10", "Speed of mode I cracks, 99th percentile over windows of 4 h", "below that of Rayleigh waves", speeds}};
  for (const auto& part : {detail::machines(), detail::dynamic_cracks(), detail::expanding_ring()})
    list.insert(list.end(), part.begin(), part.end());
  return list;
}

}  // namespace sunder::validation
