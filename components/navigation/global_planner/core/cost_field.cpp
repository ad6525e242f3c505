#include "navigation/global_planner/core/cost_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace usher::global_planner {
namespace {

StepCosts blocked_everywhere() {
  StepCosts steps{};
  steps.straight.fill(StepCosts::kBlocked);
  steps.diagonal.fill(StepCosts::kBlocked);
  return steps;
}

}  // namespace

StepCosts StepCosts::inflated(double neutral, double factor, bool allow_unknown, int unknown_cost) {
  StepCosts steps = blocked_everywhere();
  const auto weight = [&](int cost) {
    return static_cast<std::uint32_t>(std::lround(neutral + factor * cost));
  };
  const auto set = [&](std::size_t value, int cost) {
    steps.straight[value] = 70 * weight(cost);
    steps.diagonal[value] = 99 * weight(cost);
  };
  for (int cost = 0; cost < grid::kInscribedCost; ++cost) set(static_cast<std::size_t>(cost), cost);
  if (allow_unknown) set(grid::kUnknownCost, unknown_cost);
  steps.least_straight = 70 * weight(0);
  steps.least_diagonal = 99 * weight(0);
  steps.greatest_diagonal = 99 * weight(grid::kInscribedCost - 1);
  steps.uniform = factor == 0.0;
  return steps;
}

StepCosts StepCosts::shortest(bool allow_unknown) {
  StepCosts steps = blocked_everywhere();
  std::fill_n(steps.straight.begin(), grid::kInscribedCost, 408u);
  std::fill_n(steps.diagonal.begin(), grid::kInscribedCost, 577u);
  if (allow_unknown)
    steps.straight[grid::kUnknownCost] = 408, steps.diagonal[grid::kUnknownCost] = 577;
  steps.least_straight = 408;
  steps.least_diagonal = steps.greatest_diagonal = 577;
  steps.uniform = true;
  return steps;
}

void CostField::load(const CostGrid& costs) {
  if (costs.width() != width_ || costs.height() != height_) {
    width_ = costs.width();
    height_ = costs.height();
    stride_ = (width_ + 3 + 15) / 16 * 16;
    // Rows whose distance is a multiple of the page size fall on the same lines of the first cache.
    if (stride_ % 256 == 0) stride_ += 16;
    cells_.assign(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height_ + 2),
                  grid::kLethalCost);
  }
  for (int y = 0; y < height_; ++y)
    std::memcpy(cells_.data() + index({0, y}), costs.row(y), static_cast<std::size_t>(width_));
}

}  // namespace usher::global_planner
