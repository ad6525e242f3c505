#include "sensing/depth_pipeline/core/kernels.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include "sensing/depth_pipeline/core/kernels_loop.hpp"

namespace usher::depth_pipeline::kernels {

namespace {

struct Eight {
  using V = __m128i;
  static constexpr int kSize = 8;
  static V load(const std::uint16_t* p) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
  }
  static void store(std::uint16_t* p, V v) { _mm_storeu_si128(reinterpret_cast<__m128i*>(p), v); }
  static V all(std::uint16_t v) { return _mm_set1_epi16(static_cast<short>(v)); }
  static V lower(V a, V b) { return _mm_min_epu16(a, b); }
  static V higher(V a, V b) { return _mm_max_epu16(a, b); }
  static V either(V a, V b) { return _mm_or_si128(a, b); }
  static V both(V a, V b) { return _mm_and_si128(a, b); }
  static V without(V a, V b) { return _mm_andnot_si128(b, a); }
  static V flip(V a) { return _mm_xor_si128(a, _mm_set1_epi16(-1)); }
  static V equal(V a, V b) { return _mm_cmpeq_epi16(a, b); }
  static V at_most(V a, V b) { return _mm_cmpeq_epi16(_mm_min_epu16(a, b), a); }
  static V choose(V yes, V a, V b) { return _mm_blendv_epi8(b, a, yes); }
  static bool any(V a) { return _mm_testz_si128(a, a) == 0; }
  static V add(V a, V b) { return _mm_add_epi16(a, b); }
  static V subtract(V a, V b) { return _mm_sub_epi16(a, b); }
  static V subtract_to_zero(V a, V b) { return _mm_subs_epu16(a, b); }
  static V times_four(V a) { return _mm_slli_epi16(a, 2); }
  static V high_product(V a, V b) { return _mm_mulhi_epu16(a, b); }
};

}  // namespace

void process_sse41(const Frame& frame) { process<Eight>(frame); }

}  // namespace usher::depth_pipeline::kernels
#endif
