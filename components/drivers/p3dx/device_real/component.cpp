#include "drivers/p3dx/device_real/component.hpp"

namespace usher::p3dx {

namespace {
constexpr auto kCycle = std::chrono::milliseconds(20);
constexpr const char* kStoppedKey = "stopped";
}  // namespace

Link::Parameters P3dxComponent::read_parameters(runtime::Parameters& parameters) {
  Link::Parameters p;
  p.tracker.track = parameters.number("robot.track", "m", {0.1, 2}, p.tracker.track,
                                      "Effective distance of the wheels, for turning.");
  p.tracker.full_battery = parameters.number("full_battery", "V", {11, 15}, p.tracker.full_battery,
                                             "Voltage that counts as full.");
  p.tracker.empty_battery = parameters.number(
      "empty_battery", "V", {9, 12}, p.tracker.empty_battery, "Voltage that counts as empty.");
  return p;
}

P3dxComponent::P3dxComponent(runtime::Host& host)
    : damaged_(host.health().counter("packets: damaged")),
      line_(host, Link(read_parameters(host.parameters()))),
      driver_(host,
              {.drive = [this](const geometry::Twist2& twist) { line_.want(twist); },
               .emergency_stop =
                   [this] {
                     line_.link().emergency_stop();
                     remember();
                   },
               .reset =
                   [this] {
                     line_.link().reset();
                     remember();
                   },
               .last_will = [this](const geometry::Twist2& twist,
                                   runtime::Duration lasts) { line_.last_will(twist, lasts); }}),
      memory_(host, kStoppedKey) {
  const double silence =
      host.parameters().number("guard_silence", "s", {0.1, 0.15}, 0.15,
                               "The guard commands zero when the driver is silent for so long.");
  // Connecting switches the motors on: a base that was stopped must stay so over a restart.
  if (!memory_.found().empty()) line_.link().stay_stopped(memory_.found());
  line_.open({.address = "serial:///dev/ttyUSB0?baud=9600",
              .text = "The base's line.",
              .cycle = kCycle,
              .guard = {.safe = Link::velocity({}), .silence = runtime::from_seconds(silence)},
              .take =
                  [this](const Feedback& feedback) {
                    driver_.warn(line_.link().reason());
                    driver_.take(feedback);
                    remember();  // that somebody stopped it at the base
                  },
              .lost = [this](const std::string& reason) { driver_.disconnected(reason); },
              .heard = [this] { damaged_ = line_.link().decoder().damaged(); }});
}

void P3dxComponent::remember() { memory_.keep(line_.link().stopped_by()); }

}  // namespace usher::p3dx
