#include "localization/amcl/core/kept_pose.hpp"

#include <ios>
#include <sstream>

namespace usher::amcl {

namespace {
constexpr const char* kMark = "pose-on-map";
}

std::string to_text(const KeptPose& kept) {
  std::ostringstream text;
  text.precision(17);
  text << kMark << ' ' << std::hex << kept.map << std::dec;
  for (const geometry::Pose2& pose : {kept.map_T_base, kept.odom_T_base})
    text << ' ' << pose.x << ' ' << pose.y << ' ' << pose.yaw;
  return text.str();
}

Result<KeptPose> read_kept_pose(std::string_view text, std::uint64_t map) {
  std::istringstream stream{std::string(text)};
  std::string mark;
  KeptPose kept;
  stream >> mark >> std::hex >> kept.map >> std::dec;
  if (!stream || mark != kMark)
    return Error{"the kept pose was refused: it names no map, so it may belong to another one"};
  if (kept.map != map) return Error{"the kept pose was refused: it was kept on another map"};
  for (geometry::Pose2* pose : {&kept.map_T_base, &kept.odom_T_base})
    stream >> pose->x >> pose->y >> pose->yaw;
  if (!stream || !kept.map_T_base.finite() || !kept.odom_T_base.finite())
    return Error{"the kept pose was refused: expected six finite numbers"};
  return kept;
}

}  // namespace usher::amcl
