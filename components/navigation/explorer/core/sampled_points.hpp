#pragma once

#include <vector>

#include "navigation/explorer/core/strategy.hpp"

namespace usher::explorer {

/// The meeting report's way: points in squares or on a grid, each time joined from the robot to the
/// nearest one, from there to the nearest of the rest and so on (distances as the crow flies); one
/// level of point distances after the other. Looks at each point to where it goes next.
class SampledPoints final : public Strategy {
 public:
  SampledPoints(const StrategyConfig& config, std::uint64_t seed)
      : config_(config), random_(seed) {}

  void begin_round() override;
  std::optional<Pose2> next(const Outlook& outlook) override;
  /// Always: the report's robot goes to each of its points.
  bool worth(const Pose2&, SeenArea&) override { return true; }

 private:
  void sample(const Outlook& outlook, double side);

  StrategyConfig config_;
  Random random_;
  std::size_t level_ = 0;
  std::vector<Point2> points_;  // in the order of visits, from next_ on
  std::size_t next_ = 0;
};

}  // namespace usher::explorer
