/// What exact predicates rest on.
#include <CGAL/Interval_nt.h>
#include <gtest/gtest.h>

namespace sunder::geometry {
namespace {

TEST(Predicates, ArithmeticRoundsAsTold) {
  const CGAL::Protect_FPU_rounding<true> up;
  EXPECT_NE(-CGAL_IA_MUL(-1.1, 10.1), CGAL_IA_MUL(1.1, 10.1));
  EXPECT_NE(-CGAL_IA_DIV(-1.0, 10.0), CGAL_IA_DIV(1.0, 10.0));
}

}  // namespace
}  // namespace sunder::geometry
