#pragma once

#include <string>

#include "foundation/geometry/pose2.hpp"
#include "foundation/result/result.hpp"
#include "runtime/dds/observer.hpp"

namespace usher::operations {

/// Tells AMCL where the robot stands, as well as a person can say it, and waits until it takes it
/// and finds the scan in the map there: where it stands by the scan. The error says who is missing,
/// or that the map does not explain the scan; takes up to 9 s.
Result<geometry::Pose2> tell_pose(runtime::Observer& observer, const geometry::Pose2& map_T_base);

}  // namespace usher::operations
