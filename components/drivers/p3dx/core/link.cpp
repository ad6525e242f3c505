#include "drivers/p3dx/core/link.hpp"

#include <algorithm>
#include <cmath>

namespace usher::p3dx {

namespace {

constexpr double kHeadingUnit = 2.0 * geometry::kPi / 4096.0;  // [rad]
constexpr std::uint16_t kWrap = 0x8000;                        // [mm] positions have 15 bits
constexpr std::uint16_t kNoEcho = 5000;                        // [mm] and beyond
constexpr auto kEnableAgain = std::chrono::milliseconds(500);
constexpr auto kForgives = std::chrono::seconds(1);
constexpr std::uint8_t kInformation = 0x32;  // and 0x33

/// The shortest way from one wrapped position to another [m].
double way(std::uint16_t from, std::uint16_t to) {
  const int mask = kWrap - 1;
  int step = ((to & mask) - (from & mask)) & mask;
  if (step >= kWrap / 2) step -= kWrap;
  return 1e-3 * step;
}

std::array<Frame, 2> frames(const geometry::Twist2& twist) {
  const double v = std::clamp(twist.v, -10.0, 10.0), w = std::clamp(twist.w, -10.0, 10.0);
  return {encode(Command::kVelocity, static_cast<int>(std::lround(1e3 * v))),
          encode(Command::kTurnRate, static_cast<int>(std::lround(geometry::degrees(w))))};
}

/// Which slot of the ring a sonar of the front array has; sonar 0 looks to the left.
std::optional<std::size_t> slot_of(std::uint8_t number) {
  constexpr std::array<std::size_t, 8> kSlots = {9, 7, 6, 5, 4, 3, 2, 0};
  if (number >= kSlots.size()) return std::nullopt;
  return kSlots[number];
}

}  // namespace

/// The controller's own frame turns with its origin; what counts is how it moved in the body.
void Tracker::move(const Information& information) {
  const double x = way(last_->x, information.x), y = way(last_->y, information.y);
  if (std::hypot(x, y) > parameters_.longest_step) return;
  const double before = last_->heading * kHeadingUnit;
  const double turned = geometry::normalized((information.heading - last_->heading) * kHeadingUnit);
  const geometry::Pose2 step{std::cos(before) * x + std::sin(before) * y,
                             -std::sin(before) * x + std::cos(before) * y, turned};
  pose_ = pose_ * step;
}

Feedback Tracker::take(const Information& information, Time now) {
  if (last_) move(information);
  last_ = information;
  Feedback feedback;
  feedback.stamp = now;
  feedback.mode = information.motors_on ? Mode::kReady : Mode::kStandby;
  feedback.pose = pose_;
  const double left = 1e-3 * information.left_velocity, right = 1e-3 * information.right_velocity;
  feedback.twist = {0.5 * (left + right),
                    information.rotation_rate.value_or((right - left) / parameters_.track)};
  feedback.battery_percent = std::clamp(100.0 * (information.battery - parameters_.empty_battery) /
                                            (parameters_.full_battery - parameters_.empty_battery),
                                        0.0, 100.0);
  feedback.sonar.fill(std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < information.sonar_count; ++i) {
    const SonarReading& reading = information.sonar[i];
    const auto slot = slot_of(reading.number);
    if (!slot) continue;
    feedback.sonar[*slot] = reading.range >= kNoEcho ? std::numeric_limits<float>::infinity()
                                                     : 1e-3F * static_cast<float>(reading.range);
  }
  return feedback;
}

Link::Link(const Parameters& parameters) : parameters_(parameters), tracker_(parameters.tracker) {}

void Link::opened(Time now) {
  decoder_.reset();
  tracker_.reset();
  output_.clear();
  reported_.reset();
  state_ = State::kSync0;
  asked_ = now - parameters_.patience;
  reason_ = "waiting for the base to answer";
}

void Link::closed() {
  state_ = State::kClosed;
  reported_.reset();
  reason_ = "not connected";
}

void Link::send(const Frame& frame) {
  const auto bytes = frame.span();
  output_.insert(output_.end(), bytes.begin(), bytes.end());
}

void Link::send_sync(Time now) {
  const Command steps[] = {Command::kPulse, Command::kOpen, Command::kClose};
  send(encode(steps[static_cast<std::size_t>(state_) - 1]));
  asked_ = now;
}

std::optional<Feedback> Link::take(std::span<const std::uint8_t> packet, Time now) {
  if (state_ == State::kClosed || packet.empty()) return std::nullopt;
  if (state_ != State::kRunning) {
    handshake(packet, now);
    return std::nullopt;
  }
  const auto information = parse_information(packet);
  if (!information) return std::nullopt;
  reported_ = now;
  Feedback feedback = tracker_.take(*information, now);
  if (information->stop_button)
    stay_stopped("its stop button was pressed");
  else if (information->stall_stop && !stopped() && !released_ && now >= forgives_until_)
    stay_stopped("stopped after a stall");
  else if (reported_mode_ == Mode::kReady && !information->motors_on && !stopped())
    stay_stopped("its motors were switched off at the base");
  motors_on_ = information->motors_on;
  rolls_ = information->left_velocity != 0 || information->right_velocity != 0;
  if (stopped()) feedback.mode = Mode::kEmergency;
  reported_mode_ = feedback.mode;
  reason_ = stopped()                                             ? stopped_by_
            : information->left_stall || information->right_stall ? "a wheel is stalled"
            : information->motors_on                              ? ""
                                                                  : "motors off";
  return feedback;
}

/// The base echoes each step; a report instead means that it was left open.
void Link::handshake(std::span<const std::uint8_t> packet, Time now) {
  if ((packet[0] & 0xFE) == kInformation) {
    send(encode(Command::kClose));
    state_ = State::kSync0;
    asked_ = now;
    return;
  }
  if (packet[0] != static_cast<std::uint8_t>(state_) - 1) {  // out of step: from the beginning
    state_ = State::kSync0;
    return;
  }
  state_ = static_cast<State>(static_cast<std::uint8_t>(state_) + 1);
  if (state_ == State::kRunning) {
    reported_ = now;
    reported_mode_ = Mode::kStandby;
    reason_ = stopped() ? stopped_by_ : "motors off";
    motors_on_ = false;
    send_setup();
    enabled_ = now;
  } else {
    send_sync(now);
  }
}

void Link::send_setup() {
  send(encode(Command::kOpen));
  send(encode(Command::kPulse));
  send(encode(Command::kVelocity, 0));
  send(encode(Command::kTurnRate, 0));
  send(encode(Command::kSetAcceleration, parameters_.acceleration));
  send(encode(Command::kSetTurnAcceleration, parameters_.turn_acceleration));
  send(encode(Command::kSetMaxVelocity, parameters_.max_velocity));
  send(encode(Command::kSetMaxTurnRate, parameters_.max_turn_rate));
  send(encode(Command::kSonar, 1));
  if (!stopped()) send(encode(Command::kEnable, 1));
}

void Link::reset() {
  if (!stopped()) return;
  stopped_by_.clear();
  reported_mode_ = Mode::kStandby;
  released_ = true;
}

std::vector<std::uint8_t> Link::velocity(const geometry::Twist2& twist) {
  std::vector<std::uint8_t> bytes;
  for (const Frame& frame : frames(twist))
    bytes.insert(bytes.end(), frame.span().begin(), frame.span().end());
  return bytes;
}

Mode Link::mode(Time now) const {
  if (state_ != State::kRunning || !reported_ || now - *reported_ >= parameters_.lost)
    return Mode::kDisconnected;
  return stopped() ? Mode::kEmergency : reported_mode_;
}

void Link::send_velocity(const geometry::Twist2& wanted, Time now) {
  if (now - told_ < parameters_.repeat) return;
  told_ = now;
  if (stopped()) {
    send(encode(Command::kEmergencyStop));
    if (motors_on_ && !rolls_) send(encode(Command::kEnable, 0));
    return;
  }
  const bool drive =
      reported_mode_ == Mode::kReady && std::isfinite(wanted.v) && std::isfinite(wanted.w);
  for (const Frame& frame : frames(drive ? wanted : geometry::Twist2{})) send(frame);
  if (released_) forgives_until_ = now + kForgives;
  if (released_ || (reported_mode_ == Mode::kStandby && now - enabled_ >= kEnableAgain)) {
    send(encode(Command::kEnable, 1));
    enabled_ = now;
    released_ = false;
  }
}

std::span<const std::uint8_t> Link::cycle(const geometry::Twist2& wanted, Time now) {
  if (state_ == State::kRunning && now - *reported_ >= parameters_.lost) {
    opened(now);
    reason_ = "no reports from the base";
  }
  if (state_ == State::kRunning) {
    send_velocity(wanted, now);
  } else if (state_ != State::kClosed && now - asked_ >= parameters_.patience) {
    if (state_ != State::kSync0) state_ = State::kSync0;
    send_sync(now);
  }
  sent_.swap(output_);
  output_.clear();
  return sent_;
}

}  // namespace usher::p3dx
