#pragma once

#include <cstdint>

#include "navigation/costmap/core/inflation.hpp"

// Bodies that are compiled once for every instruction set (they inline into functions with that
// target), and the AVX2 entry points. Included by inflation.cpp and inflation_avx2.cpp only.
namespace usher::costmap::inflation_kernels {

/// to[x] = 0 at occupied cells, else none.
[[gnu::always_inline]] inline void seed(const std::uint8_t* __restrict states, std::uint8_t none,
                                        int count, std::uint8_t* __restrict to) {
  for (int x = 0; x < count; ++x) {
    to[x] = static_cast<std::uint8_t>(none & (states[x] == kSeenOccupied ? 0 : 0xff));
  }
}

/// to[x] = min(from[x], from[x - step] + step, from[x + step] + step); from is readable `step`
/// cells beyond both ends.
[[gnu::always_inline]] inline void spread(const std::uint8_t* __restrict from, int step, int count,
                                          std::uint8_t* __restrict to) {
  const auto added = static_cast<std::uint8_t>(step);
  for (int x = 0; x < count; ++x) {
    const std::uint8_t left = from[x - step];
    const std::uint8_t right = from[x + step];
    const std::uint8_t near = left < right ? left : right;
    const auto there = static_cast<std::uint8_t>(near + added);
    to[x] = from[x] < there ? from[x] : there;
  }
}

/// Costs of a block for any radius: the smallest squared distance, then the table.
[[gnu::always_inline]] inline void block_by_squares(const Inflation::Kernel& kernel,
                                                    const std::uint8_t* center,
                                                    std::uint8_t* costs) {
  std::int16_t best[Inflation::kBlock];
  for (int x = 0; x < Inflation::kBlock; ++x)
    best[x] = static_cast<std::int16_t>(center[x] * center[x]);
  for (int dy = 1; dy <= kernel.reach; ++dy) {
    const std::uint8_t* above = center + dy * kernel.stride;
    const std::uint8_t* below = center - dy * kernel.stride;
    const auto vertical = static_cast<std::int16_t>(dy * dy);
    for (int x = 0; x < Inflation::kBlock; ++x) {
      const std::int16_t near = above[x] < below[x] ? above[x] : below[x];
      const auto squared = static_cast<std::int16_t>(near * near + vertical);
      best[x] = best[x] < squared ? best[x] : squared;
    }
  }
  for (int x = 0; x < Inflation::kBlock; ++x) costs[x] = kernel.squared[best[x]];
}

#if defined(__x86_64__)
void seed_avx2(const std::uint8_t* states, std::uint8_t none, int count, std::uint8_t* to);
void spread_avx2(const std::uint8_t* from, int step, int count, std::uint8_t* to);
/// Radii up to 14 cells: one shuffle per pair of rows.
void block_avx2_near(const Inflation::Kernel& kernel, const std::uint8_t* center,
                     std::uint8_t* costs);
/// Radii up to 30 cells: two shuffles.
void block_avx2_wide(const Inflation::Kernel& kernel, const std::uint8_t* center,
                     std::uint8_t* costs);
void block_avx2_any(const Inflation::Kernel& kernel, const std::uint8_t* center,
                    std::uint8_t* costs);
#endif

}  // namespace usher::costmap::inflation_kernels
