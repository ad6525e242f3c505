#include "drivers/sensor_board/core/link.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "foundation/geometry/angle.hpp"

namespace usher::sensor_board {

namespace {

constexpr std::array<serial_frame::Parts, 2> kParts{
    {{kSonars, "ultrasonic sensors"}, {8, "switches"}}};
constexpr std::array<serial_frame::Trouble, 4> kTroubles{
    {{serial_frame::kWatchdogExpired, "the board missed this host"},
     {kServoOff, "servo off"},
     {kSupplyLow, "supply low"},
     {kSonarBusFault, "ultrasonic bus fault"}}};
constexpr std::uint16_t kFault = 0;
constexpr std::uint16_t kNoEcho = 0xFFFF;

float range_of(std::uint16_t millimeters) {
  if (millimeters == kFault) return std::numeric_limits<float>::quiet_NaN();
  if (millimeters == kNoEcho) return std::numeric_limits<float>::infinity();
  return static_cast<float>(millimeters) * 0.001F;
}

}  // namespace

Link::Link() : Link(Parameters{}) {}

Link::Link(const Parameters& parameters) : parameters_(parameters), dialogue_({}, kParts) {}

void Link::opened(Time now) { dialogue_.opened(now); }

void Link::closed() { dialogue_.closed(); }

void Link::set_tilt(double tilt) {
  if (!std::isfinite(tilt)) return;
  const double clipped = std::clamp(tilt, -parameters_.tilt_limit, parameters_.tilt_limit);
  const auto tenths = static_cast<std::int16_t>(std::lround(geometry::degrees(clipped) * 10.0));
  if (tilt_ == tenths) return;
  tilt_ = tenths;
  tilt_due_ = true;
}

void Link::tick(Time now) {
  dialogue_.tick(now);
  if (!tilt_ || !dialogue_.greeted()) return;
  if (!tilt_due_ && told_after_ == dialogue_.hellos()) return;
  dialogue_.send(usher::sensor_board::set_tilt(dialogue_.next_sequence(), *tilt_));
  tilt_due_ = false;
  told_after_ = dialogue_.hellos();
}

Whiskers Link::corners(std::uint8_t mask) const {
  const auto pressed = [mask](std::uint8_t bits) { return (mask & bits) != 0; };
  return {pressed(parameters_.front_left), pressed(parameters_.front_right),
          pressed(parameters_.back_left), pressed(parameters_.back_right)};
}

void Link::take(const Sensors& sensors, Time now) {
  reading_.stamp = now;
  reading_.measured = true;
  std::transform(sensors.ranges_mm.begin(), sensors.ranges_mm.end(), reading_.ranges.begin(),
                 range_of);
  reading_.whiskers = corners(sensors.whisker_mask);
  reading_.tilt = geometry::radians(sensors.tilt * 0.1);
  faults_.take(reading_);
}

bool Link::take(std::span<const std::uint8_t> content, Time now) {
  const auto message = parse(content);
  if (!message) {
    dialogue_.reject();
    return false;
  }
  dialogue_.count(message->sequence);
  if (const auto* sensors = std::get_if<Sensors>(&message->content)) {
    if (!dialogue_.believes(sensors->status, now)) return false;
    take(*sensors, now);
    return true;
  }
  if (const auto* change = std::get_if<WhiskerChange>(&message->content)) {
    if (!dialogue_.greeted() || !dialogue_.heard()) return false;  // the ranges are not known yet
    reading_.stamp = now;
    reading_.measured = false;
    reading_.whiskers = corners(change->mask);
    return true;
  }
  return false;
}

std::string Link::reason(Time now) const {
  std::string reason = dialogue_.reason(now, "no readings from the board");
  if (!reason.empty()) return reason;
  const std::string board = serial_frame::describe(dialogue_.status(), kTroubles);
  const std::string sensors = faults_.reason();
  return board + (board.empty() || sensors.empty() ? "" : ", ") + sensors;
}

}  // namespace usher::sensor_board
