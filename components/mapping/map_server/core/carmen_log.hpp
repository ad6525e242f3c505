#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/result/result.hpp"

namespace usher::map_server {

/// One FLASER line of a CARMEN log: `FLASER n r1 .. rn x y yaw x y yaw time host time`, the first
/// pose being the laser's, the second the robot's, both by odometry.
struct CarmenScan {
  std::vector<float>
      ranges;  ///< [m] counter-clockwise over half a circle ahead; 80 and more means no return
  geometry::Pose2 odom_T_laser;
  double time = 0.0;  ///< [s]
  std::size_t line = 0;

  double angle_min() const { return -0.5 * geometry::kPi; }
  /// The format does not say it: half a degree or a degree; an odd count has a beam at both ends.
  double angle_increment() const {
    const std::size_t count = ranges.size();
    return count < 2 ? 0.0
                     : geometry::kPi / static_cast<double>(count % 2 == 0 ? count : count - 1);
  }
};

/// Readings of CARMEN logs from here on [m] saw nothing (81.83, 81.91, 50, ... by recorder).
inline constexpr double kCarmenMaxRange = 50.0;

/// All FLASER lines of a log, plain or gzipped; other lines (PARAM, ODOM, comments) are passed
/// over, as the format asks. Errors name file and line: a number that is none or not finite, too
/// few of them, more than 4096 beams.
Result<std::vector<CarmenScan>> read_carmen_log(const std::string& path);
Result<std::vector<CarmenScan>> parse_carmen_log(std::string_view text, const std::string& name);

/// The reference poses beside such a log, one line `index time x y yaw` for each scan, # for
/// comments.
Result<std::vector<geometry::Pose2>> read_reference_poses(const std::string& path);
Result<std::vector<geometry::Pose2>> parse_reference_poses(std::string_view text,
                                                           const std::string& name);

}  // namespace usher::map_server
