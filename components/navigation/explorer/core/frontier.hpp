#pragma once

#include <cstdint>
#include <vector>

#include "navigation/explorer/core/strategy.hpp"

namespace usher::explorer {

/// Goes to the nearest border between what was seen and what was not [yamauchi1997frontier], and
/// looks across it.
class Frontier final : public Strategy {
 public:
  explicit Frontier(const StrategyConfig& config) : config_(config) {}

  void begin_round() override {}
  std::optional<Pose2> next(const Outlook& outlook) override;
  /// Until the unseen beyond the border was seen on the way.
  bool worth(const Pose2& view, SeenArea& seen) override;

 private:
  void mark_border(const SeenArea& seen);
  void take_piece(const SeenArea& seen, std::size_t first);
  std::optional<Pose2> view_of_piece(const Outlook& outlook) const;

  StrategyConfig config_;
  std::vector<std::uint8_t> border_;  // per cell: seen, with an unseen neighbor, not yet in a piece
  std::vector<std::uint32_t> piece_;  // cells of the border that hang together
};

}  // namespace usher::explorer
