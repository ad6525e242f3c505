#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::amcl {

/// One planar scan as the sensor gave it.
struct LaserBeams {
  geometry::Pose2 base_T_laser;   ///< at the time of the scan
  double angle_min = 0.0;         ///< [rad] of the first beam, in the laser's frame
  double angle_increment = 0.0;   ///< [rad] between beams, may be negative
  double range_min = 0.0;         ///< [m] shorter readings are no returns
  double range_max = 0.0;         ///< [m] readings from here on saw nothing
  std::span<const float> ranges;  ///< [m]; valid as long as the call
};

/// A beam chosen for the filter.
struct Beam {
  double x = 0.0, y = 0.0;  ///< [m] end point in base; for a beam without return, its point at the
                            ///< largest range
  double range = 0.0;       ///< [m]
  double angle = 0.0;       ///< [rad] in base
  double direction_x = 1.0, direction_y = 0.0;  ///< the same as a unit vector
};

/// What became of a scan's beams.
struct BeamCounts {
  std::size_t used = 0;
  std::size_t not_finite = 0;    ///< NaN or infinite
  std::size_t out_of_range = 0;  ///< below range_min, negative included
  std::size_t no_return = 0;     ///< at or beyond the largest range
};

/// Up to `max_beams` beams with a return, evenly spaced among those in order, first and last
/// included; those without a return stay out, as in the amcl of ROS, unless `with_no_return`. The
/// largest range is the smaller of the scan's and `max_range`. Does not allocate once `beams` has
/// room.
BeamCounts choose_beams(const LaserBeams& scan, std::size_t max_beams, double max_range,
                        bool with_no_return, std::vector<Beam>& beams);

}  // namespace usher::amcl
