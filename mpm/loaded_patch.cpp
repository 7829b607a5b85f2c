#include "mpm/loaded_patch.h"

#include <cmath>

#include "mpm/quadratic_kernel.h"

namespace sunder::mpm {

LoadedPatch::LoadedPatch(const std::vector<Particle>& particles, const Vec3& point, const Vec3& outward, double radius,
                         double cell_size)
    : outward_(outward), radius_(radius) {
  const double depth = 0.6 * std::max(radius, cell_size) + 0.5 * cell_size;
  int nearest = 0;
  double nearest_distance = std::numeric_limits<double>::infinity(), sum = 0;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Vec3 r = particles[p].material_position - point;
    const double height = r.dot(outward), off_axis = (r - height * outward).norm();
    if (r.norm() < nearest_distance) {
      nearest_distance = r.norm();
      nearest = static_cast<int>(p);
    }
    // The upper bound keeps a patch inside a hollow from taking hold of the wall across.
    if (off_axis >= radius || height < -depth || height > depth) continue;
    particles_.push_back(static_cast<int>(p));
    weights_.push_back(std::sqrt(1 - off_axis * off_axis / (radius * radius)));
    sum += weights_.back();
  }
  if (particles_.empty()) {
    particles_ = {nearest};
    weights_ = {1.0};
    sum = 1;
  }
  for (double& w : weights_) w /= sum;
}

double LoadedPatch::indentation(const std::vector<Particle>& particles) const {
  double sum = 0;
  for (std::size_t n = 0; n < particles_.size(); ++n)
    sum -= weights_[n] * particles[static_cast<std::size_t>(particles_[n])].displacement.dot(outward_);
  return sum;
}

bool LoadedPatch::drop_escaped(const std::vector<Particle>& particles) {
  double sum = 0;
  std::size_t kept = 0;
  for (std::size_t n = 0; n < particles_.size(); ++n) {
    if (particles[static_cast<std::size_t>(particles_[n])].escaped) continue;
    particles_[kept] = particles_[n];
    sum += weights_[kept++] = weights_[n];
  }
  particles_.resize(kept);
  weights_.resize(kept);
  for (double& w : weights_) w /= sum;
  return kept > 0;
}

void LoadedPatch::push(const std::vector<Particle>& particles, double impulse, Grid& grid) const {
  for (std::size_t n = 0; n < particles_.size(); ++n) {
    const Particle& p = particles[static_cast<std::size_t>(particles_[n])];
    const QuadraticStencil s = quadratic_stencil(grid.to_cells(p.position()));
    const Vec3 kick = -impulse * weights_[n] * outward_;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 3; ++k)
          grid.node(grid.index(s.base[0] + static_cast<int>(i), s.base[1] + static_cast<int>(j),
                               s.base[2] + static_cast<int>(k)))
              .head<3>() += s.weight[0][i] * s.weight[1][j] * s.weight[2][k] * kick;
  }
}

}  // namespace sunder::mpm
