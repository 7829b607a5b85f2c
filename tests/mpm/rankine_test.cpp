#include "mpm/rankine.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/random.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

constexpr double infinity = std::numeric_limits<double>::infinity();
/// The closed-form eigen solver of a 3 x 3 matrix is good to the root of the rounding where eigenvalues coincide.
constexpr double eigen_tolerance = 1e-7;

Mat3 random_stress(std::uint64_t n) {
  Mat3 a;
  for (int k = 0; k < 9; ++k) a(k / 3, k % 3) = 2e6 * random_unit(11, n, static_cast<std::uint64_t>(k)) - 1e6;
  return 0.5 * (a + a.transpose());
}

Mat3 random_rotation(std::uint64_t n) {
  const Vec3 axis(random_unit(12, n, 0) - 0.5, random_unit(12, n, 1) - 0.5, random_unit(12, n, 2) - 0.5);
  return Eigen::AngleAxisd(6.3 * random_unit(12, n, 3), axis.normalized()).toRotationMatrix();
}

TEST(Softening, RunsFromStrengthToZeroStress) {
  const double strength = 3e6, slope = 0.5;
  const Softening law{strength, slope, 1};
  EXPECT_EQ(law.damage(0), 0);
  EXPECT_EQ(law.damage(strength), 0);
  EXPECT_GT(law.damage(1.001 * strength), 0);
  // Complete at r = strength (1 + 1 / H), where the stress (1 - c) r is zero.
  EXPECT_NEAR(law.damage(strength * (1 + 1 / slope)), 1, 1e-15);
  EXPECT_EQ(law.damage(100 * strength), 1);
  // Linear in between: (1 - c) r = strength - H (r - strength).
  const double r = 2 * strength;
  EXPECT_NEAR((1 - law.damage(r)) * r, strength - slope * (r - strength), 1e-9 * strength);
}

TEST(Softening, FailsAtOnceWhenTheSlopeIsInfinite) {
  const Softening law{3e6, infinity, 1};
  EXPECT_EQ(law.damage(3e6), 0);
  EXPECT_EQ(law.damage(3.0001e6), 1);
}

TEST(MakeSoftening, KeepsTheMaterialBelowTheAdmissibleLength) {
  const double e = 32e9, strength = 3.08e6, energy = 3, band = 1e-3;
  const Softening law = make_softening(e, strength, energy, band, CoarseGrid::lower_strength);
  EXPECT_EQ(law.strength, strength);
  EXPECT_EQ(law.fracture_energy, energy);
  // The area under the law per volume times the band is the fracture energy.
  EXPECT_NEAR((1 + 1 / law.slope) * strength * strength / (2 * e) * band, energy, 1e-12 * energy);
}

TEST(PrincipalStress, IsSortedOrthonormalAndRebuildsTheTensor) {
  for (std::uint64_t n = 0; n < 2000; ++n) {
    const Mat3 s = random_stress(n);
    const PrincipalStress p = principal_stress(s);
    EXPECT_LE(p.value[0], p.value[1]);
    EXPECT_LE(p.value[1], p.value[2]);
    EXPECT_LT((p.direction.transpose() * p.direction - Mat3::Identity()).norm(), eigen_tolerance);
    EXPECT_LT((p.direction * p.value.asDiagonal() * p.direction.transpose() - s).norm(), eigen_tolerance * s.norm());
  }
}

TEST(LargestPrincipalStress, IsTheLastOfAllThree) {
  for (std::uint64_t n = 0; n < 2000; ++n) {
    const Mat3 s = random_stress(n);
    const PrincipalStress all = principal_stress(s);
    const LargestPrincipalStress largest = largest_principal_stress(s);
    EXPECT_NEAR(largest.value, all.value[2], 1e-7 * s.norm());
    EXPECT_NEAR(largest.direction.norm(), 1, 1e-12);
    EXPECT_LT((s * largest.direction - largest.value * largest.direction).norm(), 1e-6 * s.norm());
  }
}

TEST(LargestPrincipalStress, OfEqualValuesIsAnyDirectionAcrossTheThird) {
  for (const Vec3& values : {Vec3(2, 2, -1), Vec3(2, 2, 2), Vec3(0, 0, 0), Vec3(5, 1, 1), Vec3(-1, -1, -3)}) {
    const LargestPrincipalStress largest = largest_principal_stress(values.asDiagonal());
    EXPECT_NEAR(largest.value, values.maxCoeff(), 1e-7);
    EXPECT_NEAR(largest.direction.norm(), 1, 1e-12);
    EXPECT_LT((values.asDiagonal() * largest.direction - largest.value * largest.direction).norm(), 1e-6);
  }
}

TEST(DamagedStress, TakesAwayTensionOnly) {
  for (std::uint64_t n = 0; n < 200; ++n) {
    const Mat3 s = random_stress(n);
    const PrincipalStress p = principal_stress(s);
    const Mat3 half = damaged_stress(p, 0.5), none = damaged_stress(p, 1);
    EXPECT_LE(principal_stress(none).value[2], 1e-6 * s.norm());
    EXPECT_NEAR(principal_stress(half).value[0], std::min(p.value[0], 0.5 * p.value[0]), eigen_tolerance * s.norm());
    EXPECT_LT((damaged_stress(p, 0) - s).norm(), eigen_tolerance * s.norm());
    EXPECT_LT((half - half.transpose()).norm(), 1e-14 * s.norm());
  }
}

// Problem B4.
TEST(DamagedStress, CompressionIsNeverDamaged) {
  const Softening law{1e6, 0.5, 1};
  for (double p : {1e5, 1e6, 1e9, 1e12}) {
    for (const Vec3& v : {Vec3(-p, 0, 0), Vec3(-p, -p, -p), Vec3(-p, -2 * p, -3 * p)}) {
      const PrincipalStress s = principal_stress(v.asDiagonal());
      EXPECT_EQ(law.damage(s.value[2]), 0);
      // After damage compression still carries: the crack closes.
      EXPECT_LT((damaged_stress(s, 1) - Mat3(v.asDiagonal())).norm(), 1e-12 * p);
    }
  }
}

TEST(DamagedStress, PureShearFailsAtTheStrengthAtFortyFiveDegrees) {
  const double tau = 2.5e6;
  Mat3 s = Mat3::Zero();
  s(0, 1) = s(1, 0) = tau;
  const PrincipalStress p = principal_stress(s);
  EXPECT_NEAR(p.value[2], tau, 1e-12 * tau);
  EXPECT_NEAR(std::abs(p.direction.col(2).dot(Vec3(1, 1, 0).normalized())), 1, 1e-12);
}

TEST(DamagedStress, RotatesWithTheStress) {
  for (std::uint64_t n = 0; n < 500; ++n) {
    // Well separated eigenvalues: there the directions are known to rounding.
    const Mat3 s = Vec3(-2e6, 1e6, 3e6).asDiagonal();
    const Mat3 q = random_rotation(n), turned = q * s * q.transpose();
    EXPECT_NEAR(principal_stress(turned).value[2], 3e6, 1e-12 * 3e6);
    const Mat3 expected = q * damaged_stress(principal_stress(s), 0.7) * q.transpose();
    EXPECT_LT((damaged_stress(principal_stress(turned), 0.7) - expected).norm(), 1e-12 * s.norm());
  }
}

TEST(DamagedStress, EqualEigenvaluesStayFiniteAndSymmetric) {
  for (const Vec3& v : {Vec3(1, 1, 1), Vec3(-1, -1, -1), Vec3(1, 1, -2), Vec3(2, -1, -1), Vec3(0, 0, 0)}) {
    for (std::uint64_t n = 0; n < 50; ++n) {
      const Mat3 q = random_rotation(n);
      Mat3 s = 1e6 * q * v.asDiagonal() * q.transpose();
      s = 0.5 * (s + s.transpose()).eval();
      const Mat3 damaged = damaged_stress(principal_stress(s), 0.5);
      const Mat3 expected = 1e6 * q * Vec3(v.array().max(0) * 0.5 + v.array().min(0)).asDiagonal() * q.transpose();
      ASSERT_TRUE(damaged.allFinite());
      EXPECT_LT((damaged - damaged.transpose()).norm(), 1e-9);
      EXPECT_LT((damaged - expected).norm(), eigen_tolerance * 1e6);
    }
  }
}

}  // namespace
