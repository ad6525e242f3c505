#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "foundation/geometry/pose2.hpp"
#include "foundation/result/result.hpp"

namespace usher::amcl {

/// The last good pose, as it is kept over restarts.
struct KeptPose {
  std::uint64_t map = 0;  ///< fingerprint of the map that it is a pose in
  geometry::Pose2 map_T_base;
  geometry::Pose2 odom_T_base;  ///< of the same moment
};

std::string to_text(const KeptPose& kept);

/// An error says what the text lacks, or that the pose was kept on another map than this one: the
/// same numbers are somewhere else there.
Result<KeptPose> read_kept_pose(std::string_view text, std::uint64_t map);

}  // namespace usher::amcl
