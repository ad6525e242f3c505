#include "drivers/torso/core/link.hpp"

#include <utility>

namespace usher::torso {

namespace {

constexpr std::uint8_t kProtocolVersion = 1;
constexpr std::uint8_t kEyes = 2;
constexpr std::uint8_t kHolds = kWatchdogExpired | kServosOff;

}  // namespace

Link::Link() : Link(Parameters{}) {}

Link::Link(const Parameters& parameters) : parameters_(parameters) {}

void Link::opened(Time now) {
  open_ = true;
  greeted_ = false;
  opened_at_ = now;
  hello_sent_.reset();
  sent_.reset();
  heard_at_.reset();
  last_sequence_.reset();
  due_.reset();
  status_ = 0;
  refusal_.clear();
  output_.clear();
  decoder_.reset();
}

void Link::closed() {
  open_ = false;
  heard_at_.reset();
  output_.clear();
}

void Link::show(const TorsoFrame& frame) {
  if (kinematics::finite(frame.joints)) due_ = frame;
}

void Link::send(const serial_frame::Frame& frame, Time now) {
  output_.insert(output_.end(), frame.bytes.begin(),
                 frame.bytes.begin() + static_cast<std::ptrdiff_t>(frame.size));
  sent_ = now;
}

std::vector<std::uint8_t> Link::take_output() { return std::exchange(output_, {}); }

void Link::tick(Time now) {
  if (!open_ || (!greeted_ && now - opened_at_ < parameters_.boot)) return;
  if (!greeted_ && (!hello_sent_ || now - *hello_sent_ >= parameters_.boot)) {
    send(hello_request(sequence_++), now);
    hello_sent_ = now;
  }
  if (due_ && greeted_ && refusal_.empty()) {
    send(set_frame(sequence_++, *due_), now);
    due_.reset();
  }
  if (!sent_ || now - *sent_ >= parameters_.heartbeat) send(heartbeat(sequence_++), now);
}

void Link::take(const Hello& hello) {
  greeted_ = true;
  refusal_.clear();
  if (hello.protocol_version != kProtocolVersion) {
    refusal_ =
        "expected protocol version 1, the board speaks " + std::to_string(hello.protocol_version);
  } else if (hello.joints != kinematics::kTorsoJoints || hello.eyes != kEyes) {
    refusal_ = "expected 7 joints and 2 eyes, the board has ";
    refusal_ += std::to_string(hello.joints) + " and " + std::to_string(hello.eyes);
  }
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
  const auto& state = std::get<State>(message->content);
  // The board restarted and its hello was lost: it is another board until it is greeted.
  if ((state.status & kRebooted) != 0 && (status_ & kRebooted) == 0) {
    greeted_ = false;
    hello_sent_.reset();
  }
  status_ = state.status;
  if (!greeted_ || !refusal_.empty()) return false;
  heard_at_ = now;
  reading_ = {now, state.frame, (state.status & kHolds) == 0};
  return true;
}

bool Link::healthy(Time now) const {
  return open_ && greeted_ && refusal_.empty() && heard_at_ &&
         now - *heard_at_ < parameters_.silence;
}

std::string Link::reason(Time now) const {
  if (!open_) return "not connected";
  if (!refusal_.empty()) return refusal_;
  if (!healthy(now)) return heard_at_ ? "no word from the board" : "waiting for the board";
  std::string text;
  const auto add = [&](std::uint8_t bit, const char* meaning) {
    if ((status_ & bit) == 0) return;
    if (!text.empty()) text += ", ";
    text += meaning;
  };
  add(kWatchdogExpired, "the board missed this host");
  add(kServosOff, "servos off");
  add(kSupplyLow, "supply low");
  add(kJointStuck, "a joint is stuck");
  return text;
}

}  // namespace usher::torso
