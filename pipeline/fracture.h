#pragma once
/// One body breaks: sample, solve, extract, cut. Values in, values out; nothing here knows of worlds or scenes.
#include <memory>
#include <vector>

#include "core/progress.h"
#include "geometry/cut.h"
#include "geometry/mesh.h"
#include "geometry/sample.h"
#include "mpm/solve.h"
#include "pipeline/cracking.h"
#include "pipeline/material.h"

namespace sunder::pipeline {

/// Wall-clock seconds by stage.
struct StageSeconds {
  double sample = 0, solve = 0, extract = 0, cut = 0;
};

/// The particles of a body with the damage that they took: kept while the body stays whole, so that the next hit finds
/// the cracks of the last one.
struct Particles {
  geometry::Samples samples;  ///< in the body's frame
  mpm::PriorDamage damage;
};

struct FractureInput {
  geometry::TriangleMesh mesh;  ///< closed solid, in the body's frame [m]
  Material material;
  std::vector<mpm::Load> loads;  ///< in the body's frame; their points need to lie near the surface only
  std::vector<mpm::Partner> partners;
  mpm::SolveSettings solve;
  CrackChoice crack;
  int particles = 20000;                           ///< to fill the body with, unless it has its own
  double nearly_whole = 0.98;                      ///< a piece of this share of the body keeps its particles
  std::shared_ptr<const Particles> own = nullptr;  ///< of an earlier solve
  std::uint64_t seed = 1;
};

/// A piece with the motion of its own material.
struct BrokenPiece {
  geometry::Fragment fragment;
  Twist twist;  ///< of its centre of mass, in the body's frame, relative to the body before the impact
  std::shared_ptr<const Particles> own = nullptr;  ///< of a piece that is nearly the whole body, in its frame
};

struct FractureOutcome {
  std::vector<BrokenPiece> pieces;                 ///< fewer than two: the body stays whole
  std::shared_ptr<const Particles> own = nullptr;  ///< of the body, should it stay whole
  mpm::SolveResult solve;
  Cracked cracked;  ///< its fragments are those of `pieces`, or the body with hairlines if that is all there is
  double damaged_share = 0;
  long particles = 0;
  StageSeconds seconds;
  Fallbacks fallbacks;
};

/// Errors: those of mpm::solve and of the interruption. When nothing can cut the body it stays whole and the fallback
/// "fracture_abandoned" is counted.
FractureOutcome fracture(const FractureInput& input, Progress& progress);

/// The same of several bodies side by side on all threads; the outcomes do not depend on the order in which they
/// finish. Errors: the first of them by the order of the inputs.
std::vector<FractureOutcome> fracture_all(const std::vector<FractureInput>& inputs, Progress& progress);

}  // namespace sunder::pipeline
