#include "drivers/segway_rmp/device_real/component.hpp"

namespace usher::segway_rmp {

namespace {
/// The base holds a command for 0.4 s; it is told at its own rate.
constexpr auto kCycle = std::chrono::milliseconds(10);
constexpr const char* kEmergencyKey = "emergency";
constexpr const char* kBalancedKey = "balanced";  // also over a boot: the base has its own supply

Calibration read_calibration(runtime::Parameters& parameters) {
  Calibration c;
  c.command_counts_per_speed =
      parameters.number("robot.segway.speed_counts", "-", {300, 360}, c.command_counts_per_speed,
                        "Of a commanded velocity, for each m/s.");
  c.command_counts_per_turn_rate =
      parameters.number("robot.segway.turn_counts", "-", {250, 600}, c.command_counts_per_turn_rate,
                        "Of a commanded turn rate, for each rad/s.");
  const bool reversed = parameters.flag("robot.segway.turn_reversed", c.command_turn_sign < 0.0,
                                        "Whether the base takes positive counts for a turn right.");
  c.command_turn_sign = reversed ? -1.0 : 1.0;
  return c;
}

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
  p.calibration = read_calibration(parameters);
  return p;
}

SegwayRmpComponent::SegwayRmpComponent(runtime::Host& host)
    : damaged_packets_(host.health().counter("packets: damaged")),
      skipped_bytes_(host.health().counter("bytes: skipped")),
      incomplete_cycles_(host.health().counter("cycles: incomplete")),
      counter_jumps_(host.health().counter("odometers: jumped")),
      line_(host, Link(read_parameters(host.parameters()))),
      driver_(host,
              {.drive = [this](const geometry::Twist2& twist) { line_.want(twist); },
               .emergency_stop = [this] { emergency(true); },
               .reset = [this] { emergency(false); },
               .last_will = [this](const geometry::Twist2& twist,
                                   runtime::Duration lasts) { line_.last_will(twist, lasts); }}),
      memory_(host, kEmergencyKey),
      balanced_(host, kBalancedKey) {
  const double silence =
      host.parameters().number("guard_silence", "s", {0.03, 0.15}, runtime::seconds(kGuardSilence),
                               "The guard commands zero when the driver is silent for so long.");
  const auto zero = line_.link().velocity({});
  // Connecting sets the balance mode: a base that was switched off must stay so over a restart, and
  // one that balanced is asked first, because it may have gone off while no driver ran.
  if (!memory_.found().empty()) line_.link().emergency_stop();
  if (!balanced_.found().empty()) line_.link().balanced_before();
  line_.open(
      {.address = "serial:///dev/ttyUSB0?baud=460800",
       .text = "The base's line.",
       .cycle = kCycle,
       .guard = {.safe = {zero.begin(), zero.end()}, .silence = runtime::from_seconds(silence)},
       .take =
           [this](const SegwayFeedback& feedback) {
             driver_.warn(line_.link().reason());
             driver_.take(feedback);
             remember();  // that it balances, and that it fell
           },
       .lost = [this](const std::string& reason) { driver_.disconnected(reason); },
       .heard = [this] { count(); }});
}

void SegwayRmpComponent::emergency(bool on) {
  if (on && line_.link().emergency()) return;
  if (on) {
    line_.link().emergency_stop();
  } else {
    line_.link().reset();
  }
  remember();
}

void SegwayRmpComponent::count() {
  const Link& link = line_.link();
  damaged_packets_ = link.decoder().bad_checksums();
  skipped_bytes_ = link.decoder().skipped_bytes();
  incomplete_cycles_ = link.assembler().incomplete_cycles();
  counter_jumps_ = link.assembler().counter_jumps();
}

void SegwayRmpComponent::remember() {
  memory_.keep(line_.link().emergency() ? "off" : "");
  balanced_.keep(line_.link().balanced() ? "yes" : "");
}

}  // namespace usher::segway_rmp
