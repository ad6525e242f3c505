#include "drivers/p3dx/device_real/component.hpp"

namespace usher::p3dx {

namespace {
constexpr auto kCycle = std::chrono::milliseconds(20);
}

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
    : host_(host),
      link_(read_parameters(host.parameters())),
      damaged_(host.health().counter("packets: damaged")),
      driver_(host, {.drive = [this](const geometry::Twist2& twist) { wanted_ = twist; },
                     .emergency_stop = [this] { link_.emergency_stop(); },
                     .reset = [this] { link_.reset(); }}) {
  const std::string line =
      host.parameters().text("address", "serial:///dev/ttyUSB0?baud=9600", "The base's line.");
  stream_ =
      &host.open_stream(line, {.on_open = [this] { link_.opened(now()); },
                               .on_bytes =
                                   [this](std::span<const std::uint8_t> bytes) {
                                     link_.received(bytes, now(), [this](const Feedback& feedback) {
                                       driver_.warn(link_.reason());
                                       driver_.take(feedback);
                                     });
                                     damaged_ = link_.decoder().damaged();
                                   },
                               .on_close =
                                   [this](const std::string& reason) {
                                     link_.closed();
                                     driver_.disconnected(reason);
                                   }});
  timer_ = host.timer("line", kCycle, [this](auto) {
    const auto bytes = link_.cycle(wanted_, now());
    if (!bytes.empty()) stream_->write(bytes);
    if (link_.mode(now()) == Mode::kDisconnected) driver_.disconnected(link_.reason());
  });
}

}  // namespace usher::p3dx
