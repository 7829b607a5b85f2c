#include "geometry/poisson_disk.h"

#include <array>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "geometry/detail/box_tree.h"
#include "geometry/detail/inside.h"
#include "geometry/mass_properties.h"

namespace sunder::geometry {
namespace {

constexpr std::uint64_t kStream = 0x706f6973736f6e;
constexpr double kMostCells = 1 << 28, kMostAlong = 1 << 20;  // so that the last level can be counted with integers
// Darts per cell and level: more find room where it is large, fewer leave it to the next level.
constexpr double kDarts = 1;
constexpr int kMostLevels = 11;
constexpr int kReach = 2;  // a disk reaches this many cells of the grid

/// The cubes of the first level. Their diagonal is the radius, so each has room for one point at most.
struct Grid {
  Vec3 origin;
  double size;
  std::array<int, 3> count;

  int index(int i, int j, int k) const { return i + count[0] * (j + count[1] * k); }
};

Grid grid_over(const Box& box, double radius) {
  Grid grid{box.min(), radius / std::sqrt(3.0), {}};
  double cells = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double count = std::floor(box.diagonal()[axis] / grid.size) + 1;
    cells *= count;
    if (!(cells <= kMostCells && count <= kMostAlong))
      throw Error(ErrorKind::usage, "the radius is too small for the body");
    grid.count[axis] = static_cast<int>(count);
  }
  return grid;
}

/// A cube of some level that may have room: its place in the grid of that level.
struct Cell {
  std::array<int, 3> at;
  bool cut;  // the surface may pass through it
};

class Thrower {
 public:
  Thrower(const TriangleMesh& solid, double radius, std::uint64_t seed)
      : radius_(radius),
        seed_(seed),
        inside_(solid),
        tree_(solid.vertices, solid.faces),
        grid_(grid_over(bounds(solid), radius)),
        size_(grid_.size) {
    for (const auto& [a, b, c] : solid.faces) {
      meets_.emplace_back(solid.vertices[a], solid.vertices[b], solid.vertices[c]);
    }
    point_in_.assign(grid_.index(0, 0, grid_.count[2]), -1);
    for (int k = 0; k < grid_.count[2]; ++k) {
      for (int j = 0; j < grid_.count[1]; ++j) {
        for (int i = 0; i < grid_.count[0]; ++i) keep_if_inside({{i, j, k}, true}, open_);
      }
    }
  }

  std::size_t open_cells() const { return open_.size(); }
  double open_volume() const { return static_cast<double>(open_.size()) * size_ * size_ * size_; }

  /// Throws darts at the open cells of this level.
  void throw_darts(Progress& progress, double done) {
    constexpr std::size_t kBetweenReports = 4096;
    const auto darts = static_cast<std::size_t>(std::ceil(kDarts * static_cast<double>(open_.size())));
    for (std::size_t i = 0; i < darts && !open_.empty(); ++i) {
      if (i % kBetweenReports == 0) progress.checkpoint("poisson disk", done);
      const std::size_t chosen = random_word(seed_, kStream, words_++) % open_.size();
      const Cell cell = open_[chosen];
      bool closed = point_in_[first_level(cell)] >= 0;
      if (!closed) {
        Vec3 x = corner(cell);
        for (int axis = 0; axis < 3; ++axis) x[axis] += size_ * random_unit(seed_, kStream, words_++);
        closed = has_room(cell, x) && inside_(x) && !inside_.on_surface(x);
        if (closed) {
          point_in_[first_level(cell)] = static_cast<int>(points_.size());
          points_.push_back(x);
        }
      }
      if (!closed) continue;
      open_[chosen] = open_.back();
      open_.pop_back();
    }
  }

  /// Divides the open cells and drops the parts that are covered or outside.
  void divide() {
    std::vector<Cell> parts;
    size_ /= 2;
    ++level_;
    for (const Cell& cell : open_) {
      for (int child = 0; child < 8; ++child) {
        const Cell part{
            {2 * cell.at[0] + (child & 1), 2 * cell.at[1] + (child >> 1 & 1), 2 * cell.at[2] + (child >> 2)}, cell.cut};
        if (!is_covered(part)) keep_if_inside(part, parts);
      }
    }
    open_ = std::move(parts);
  }

  std::vector<Vec3> take() { return std::move(points_); }

 private:
  Vec3 corner(const Cell& cell) const { return grid_.origin + size_ * Vec3(cell.at[0], cell.at[1], cell.at[2]); }
  int first_level(const Cell& cell) const {
    return grid_.index(cell.at[0] >> level_, cell.at[1] >> level_, cell.at[2] >> level_);
  }

  void keep_if_inside(Cell cell, std::vector<Cell>& kept) const {
    const Vec3 low = corner(cell), half = Vec3::Constant(size_ / 2);
    if (cell.cut) {
      cell.cut = false;
      const Box box(low, low + 2 * half);
      tree_.visit([&](const Box& other) { return !cell.cut && box.intersects(other); },
                  [&](int face) { cell.cut |= meets_[face](box); });
      if (!cell.cut && !inside_(low + half)) return;
    }
    kept.push_back(cell);
  }

  /// Calls visit(point) for the points whose disks may reach into the cell, until it returns false.
  template <typename Visit>
  bool all_near(const Cell& cell, const Visit& visit) const {
    std::array<int, 3> low, high;
    for (int axis = 0; axis < 3; ++axis) {
      const int at = cell.at[axis] >> level_;
      low[axis] = std::max(0, at - kReach);
      high[axis] = std::min(grid_.count[axis] - 1, at + kReach);
    }
    for (int k = low[2]; k <= high[2]; ++k) {
      for (int j = low[1]; j <= high[1]; ++j) {
        for (int i = low[0]; i <= high[0]; ++i) {
          const int point = point_in_[grid_.index(i, j, k)];
          if (point >= 0 && !visit(points_[point])) return false;
        }
      }
    }
    return true;
  }

  bool has_room(const Cell& cell, const Vec3& x) const {
    return all_near(cell, [&](const Vec3& point) { return (point - x).norm() >= radius_; });
  }

  // By one disk; what several cover together is found when it is divided.
  bool is_covered(const Cell& cell) const {
    const Vec3 half = Vec3::Constant(size_ / 2), centre = corner(cell) + half;
    return !all_near(cell, [&](const Vec3& point) { return ((point - centre).cwiseAbs() + half).norm() >= radius_; });
  }

  double radius_;
  std::uint64_t seed_, words_ = 0;
  detail::InsideTest inside_;
  detail::BoxTree tree_;
  std::vector<detail::TriangleTest> meets_;  // per face
  Grid grid_;
  double size_;  // of the cells of this level
  int level_ = 0;
  std::vector<int> point_in_;  // per cell of the grid its point, or -1
  std::vector<Cell> open_;
  std::vector<Vec3> points_;
};

}  // namespace

std::vector<Vec3> poisson_disk(const TriangleMesh& solid, double radius, std::uint64_t seed, Progress& progress) {
  if (!(radius > 0) || !std::isfinite(radius)) throw Error(ErrorKind::usage, "the radius must be positive");
  const double volume = mass_properties(solid).volume;
  if (!(volume > 0)) throw Error(ErrorKind::mesh, "cannot fill a mesh without positive volume: repair it first");
  Thrower thrower(solid, radius, seed);
  for (int level = 0; level < kMostLevels; ++level) {
    thrower.throw_darts(progress, static_cast<double>(level) / kMostLevels);
    thrower.divide();
    if (thrower.open_volume() <= poisson_disk_left_over * volume) break;
  }
  progress.checkpoint("poisson disk", 1);
  return thrower.take();
}

}  // namespace sunder::geometry
