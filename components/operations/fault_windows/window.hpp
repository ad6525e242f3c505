#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "operations/experiments/run_record.hpp"
#include "operations/fault_windows/fault.hpp"
#include "operations/fault_windows/judge.hpp"
#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// The robot that the windows hit, and whom they may hit.
struct WindowSetting {
  struct Robot {
    Deployment deployment;
    FaultTargets targets;
  };
  Robot blind;   ///< laser, ultrasonic sensors and whiskers: marvin-sim.yaml
  Robot seeing;  ///< with depth cameras too, by their models: marvin-depth-sim.yaml
  /// Every third window hits the one that sees.
  const Robot& robot_of(std::uint64_t seed) const { return seed % 3 == 0 ? seeing : blind; }
  std::vector<std::string> locations;    ///< names
  std::vector<geometry::Point2> starts;  ///< in map, free around
};

/// MARVIN in the office among people, in lock-step, with all that runs on it. `share` is
/// share/usher of an installation or a build.
Result<WindowSetting> window_setting(const std::string& share);

struct WindowResult {
  std::uint64_t seed = 0;
  WindowPlan plan;
  Judgement judgement;
  std::uint32_t touches = 0;
  double hit_at = 0.0;     ///< [s] after the start of the run
  double hit_speed = 0.0;  ///< [m/s] > kHitSpeed
  double simulated = 0.0;  ///< [s] with the way until the hit
  double wall = 0.0;       ///< [s]
  std::uint64_t digest = 0;
  std::vector<double> speeds;  ///< [m/s] every half second from the hit on
};

/// A window in which the robot did not drive faster when it was hit counts for nothing.
inline constexpr double kHitSpeed = 0.3;  // [m/s]

/// Drives, is hit, is judged. Where the robot does not get to drive, another window of the same
/// seed takes its place. With `trace` the run lies beside it as TRACE.csv and TRACE.png.
Result<WindowResult> run_window(const WindowSetting& setting, std::uint64_t seed,
                                const std::string& trace = {});

}  // namespace usher::operations
