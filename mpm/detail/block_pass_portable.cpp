#include "mpm/detail/block_pass_impl.h"
#include "mpm/detail/instruction_sets.h"

namespace sunder::mpm {

const StepKernels quadratic_portable = kernels<QuadraticSpline>, cubic_portable = kernels<CubicSpline>;

}  // namespace sunder::mpm
