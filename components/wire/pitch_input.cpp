#include "wire/pitch_input.hpp"

#include <utility>

namespace usher::wire {

namespace {
using runtime::HealthState;
using std::chrono::milliseconds;
constexpr auto kMaxAge = milliseconds(100);
constexpr auto kUprightAge = milliseconds(250);  // statuses as old as its reports, ten a second
constexpr auto kFuture = milliseconds(20);
}  // namespace

PitchInput::PitchInput(runtime::Host& host, const char* on_loss, std::function<void()> on_pitch,
                       HealthState without)
    : host_(host),
      on_pitch_(std::move(on_pitch)),
      without_(without),
      upright_(host.parameters().choice("robot.base", {"segway", "pioneer"}, "segway",
                                        "What kind of base it is.") == "pioneer"),
      refused_(host.health().counter("base/status: refused")),
      base_(host.input(
          topics::kBaseStatus, {.max_age = upright_ ? kUprightAge : kMaxAge, .on_loss = on_loss},
          [this](const auto& status, const auto&) { take(status); },
          [this] { host_.health().set(without_, "no pitch"); })) {}

Result<estimation::Pitch> PitchInput::at(Time stamp) const {
  if (!upright_) return history_.at(stamp.time_since_epoch());
  if (!current()) return Error{"nothing was heard of the base for 100 ms"};
  return estimation::Pitch{};
}

/// Not once the loss was reported, which is said once.
bool PitchInput::current() const {
  return base_.fresh() != nullptr && host_.now() - heard_ <= kMaxAge;
}

void PitchInput::take(const usher_msgs::msg::BaseStatus& status) {
  const bool connected =
      status.state() != usher_msgs::msg::BaseStatus_Constants::STATE_DISCONNECTED;
  const Status added = !connected ? Error{"the base is disconnected"}
                       : upright_ ? Status{}
                                  : add(status);
  if (added) {
    heard_ = host_.now();
    on_pitch_();
    return;
  }
  if (connected) ++refused_;
  if (!current()) host_.health().set(without_, "no pitch: " + added.error());
}

Status PitchInput::add(const usher_msgs::msg::BaseStatus& status) {
  const Time stamp = from_message(status.header().stamp());
  if (const auto ahead = stamp - host_.now(); ahead > kFuture) {
    return Error{"base/status must be stamped at most 20 ms ahead of now, got " +
                 std::to_string(std::chrono::duration_cast<milliseconds>(ahead).count()) + " ms"};
  }
  return history_.add(stamp.time_since_epoch(), {status.pitch(), status.pitch_rate()});
}

}  // namespace usher::wire
