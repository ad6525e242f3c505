#include "operations/command_line/locating.hpp"

#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "idl/topics.hpp"
#include "operations/command_line/table.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::operations {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr auto kPatience = std::chrono::seconds(5);
constexpr auto kBelieved = milliseconds(500);      // for where it believed to be before it is told
constexpr auto kJudged = std::chrono::seconds(2);  // by then its scans have judged what it was told
// How well somebody knows where the robot stands; what viewers of ROS 2 say, too.
constexpr double kPositionSigma = 0.5;                 // [m]
constexpr double kYawSigma = std::numbers::pi / 12.0;  // [rad]
// By the scan it may stand so far from there.
constexpr double kNear = 3.0 * kPositionSigma;
constexpr double kTurned = 3.0 * kYawSigma;

bool is_near(const geometry::Pose2& one, const geometry::Pose2& other) {
  return geometry::distance(one, other) < kNear &&
         std::abs(geometry::normalized(one.yaw - other.yaw)) < kTurned;
}

geometry_msgs::msg::PoseWithCovarianceStamped message_of(const geometry::Pose2& map_T_base,
                                                         runtime::Time now) {
  geometry_msgs::msg::PoseWithCovarianceStamped message;
  message.header(wire::header(now, frames::kMap));
  message.pose().pose(wire::to_message(map_T_base));
  message.pose().covariance(
      wire::to_covariance(Eigen::Vector3d(kPositionSigma * kPositionSigma,
                                          kPositionSigma * kPositionSigma, kYawSigma * kYawSigma)
                              .asDiagonal()));
  return message;
}

}  // namespace

Result<geometry::Pose2> tell_pose(runtime::Observer& observer, const geometry::Pose2& map_T_base) {
  namespace confidence = usher_msgs::msg::LocalizationStatus_Constants;
  auto writer = observer.writer(topics::kInitialPose);
  auto poses = observer.reader(topics::kAmclPose);
  auto statuses = observer.reader(topics::kLocalizationStatus);
  if (!writer) return Error{writer.error()};
  if (!poses) return Error{poses.error()};
  if (!statuses) return Error{statuses.error()};
  if (!writer->wait_for_readers(1, kPatience)) return Error{"no amcl reads initialpose"};
  poses->take(kBelieved);
  while (poses->take()) continue;
  writer->write(message_of(map_T_base, observer.now()));
  std::optional<geometry::Pose2> found;
  std::shared_ptr<const usher_msgs::msg::LocalizationStatus> status;
  runtime::Time stamp{};
  Clock::time_point taken_at{};
  std::string reason = "amcl did not take the pose within 5 s";
  for (const auto until = Clock::now() + kPatience; Clock::now() < until;) {
    while (const auto pose = poses->take()) {
      const auto here = wire::to_planar(pose->pose().pose());
      if (!here) continue;
      const bool taken = is_near(*here, map_T_base);
      if (!taken)
        reason = "its scans do not fit there: it believes to be at " + format("%.2f", here->x) +
                 " " + format("%.2f", here->y) + " " + format("%.2f", here->yaw);
      if (taken && !found) {
        taken_at = Clock::now();
        reason = "its scans have not judged the place yet";
      }
      found = taken ? std::optional(*here) : std::nullopt;
      stamp = wire::from_message(pose->header().stamp());
    }
    if (auto newer = statuses->take(milliseconds(50))) status = std::move(newer);
    // An older one is of where it believed to be before.
    if (!status || !found || wire::from_message(status->header().stamp()) < stamp) continue;
    if (status->state() == confidence::STATE_GOOD) {
      if (Clock::now() - taken_at >= kJudged) return *found;
      continue;
    }
    reason = "the pose is taken, but the robot is not sure of it: " + status->reason();
  }
  return Error{reason};
}

}  // namespace usher::operations
