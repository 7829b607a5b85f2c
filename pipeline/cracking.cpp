#include "pipeline/cracking.h"

#include <cmath>

#include "core/optional_effects.h"
#include "core/random.h"
#include "core/stopwatch.h"
#include "crack/hairlines.h"
#include "geometry/level_set_cut.h"
#include "geometry/mass_properties.h"

namespace sunder::pipeline {
namespace {

constexpr int exact_attempts = 4;
constexpr int attempts_with_hairlines = 3, attempts_with_detail = 3;
constexpr double narrowing = 4;  // of hairlines, from attempt to attempt: folded sheets have no room for wide gaps

crack::DamageTimes times_of(const crack::DamageField& field) {
  if (field.damage_time.empty()) return {};
  return {field.points, field.damage_time, field.spacing};
}

crack::Settings settings_of(const CrackChoice& choice, std::uint64_t seed) {
  crack::Settings settings;
  settings.node_spacing = choice.node_spacing;
  settings.debris_size = choice.debris_size;
  settings.seed = seed;
  return settings;
}

class Cracking {
 public:
  Cracking(const geometry::TriangleMesh& mesh, const CrackChoice& choice, std::uint64_t seed, Progress& progress)
      : mesh_(mesh), box_(geometry::bounds(mesh)), choice_(choice), seed_(seed), progress_(progress) {}

  void extract(const crack::DamageField& field, int attempt) {
    const Stopwatch watch(result_.extract_seconds);
    const std::uint64_t seed = random_word(seed_, 0xc7ac4, static_cast<std::uint64_t>(attempt));
    result_.extraction = crack::extract(field, box_, settings_of(choice_, seed), progress_);
    if (result_.extraction.retries > 0) count("voronoi_sites_jittered_anew", result_.extraction.retries);
    result_.boundary = result_.extraction.boundary;
  }

  void set_regions(geometry::RegionBoundary regions) { result_.boundary = std::move(regions); }

  /// False when there is nothing to cut.
  bool roughen(const crack::DamageTimes& times, int attempt) {
    const Stopwatch watch(result_.extract_seconds);
    first_gap_ = result_.boundary.region_count;
    result_.damage_time = result_.extraction.damage_time;
    result_.detailed_vertices.count = result_.detail_limited = result_.hairline_faces.count = 0;
    if (with_optional_effects && !choice_.detail.empty() && result_.boundary.region_count > 1)
      add_detail(times, attempt);
    if (with_optional_effects && choice_.hairline_width > 0) add_hairlines(attempt);
    return result_.boundary.region_count > 1;
  }

  bool cut_exactly() {
    const Stopwatch watch(result_.cut_seconds);
    result_.cut = geometry::cut(mesh_, result_.boundary, {}, progress_);
    if (result_.cut.nudges > 0) count("cut_regions_nudged", result_.cut.nudges);
    return take_out_gaps();
  }

  bool cut_on_voxels() {
    const Stopwatch watch(result_.cut_seconds);
    result_.cut = geometry::level_set_cut(mesh_, result_.boundary, {choice_.voxel_size}, progress_);
    return take_out_gaps();
  }

  void count(const char* fallback, int times = 1) { result_.fallbacks[fallback] += times; }
  void drop_fragments() { result_.cut.fragments.clear(); }
  Cracked take() { return std::move(result_); }

 private:
  void add_detail(const crack::DamageTimes& times, int attempt) {
    if (attempt >= attempts_with_detail) return count("surface_detail_dropped");
    const Stopwatch watch(result_.detailed_vertices.seconds);
    crack::DetailSettings settings = crack::detail_preset(choice_.detail, box_.sizes().maxCoeff());
    settings.seed = seed_;
    crack::DetailedBoundary detailed = crack::add_surface_detail(result_.boundary, box_, times, settings, progress_);
    result_.boundary = std::move(detailed.boundary);
    result_.damage_time = std::move(detailed.damage_time);
    result_.detailed_vertices.count = static_cast<long>(result_.boundary.vertices.size());
    result_.detail_limited = detailed.limited;
  }

  void add_hairlines(int attempt) {
    if (attempt >= attempts_with_hairlines) return count("hairlines_dropped");
    if (attempt > 0) count("hairlines_narrowed");
    const Stopwatch watch(result_.hairline_faces.seconds);
    const double width = choice_.hairline_width / std::pow(narrowing, attempt);
    const crack::Hairlines lines = crack::add_hairlines(result_.extraction, width, result_.boundary);
    first_gap_ = lines.first_gap;
    result_.damage_time.resize(result_.boundary.vertices.size(), -1);
    result_.hairline_faces.count = lines.faces;
  }

  /// Neighbours across a gap become outside.
  bool take_out_gaps() {
    if (result_.cut.status != geometry::CutStatus::ok) {
      result_.troubles.push_back("cut failed: " + result_.cut.detail);
      return false;
    }
    std::vector<geometry::Fragment>& fragments = result_.cut.fragments;
    std::vector<int> number;
    int kept = 0;
    for (const geometry::Fragment& fragment : fragments) number.push_back(fragment.region < first_gap_ ? kept++ : -1);
    for (geometry::Fragment& fragment : fragments)
      for (int& neighbour : fragment.neighbour)
        if (neighbour >= 0) neighbour = number[static_cast<std::size_t>(neighbour)];
    std::erase_if(fragments, [&](const geometry::Fragment& fragment) { return fragment.region >= first_gap_; });
    return true;
  }

  const geometry::TriangleMesh& mesh_;
  Box box_;
  const CrackChoice& choice_;
  std::uint64_t seed_;
  Progress& progress_;
  int first_gap_ = 0;
  Cracked result_;
};

/// `prepare(attempt)` sets the regions; false when there is nothing to cut.
template <typename Prepare>
Cracked attempt_until_cut(Cracking& cracking, bool level_set, Prepare&& prepare) {
  for (int attempt = 0; attempt < exact_attempts; ++attempt) {
    if (!prepare(attempt)) return cracking.take();
    if (level_set ? cracking.cut_on_voxels() : cracking.cut_exactly()) return cracking.take();
    cracking.count("cut_retried");
  }
  cracking.count("cut_level_set");
  if (!cracking.cut_on_voxels()) {
    cracking.count("fracture_abandoned");
    cracking.drop_fragments();
  }
  return cracking.take();
}

}  // namespace

Cracked crack_and_cut(const geometry::TriangleMesh& mesh, const crack::DamageField& field, const CrackChoice& choice,
                      std::uint64_t seed, Progress& progress) {
  Cracking cracking(mesh, choice, seed, progress);
  return attempt_until_cut(cracking, choice.level_set, [&](int attempt) {
    cracking.extract(field, attempt);
    return cracking.roughen(times_of(field), attempt);
  });
}

Cracked extract_only(const crack::DamageField& field, const CrackChoice& choice, std::uint64_t seed,
                     Progress& progress) {
  Box box;
  for (const Vec3& x : field.points) box.extend(x);
  Cracked result;
  const Stopwatch watch(result.extract_seconds);
  result.extraction = crack::extract(field, box, settings_of(choice, seed), progress);
  return result;
}

Cracked cut_regions(const geometry::TriangleMesh& mesh, geometry::RegionBoundary regions, const CrackChoice& choice,
                    std::uint64_t seed, Progress& progress) {
  Cracking cracking(mesh, choice, seed, progress);
  return attempt_until_cut(cracking, choice.level_set, [&](int attempt) {
    cracking.set_regions(regions);
    return cracking.roughen({}, attempt);
  });
}

}  // namespace sunder::pipeline
