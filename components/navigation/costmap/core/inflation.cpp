#include "navigation/costmap/core/inflation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "navigation/costmap/core/inflation_kernels.hpp"

namespace usher::costmap {

namespace {

void seed_portable(const std::uint8_t* states, std::uint8_t none, int count, std::uint8_t* to) {
  inflation_kernels::seed(states, none, count, to);
}

void spread_portable(const std::uint8_t* from, int step, int count, std::uint8_t* to) {
  inflation_kernels::spread(from, step, count, to);
}

void block_portable(const Inflation::Kernel& kernel, const std::uint8_t* center,
                    std::uint8_t* costs) {
  inflation_kernels::block_by_squares(kernel, center, costs);
}

Inflation::BlockFunction block_function(int reach, cpu::Simd simd) {
#if defined(__x86_64__)
  if (simd == cpu::Simd::kAvx2) {
    if (reach <= 14) return inflation_kernels::block_avx2_near;
    if (reach <= 30) return inflation_kernels::block_avx2_wide;
    return inflation_kernels::block_avx2_any;
  }
#endif
  return static_cast<void>(reach), static_cast<void>(simd), block_portable;
}

Inflation::SeedFunction seed_function(cpu::Simd simd) {
#if defined(__x86_64__)
  if (simd == cpu::Simd::kAvx2) return inflation_kernels::seed_avx2;
#endif
  return static_cast<void>(simd), seed_portable;
}

Inflation::SpreadFunction spread_function(cpu::Simd simd) {
#if defined(__x86_64__)
  if (simd == cpu::Simd::kAvx2) return inflation_kernels::spread_avx2;
#endif
  return static_cast<void>(simd), spread_portable;
}

/// Does any cell of the block have another value?
bool differs(const std::uint8_t* block, std::uint8_t value) {
  std::uint64_t words[Inflation::kBlock / sizeof(std::uint64_t)];
  std::memcpy(words, block, sizeof(words));
  std::uint64_t difference = 0;
  for (const std::uint64_t word : words) difference |= word ^ (0x0101010101010101U * value);
  return difference != 0;
}

/// 1, 2, 4, ... and a rest, together `reach`.
std::vector<int> doubling_steps(int reach) {
  std::vector<int> steps;
  for (int step = 1, left = reach; left > 0; step *= 2) {
    steps.push_back(std::min(step, left));
    left -= steps.back();
  }
  return steps;
}

}  // namespace

Inflation::Inflation(int width, int height, double resolution, const CostDecay& decay,
                     Unseen unseen, cpu::Simd simd)
    : width_(width),
      height_(height),
      reach_(static_cast<int>(std::floor(decay.inflation_radius / resolution + 1e-6))),
      blocks_((width + kBlock - 1) / kBlock),
      stride_(blocks_ * kBlock),
      none_(static_cast<std::uint8_t>(reach_ + 1)),
      unseen_below_(unseen == Unseen::kFree      ? 0
                    : unseen == Unseen::kUnknown ? kInscribedCost
                                                 : 1),
      steps_(doubling_steps(reach_)),
      states_(offset(height), kUnseen),
      distances_(offset(height + 2 * reach_), none_),
      active_(static_cast<std::size_t>(height + 2 * reach_) * static_cast<std::size_t>(blocks_), 0),
      active_around_(static_cast<std::size_t>(blocks_), 0),
      scratch_a_(static_cast<std::size_t>(stride_ + 4 * reach_ + 4), none_),
      scratch_b_(scratch_a_),
      tables_(static_cast<std::size_t>((reach_ + 1) * kTable), 0),
      squared_(static_cast<std::size_t>(none_ * none_ + reach_ * reach_ + 1), 0),
      block_(block_function(reach_, simd)),
      seed_(seed_function(simd)),
      spread_(spread_function(simd)) {
  assert(reach_ >= 0 && reach_ <= kMaxReach);
  for (std::size_t square = 0; square < squared_.size(); ++square) {
    squared_[square] = decay.at(resolution * std::sqrt(static_cast<double>(square)));
  }
  for (int dy = 0; dy <= reach_; ++dy) {
    for (int dx = 0; dx <= std::min(reach_, kTable - 1); ++dx) {
      tables_[static_cast<std::size_t>(dy * kTable + dx)] =
          squared_[static_cast<std::size_t>(dy * dy + dx * dx)];
    }
  }
}

CellRect Inflation::update(const CellRect& changed, grid::Grid<std::uint8_t>& master) {
  assert(master.width() == width_ && master.height() == height_);
  const CellRect dirty = changed.within({0, 0, width_, height_});
  if (dirty.empty()) return {};
  const CellRect reached = dirty.grown(reach_).within({0, 0, width_, height_});
  const int first_block = reached.x0 / kBlock;
  const int last_block = (reached.x1 + kBlock - 1) / kBlock;
  for (int y = dirty.y0; y < dirty.y1; ++y) measure_row(y, first_block, last_block);

  std::fill(active_around_.begin() + first_block, active_around_.begin() + last_block, 0);
  const auto count_row = [&](int y, int sign) {
    const std::uint8_t* active = active_row(y);
    for (int b = first_block; b < last_block; ++b)
      active_around_[static_cast<std::size_t>(b)] += sign * active[b];
  };
  for (int y = reached.y0 - reach_; y < reached.y0 + reach_; ++y) count_row(y, 1);
  for (int y = reached.y0; y < reached.y1; ++y) {
    count_row(y + reach_, 1);
    write_row(y, first_block, last_block, master.row(y));
    count_row(y - reach_, -1);
  }
  return {first_block * kBlock, reached.y0, std::min(width_, last_block * kBlock), reached.y1};
}

// Distances within the row for whole blocks. The scratch rows start `reach` cells left of the first
// block and end as far right of the last, since those cells can reach into them. Another `reach` on
// both sides can be read by a step, but is too far away to matter.
void Inflation::measure_row(int y, int first_block, int last_block) {
  const int first = first_block * kBlock;
  const int count = (last_block - first_block) * kBlock;
  std::uint8_t* distances = distance_row(y) + first;
  std::uint8_t* active = active_row(y);
  const int from = std::max(0, first - reach_);
  const int to = std::min(width_, first + count + reach_);
  const std::uint8_t* states = state_row(y);
  if (std::memchr(states + from, kSeenOccupied, static_cast<std::size_t>(to - from)) == nullptr) {
    std::memset(distances, none_, static_cast<std::size_t>(count));
    std::memset(active + first_block, 0, static_cast<std::size_t>(last_block - first_block));
    return;
  }
  const int span = count + 2 * reach_;
  std::uint8_t* a = scratch_a_.data() + reach_;
  std::uint8_t* b = scratch_b_.data() + reach_;
  std::memset(a, none_, static_cast<std::size_t>(span));
  seed_(states + from, none_, to - from, a + (from - (first - reach_)));
  for (const int step : steps_) {
    spread_(a, step, span, b);
    std::swap(a, b);
  }
  std::memcpy(distances, a + reach_, static_cast<std::size_t>(count));
  for (int block = first_block; block < last_block; ++block) {
    active[block] = differs(a + reach_ + (block - first_block) * kBlock, none_);
  }
}

void Inflation::write_row(int y, int first_block, int last_block, std::uint8_t* master_row) {
  const Kernel kernel{reach_, stride_, tables_.data(), squared_.data()};
  const std::uint8_t* distances = distance_row(y);
  const std::uint8_t* states = state_row(y);
  for (int block = first_block; block < last_block; ++block) {
    alignas(kBlock) std::uint8_t costs[kBlock];
    if (active_around_[static_cast<std::size_t>(block)] > 0) {
      block_(kernel, distances + block * kBlock, costs);
    } else {
      std::memset(costs, kFreeCost, kBlock);
    }
    const std::uint8_t* seen = states + block * kBlock;
    for (int x = 0; x < kBlock; ++x) {
      const bool unknown = (seen[x] == kUnseen) & (costs[x] < unseen_below_);
      costs[x] = unknown ? kUnknownCost : costs[x];
    }
    const int cells = width_ - block * kBlock;
    if (cells >= kBlock) {
      std::memcpy(master_row + block * kBlock, costs, kBlock);  // a constant size costs no call
    } else {
      std::memcpy(master_row + block * kBlock, costs, static_cast<std::size_t>(cells));
    }
  }
}

}  // namespace usher::costmap
