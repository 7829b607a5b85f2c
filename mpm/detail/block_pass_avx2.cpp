#include "mpm/detail/block_pass_impl.h"
#include "mpm/detail/instruction_sets.h"

namespace sunder::mpm {

const StepKernels quadratic_avx2 = kernels<QuadraticSpline>, cubic_avx2 = kernels<CubicSpline>;

}  // namespace sunder::mpm
