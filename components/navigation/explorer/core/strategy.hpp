#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "foundation/random/random.hpp"
#include "navigation/explorer/core/ground.hpp"
#include "navigation/explorer/core/seen_area.hpp"

namespace usher::explorer {

enum class StrategyKind : std::uint8_t {
  kInformationGain,  ///< where most is seen for the time that it takes
  kFrontier,         ///< to the nearest border of what was seen [yamauchi1997frontier]
  kCell,             ///< a point drawn in each square of the map, the nearest next, then smaller
                     ///< squares (III-B-5 of the meeting report)
  kGrid,             ///< the same on the crossings of a grid
};

struct StrategyConfig {
  StrategyKind kind = StrategyKind::kInformationGain;
  std::vector<double> levels{4.0, 2.0, 1.0};  ///< [m] of kCell and kGrid: 1 to 8 sides, [0.2, 50]
  double least_gain = 0.1;         ///< [m2] less that is unseen is worth no view; [0.01, 10]
  double candidate_spacing = 0.5;  ///< [m] of kInformationGain: squares with a place each; [0.2, 5]
  double usual_speed = 0.5;        ///< [m/s] kept on a way; [0.05, 2]
  double turn_rate = 0.5;          ///< [rad/s] in place; [0.05, 3]
  double stop_time = 1.5;          ///< [s] that a stop costs; [0, 10]
  double give_up_radius = 0.4;     ///< [m] around a viewpoint that could not be reached; [0, 5]
};

/// What a viewpoint is chosen from. The ways of `ground` start at the robot.
struct Outlook {
  SeenArea& seen;
  Ground& ground;
  Pose2 robot;
  std::span<const Point2> given_up;  ///< viewpoints of this round that could not be reached
};

/// Whether a point lies at a viewpoint that could not be reached.
bool is_given_up(const Outlook& outlook, const Point2& point, double radius);
/// [cells] of `area` m2, at least 1.
std::size_t cells_of(const SeenArea& seen, double area);

/// Chooses viewpoints: poses to drive to. Same map, seed and calls, same viewpoints.
class Strategy {
 public:
  virtual ~Strategy() = default;
  /// Everything is to be looked at again; also after a new map.
  virtual void begin_round() = 0;
  /// The next viewpoint, reachable; nothing when the round is over.
  virtual std::optional<Pose2> next(const Outlook& outlook) = 0;
  /// Whether a viewpoint on the way to which more was seen is still worth to go there.
  virtual bool worth(const Pose2& view, SeenArea& seen) = 0;
};

/// The error names the value that is out of its range.
Result<std::unique_ptr<Strategy>> make_strategy(const StrategyConfig& config, std::uint64_t seed);

}  // namespace usher::explorer
