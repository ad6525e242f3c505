#include "drivers/segway_rmp/core/link.hpp"

#include "drivers/segway_rmp/core/status.hpp"

namespace usher::segway_rmp {

Link::Link() : Link(Parameters{}) {}

Link::Link(const Parameters& parameters)
    : parameters_(parameters), assembler_(parameters.calibration) {}

void Link::opened(Time now) {
  open_ = true;
  opened_at_ = now;
  step_ = 0;
  decoder_.reset();
  assembler_.reopened();
  feedback_at_.reset();
  reported_ = Mode::kDisconnected;
  reason_ = "waiting for feedback";
}

void Link::closed() {
  open_ = false;
  feedback_at_.reset();
  reported_ = Mode::kDisconnected;
  reason_ = "not connected";
}

void Link::reset() {
  if (!emergency_ && reported_ != Mode::kStandby) return;
  emergency_ = balanced_ = false;
  step_ = 0;  // a base that was switched off may have forgotten its settings
}

std::optional<SegwayFeedback> Link::take(const Packet& packet, Time now) {
  auto feedback = assembler_.take(packet, now);
  if (!feedback) return std::nullopt;
  // A base that was away may have been switched off and have forgotten its settings.
  if (feedback_at_ && now - *feedback_at_ >= parameters_.lost) step_ = 0;
  off_ = feedback->mode != Mode::kBalancing;
  const bool fell = balanced_ && feedback->mode == Mode::kStandby;
  if (feedback->mode == Mode::kBalancing) balanced_ = true;
  if (fell) emergency_ = true;
  if (emergency_) feedback->mode = Mode::kEmergency;
  const bool news = !feedback_at_ || reported_ != feedback->mode ||
                    status_1_ != feedback->status_1 || status_2_ != feedback->status_2;
  feedback_at_ = now;
  reported_ = feedback->mode;
  status_1_ = feedback->status_1;
  status_2_ = feedback->status_2;
  if (news) {
    reason_ = report(status_1_, status_2_).text;
    if (reason_.empty() && reported_ == Mode::kEmergency) reason_ = "emergency stop";
    if (reason_.empty() && reported_ == Mode::kStandby) reason_ = "not balancing";
  }
  return feedback;
}

Mode Link::mode(Time now) const {
  if (!feedback_at_ || now - *feedback_at_ >= parameters_.lost) return Mode::kDisconnected;
  return emergency_ ? Mode::kEmergency : reported_;
}

std::span<const std::uint8_t> Link::cycle(const geometry::Twist2& wanted, Time now) {
  if (!open_) return {};
  if (mode(now) == Mode::kDisconnected && feedback_at_) reason_ = "no feedback from the base";
  if (emergency_) {
    // One that is off is told so no longer: what switches it on may be about to.
    output_ = feedback_at_ && off_ ? velocity({}) : shutdown();
    return output_;
  }
  if (asks_first()) {
    output_ = velocity({});
    return output_;
  }
  if (configured()) {
    output_ = velocity(wanted);
    return output_;
  }
  struct Step {
    Setting setting;
    std::uint16_t value;
  };
  const Step steps[kSteps] = {
      {Setting::kMaxVelocityScale, parameters_.velocity_scale},
      {Setting::kMaxAccelerationScale, parameters_.acceleration_scale},
      {Setting::kMaxTurnScale, parameters_.turn_scale},
      {Setting::kGainSchedule, parameters_.gain_schedule},
      {Setting::kBalanceLockout, 0},
      {Setting::kOperationalMode, kModeBalance},
  };
  const Step& step = steps[step_ % kSteps];
  ++step_;
  // A base that balances may still roll on its arc, after the driver before this one.
  const bool rolls_out = wanted.v == 0.0 && reported_ == Mode::kBalancing;
  const geometry::Twist2 turn{0.0, rolls_out ? wanted.w : 0.0};
  output_ = command(turn, parameters_.calibration, step.setting, step.value);
  return output_;
}

}  // namespace usher::segway_rmp
