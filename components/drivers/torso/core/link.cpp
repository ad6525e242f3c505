#include "drivers/torso/core/link.hpp"

#include <array>

namespace usher::torso {

namespace {

constexpr std::array<serial_frame::Parts, 2> kParts{
    {{kinematics::kTorsoJoints, "joints"}, {2, "eyes"}}};
constexpr std::uint8_t kHolds = serial_frame::kWatchdogExpired | kServosOff;
constexpr std::array<serial_frame::Trouble, 4> kTroubles{
    {{serial_frame::kWatchdogExpired, "the board missed this host"},
     {kServosOff, "servos off"},
     {kSupplyLow, "supply low"},
     {kJointStuck, "a joint is stuck"}}};

}  // namespace

Link::Link() : dialogue_({}, kParts) {}

void Link::opened(Time now) {
  dialogue_.opened(now);
  due_.reset();
}

void Link::closed() { dialogue_.closed(); }

void Link::show(const TorsoFrame& frame) {
  if (kinematics::finite(frame.joints)) due_ = frame;
}

void Link::tick(Time now) {
  dialogue_.tick(now);
  if (!due_ || !dialogue_.greeted()) return;
  dialogue_.send(set_frame(dialogue_.next_sequence(), *due_));
  due_.reset();
}

bool Link::take(std::span<const std::uint8_t> content, Time now) {
  const auto said = parse(content);
  if (!said) {
    dialogue_.reject();
    return false;
  }
  dialogue_.count(said->sequence);
  if (!dialogue_.believes(said->state.status, now)) return false;
  reading_ = {now, said->state.frame, (said->state.status & kHolds) == 0};
  return true;
}

std::string Link::reason(Time now) const {
  const std::string reason = dialogue_.reason(now, "no word from the board");
  return reason.empty() ? serial_frame::describe(dialogue_.status(), kTroubles) : reason;
}

}  // namespace usher::torso
