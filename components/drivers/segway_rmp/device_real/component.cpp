#include "drivers/segway_rmp/device_real/component.hpp"

#include <memory>

namespace usher::segway_rmp {

namespace {
/// The base holds a command for 0.4 s; it is told at its own rate.
constexpr auto kCycle = std::chrono::milliseconds(10);
constexpr const char* kEmergencyKey = "emergency";
constexpr auto kKeeping = std::chrono::milliseconds(5);  // in simulation
constexpr auto kKeepAgain = std::chrono::seconds(1);     // after a failure
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
      line_(host, Link(read_parameters(host.parameters()))),
      driver_(host, {.drive = [this](const geometry::Twist2& twist) { line_.want(twist); },
                     .emergency_stop = [this] { emergency(true); },
                     .reset = [this] { emergency(false); }}),
      keep_again_(host.timer("keep", kKeepAgain, [this](auto) { keep(); })) {
  const double silence =
      host.parameters().number("guard_silence", "s", {0.03, 0.3}, 0.1,
                               "The guard commands zero when the driver is silent for so long.");
  const auto zero = command({}, Calibration{});
  // Connecting sets the balance mode: a base that was switched off must stay so over a restart.
  if (const auto kept = host.kept(kEmergencyKey); kept && !kept->empty() && kept->front() != 0) {
    line_.link().emergency_stop();
    kept_ = true;
  }
  line_.open(
      {.address = "serial:///dev/ttyUSB0?baud=460800",
       .text = "The base's line.",
       .cycle = kCycle,
       .guard = {.safe = {zero.begin(), zero.end()}, .silence = runtime::from_seconds(silence)},
       .take = [this](const SegwayFeedback& feedback) { driver_.take(feedback); },
       .lost = [this](const std::string& reason) { driver_.disconnected(reason); }});
}

void SegwayRmpComponent::emergency(bool on) {
  if (on == line_.link().emergency()) return;
  if (on) {
    line_.link().emergency_stop();
  } else {
    line_.link().reset();
  }
  keep();
}

/// Beside the handlers: the base must not wait for a disk to be switched off.
void SegwayRmpComponent::keep() {
  const bool emergency = line_.link().emergency();
  if (keeping_ || emergency == kept_) return;
  keeping_ = true;
  const auto outcome = std::make_shared<Status>();
  host_.offload(
      kKeeping,
      [&host = host_, emergency, outcome] {
        const std::uint8_t remembered = emergency ? 1 : 0;
        *outcome = host.keep(kEmergencyKey, {&remembered, 1});
      },
      [this, emergency, outcome] {
        keeping_ = false;
        if (!*outcome) {
          ++host_.health().counter("emergency: not kept");
          return;
        }
        kept_ = emergency;
        keep();
      });
}

}  // namespace usher::segway_rmp
