/// Random damage in random bodies: cracks are found and cut; pieces are closed and together as large as the body.
#include <cmath>

#include "core/progress.h"
#include "crack/extract.h"
#include "geometry/cut.h"
#include "geometry/inspect.h"
#include "geometry/mass_properties.h"
#include "geometry/primitives.h"
#include "geometry/sample.h"
#include "tests/fuzz/bytes.h"

namespace {

using namespace sunder;

geometry::TriangleMesh body_of(fuzz::Dice& dice) {
  switch (dice.below(6)) {
    case 0:
      return geometry::box(Vec3(dice.real(0.05, 1), dice.real(0.05, 1), dice.real(0.05, 1)));
    case 1:
      return geometry::sphere(0.5, dice.below(3) + 1);
    case 2:
      return geometry::torus(0.5, dice.real(0.05, 0.3), 24, 12);
    case 3:
      return geometry::cup(1, dice.real(0.03, 0.09));
    case 4:
      return geometry::hollow_sphere(0.5, dice.real(0.03, 0.3), 2);
    default:
      return geometry::cylinder(0.3, dice.real(0.02, 1), 24);
  }
}

/// A sheet of damage: a plane, a sphere or a wave, which may end.
struct Sheet {
  int kind;
  Vec3 normal, centre;
  double radius, width, reach;

  explicit Sheet(fuzz::Dice& dice)
      : kind(dice.below(3)),
        normal(Vec3(dice.real(-1, 1), dice.real(-1, 1), dice.real(-1, 1)) + Vec3(1e-3, 0, 0)),
        centre(dice.real(-0.5, 0.5), dice.real(-0.5, 0.5), dice.real(-0.5, 0.5)),
        radius(dice.real(0.1, 0.5)),
        width(dice.real(0.5, 3)),
        reach(dice.real(0.1, 2)) {
    normal.normalize();
  }
  bool holds(const Vec3& x, double spacing) const {
    const Vec3 r = x - centre;
    if (r.norm() > reach) return false;
    const double height = kind == 0   ? normal.dot(r)
                          : kind == 1 ? r.norm() - radius
                                      : normal.dot(r) + 0.1 * std::sin(12 * normal.unitOrthogonal().dot(r));
    return std::abs(height) < width * spacing;
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Dice dice(data, size);
  SilentProgress progress;
  const geometry::TriangleMesh body = body_of(dice);
  const geometry::Samples samples = geometry::sample_solid(
      body, {.count = 200 + 40 * dice.below(32), .seed = static_cast<std::uint64_t>(dice.byte())}, progress);
  if (samples.points.empty()) return 0;
  crack::DamageField field{
      samples.points, std::vector<double>(samples.points.size(), 0), {}, samples.spacing, 2 * samples.spacing};
  for (int sheets = 1 + dice.below(6); sheets > 0 && !dice.empty(); --sheets) {
    const Sheet sheet(dice);
    for (std::size_t i = 0; i < samples.points.size(); ++i)
      if (sheet.holds(samples.points[i], samples.spacing)) field.damage[i] = 1;
  }
  const crack::Extraction cracks = crack::extract(field, geometry::bounds(body), {}, progress);
  fuzz::require(cracks.region.size() == field.points.size(), "every point has a region");
  if (cracks.region_count < 2) return 0;
  const geometry::CutResult cut = geometry::cut(body, cracks.boundary, {}, progress);
  if (cut.status != geometry::CutStatus::ok) return 0;  // said, and answered by the fallbacks of the pipeline
  double volume = 0;
  for (const geometry::Fragment& f : cut.fragments) {
    fuzz::require(geometry::inspect(f.mesh).is_solid(), "fragments are closed");
    volume += geometry::mass_properties(f.mesh).volume;
  }
  fuzz::require(std::abs(volume / geometry::mass_properties(body).volume - 1) < 1e-9, "no volume is lost");
  return 0;
}
