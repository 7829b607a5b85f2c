/// What exact predicates rest on.
#include <CGAL/Interval_nt.h>
#include <gtest/gtest.h>

namespace sunder::geometry {
namespace {

TEST(Predicates, ArithmeticRoundsAsTold) {
  using Interval = CGAL::Interval_nt<true>;
  const Interval product = Interval(1.1) * Interval(10.1), quotient = Interval(1) / Interval(10);
  EXPECT_LT(product.inf(), product.sup());
  EXPECT_LT(quotient.inf(), quotient.sup());
}

}  // namespace
}  // namespace sunder::geometry
