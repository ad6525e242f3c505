#include "navigation/global_planner/core/grid_search.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace usher::global_planner {
namespace {

constexpr std::uint32_t kUnseen = StepCosts::kBlocked - 1;
// What one search may cost at first; one that needs more clears all values and has (nearly) all of
// kUnseen. A multiple of a turn of the bucket ring, so that a stored value tells its bucket without
// taking off base_.
constexpr std::uint32_t kSpan = 1u << 26;
constexpr std::uint32_t kTop = StepCosts::kBlocked - kSpan;

// Directions counter-clockwise from east; odd ones are diagonal.
constexpr int kDx[8] = {1, 1, 0, -1, -1, -1, 0, 1};
constexpr int kDy[8] = {0, 1, 1, 1, 0, -1, -1, -1};

std::uint32_t packed(int x, int y) { return static_cast<std::uint32_t>(y << 16 | x); }
std::uint32_t three_costs(const std::uint8_t* first) {
  static_assert(std::endian::native == std::endian::little);
  std::uint32_t four = 0;
  std::memcpy(&four, first, sizeof four);
  return four & 0xffffff;
}
BandQueue::Entry make_entry(std::uint32_t value, std::uint32_t cell) {
  return static_cast<BandQueue::Entry>(value) << 32 | cell;
}

}  // namespace

inline std::uint32_t GridSearch::Target::estimate(std::uint32_t from) const {
  const auto dx = static_cast<std::uint32_t>(std::abs(static_cast<int>(from & 0xffff) - x));
  const auto dy = static_cast<std::uint32_t>(std::abs(static_cast<int>(from >> 16) - y));
  return straight * std::max(dx, dy) + bend * std::min(dx, dy);
}

SearchOutcome GridSearch::run(const CostField& field, grid::Cell start, grid::Cell goal,
                              bool informed) {
  assert(field.traversable(start) && field.traversable(goal));
  const auto search = [&] {
    prepare(field);
    if (field.steps().uniform)
      return informed ? attempt<true, true>(field, start, goal)
                      : attempt<false, true>(field, start, goal);
    return informed ? attempt<true, false>(field, start, goal)
                    : attempt<false, false>(field, start, goal);
  };
  if (values_.size() != field.size() || base_ < kSpan) {
    clear(field.size());
    ceiling_ = kTop;
  } else {
    ceiling_ = base_;
  }
  base_ = ceiling_ - kSpan;
  expanded_ = 0;
  const SearchOutcome outcome = search();
  if (outcome != SearchOutcome::kTooLong) return outcome;
  clear(field.size());
  ceiling_ = kTop;
  base_ = 0;
  return search();
}

void GridSearch::clear(std::size_t size) { values_.assign(size, kUnseen); }

void GridSearch::prepare(const CostField& field) {
  const StepCosts& steps = field.steps();
  band_shift_ = std::bit_width(steps.least_straight) - 1;
  // A step raises the estimated cost of the whole path by its own cost and a step away from the
  // goal.
  const std::uint32_t rise = steps.greatest_diagonal + steps.least_diagonal;
  bands_ = std::bit_ceil((rise >> band_shift_) + 2);
  queue_.reset(bands_ * 8, field.size() / 4);
}

template <bool kInformed, bool kUniform>
SearchOutcome GridSearch::attempt(const CostField& field, grid::Cell start, grid::Cell goal) {
  const StepCosts& steps = field.steps();
  const Target target{goal.x, goal.y, steps.least_straight,
                      steps.least_diagonal - steps.least_straight};
  const std::size_t goal_index = field.index(goal);
  values_[field.index(start)] = base_;
  std::uint64_t band = (kInformed ? target.estimate(packed(start.x, start.y)) : 0) >> band_shift_;
  const auto ring = [&] { return static_cast<std::uint32_t>(band) & (bands_ - 1); };
  for (std::uint32_t d = 0; d < 8; ++d)
    queue_.push(ring() * 8 + d, make_entry(base_, packed(start.x, start.y)));

  for (std::uint32_t empty_bands = 0; empty_bands < bands_; ++band) {
    const std::uint64_t least = band << band_shift_;
    if (values_[goal_index] < base_ + least) return SearchOutcome::kReached;
    if (least + (1ull << band_shift_) + steps.greatest_diagonal > ceiling_ - base_)
      return SearchOutcome::kTooLong;
    empty_bands = expand_band<kInformed, kUniform>(field, target, ring()) ? 0 : empty_bands + 1;
  }
  return SearchOutcome::kDisconnected;
}

template <bool kInformed, bool kUniform>
bool GridSearch::expand_band(const CostField& field, const Target& target, std::uint32_t band) {
  const auto waiting = [&] {
    bool any = false;
    for (std::uint32_t d = 0; d < 8; ++d) any |= !queue_.empty(band * 8 + d);
    return any;
  };
  if (!waiting()) return false;
  do {
    expand<kInformed, kUniform, 0>(field, target, band);
    expand<kInformed, kUniform, 1>(field, target, band);
    expand<kInformed, kUniform, 2>(field, target, band);
    expand<kInformed, kUniform, 3>(field, target, band);
    expand<kInformed, kUniform, 4>(field, target, band);
    expand<kInformed, kUniform, 5>(field, target, band);
    expand<kInformed, kUniform, 6>(field, target, band);
    expand<kInformed, kUniform, 7>(field, target, band);
  } while (waiting());
  return true;
}

template <bool kInformed, bool kUniform, int kDirection>
void GridSearch::expand(const CostField& field, const Target& target, std::uint32_t band) {
  constexpr std::uint32_t kBlocked = StepCosts::kBlocked;
  constexpr int d =
      kDirection;  // the names below are relative to it: d + 1 is 45 degrees to the left
  const std::ptrdiff_t stride = field.stride();
  const std::uint32_t* const straight = field.steps().straight.data();
  const std::uint32_t* const diagonal = field.steps().diagonal.data();
  const std::uint8_t* const costs = field.data();
  std::uint32_t* const values = values_.data();
  const std::uint32_t list_mask = (bands_ - 1) * 8;
  const int shift = band_shift_ - 3;  // lists are eight to a band
  std::uint32_t expanded = 0;

  const std::uint32_t list = band * 8 + kDirection;
  for (std::uint32_t at = queue_.begin(list); !queue_.at_end(list, at);) {
    const BandQueue::Entry entry = queue_.take(at);
    const auto here = static_cast<std::uint32_t>(entry);
    const auto value = static_cast<std::uint32_t>(entry >> 32);
    const std::ptrdiff_t cell = ((here >> 16) + 1) * stride + (here & 0xffff) + 1;
    if (values[cell] != value) continue;  // a cheaper way was found after this entry was made
    ++expanded;
    const auto offset = [&](int direction) __attribute__((always_inline)) {
      return kDx[direction & 7] + stride * kDy[direction & 7];
    };
    const auto straight_at = [&](int direction) __attribute__((always_inline)) {
      return straight[costs[cell + offset(direction)]];
    };
    // Whether all eight neighbours cost what this cell costs.
    const auto even_around = [&]() __attribute__((always_inline)) {
      const std::uint32_t beside = three_costs(costs + cell - 1);
      const std::uint32_t even = (beside >> 8 & 0xff) * 0x010101u;
      return ((beside ^ even) | (three_costs(costs + cell - stride - 1) ^ even) |
              (three_costs(costs + cell + stride - 1) ^ even)) == 0;
    };
    const auto diagonal_at = [&](int direction) __attribute__((always_inline)) {
      return diagonal[costs[cell + offset(direction)]];
    };
    // A blocked step is above kUnseen and so never better than what is there.
    const auto relax = [&](int direction, std::uint32_t step) __attribute__((always_inline)) {
      std::uint32_t& best = values[cell + offset(direction)];
      const std::uint32_t reached = value + step;
      if (reached >= best) return;
      best = reached;
      // The values of a whole map do not fit into a core's own cache: what lies behind is wanted
      // when this cell's turn comes.
      __builtin_prefetch(values + cell + 2 * offset(direction), 1);
      // Two's complement carries a step to the left or down through both halves.
      const std::uint32_t there =
          here + packed(kDx[direction & 7], 0) + packed(0, kDy[direction & 7]);
      const std::uint32_t total = reached + (kInformed ? target.estimate(there) : 0);
      queue_.push((total >> shift & list_mask) + static_cast<std::uint32_t>(direction & 7),
                  make_entry(reached, there));
    };
    const auto relax_diagonal = [&](int direction, std::uint32_t beside)
        __attribute__((always_inline)) {
      relax(direction, diagonal_at(direction) | (beside & kBlocked));
    };

    const bool even = !kUniform && even_around();
    if constexpr (d % 2 == 0) {
      const std::uint32_t ahead = straight_at(d);
      relax(d, ahead);
      if (even) continue;
      // In the open and on uniform costs the parent reaches both sides by a diagonal step of its
      // own.
      if (!kUniform || straight_at(d + 3) == kBlocked) {
        const std::uint32_t left = straight_at(d + 2);
        relax(d + 2, left);
        relax_diagonal(d + 1, ahead | left);
      }
      if (!kUniform || straight_at(d + 5) == kBlocked) {
        const std::uint32_t right = straight_at(d + 6);
        relax(d + 6, right);
        relax_diagonal(d + 7, ahead | right);
      }
    } else {
      const std::uint32_t left = straight_at(d + 1);
      const std::uint32_t right = straight_at(d + 7);
      relax(d + 1, left);
      relax(d + 7, right);
      relax_diagonal(d, left | right);
      if (!kUniform && !even) {
        relax_diagonal(d + 2, left | straight_at(d + 3));
        relax_diagonal(d + 6, right | straight_at(d + 5));
      }
    }
  }
  queue_.consume(list);
  expanded_ += expanded;
}

void GridSearch::trace(const CostField& field, grid::Cell to,
                       std::vector<grid::Cell>& cells) const {
  assert(reached(field, to));
  const StepCosts& steps = field.steps();
  const std::uint8_t* const costs = field.data();
  const std::ptrdiff_t stride = field.stride();
  cells.clear();
  cells.push_back(to);
  int direction = 0;
  for (auto cell = static_cast<std::ptrdiff_t>(field.index(to)); values_[cell] != base_;) {
    const auto blocked = [&](int d) {
      return steps.straight[costs[cell + kDx[d & 7] + stride * kDy[d & 7]]] == StepCosts::kBlocked;
    };
    // The values of the way here are no greater than this cell's less the step, so one neighbour at
    // least qualifies.
    std::uint32_t best = kUnseen;
    int best_direction = 0;
    for (int turn = 0; turn < 8; ++turn) {
      const int d = (direction + turn) & 7;  // straight on wins a tie
      const std::uint32_t value = values_[cell + kDx[d] + stride * kDy[d]];
      if (value >= ceiling_ || (d % 2 == 1 && (blocked(d + 1) || blocked(d + 7)))) continue;
      const std::uint32_t total =
          value + (d % 2 == 1 ? steps.diagonal : steps.straight)[costs[cell]];
      if (total < best) best = total, best_direction = d;
    }
    assert(best <= values_[cell]);
    direction = best_direction;
    to = {to.x + kDx[direction], to.y + kDy[direction]};
    cell += kDx[direction] + stride * kDy[direction];
    cells.push_back(to);
  }
  std::reverse(cells.begin(), cells.end());
}

}  // namespace usher::global_planner
