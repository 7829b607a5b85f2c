#pragma once
/// The same functions compiled for several instruction sets; cmake/sunder.cmake says which.
#include "mpm/block_pass.h"

namespace sunder::mpm {

extern const StepKernels quadratic_portable, cubic_portable, quadratic_avx2, cubic_avx2, quadratic_avx512, cubic_avx512;

}  // namespace sunder::mpm
