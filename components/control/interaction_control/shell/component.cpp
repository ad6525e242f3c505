#include "control/interaction_control/shell/component.hpp"

#include <cmath>
#include <optional>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::interaction_control {

namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg::FaceTarget_Constants;

constexpr auto kPeriod = milliseconds(50);
constexpr auto kTargetAge = milliseconds(500);
constexpr auto kOdometryAge = milliseconds(200);
constexpr auto kEnableAge = milliseconds(120);

/// Nothing without odometry, or with one that is no pose in the plane.
std::optional<double> yaw_of(const nav_msgs::msg::Odometry* odometry) {
  if (odometry == nullptr) return std::nullopt;
  const auto pose = wire::to_planar(odometry->pose().pose());
  return pose ? std::optional(pose->yaw) : std::nullopt;
}

}  // namespace

Parameters InteractionControlComponent::read_parameters(runtime::Parameters& parameters) {
  Parameters p;
  p.dead_zone = parameters.number("dead_zone", "rad", {0.02, 0.7}, p.dead_zone,
                                  "An error up to this is facing.");
  p.resume_zone = parameters.number("resume_zone", "rad", {0.03, 1.5}, p.resume_zone,
                                    "From this error on it turns again; above dead_zone.");
  p.gain = parameters.number("gain", "-", {0.2, 4}, p.gain, "Turn rate per error, in 1/s.");
  p.max_rate = parameters.number("max_rate", "rad/s", {0.1, 1}, p.max_rate, "Fastest turn.");
  p.min_rate = parameters.number("min_rate", "rad/s", {0, 0.1}, p.min_rate,
                                 "Slower than this the base does not turn.");
  p.search_rate = parameters.number("search_rate", "rad/s", {0.05, 0.5}, p.search_rate,
                                    "Of the turn while nobody is found.");
  if (p.resume_zone <= p.dead_zone) p.resume_zone = 1.5 * p.dead_zone;
  return p;
}

InteractionControlComponent::InteractionControlComponent(runtime::Host& host)
    : host_(host),
      core_(read_parameters(host.parameters())),
      rejected_(host.health().counter("targets: rejected")) {
  target_ = host.input(
      topics::kInteractionTarget,
      {.max_age = kTargetAge, .on_loss = "turns no further", .optional = true},
      [this](const auto& target, const auto&) { aim(target); }, [this] { core_.stand(); });
  odom_ = host.input(topics::kOdom, {.max_age = kOdometryAge, .on_loss = "stands"});
  enable_ = host.input(topics::kMovementEnable, {.max_age = kEnableAge, .on_loss = "stands"});
  command_ = host.output(topics::kCmdVelInteraction);
  timer_ = host.timer("drive", kPeriod, [this](auto) { drive(); });
  host.health().set(runtime::HealthState::kOk);
}

void InteractionControlComponent::aim(const usher_msgs::msg::FaceTarget& target) {
  const auto yaw = yaw_of(odom_.fresh());
  const bool known = target.mode() <= MODE_SEARCH && std::isfinite(target.bearing());
  if (!known) ++rejected_;
  if (!known || target.mode() == MODE_STAND) {
    core_.stand();
  } else if (target.mode() == MODE_SEARCH) {
    core_.search(target.bearing() >= 0.0);
  } else if (yaw) {
    core_.face(*yaw + target.bearing());
  } else {
    core_.stand();
  }
}

void InteractionControlComponent::drive() {
  const auto yaw = yaw_of(odom_.fresh());
  const auto* enable = enable_.fresh();
  geometry::Twist2 twist;
  if (yaw && enable != nullptr && enable->interaction_control()) twist.w = core_.step(*yaw);
  auto message = wire::to_message(host_.now(), twist);
  message.header().frame_id(frames::kBaseFootprint);
  command_.publish(message);
}

}  // namespace usher::interaction_control
