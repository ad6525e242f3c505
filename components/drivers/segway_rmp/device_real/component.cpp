#include "drivers/segway_rmp/device_real/component.hpp"

namespace usher::segway_rmp {

namespace {
/// The base holds a command for 0.4 s; it is told at its own rate.
constexpr auto kCycle = std::chrono::milliseconds(10);
}  // namespace

Link::Parameters SegwayRmpComponent::read_parameters(runtime::Parameters& parameters) {
  Link::Parameters p;
  const auto scale = [&](const char* name, std::uint16_t& value, const char* text) {
    value = static_cast<std::uint16_t>(parameters.integer(name, "-", {0, 16}, value, text));
  };
  scale("velocity_scale", p.velocity_scale, "Of the firmware, in sixteenths.");
  scale("acceleration_scale", p.acceleration_scale, "Of the firmware, in sixteenths.");
  scale("turn_scale", p.turn_scale, "Of the firmware, in sixteenths.");
  p.gain_schedule =
      static_cast<std::uint16_t>(parameters.integer("gain_schedule", "-", {0, 2}, p.gain_schedule,
                                                    "Of the balancing: 0 light, 1 tall, 2 heavy."));
  return p;
}

SegwayRmpComponent::SegwayRmpComponent(runtime::Host& host)
    : host_(host),
      link_(read_parameters(host.parameters())),
      driver_(host, {.drive = [this](const geometry::Twist2& twist) { wanted_ = twist; },
                     .emergency_stop = [this] { link_.emergency_stop(); },
                     .reset = [this] { link_.reset(); }}) {
  const std::string line =
      host.parameters().text("address", "serial:///dev/ttyUSB0?baud=460800", "The base's line.");
  stream_ = &host.open_stream(line, {.on_open = [this] { link_.opened(now()); },
                                     .on_bytes =
                                         [this](std::span<const std::uint8_t> bytes) {
                                           link_.received(bytes, now(),
                                                          [this](const SegwayFeedback& feedback) {
                                                            driver_.take(feedback);
                                                          });
                                         },
                                     .on_close =
                                         [this](const std::string& reason) {
                                           link_.closed();
                                           driver_.disconnected(reason);
                                         }});
  timer_ = host.timer("line", kCycle, [this](auto) {
    const auto frames = link_.cycle(wanted_, now());
    if (!frames.empty()) stream_->write(frames);
    if (link_.mode(now()) == Mode::kDisconnected) driver_.disconnected(link_.reason());
  });
}

}  // namespace usher::segway_rmp
