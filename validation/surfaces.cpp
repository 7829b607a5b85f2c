#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <Eigen/Geometry>

#include "core/progress.h"
#include "crack/shatter.h"
#include "crack/time_field.h"
#include "geometry/inspect.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "validation/catalogue.h"
#include "validation/damage_cloud.h"
#include "validation/detail/parts.h"

namespace sunder::validation {
namespace {

using crack::DamageField;
using crack::Extraction;
using crack::FaceKind;
using namespace crack::setup;
using geometry::CutResult;
using geometry::TriangleMesh;

constexpr double slab = 3;  ///< thickness of the damage, in node spacings

Extraction extracted(const DamageField& field, const Box& domain, std::uint64_t seed = 1) {
  SilentProgress progress;
  crack::Settings settings;
  settings.node_spacing = field.spacing;
  settings.seed = seed;
  return crack::extract(field, domain, settings, progress);
}

CutResult cut_along(const TriangleMesh& body, const geometry::RegionBoundary& boundary) {
  SilentProgress progress;
  return geometry::cut(body, boundary, {}, progress);
}

/// The box [0, size] as a mesh.
TriangleMesh block(const Vec3& size) { return geometry::transformed(geometry::box(size), Mat3::Identity(), size / 2); }

std::vector<double> volumes(const CutResult& cut) {
  std::vector<double> list;
  for (const geometry::Fragment& f : cut.fragments) list.push_back(geometry::mass_properties(f.mesh).volume);
  std::sort(list.begin(), list.end());
  return list;
}

double sum(const std::vector<double>& list) {
  double total = 0;
  for (const double v : list) total += v;
  return total;
}

long open_pieces(const CutResult& cut) {
  return std::count_if(cut.fragments.begin(), cut.fragments.end(),
                       [](const geometry::Fragment& f) { return !geometry::inspect(f.mesh).is_solid(); });
}

/// V - E + F.
int euler_characteristic(const TriangleMesh& mesh) {
  std::set<std::pair<int, int>> edges;
  std::set<int> vertices;
  for (const geometry::Triangle& t : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      edges.insert(std::minmax({t[k], t[(k + 1) % 3]}));
      vertices.insert(t[k]);
    }
  return static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.faces.size());
}

/// A cube of n^3 points with a slab of damage about the plane through its middle, off the lattice.
struct PlanarSlab {
  Vec3 normal;
  double h, offset;
  DamageField field;

  PlanarSlab(const Vec3& direction, int n)
      : normal(direction.normalized()), h(1.0 / n), offset(normal.dot(Vec3::Constant(0.5)) + 0.37 * h) {
    field = cloud(unit_cube(), h, everywhere, [this](const Vec3& x) { return std::abs(height(x)) <= slab * h / 2; });
  }
  double height(const Vec3& x) const { return normal.dot(x) - offset; }
  /// The plane itself, to cut along.
  geometry::RegionBoundary plane() const {
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    geometry::RegionBoundary boundary;
    for (const auto& [a, b] : {std::pair(-2, -2), std::pair(2, -2), std::pair(2, 2), std::pair(-2, 2)})
      boundary.vertices.push_back(offset * normal + a * u + b * v + (Vec3::Constant(0.5) - normal * normal.sum() / 2));
    boundary.faces = {{{0, 1, 2, 3}, 0, 1}};
    boundary.region_count = 2;
    return boundary;
  }
};

/// Distances of the separating faces' corners from the plane [h].
struct Deviation {
  double rms = 0, largest = 0;
};
Deviation deviation(const PlanarSlab& planar, const Extraction& e) {
  Deviation d;
  double squares = 0, count = 0;
  for (const crack::CrackFace& face : e.faces) {
    if (!face.in_body || face.kind == FaceKind::partial) continue;
    for (const int v : face.loop) {
      const Vec3& x = e.vertices[static_cast<std::size_t>(v)];
      if (!unit_cube().contains(x)) continue;
      const double off = std::abs(planar.height(x)) / planar.h;
      squares += off * off, count += 1;
      d.largest = std::max(d.largest, off);
    }
  }
  d.rms = std::sqrt(squares / count);
  return d;
}

/// C1. Sheets off the lattice, at three directions; the catalogue's bounds.
Outcome planar_slabs() {
  Outcome outcome;
  for (const auto& [name, normal] : {std::pair("along the axis: ", Vec3(1, 0, 0)),
                                     std::pair("diagonal: ", Vec3(1, 1, 0)), std::pair("oblique: ", Vec3(1, 2, 3))}) {
    const PlanarSlab planar(normal, 32);
    const Extraction e = extracted(planar.field, unit_cube());
    const Deviation d = deviation(planar, e);
    const CutResult cut = cut_along(block(Vec3::Ones()), e.boundary);
    const std::vector<double> v = volumes(cut);
    outcome.checks.push_back(absolute(std::string(name) + "deviation from the plane, RMS [h]", d.rms, 0, 0.35));
    outcome.checks.push_back(absolute(std::string(name) + "largest deviation [h]", d.largest, 0, 0.75));
    outcome.checks.push_back(absolute(std::string(name) + "fragments", static_cast<double>(v.size()), 2, 0));
    const double exact = volumes(cut_along(block(Vec3::Ones()), planar.plane())).at(0);
    outcome.checks.push_back(relative(std::string(name) + "volume of the smaller one [that below the plane]",
                                      v.empty() ? 0 : v[0] / exact, 1, 0.01));
    outcome.checks.push_back(absolute(std::string(name) + "sum of the volumes [cube]", sum(v), 1, 1e-12));
  }
  return outcome;
}

/// RMS deviation of the oblique sheet [cube].
StudyPoint planar_error(int nodes) {
  const PlanarSlab planar(Vec3(1, 2, 3), nodes);
  return {deviation(planar, extracted(planar.field, unit_cube())).rms * planar.h, 0};
}

/// C2. A slab that stops short of one side, and one that ends in the middle; the order of the points means nothing.
Outcome short_slabs() {
  constexpr int n = 32;
  constexpr double h = 1.0 / n;
  const auto field_to = [&](double end) {
    return cloud(unit_cube(), h, everywhere,
                 [&](const Vec3& x) { return std::abs(x[0] - 0.51) <= slab * h / 2 && x[1] < end; });
  };
  const DamageField nearly = field_to(1 - 1.5 * h + 1e-9);  // one layer of sound points is left
  const Extraction e = extracted(nearly, unit_cube());
  const CutResult cut = cut_along(block(Vec3::Ones()), e.boundary);
  const Extraction half = extracted(field_to(0.5), unit_cube());
  const auto partial = std::count_if(half.faces.begin(), half.faces.end(), [](const crack::CrackFace& f) {
    return f.kind == FaceKind::partial && f.in_body;
  });
  long other = 0;
  for (std::uint64_t turn = 1; turn <= 20; ++turn) {
    DamageField shuffled = nearly;
    for (std::size_t i = shuffled.points.size(); i > 1; --i) {
      const auto j = static_cast<std::size_t>(random_unit(turn, 0, i) * static_cast<double>(i));
      std::swap(shuffled.points[i - 1], shuffled.points[j]);
      std::swap(shuffled.damage[i - 1], shuffled.damage[j]);
    }
    const Extraction again = extracted(shuffled, unit_cube());
    other += again.region_count != e.region_count || again.faces.size() != e.faces.size();
  }
  Outcome outcome;
  outcome.checks = {absolute("1.5 h short of the surface: fragments", static_cast<double>(cut.fragments.size()), 2, 0),
                    absolute("1.5 h short: pieces that are not closed", static_cast<double>(open_pieces(cut)), 0, 0),
                    absolute("ends in the middle: regions", half.region_count, 1, 0),
                    within("ends in the middle: partial faces", static_cast<double>(partial), 100, 1e6),
                    absolute("other topology in 20 orders of the points", static_cast<double>(other), 0, 0)};
  return outcome;
}

/// C3. Half planes that meet in a line: three at 120 degrees, four, and a plane with half of one.
Outcome junctions() {
  constexpr int n = 32;
  constexpr double h = 1.0 / n;
  const auto star = [&](const std::vector<double>& angles) {
    return cloud(unit_cube(), h, everywhere, [&](const Vec3& x) {
      const Vec3 r = x - Vec3(0.507, 0.493, 0);
      return std::any_of(angles.begin(), angles.end(), [&](double a) {
        const Vec3 along(std::cos(a), std::sin(a), 0);
        return along.dot(r) > -h && std::abs(along.cross(r)[2]) <= slab * h / 2;
      });
    });
  };
  const auto pieces_of = [&](const DamageField& f) {
    return cut_along(block(Vec3::Ones()), extracted(f, unit_cube()).boundary);
  };
  constexpr double turn = 2 * std::numbers::pi;
  Outcome outcome;
  const auto book = [&](const std::string& name, const std::vector<double>& angles) {
    const CutResult cut = pieces_of(star(angles));
    outcome.checks.push_back(absolute(name + ": fragments", static_cast<double>(cut.fragments.size()),
                                      static_cast<double>(angles.size()), 0));
    outcome.checks.push_back(absolute(name + ": sum of the volumes [cube]", sum(volumes(cut)), 1, 1e-12));
    outcome.checks.push_back(
        absolute(name + ": pieces that are not closed", static_cast<double>(open_pieces(cut)), 0, 0));
    return volumes(cut);
  };
  const std::vector<double> y = book("Y", {0.3, 0.3 + turn / 3, 0.3 + 2 * turn / 3});
  book("X", {0.3, 0.3 + turn / 4, 0.3 + turn / 2, 0.3 + 3 * turn / 4});
  book("T", {0.3, 0.3 + turn / 4, 0.3 + turn / 2});
  // Sectors of a square about a point near its middle: within two per cent of a third each, and what being off it
  // costs.
  outcome.checks.push_back(within("Y: smallest sector [cube]", y.empty() ? 0 : y.front(), 0.29, 1.02 / 3));
  outcome.checks.push_back(within("Y: largest sector [cube]", y.empty() ? 0 : y.back(), 0.98 / 3, 0.37));
  return outcome;
}

/// C4. A shell of damage sets a ball free inside of a cube.
Outcome spherical_shell() {
  constexpr int n = 32;
  constexpr double h = 1.0 / n, radius = 10 * h;
  const DamageField field = cloud(
      unit_cube(), h, everywhere,
      [](const Vec3& x) { return std::abs((x - Vec3::Constant(0.5)).norm() - radius) <= slab * h / 2; }, 0.25);
  const CutResult cut = cut_along(block(Vec3::Ones()), extracted(field, unit_cube()).boundary);
  const std::vector<double> v = volumes(cut);
  int euler = 0;
  for (const geometry::Fragment& f : cut.fragments) euler += euler_characteristic(f.mesh);
  const double ball = 4.0 / 3 * std::numbers::pi * std::pow(radius, 3);
  Outcome outcome;
  outcome.checks = {absolute("fragments", static_cast<double>(v.size()), 2, 0),
                    relative("volume of the inner one [ball]", v.empty() ? 0 : v[0] / ball, 1, 0.03),
                    absolute("sum of the volumes [cube]", sum(v), 1, 1e-12),
                    // The ball has one closed surface, the rest two.
                    absolute("Euler characteristic of all surfaces", euler, 6, 0)};
  return outcome;
}

/// C5. A crack in the right leg of a horseshoe does not touch the left one.
Outcome horseshoe() {
  constexpr int n = 32;
  constexpr double h = 1.0 / n;
  Outcome outcome;
  for (const double gap : {0.5, 2 * h}) {
    const double left = 0.5 - gap / 2, right = 0.5 + gap / 2;
    const Box box(Vec3::Zero(), Vec3(1, 0.25, 1));
    const DamageField field = cloud(
        box, h, [&](const Vec3& x) { return x[0] < left || x[0] > right || x[2] < 0.25; },
        [&](const Vec3& x) { return x[0] > right && std::abs(x[2] - 0.65) <= slab * h / 2; }, 0.1);
    const Extraction e = extracted(field, box);
    long strangers = 0;
    for (std::size_t i = 0; i < field.points.size(); ++i)
      strangers += field.points[i][0] < 0.5 && e.region[i] != e.region[0];
    const std::string name = gap > 0.4 ? "wide gap: " : "gap of two spacings: ";
    outcome.checks.push_back(absolute(name + "regions", e.region_count, 2, 0));
    outcome.checks.push_back(
        absolute(name + "points of the other leg that it took along", static_cast<double>(strangers), 0, 0));
  }
  return outcome;
}

/// C6. Fan (2024) 3.2 decides sides by the node's offset and skips oblique normals: all points have to be told apart by
/// the crack.
Outcome sides() {
  Outcome outcome;
  for (const Vec3& normal : {Vec3(1, 1, 1), Vec3(3, -1, 2), Vec3(0.02, 1, 0.01)}) {
    const PlanarSlab planar(normal, 24);
    const Extraction e = extracted(planar.field, unit_cube());
    // Which region lies in front of the plane: that of the farthest point.
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < planar.field.points.size(); ++i)
      if (planar.height(planar.field.points[i]) > planar.height(planar.field.points[farthest])) farthest = i;
    long wrong = 0;
    for (std::size_t i = 0; i < planar.field.points.size(); ++i)
      if (planar.field.damage[i] == 0)
        wrong += (e.region[i] == e.region[farthest]) != (planar.height(planar.field.points[i]) > 0);
    char name[96];
    std::snprintf(name, sizeof name, "normal (%g, %g, %g): sound points on the wrong side", normal[0], normal[1],
                  normal[2]);
    outcome.checks.push_back(absolute(name, static_cast<double>(wrong), 0, 0));
  }
  return outcome;
}

Mat3 inertia_about_origin(const geometry::MassProperties& m) {
  const Vec3& r = m.centroid;
  return m.inertia + m.volume * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
}

/// C7. Random cells through bodies of several shapes; a third of the sites on a lattice, so that cells meet in corners.
Outcome conservation() {
  double volume = 0, centre = 0, inertia = 0, open = 0, failed = 0, pieces = 0;
  const std::vector<TriangleMesh> bodies = {geometry::sphere(0.5, 3), geometry::torus(0.35, 0.12, 48, 16),
                                            geometry::cup(0.8, 0.05), geometry::box(Vec3(1, 0.05, 0.7))};
  constexpr std::uint64_t cuts = 100;
  for (std::uint64_t n = 0; n < cuts; ++n) {
    const TriangleMesh& body = bodies[n % bodies.size()];
    const Box box = geometry::bounds(body);
    const auto count = 2 + static_cast<std::uint64_t>(25 * random_unit(n, 9, 0));
    std::vector<Vec3> sites;
    for (std::uint64_t i = 0; i < count; ++i) {
      const Vec3 lattice(static_cast<double>(i % 3) / 3, static_cast<double>(i / 3 % 3) / 3,
                         static_cast<double>(i / 9) / 3);
      const Vec3 random(random_unit(n, 0, i), random_unit(n, 1, i), random_unit(n, 2, i));
      sites.push_back(box.min() + (n % 3 == 0 ? lattice : random).cwiseProduct(box.sizes()));
    }
    SilentProgress progress;
    const CutResult cut = cut_along(body, crack::voronoi_cells(sites, box, n, progress));
    failed += cut.status != geometry::CutStatus::ok;
    open += static_cast<double>(open_pieces(cut));
    pieces += static_cast<double>(cut.fragments.size());
    const geometry::MassProperties whole = geometry::mass_properties(body);
    double v = 0;
    Vec3 moment = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    for (const geometry::Fragment& f : cut.fragments) {
      const geometry::MassProperties m = geometry::mass_properties(f.mesh);
      v += m.volume;
      moment += m.volume * m.centroid;
      second += inertia_about_origin(m);
    }
    if (cut.fragments.empty()) continue;
    volume = std::max(volume, std::abs(v / whole.volume - 1));
    centre = std::max(centre, (moment / v - whole.centroid).norm() / box.diagonal().norm());
    inertia = std::max(inertia, (second - inertia_about_origin(whole)).norm() / inertia_about_origin(whole).norm());
  }
  Outcome outcome;
  outcome.checks = {absolute("100 random cuts: failed", failed, 0, 0),
                    within("fragments", pieces, 500, 1e5),
                    absolute("fragments that are not closed", open, 0, 0),
                    absolute("volume lost [body]", volume, 0, 1e-10),
                    absolute("centre of mass moved [diagonal]", centre, 0, 1e-9),
                    absolute("moment of inertia changed [body]", inertia, 0, 1e-9)};
  return outcome;
}

/// C8. Points on a jittered lattice of half the grid's spacing h; a linear time is exact also where only one side has
/// points, which Fan (2024) 3.13 is not: there a mean over one side stands for the node in the middle.
Outcome time_gradient() {
  constexpr double h = 0.1;
  const Vec3 slope(3, -2, 0.7), source(0.05, 0.03, 0.08);
  const auto field_of = [&](const Box& box, const Inside& inside, const std::function<double(const Vec3&)>& time) {
    const DamageField points = cloud(box, h / 2, inside, everywhere, 0.3);
    std::vector<double> times;
    for (const Vec3& x : points.points) times.push_back(time(x));
    return crack::TimeField(points.points, times, h);
  };
  const auto linear = [&](const Vec3& x) { return 5 + slope.dot(x); };
  const auto radius = [&](const Vec3& x) { return (x - source).norm(); };
  const crack::TimeField full = field_of(unit_cube(), everywhere, linear),
                         half = field_of(
                             unit_cube(), [](const Vec3&x) { return x[0] < 0.5; }, linear),
                         radial = field_of(Box(Vec3::Zero(), Vec3::Constant(1.5)), everywhere, radius);
  const auto error = [&](const crack::TimeField& field, const Vec3& x) {
    const auto sample = field.at(x);
    return sample ? (sample->gradient - slope).norm() / slope.norm() : 1;
  };
  double inside = 0, beside = 0, angle = 0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Vec3 u(random_unit(2, 0, i), random_unit(2, 1, i), random_unit(2, 2, i));
    inside = std::max(inside, error(full, Vec3::Constant(0.25) + 0.5 * u));
    beside = std::max(beside, error(half, Vec3(0.5, 0.2 + 0.6 * u[1], 0.2 + 0.6 * u[2])));
    const Vec3 x = Vec3::Constant(2 * h) + (1.5 - 4 * h) * u;
    if (radius(x) < 5 * h) continue;
    const auto sample = radial.at(x);
    const double cosine = sample ? sample->gradient.normalized().dot((x - source).normalized()) : -1;
    angle = std::max(angle, std::acos(std::min(1.0, cosine)) * 180 / std::numbers::pi);
  }
  Outcome outcome;
  outcome.checks = {absolute("linear times: gradient inside [its size]", inside, 0, 1e-12),
                    absolute("linear times: gradient at a free surface [its size]", beside, 0, 1e-12),
                    absolute("radial times: direction beyond 5 h [degrees]", angle, 0, 2)};
  return outcome;
}

/// C9. The same input gives the same bits, and a quarter turn the turned pieces.
Outcome determinism() {
  constexpr int n = 24;
  constexpr double h = 1.0 / n;
  const Vec3 a = Vec3(1, 2, 3).normalized(), b = Vec3(-2, 1, 0.5).normalized();
  const auto damaged = [&](const Vec3& x) {
    const Vec3 r = x - Vec3(0.507, 0.493, 0.511);
    return std::abs(a.dot(r)) <= slab * h / 2 || std::abs(b.dot(r)) <= slab * h / 2;
  };
  const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()).toRotationMatrix();
  const Vec3 middle = Vec3::Constant(0.5);
  const DamageField field = cloud(unit_cube(), h, everywhere, damaged);
  const DamageField turned = cloud(unit_cube(), h, everywhere,
                                   [&](const Vec3& x) { return damaged(turn.transpose() * (x - middle) + middle); });
  const Extraction first = extracted(field, unit_cube()), second = extracted(field, unit_cube());
  const auto v = volumes(cut_along(block(Vec3::Ones()), first.boundary)),
             w = volumes(cut_along(block(Vec3::Ones()), extracted(turned, unit_cube()).boundary));
  double changed = 0;
  for (std::size_t i = 0; i < std::min(v.size(), w.size()); ++i) changed = std::max(changed, std::abs(v[i] - w[i]));
  Outcome outcome;
  outcome.checks = {absolute("extracted twice: vertices that differ", first.vertices == second.vertices ? 0 : 1, 0, 0),
                    absolute("fragments", static_cast<double>(v.size()), 4, 0),
                    absolute("turned by 90 degrees: fragments", static_cast<double>(w.size()), 4, 0),
                    // Sites are jittered against cospherical ones by 1e-4 of the diagonal, in the lattice's order.
                    absolute("turned by 90 degrees: volumes that changed [cube]", changed, 0, 1e-3)};
  return outcome;
}

}  // namespace

std::vector<Problem> surfaces() {
  return {
      {"C1", "Planar sheets of damage, off the lattice", "the plane", planar_slabs,
       Study{
           "RMS distance of the crack from its plane [cube]", "nodes along the cube", {16, 32, 64}, 0.8, planar_error}},
      {"C2", "Sheets that stop short of the surface, or in the body", "two pieces; one", short_slabs},
      {"C3", "Junctions of three and four sheets", "sectors of a cube", junctions},
      {"C4", "Shell of damage in a cube", "volume of a ball; Euler", spherical_shell},
      {"C5", "Crack in one leg of a horseshoe", "the other leg stays whole", horseshoe},
      {"C6", "Sides of oblique cracks", "the plane", sides},
      {"C7", "Conservation and topology of 100 random cuts", "divergence theorem", conservation},
      {"C8", "Gradient of the damage time", "linear and radial fields", time_gradient},
      {"C9", "The same again, and turned by a quarter", "identity", determinism}};
}

}  // namespace sunder::validation
