#include "navigation/costmap/core/inflation_kernels.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

namespace usher::costmap::inflation_kernels {

namespace {

[[gnu::target("avx2")]] inline __m256i load(const std::uint8_t* cells) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(cells));
}

[[gnu::target("avx2")]] inline __m256i table(const std::uint8_t* entries) {
  return _mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(entries)));
}

}  // namespace

[[gnu::target("avx2")]] void seed_avx2(const std::uint8_t* states, std::uint8_t none, int count,
                                       std::uint8_t* to) {
  seed(states, none, count, to);
}

[[gnu::target("avx2")]] void spread_avx2(const std::uint8_t* from, int step, int count,
                                         std::uint8_t* to) {
  spread(from, step, count, to);
}

[[gnu::target("avx2")]] void block_avx2_any(const Inflation::Kernel& kernel,
                                            const std::uint8_t* center, std::uint8_t* costs) {
  block_by_squares(kernel, center, costs);
}

[[gnu::target("avx2")]] void block_avx2_near(const Inflation::Kernel& kernel,
                                             const std::uint8_t* center, std::uint8_t* costs) {
  const std::uint8_t* entries = kernel.tables;
  const std::uint8_t* above = center;
  const std::uint8_t* below = center;
  __m256i best = _mm256_shuffle_epi8(table(entries), load(center));
  for (int dy = 1; dy <= kernel.reach; ++dy) {
    above += kernel.stride;
    below -= kernel.stride;
    entries += Inflation::kTable;
    const __m256i near = _mm256_min_epu8(load(above), load(below));
    best = _mm256_max_epu8(best, _mm256_shuffle_epi8(table(entries), near));
  }
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(costs), best);
}

[[gnu::target("avx2")]] void block_avx2_wide(const Inflation::Kernel& kernel,
                                             const std::uint8_t* center, std::uint8_t* costs) {
  // A shuffle gives zero where bit 7 of the index is set: distances of 16 and more in the first
  // table, below 16 in the second.
  const __m256i to_first = _mm256_set1_epi8(0x70);
  const __m256i to_second = _mm256_set1_epi8(16);
  const std::uint8_t* entries = kernel.tables;
  const std::uint8_t* above = center;
  const std::uint8_t* below = center;
  __m256i best = _mm256_setzero_si256();
  for (int dy = 0; dy <= kernel.reach; ++dy) {
    const __m256i near = _mm256_min_epu8(load(above), load(below));
    const __m256i first = _mm256_shuffle_epi8(table(entries), _mm256_adds_epu8(near, to_first));
    const __m256i second =
        _mm256_shuffle_epi8(table(entries + 16), _mm256_sub_epi8(near, to_second));
    best = _mm256_max_epu8(best, _mm256_or_si256(first, second));
    above += kernel.stride;
    below -= kernel.stride;
    entries += Inflation::kTable;
  }
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(costs), best);
}

}  // namespace usher::costmap::inflation_kernels
#endif
