#include "geometry/sample.h"

#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "core/error.h"
#include "core/random.h"
#include "geometry/detail/inside.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry {
namespace {

constexpr double kThin = 6;      // extents below this many spacings are layered
constexpr int kLargeFaces = 16;  // faces whose normals are tried as thin directions
constexpr int kAttempts = 4;
constexpr double kCountTolerance = 0.01;  // an attempt this close to the wanted count is taken
// In-plane rotation of the lattice in a plate: a generic angle, far from the symmetries of the square.
constexpr double kPlateAngle = 0.39;
constexpr std::uint64_t kJitterStream = 0x73616d706c65;  // one stream per axis, counted from here

/// Lattice cells: cell (i, j, k) is centred at origin + axes * (size * (i + 1/2, j + 1/2, k + 1/2)).
struct Lattice {
  Mat3 axes;
  Vec3 origin, size;
  std::array<int, 3> count;
};

/// Directions in which extents are measured, and the body's span along each of them.
struct Frame {
  Mat3 axes;
  Vec3 low, extent;
};

Frame measured(const TriangleMesh& mesh, const Mat3& axes) {
  Box box;
  for (const Vec3& vertex : mesh.vertices) box.extend((axes.transpose() * vertex).eval());
  return {axes, box.min(), box.diagonal()};
}

double extent(const TriangleMesh& mesh, const Vec3& direction) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec3& vertex : mesh.vertices) {
    low = std::min(low, direction.dot(vertex));
    high = std::max(high, direction.dot(vertex));
  }
  return high - low;
}

// Directions in which a body is likely to be thin: coordinate and principal axes, and the normals of its largest faces.
std::vector<Vec3> candidate_directions(const TriangleMesh& mesh, const MassProperties& mass) {
  std::vector<Vec3> result = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(mass.inertia);
  for (int i = 0; i < 3; ++i) result.push_back(principal.eigenvectors().col(i));
  std::vector<std::pair<double, int>> faces;
  std::vector<Vec3> normals;
  for (const auto& [a, b, c] : mesh.faces) {
    const Vec3& at = mesh.vertices[a];
    normals.push_back((mesh.vertices[b] - at).cross(mesh.vertices[c] - at));
    faces.emplace_back(-normals.back().squaredNorm(), static_cast<int>(faces.size()));
  }
  const auto end = faces.begin() + std::min<std::ptrdiff_t>(kLargeFaces, static_cast<std::ptrdiff_t>(faces.size()));
  std::partial_sort(faces.begin(), end, faces.end());
  for (auto face = faces.begin(); face != end; ++face) result.push_back(normals[face->second].normalized());
  return result;
}

// The candidate, made normal to `fixed` (zero: any direction), in which the body is thinnest.
Vec3 thinnest(const TriangleMesh& mesh, const std::vector<Vec3>& candidates, const Vec3& fixed) {
  Vec3 best = Vec3::Zero();
  double best_extent = std::numeric_limits<double>::infinity();
  for (const Vec3& candidate : candidates) {
    const Vec3 direction = candidate - candidate.dot(fixed) * fixed;
    if (direction.norm() < 0.5) continue;
    const double width = extent(mesh, direction.normalized());
    // A later candidate has to be clearly better: rounding must not pick between equal ones.
    if (width < best_extent * (1 - 1e-9)) std::tie(best, best_extent) = std::pair(Vec3(direction.normalized()), width);
  }
  return best;
}

// Found by search: no lattice axis is within 25 degrees of a side, a diagonal or a space diagonal of the world's cube,
// or vice versa.
Mat3 generic_rotation() { return Quat(0.17, 0.17, 0.15, -0.96).normalized().toRotationMatrix(); }

Lattice covering(const Frame& frame, const Vec3& size) {
  Lattice lattice{frame.axes, frame.axes * frame.low, size, {}};
  for (int i = 0; i < 3; ++i) lattice.count[i] = static_cast<int>(std::ceil(frame.extent[i] / size[i]));
  return lattice;
}

Frame plate_frame(const TriangleMesh& mesh, const Vec3& across, const Vec3& along) {
  Mat3 axes;
  axes << along, across.cross(along), across;
  const Mat3 turn = Eigen::AngleAxisd(kPlateAngle, Vec3::UnitZ()).toRotationMatrix();
  return measured(mesh, axes * turn);
}

double layer(double extent, double spacing) { return extent / std::max(1.0, std::round(extent / spacing)); }

/// The lattices for one body: how cells are laid out does not depend on their volume, so that it can be tuned.
class Layout {
 public:
  Layout(const TriangleMesh& mesh, const MassProperties& mass, double spacing) : spacing_(spacing) {
    const std::vector<Vec3> candidates = candidate_directions(mesh, mass);
    const Vec3 across = thinnest(mesh, candidates, Vec3::Zero());
    const Vec3 second = thinnest(mesh, candidates, across);
    Mat3 axes;
    axes << second.cross(across), second, across;
    frame_ = measured(mesh, axes);
    const bool plate = frame_.extent.z() < kThin * spacing, rod = frame_.extent.y() < kThin * spacing;
    layered_ = rod ? 2 : plate ? 1 : 0;
    if (layered_ == 0) frame_ = measured(mesh, generic_rotation());
    if (layered_ == 1) frame_ = plate_frame(mesh, across, second);
  }

  Lattice lattice(double cell_volume) const {
    Vec3 size = Vec3::Constant(std::cbrt(cell_volume));
    if (layered_ >= 1) size.z() = layer(frame_.extent.z(), spacing_);
    if (layered_ == 1) size.x() = size.y() = std::sqrt(cell_volume / size.z());
    if (layered_ == 2) {
      size.y() = layer(frame_.extent.y(), spacing_);
      size.x() = layer(frame_.extent.x(), cell_volume / (size.y() * size.z()));
    }
    return covering(frame_, size);
  }

 private:
  double spacing_;
  int layered_ = 0;  // axes across which the layers are even: Z, then Y
  Frame frame_;
};

std::vector<Vec3> points_inside(const detail::InsideTest& inside, const Lattice& lattice,
                                const SampleSettings& settings, Progress& progress) {
  std::vector<Vec3> points;
  std::uint64_t index = 0;
  for (int k = 0; k < lattice.count[2]; ++k) {
    progress.checkpoint("sample", static_cast<double>(k) / lattice.count[2]);
    for (int j = 0; j < lattice.count[1]; ++j) {
      for (int i = 0; i < lattice.count[0]; ++i, ++index) {
        Vec3 cell(i + 0.5, j + 0.5, k + 0.5);
        for (int axis = 0; axis < 3; ++axis) {
          cell[axis] += settings.jitter * (2 * random_unit(settings.seed, kJitterStream + axis, index) - 1);
        }
        const Vec3 point = lattice.origin + lattice.axes * lattice.size.cwiseProduct(cell);
        if (inside(point)) points.push_back(point);
      }
    }
  }
  return points;
}

}  // namespace

Samples sample_solid(const TriangleMesh& solid, const SampleSettings& settings, Progress& progress) {
  if (settings.count < 1) throw Error(ErrorKind::usage, "the number of sample points must be positive");
  const MassProperties mass = mass_properties(solid);
  if (!(mass.volume > 0)) throw Error(ErrorKind::mesh, "cannot sample a mesh without positive volume: repair it first");
  Samples result;
  result.spacing = std::cbrt(mass.volume / settings.count);
  const detail::InsideTest inside(solid);
  const Layout layout(solid, mass, result.spacing);
  double cell_volume = mass.volume / settings.count;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::vector<Vec3> points = points_inside(inside, layout.lattice(cell_volume), settings, progress);
    const auto miss = [&](const std::vector<Vec3>& x) {
      return std::abs(static_cast<double>(x.size()) / settings.count - 1);
    };
    const double ratio = std::max<double>(1, points.size()) / settings.count;
    if (result.points.empty() || miss(points) < miss(result.points)) result.points = std::move(points);
    if (miss(result.points) < kCountTolerance) break;
    cell_volume *= ratio;
  }
  if (result.points.empty()) throw Error(ErrorKind::mesh, "no sample point falls inside the mesh: ask for more points");
  return result;
}

}  // namespace sunder::geometry
