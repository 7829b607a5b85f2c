#include "mpm/neo_hookean.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/mpm/bodies.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

Mat3 random_gradient(std::uint64_t n, double size) {
  Mat3 h;
  for (int k = 0; k < 9; ++k) h(k / 3, k % 3) = size * (2 * random_unit(3, n, static_cast<std::uint64_t>(k)) - 1);
  return h;
}

Mat3 textbook_stress(const Material& m, const Mat3& h) {
  const Mat3 f = Mat3::Identity() + h;
  const double j = f.determinant();
  return (m.shear_modulus() * (f * f.transpose() - Mat3::Identity()) +
          m.lame_lambda() * std::log(j) * Mat3::Identity()) /
         j;
}

/// First Piola-Kirchhoff stress J sigma F^-T.
Mat3 piola(const NeoHookean& law, const Mat3& h) {
  const double dj = volume_change(h);
  const Mat3 f = Mat3::Identity() + h;
  return (1 + dj) * law.cauchy_stress(h, dj) * f.inverse().transpose();
}

TEST(VolumeChange, IsTheDeterminantMinusOne) {
  for (std::uint64_t n = 0; n < 1000; ++n) {
    const Mat3 h = random_gradient(n, 0.5);
    EXPECT_NEAR(volume_change(h), (Mat3::Identity() + h).determinant() - 1, 1e-14);
  }
}

TEST(VolumeChange, KeepsItsDigitsAtTinyStrains) {
  const double e = 1e-11;
  // (1 + e)^3 - 1 = 3e + 3e^2 + e^3; the determinant of F keeps five digits of it.
  EXPECT_NEAR(volume_change(e * Mat3::Identity()) / (3 * e + 3 * e * e + e * e * e), 1, 1e-15);
}

TEST(NeoHookean, StressIsTheTextbookFormula) {
  const Material glass = fixture::glass();
  const NeoHookean law(glass);
  for (std::uint64_t n = 0; n < 1000; ++n) {
    const Mat3 h = random_gradient(n, 0.1);
    const Mat3 stress = law.cauchy_stress(h, volume_change(h));
    EXPECT_LT((stress - textbook_stress(glass, h)).norm(), 1e-13 * glass.youngs_modulus);
    EXPECT_EQ(stress, Mat3(stress.transpose()));
  }
}

TEST(NeoHookean, IsHookeanAtSmallStrain) {
  const Material glass = fixture::glass();
  const NeoHookean law(glass);
  const double size = 1e-9;
  const Mat3 h = random_gradient(1, size), strain = 0.5 * (h + h.transpose());
  const Mat3 hooke = 2 * glass.shear_modulus() * strain + glass.lame_lambda() * strain.trace() * Mat3::Identity();
  // The next term is quadratic in the strain.
  EXPECT_LT((law.cauchy_stress(h, volume_change(h)) - hooke).norm(), 10 * size * hooke.norm());
}

TEST(NeoHookean, ARotationCarriesNoStress) {
  const NeoHookean law(fixture::glass());
  const Mat3 q = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Mat3 h = q - Mat3::Identity();
  EXPECT_LT(law.cauchy_stress(h, volume_change(h)).norm(), 1e-14 * fixture::glass().youngs_modulus);
  EXPECT_NEAR(law.energy(h), 0, 1e-14 * fixture::glass().youngs_modulus);
}

TEST(NeoHookean, RotatesWithTheBody) {
  const NeoHookean law(fixture::glass());
  const Mat3 q = Eigen::AngleAxisd(2.0, Vec3(3, -2, 1).normalized()).toRotationMatrix();
  const Mat3 h = random_gradient(5, 0.05), rotated = q * (Mat3::Identity() + h) - Mat3::Identity();
  const Mat3 stress = law.cauchy_stress(h, volume_change(h));
  EXPECT_LT((law.cauchy_stress(rotated, volume_change(rotated)) - q * stress * q.transpose()).norm(),
            1e-12 * stress.norm());
}

// Problem A11.
TEST(NeoHookean, PiolaStressIsTheDerivativeOfTheEnergyFromCrushedToTenfold) {
  const NeoHookean law(fixture::glass());
  for (double s : {1e-3, 1e-2, 0.1, 0.5, 1.0, 2.0, 10.0}) {
    Mat3 h = random_gradient(9, 0.02);
    h(0, 0) = s - 1;
    const double step = 1e-6 * std::min(1.0, s);
    const Mat3 p = piola(law, h);
    for (int n = 0; n < 9; ++n) {
      Mat3 up = h, down = h;
      up(n / 3, n % 3) += step;
      down(n / 3, n % 3) -= step;
      EXPECT_NEAR((law.energy(up) - law.energy(down)) / (2 * step), p(n / 3, n % 3), 1e-6 * p.norm()) << "s = " << s;
    }
  }
}

}  // namespace
