// The contact kernels for AVX2: four rows of the grid at a time. Same operations in the same order
// as contact.cpp.
#include "navigation/local_planner/core/contact.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include <algorithm>

namespace usher::local_planner::detail {
namespace {

#define USHER_AVX2 __attribute__((target("avx2")))

/// Ones in the lanes of rows that exist: `remaining` rows from here on.
USHER_AVX2 inline __m256i row_mask(int remaining) {
  const __m256i lane = _mm256_setr_epi64x(0, 1, 2, 3);
  return _mm256_cmpgt_epi64(_mm256_set1_epi64x(remaining), lane);
}

USHER_AVX2 inline __m256i load_rows(const std::uint64_t* words) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(words));
}

/// The lethal bits of four rows within the footprint's span on each.
USHER_AVX2 inline __m256i inside_spans(__m256i lethal, const TurnedFootprint& turned,
                                       const Rows& rows, int row, int base) {
  const __m256d line =
      _mm256_sub_pd(_mm256_add_pd(_mm256_set1_pd(row), _mm256_setr_pd(0.0, 1.0, 2.0, 3.0)),
                    _mm256_set1_pd(rows.y));
  __m256d low = _mm256_set1_pd(turned.min_x);
  __m256d high = _mm256_set1_pd(turned.max_x);
  for (int i = 0; i < turned.lower_count; ++i) {
    low = _mm256_max_pd(
        low, _mm256_add_pd(_mm256_broadcast_sd(turned.lower_intercept + i),
                           _mm256_mul_pd(_mm256_broadcast_sd(turned.lower_slope + i), line)));
  }
  for (int i = 0; i < turned.upper_count; ++i) {
    high = _mm256_min_pd(
        high, _mm256_add_pd(_mm256_broadcast_sd(turned.upper_intercept + i),
                            _mm256_mul_pd(_mm256_broadcast_sd(turned.upper_slope + i), line)));
  }
  low = _mm256_min_pd(low, _mm256_set1_pd(turned.max_x + 1.0));
  high = _mm256_max_pd(high, _mm256_set1_pd(turned.min_x - 1.0));
  const __m256d x = _mm256_set1_pd(rows.x);
  const __m128i column = _mm_set1_epi32(base);
  const __m128i first = _mm_max_epi32(
      _mm_sub_epi32(_mm256_cvttpd_epi32(_mm256_ceil_pd(_mm256_add_pd(x, low))), column),
      _mm_setzero_si128());
  const __m128i last =
      _mm_sub_epi32(_mm256_cvttpd_epi32(_mm256_floor_pd(_mm256_add_pd(x, high))), column);
  // Shift counts beyond 63, negative ones among them, give zero: an empty span has no bits.
  const __m256i ones = _mm256_set1_epi64x(-1);
  const __m256i from = _mm256_sllv_epi64(ones, _mm256_cvtepi32_epi64(first));
  const __m128i drop = _mm_max_epi32(_mm_sub_epi32(_mm_set1_epi32(63), last), _mm_setzero_si128());
  const __m256i to = _mm256_srlv_epi64(ones, _mm256_cvtepi32_epi64(drop));
  return _mm256_and_si256(lethal, _mm256_and_si256(from, to));
}

}  // namespace

USHER_AVX2 bool touches_avx2(const LethalBits& bits, const TurnedFootprint& turned,
                             const Rows& rows) {
  for (int base = rows.first_column; base <= rows.last_column; base += LethalBits::kSpan) {
    const std::uint64_t* words = bits.words(base / LethalBits::kStride);
    const __m128i shift = _mm_cvtsi32_si128(base % LethalBits::kStride);
    const int width = std::min(LethalBits::kSpan, rows.last_column - base + 1);
    const __m256i box =
        _mm256_set1_epi64x(static_cast<long long>(~std::uint64_t{0} >> (64 - width)));
    for (int row = rows.first; row <= rows.last; row += 4) {
      __m256i lethal = _mm256_and_si256(_mm256_srl_epi64(load_rows(words + row), shift), box);
      lethal = _mm256_and_si256(lethal, row_mask(rows.last - row + 1));
      if (_mm256_testz_si256(lethal, lethal)) continue;
      const __m256i inside = inside_spans(lethal, turned, rows, row, base);
      if (!_mm256_testz_si256(inside, inside)) return true;
    }
  }
  return false;
}

USHER_AVX2 bool any_avx2(const LethalBits& bits, const Rows& rows) {
  for (int base = rows.first_column; base <= rows.last_column; base += LethalBits::kSpan) {
    const std::uint64_t* words = bits.words(base / LethalBits::kStride);
    const int width = std::min(LethalBits::kSpan, rows.last_column - base + 1);
    const std::uint64_t box = (~std::uint64_t{0} >> (64 - width)) << (base % LethalBits::kStride);
    __m256i any = _mm256_setzero_si256();
    int row = rows.first;
    for (; row + 3 <= rows.last; row += 4) any = _mm256_or_si256(any, load_rows(words + row));
    any = _mm256_or_si256(any,
                          _mm256_and_si256(load_rows(words + row), row_mask(rows.last - row + 1)));
    const __m256i mask = _mm256_set1_epi64x(static_cast<long long>(box));
    if (!_mm256_testz_si256(any, mask)) return true;
  }
  return false;
}

}  // namespace usher::local_planner::detail
#endif
