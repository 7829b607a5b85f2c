#pragma once
/// Elasticity and damage of `width` points at once; see mpm/neo_hookean.h and mpm/rankine.h for the same point by
/// point. Always inline: which products the compiler contracts, and so the last bit, must not depend on where it finds
/// inlining worth its while.
#include "mpm/detail/lanes.h"

namespace sunder::mpm {
namespace {

struct Symmetric {
  Lanes xx, yy, zz, xy, xz, yz;
};

/// log(1 + x) to rounding. Strains are small nearly always: atanh series in x / (2 + x).
[[gnu::always_inline]] inline Lanes log1p(Lanes x) {
  constexpr double small = 0.02;
  const Lanes s = x / (2.0 + x), z = s * s;
  const Lanes series = 2.0 * s * (1.0 + z * (1.0 / 3 + z * (1.0 / 5 + z * (1.0 / 7 + z * (1.0 / 9)))));
  const Mask large = (x > small) | (x < -small);
  if (!any(large)) return series;
  Lanes exact = x;
  for (int n = 0; n < width; ++n) exact[n] = __builtin_log1p(x[n]);
  return large ? exact : series;
}

/// J - 1 without cancellation.
[[gnu::always_inline]] inline Lanes volume_change(const Lanes h[9]) {
  const Lanes trace = h[0] + h[4] + h[8];
  const Lanes m0 = h[4] * h[8] - h[5] * h[7], m1 = h[0] * h[8] - h[2] * h[6], m2 = h[0] * h[4] - h[1] * h[3];
  const Lanes det = h[0] * m0 - h[1] * (h[3] * h[8] - h[5] * h[6]) + h[2] * (h[3] * h[7] - h[4] * h[6]);
  return trace + (m0 + m1 + m2) + det;
}

struct NeoHookeanLanes {
  double mu, lambda;

  /// Cauchy stress (mu (b - I) + lambda ln J I) / J.
  [[gnu::always_inline]] Symmetric cauchy_stress(const Lanes h[9], Lanes dj) const {
    const Lanes inverse = 1.0 / (1.0 + dj), m = mu * inverse, pressure = inverse * lambda * log1p(dj);
    const auto row = [&](int i, int j) {
      return h[3 * i] * h[3 * j] + h[3 * i + 1] * h[3 * j + 1] + h[3 * i + 2] * h[3 * j + 2];
    };
    return {m * (2.0 * h[0] + row(0, 0)) + pressure, m * (2.0 * h[4] + row(1, 1)) + pressure,
            m * (2.0 * h[8] + row(2, 2)) + pressure, m * (h[1] + h[3] + row(0, 1)),
            m * (h[2] + h[6] + row(0, 2)),           m * (h[5] + h[7] + row(1, 2))};
  }
};

/// Where the largest principal stress may exceed r: mean + 2 sqrt(J2 / 3) does.
[[gnu::always_inline]] inline Mask may_exceed(const Symmetric& s, Lanes r) {
  const Lanes mean = (s.xx + s.yy + s.zz) * (1.0 / 3), x = s.xx - mean, y = s.yy - mean, z = s.zz - mean;
  const Lanes j2 = 0.5 * (x * x + y * y + z * z) + (s.xy * s.xy + s.xz * s.xz + s.yz * s.yz), left = r - mean;
  return (left < 0.0) | (4.0 / 3 * j2 > left * left);
}

/// Closed form. With B = (s - q I) / p, p^2 = B's norm^2 / 6, the roots b of b^3 - 3 b = 2 r, r = det B / 2, are the
/// principal stresses (s = q + p b). The isolated root, largest for r >= 0 and smallest otherwise, is found by Newton;
/// the other two are at its opposite half. Near a double root they are right to 1e-8 of the norm.
struct Principal {
  Symmetric b;  ///< normalised deviator
  Lanes q, p;
  Lanes root[3];  ///< ascending

  [[gnu::always_inline]] explicit Principal(const Symmetric& s) {
    q = (s.xx + s.yy + s.zz) * (1.0 / 3);
    const Lanes x = s.xx - q, y = s.yy - q, z = s.zz - q;
    const Lanes squared = (x * x + y * y + z * z + 2.0 * (s.xy * s.xy + s.xz * s.xz + s.yz * s.yz)) * (1.0 / 6);
    p = sqrt(squared);
    const Lanes inverse = 1.0 / max(p, all(1e-300));
    b = {x * inverse, y * inverse, z * inverse, s.xy * inverse, s.xz * inverse, s.yz * inverse};
    const Lanes r = 0.5 * (b.xx * (b.yy * b.zz - b.yz * b.yz) - b.xy * (b.xy * b.zz - b.yz * b.xz) +
                           b.xz * (b.xy * b.yz - b.yy * b.xz));
    const Mask negative = r < 0.0;
    const Lanes magnitude = min(negative ? -r : r, all(1.0));
    // Start within 2e-3 of the root in [sqrt(3), 2]; the error squares in every turn.
    Lanes g = 1.7320508 + magnitude * (0.3333333 - 0.0653842 * magnitude);
    for (int turn = 0; turn < 3; ++turn) g -= (g * (g * g - 3.0) - 2.0 * magnitude) / (3.0 * (g * g - 1.0));
    const Lanes half = 0.5 * g, apart = sqrt(max(3.0 * (1.0 - half * half), all(0.0)));
    root[0] = negative ? -g : -half - apart;
    root[1] = negative ? half - apart : apart - half;
    root[2] = negative ? half + apart : g;
  }

  Lanes value(int n) const { return q + p * root[n]; }

  /// Elastic energy of the tensile stresses per volume, sum of s_k e_k / 2 with the strains e of Hooke's law.
  [[gnu::always_inline]] Lanes tensile_energy(double mu, double lambda) const {
    const double nu = lambda / (2 * (lambda + mu)), modulus = 2 * mu * (1 + nu);
    const Lanes trace = 3.0 * q;
    Lanes sum = {};
    for (int k = 0; k < 3; ++k) {
      const Lanes v = value(k);
      sum += v > 0.0 ? v * ((1 + nu) * v - nu * trace) : Lanes{};
    }
    return (0.5 / modulus) * sum;
  }

  /// s+, the tensile part of s. Where the middle value is tensile it is s less the compressive part, so that only the
  /// projector on one direction whose value has the other sign than its neighbour is ever needed: its denominator may
  /// vanish no faster than that value.
  [[gnu::always_inline]] Symmetric tension(const Symmetric& s) const {
    const Mask from_below = value(1) > 0.0;
    const Lanes g = from_below ? root[0] : root[2];
    const Lanes v = from_below ? min(value(0), all(0.0)) : max(value(2), all(0.0));
    const Lanes denominator = 3.0 * (g * g - 1.0);
    const Lanes scale = v / ((denominator < 1e-30) & (denominator > -1e-30) ? all(1e-30) : denominator);
    const Lanes c = g * g - 3.0;
    const Symmetric part = {scale * (b.xx * b.xx + b.xy * b.xy + b.xz * b.xz + g * b.xx + c),
                            scale * (b.xy * b.xy + b.yy * b.yy + b.yz * b.yz + g * b.yy + c),
                            scale * (b.xz * b.xz + b.yz * b.yz + b.zz * b.zz + g * b.zz + c),
                            scale * (b.xx * b.xy + b.xy * b.yy + b.xz * b.yz + g * b.xy),
                            scale * (b.xx * b.xz + b.xy * b.yz + b.xz * b.zz + g * b.xz),
                            scale * (b.xy * b.xz + b.yy * b.yz + b.yz * b.zz + g * b.yz)};
    return {from_below ? s.xx - part.xx : part.xx, from_below ? s.yy - part.yy : part.yy,
            from_below ? s.zz - part.zz : part.zz, from_below ? s.xy - part.xy : part.xy,
            from_below ? s.xz - part.xz : part.xz, from_below ? s.yz - part.yz : part.yz};
  }
};

}  // namespace
}  // namespace sunder::mpm
