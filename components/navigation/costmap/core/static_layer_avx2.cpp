#include "navigation/costmap/core/static_layer_kernels.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

namespace usher::costmap::static_layer_kernels {

namespace {

/// The integer parts of eight fixed-point numbers, four in each argument.
[[gnu::target("avx2")]] inline __m256i integer_parts(__m256i even, __m256i odd) {
  return _mm256_blend_epi32(_mm256_srli_epi64(even, 32), odd, 0b10101010);
}

/// Samples 0, 2, 4, 6 steps from the start.
[[gnu::target("avx2")]] inline __m256i every_second(std::int64_t start, std::int64_t step) {
  return _mm256_setr_epi64x(start, start + 2 * step, start + 4 * step, start + 6 * step);
}

}  // namespace

[[gnu::target("avx2")]] void sample_avx2(const std::uint8_t* map, int map_width,
                                         const StaticLayer::Run& run, std::uint8_t* states) {
  // Eight samples at a time: numbers 0, 2, 4, 6 in the even vectors and 1, 3, 5, 7 in the odd ones.
  __m256i x_even = every_second(run.x, run.step_x);
  __m256i x_odd = every_second(run.x + run.step_x, run.step_x);
  __m256i y_even = every_second(run.y, run.step_y);
  __m256i y_odd = every_second(run.y + run.step_y, run.step_y);
  const __m256i step_x = _mm256_set1_epi64x(8 * run.step_x);
  const __m256i step_y = _mm256_set1_epi64x(8 * run.step_y);
  const __m256i width = _mm256_set1_epi32(map_width);
  const __m256i byte = _mm256_set1_epi32(0xff);
  const auto* base = reinterpret_cast<const int*>(map);
  int i = 0;
  for (; i + 8 <= run.count; i += 8) {
    const __m256i index = _mm256_add_epi32(_mm256_mullo_epi32(integer_parts(y_even, y_odd), width),
                                           integer_parts(x_even, x_odd));
    const __m256i cells = _mm256_and_si256(_mm256_i32gather_epi32(base, index, 1), byte);
    const __m128i words =
        _mm_packus_epi32(_mm256_castsi256_si128(cells), _mm256_extracti128_si256(cells, 1));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(states + i), _mm_packus_epi16(words, words));
    x_even = _mm256_add_epi64(x_even, step_x);
    x_odd = _mm256_add_epi64(x_odd, step_x);
    y_even = _mm256_add_epi64(y_even, step_y);
    y_odd = _mm256_add_epi64(y_odd, step_y);
  }
  StaticLayer::Run rest = run;
  rest.x += i * run.step_x;
  rest.y += i * run.step_y;
  rest.count -= i;
  sample_portable(map, map_width, rest, states + i);
}

}  // namespace usher::costmap::static_layer_kernels
#endif
