#include "mpm/detail/block_pass_impl.h"
#include "mpm/detail/instruction_sets.h"

namespace sunder::mpm {

const StepKernels quadratic_avx512 = kernels<QuadraticSpline>, cubic_avx512 = kernels<CubicSpline>;

}  // namespace sunder::mpm
