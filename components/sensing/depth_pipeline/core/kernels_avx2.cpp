#include "sensing/depth_pipeline/core/kernels.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include "sensing/depth_pipeline/core/kernels_loop.hpp"

namespace usher::depth_pipeline::kernels {

namespace {

struct Sixteen {
  using V = __m256i;
  static constexpr int kSize = 16;
  static V load(const std::uint16_t* p) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
  }
  static void store(std::uint16_t* p, V v) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), v);
  }
  static V all(std::uint16_t v) { return _mm256_set1_epi16(static_cast<short>(v)); }
  static V lower(V a, V b) { return _mm256_min_epu16(a, b); }
  static V higher(V a, V b) { return _mm256_max_epu16(a, b); }
  static V either(V a, V b) { return _mm256_or_si256(a, b); }
  static V both(V a, V b) { return _mm256_and_si256(a, b); }
  static V without(V a, V b) { return _mm256_andnot_si256(b, a); }
  static V flip(V a) { return _mm256_xor_si256(a, _mm256_set1_epi16(-1)); }
  static V equal(V a, V b) { return _mm256_cmpeq_epi16(a, b); }
  static V at_most(V a, V b) { return _mm256_cmpeq_epi16(_mm256_min_epu16(a, b), a); }
  static V choose(V yes, V a, V b) { return _mm256_blendv_epi8(b, a, yes); }
  static bool any(V a) { return _mm256_testz_si256(a, a) == 0; }
  static V add(V a, V b) { return _mm256_add_epi16(a, b); }
  static V subtract(V a, V b) { return _mm256_sub_epi16(a, b); }
  static V subtract_to_zero(V a, V b) { return _mm256_subs_epu16(a, b); }
  static V times_four(V a) { return _mm256_slli_epi16(a, 2); }
  static V high_product(V a, V b) { return _mm256_mulhi_epu16(a, b); }
};

}  // namespace

void process_avx2(const Frame& frame) { process<Sixteen>(frame); }

}  // namespace usher::depth_pipeline::kernels
#endif
