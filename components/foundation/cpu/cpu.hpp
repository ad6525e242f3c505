#pragma once

namespace usher::cpu {

/// Instruction sets that kernels are written for, in rising order.
enum class Simd { kPortable = 0, kSse41 = 1, kAvx2 = 2 };

/// The best set that this processor has. A kernel takes the set as an argument (default: this), so
/// that a test can compare all sets that the machine has.
inline Simd best_simd() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return Simd::kAvx2;
  if (__builtin_cpu_supports("sse4.1")) return Simd::kSse41;
#endif
  return Simd::kPortable;
}

}  // namespace usher::cpu
