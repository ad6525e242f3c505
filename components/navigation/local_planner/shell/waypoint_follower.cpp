#include "navigation/local_planner/shell/waypoint_follower.hpp"

#include <utility>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::local_planner {

namespace {

using std::chrono::milliseconds;

constexpr auto kScanAge = milliseconds(250);

WaypointFollowerConfig read_parameters(runtime::Host& host) {
  auto& p = host.parameters();
  WaypointFollowerConfig c;
  c.motion = read_motion(host);
  const auto number = [&](const char* name, const char* unit, runtime::Range range, double& value,
                          const char* text) { value = p.number(name, unit, range, value, text); };
  number("heading_tolerance", "rad", {0.02, 1}, c.heading_tolerance,
         "It turns to a waypoint up to this, and drives straight within it.");
  number("waypoint_radius", "m", {0.05, 1}, c.waypoint_radius,
         "Nearer than this it has arrived at a waypoint.");
  number("safe_distance", "m", {0.1, 3}, c.safe_distance,
         "An obstacle ahead that is nearer than this stops it.");
  number("sector_angle", "rad", {0.2, 3.1}, c.sector_angle, "Ahead, that is watched.");
  c.sectors = static_cast<int>(p.integer("sectors", "-", {1, SectorMedians::kMost}, c.sectors,
                                         "Of that angle, each with its median."));
  number("lost_heading", "rad", {0.1, 3}, c.lost_heading,
         "So far off the way to the waypoint it stops and turns anew.");
  number("corner_tolerance", "m", {0.005, 0.5}, c.corner_tolerance,
         "By which the way over the waypoints may miss the path.");
  return c;
}

std::shared_ptr<WaypointFollower> make(runtime::Host& host, const WaypointFollowerConfig& config) {
  auto follower = WaypointFollower::make(config);
  if (!follower) host.fault(follower.error());
  return std::make_shared<WaypointFollower>(std::move(follower).value());
}

}  // namespace

WaypointFollowerComponent::WaypointFollowerComponent(runtime::Host& host)
    : WaypointFollowerComponent(host, read_parameters(host)) {}

WaypointFollowerComponent::WaypointFollowerComponent(runtime::Host& host,
                                                     const WaypointFollowerConfig& config)
    : WaypointFollowerComponent(host, make(host, config), config.motion) {}

WaypointFollowerComponent::WaypointFollowerComponent(runtime::Host& host,
                                                     std::shared_ptr<WaypointFollower> follower,
                                                     const DynamicWindowConfig& motion)
    : FollowerComponent(host, follower, motion), follower_(std::move(follower)) {
  scan_ = host.input(
      topics::kScanFiltered, {.max_age = kScanAge, .on_loss = "commands zero and waits"},
      [this](const auto& scan, const auto&) { take_scan(scan); },
      [this] {
        follower_->sectors().clear();
        stand(usher_msgs::msg::GoalStatus_Constants::STATE_WAITING, "no scan");
      });
}

std::string WaypointFollowerComponent::not_ready() {
  return follower_->sectors().medians().empty() ? "no scan" : "";
}

/// The mount of the laser does not move on base_footprint.
void WaypointFollowerComponent::take_scan(const sensor_msgs::msg::LaserScan& scan) {
  const auto mount = transforms().lookup_planar(frames::kBaseFootprint, scan.header().frame_id(),
                                                wire::from_message(scan.header().stamp()));
  if (!mount || !wire::check(scan)) {
    reject();
    follower_->sectors().clear();
    return;
  }
  follower_->sectors().take(scan.ranges(), static_cast<double>(scan.angle_min()),
                            static_cast<double>(scan.angle_increment()), *mount);
}

}  // namespace usher::local_planner
