#include "navigation/local_planner/shell/component.hpp"

#include <memory>
#include <utility>

namespace usher::local_planner {

namespace {

DynamicWindowConfig read_parameters(runtime::Host& host) {
  auto& p = host.parameters();
  DynamicWindowConfig c = read_motion(host);
  c.tight_speed = p.number("tight_speed", "m/s", {0.05, 1}, c.tight_speed,
                           "Speed where only the outline fits.");
  c.lateral_acceleration = p.number("lateral_acceleration", "m/s2", {0.1, 3},
                                    c.lateral_acceleration, "Bounds speed times turn rate.");
  c.sampling =
      p.choice("sampling", {"dynamic_window", "rollout"}, "dynamic_window",
               "Velocities that are tried: within reach now, or within the simulated time.") ==
              "rollout"
          ? Sampling::kTrajectoryRollout
          : Sampling::kDynamicWindow;
  c.keep_left = p.choice("keep", {"right", "left"}, "right",
                         "Side on which people of the country pass each other.") == "left";
  c.speed_samples = static_cast<int>(
      p.integer("speed_samples", "-", {3, 64}, c.speed_samples, "Speeds that are tried."));
  c.turn_samples = static_cast<int>(
      p.integer("turn_samples", "-", {3, 255}, c.turn_samples, "Turn rates that are tried."));
  c.simulated_time =
      p.number("simulated_time", "s", {1, 4}, c.simulated_time, "How far each trial looks ahead.");
  return c;
}

std::shared_ptr<DynamicWindow> make(runtime::Host& host, const DynamicWindowConfig& config) {
  auto window = DynamicWindow::make(config);
  if (!window) host.fault(window.error());
  return std::make_shared<DynamicWindow>(std::move(window).value());
}

}  // namespace

LocalPlannerComponent::LocalPlannerComponent(runtime::Host& host)
    : LocalPlannerComponent(host, read_parameters(host)) {}

LocalPlannerComponent::LocalPlannerComponent(runtime::Host& host, const DynamicWindowConfig& config)
    : FollowerComponent(host, make(host, config), config) {}

}  // namespace usher::local_planner
