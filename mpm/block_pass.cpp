#include "mpm/block_pass.h"

#include "mpm/detail/instruction_sets.h"

namespace sunder::mpm {

bool has(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (set == InstructionSet::avx512)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
#endif
  return set == InstructionSet::portable;
}

InstructionSet best_instruction_set() {
  if (has(InstructionSet::avx512)) return InstructionSet::avx512;
  return has(InstructionSet::avx2) ? InstructionSet::avx2 : InstructionSet::portable;
}

const char* name_of(InstructionSet set) {
  switch (set) {
    case InstructionSet::portable:
      return "portable";
    case InstructionSet::avx2:
      return "AVX2";
    case InstructionSet::avx512:
      return "AVX-512";
  }
  return "";
}

const StepKernels& step_kernels(Spline spline, InstructionSet set) {
  const bool quadratic = spline == Spline::quadratic;
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return quadratic ? quadratic_avx512 : cubic_avx512;
  if (set == InstructionSet::avx2) return quadratic ? quadratic_avx2 : cubic_avx2;
#endif
  return quadratic ? quadratic_portable : cubic_portable;
}

}  // namespace sunder::mpm
