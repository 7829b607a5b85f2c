#include "mpm/loaded_patch.h"

#include <cmath>

namespace sunder::mpm {

LoadedPatch::LoadedPatch(const Continuum& body, const Vec3& point, const Vec3& outward, double radius)
    : outward_(outward), radius_(radius) {
  const double depth = 0.6 * std::max(radius, body.cell_size()) + 0.5 * body.cell_size();
  int nearest = 0;
  double nearest_distance = std::numeric_limits<double>::infinity(), sum = 0;
  for (int id = 0; id < body.size(); ++id) {
    const Vec3 r = body.material_position(id) - point;
    const double height = r.dot(outward), off_axis = (r - height * outward).norm();
    if (r.norm() < nearest_distance) {
      nearest_distance = r.norm();
      nearest = id;
    }
    // The upper bound keeps a patch inside a hollow from taking hold of the wall across.
    if (off_axis >= radius || height < -depth || height > depth) continue;
    particles_.push_back(id);
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

double LoadedPatch::indentation(const Continuum& body) const {
  double sum = 0;
  for (std::size_t n = 0; n < particles_.size(); ++n)
    sum -= weights_[n] * body.displacement(particles_[n]).dot(outward_);
  return sum;
}

bool LoadedPatch::drop_escaped(const Continuum& body) {
  double sum = 0;
  std::size_t kept = 0;
  for (std::size_t n = 0; n < particles_.size(); ++n) {
    if (body.escaped(particles_[n])) continue;
    particles_[kept] = particles_[n];
    sum += weights_[kept++] = weights_[n];
  }
  particles_.resize(kept);
  weights_.resize(kept);
  for (double& w : weights_) w /= sum;
  return kept > 0;
}

void LoadedPatch::push(double impulse, Continuum& body) const {
  for (std::size_t n = 0; n < particles_.size(); ++n) body.push(particles_[n], -impulse * weights_[n] * outward_);
}

}  // namespace sunder::mpm
