#include "simulation/visitor/core/attendee.hpp"

namespace usher::visitor {

void Attendee::see(const Screen& screen, bool asked, double now) {
  if (screen.state == "invite" && !arrived()) {
    if (asked && screen.id != answered_ && screen.id != asked_by_) {
      asked_by_ = screen.id;
      asked_at_ = now;
    }
    return;
  }
  asked_by_ = 0;
  if (!accepted_) return;
  if (screen.state == "guide" || screen.state == "look_back") {
    const bool strays = manner_ == Manner::kStrays && now - accepted_at_ >= stray_time_;
    if (strays) {
      manner_ = Manner::kComes;
      accepted_ = false;
    }
    const bool looked_at = screen.state == "look_back" && asked;
    walk_ = strays || looked_at ? Walk::kStand : Walk::kFollow;
  } else if (screen.state == "arrived" || screen.state == "done") {
    walk_ = Walk::kToSeat;
    accepted_ = false;
  } else {  // the robot gave it up
    walk_ = Walk::kStand;
    accepted_ = false;
  }
}

std::optional<std::string> Attendee::answer(double now) {
  if (asked_by_ == 0 || manner_ == Manner::kSilent || now - asked_at_ < reading_time_)
    return std::nullopt;
  answered_ = asked_by_;
  accepted_ = manner_ != Manner::kDeclines;
  accepted_at_ = now;
  asked_by_ = 0;
  return accepted_ ? "yes" : "no";
}

}  // namespace usher::visitor
