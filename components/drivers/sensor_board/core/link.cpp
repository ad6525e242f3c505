#include "drivers/sensor_board/core/link.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "foundation/geometry/angle.hpp"

namespace usher::sensor_board {

namespace {

constexpr std::uint8_t kProtocolVersion = 1;
constexpr std::uint8_t kSwitches = 8;
constexpr std::uint16_t kFault = 0;
constexpr std::uint16_t kNoEcho = 0xFFFF;

float range_of(std::uint16_t millimeters) {
  if (millimeters == kFault) return std::numeric_limits<float>::quiet_NaN();
  if (millimeters == kNoEcho) return std::numeric_limits<float>::infinity();
  return static_cast<float>(millimeters) * 0.001F;
}

}  // namespace

Link::Link() : Link(Parameters{}) {}

Link::Link(const Parameters& parameters) : parameters_(parameters) {
  filters_.fill(MedianFilter(parameters.median_window));
}

void Link::opened(Time now) {
  open_ = true;
  greeted_ = false;
  opened_at_ = now;
  hello_sent_.reset();
  heartbeat_sent_.reset();
  heard_at_.reset();
  last_sequence_.reset();
  status_ = 0;
  refusal_.clear();
  output_.clear();
  decoder_.reset();
  for (MedianFilter& filter : filters_) filter.reset();
}

void Link::closed() {
  open_ = false;
  heard_at_.reset();
  output_.clear();
}

void Link::set_tilt(double tilt) {
  if (!std::isfinite(tilt)) return;
  const double clipped = std::clamp(tilt, -parameters_.tilt_limit, parameters_.tilt_limit);
  const auto tenths = static_cast<std::int16_t>(std::lround(geometry::degrees(clipped) * 10.0));
  if (tilt_wanted_ && tenths == tilt_) return;
  tilt_ = tenths;
  tilt_wanted_ = tilt_due_ = true;
}

void Link::send(const Frame& frame) {
  output_.insert(output_.end(), frame.bytes.begin(),
                 frame.bytes.begin() + static_cast<std::ptrdiff_t>(frame.size));
}

std::vector<std::uint8_t> Link::take_output() { return std::exchange(output_, {}); }

void Link::tick(Time now) {
  if (!open_ || (!greeted_ && now - opened_at_ < parameters_.boot)) return;
  if (!greeted_ && (!hello_sent_ || now - *hello_sent_ >= parameters_.boot)) {
    send(hello_request(sequence_++));
    hello_sent_ = now;
  }
  if (!heartbeat_sent_ || now - *heartbeat_sent_ >= parameters_.heartbeat) {
    send(heartbeat(sequence_++));
    heartbeat_sent_ = now;
  }
  if (tilt_due_ && greeted_) {
    send(usher::sensor_board::set_tilt(sequence_++, tilt_));
    tilt_due_ = false;
  }
}

Whiskers Link::corners(std::uint8_t mask) const {
  const auto pressed = [mask](std::uint8_t bits) { return (mask & bits) != 0; };
  return {pressed(parameters_.front_left), pressed(parameters_.front_right),
          pressed(parameters_.back_left), pressed(parameters_.back_right)};
}

void Link::take(const Hello& hello) {
  greeted_ = true;
  tilt_due_ = tilt_wanted_;
  refusal_.clear();
  if (hello.protocol_version != kProtocolVersion) {
    refusal_ =
        "expected protocol version 1, the board speaks " + std::to_string(hello.protocol_version);
  } else if (hello.sonars != kSonars || hello.whiskers != kSwitches) {
    refusal_ = "expected 5 ultrasonic sensors and 8 switches, the board has ";
    refusal_ += std::to_string(hello.sonars) + " and " + std::to_string(hello.whiskers);
  }
}

void Link::take(const Sensors& sensors, Time now) {
  // The board restarted and its hello was lost: ask for it, and for the tilt again.
  if ((sensors.status & kRebooted) != 0 && (status_ & kRebooted) == 0) {
    greeted_ = false;
    hello_sent_.reset();
    tilt_due_ = tilt_wanted_;
  }
  status_ = sensors.status;
  heard_at_ = now;
  reading_.stamp = now;
  for (std::size_t i = 0; i < kSonars; ++i) {
    reading_.ranges[i] = filters_[i].update(range_of(sensors.ranges_mm[i]));
  }
  reading_.whiskers = corners(sensors.whisker_mask);
  reading_.tilt = geometry::radians(sensors.tilt * 0.1);
}

bool Link::take(std::span<const std::uint8_t> content, Time now) {
  const auto message = parse(content);
  if (!message) {
    ++rejected_;
    return false;
  }
  if (const auto* hello = std::get_if<Hello>(&message->content)) {
    last_sequence_ = message->sequence;
    take(*hello);
    return false;
  }
  if (last_sequence_) {
    lost_messages_ += static_cast<std::uint8_t>(message->sequence - *last_sequence_ - 1);
  }
  last_sequence_ = message->sequence;
  if (!refusal_.empty()) return false;
  if (const auto* sensors = std::get_if<Sensors>(&message->content)) {
    take(*sensors, now);
    return true;
  }
  if (const auto* change = std::get_if<WhiskerChange>(&message->content)) {
    if (!heard_at_) return false;  // the ranges are not known yet
    reading_.stamp = now;
    reading_.whiskers = corners(change->mask);
    return true;
  }
  return false;
}

bool Link::healthy(Time now) const {
  return open_ && refusal_.empty() && heard_at_ && now - *heard_at_ < parameters_.silence;
}

std::string Link::reason(Time now) const {
  if (!open_) return "not connected";
  if (!refusal_.empty()) return refusal_;
  if (!healthy(now)) return heard_at_ ? "no readings from the board" : "waiting for the board";
  std::string text;
  const auto add = [&](std::uint8_t bit, const char* meaning) {
    if ((status_ & bit) == 0) return;
    if (!text.empty()) text += ", ";
    text += meaning;
  };
  add(kWatchdogExpired, "the board missed this host");
  add(kServoOff, "servo off");
  add(kSupplyLow, "supply low");
  add(kSonarBusFault, "ultrasonic bus fault");
  return text;
}

}  // namespace usher::sensor_board
