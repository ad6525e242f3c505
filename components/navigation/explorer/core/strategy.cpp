#include "navigation/explorer/core/strategy.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/result/bounds.hpp"
#include "navigation/explorer/core/frontier.hpp"
#include "navigation/explorer/core/information_gain.hpp"
#include "navigation/explorer/core/sampled_points.hpp"

namespace usher::explorer {

Result<std::unique_ptr<Strategy>> make_strategy(const StrategyConfig& config, std::uint64_t seed) {
  Status status = within({{"levels", static_cast<double>(config.levels.size()), 1, 8},
                          {"least_gain", config.least_gain, 0.01, 10.0, "m2"},
                          {"candidate_spacing", config.candidate_spacing, 0.2, 5.0, "m"},
                          {"usual_speed", config.usual_speed, 0.05, 2.0, "m/s"},
                          {"turn_rate", config.turn_rate, 0.05, 3.0, "rad/s"},
                          {"stop_time", config.stop_time, 0.0, 10.0, "s"},
                          {"give_up_radius", config.give_up_radius, 0.0, 5.0, "m"}});
  for (const double level : config.levels) {
    if (status) status = within({{"levels", level, 0.2, 50.0, "m"}});
  }
  if (!status) return Error{status.error()};
  std::unique_ptr<Strategy> strategy;
  switch (config.kind) {
    case StrategyKind::kInformationGain:
      strategy = std::make_unique<InformationGain>(config, seed);
      break;
    case StrategyKind::kFrontier:
      strategy = std::make_unique<Frontier>(config);
      break;
    case StrategyKind::kCell:
    case StrategyKind::kGrid:
      strategy = std::make_unique<SampledPoints>(config, seed);
      break;
  }
  return strategy;
}

bool is_given_up(const Outlook& outlook, const Point2& point, double radius) {
  for (const Point2& other : outlook.given_up) {
    if ((point - other).norm() <= radius) return true;
  }
  return false;
}

std::size_t cells_of(const SeenArea& seen, double area) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(area / seen.cell_area())));
}

}  // namespace usher::explorer
