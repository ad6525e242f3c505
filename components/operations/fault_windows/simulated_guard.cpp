#include "operations/fault_windows/simulated_guard.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "idl/topics.hpp"

namespace usher::operations {

namespace {

using namespace std::chrono_literals;

constexpr auto kPeriod = 5ms;  // more than the end of a driver takes to be seen
// The line carries no bytes here: one stands for whatever the driver writes, one for zero, one for
// what it leaves as its will.
constexpr std::uint8_t kZero = 0, kWill = 2;
constexpr std::array<std::uint8_t, 1> kDriven = {1};

}  // namespace

SimulatedGuard::SimulatedGuard(runtime::LockstepWorld& world, std::string driver,
                               runtime::Guard::Time silence)
    : world_(world), driver_(std::move(driver)), silence_(silence) {
  // Before whatever a fault does to the line, which lies behind the guard.
  world_.tamper(topics::kSimBaseCommand, [this](const runtime::Guid& writer, auto& command) {
    if (world_.participant_of(writer) == driver_) hear({command.v(), command.w()});
    return true;
  });
  watch();
}

void SimulatedGuard::watch() {
  if (const std::uint64_t life = world_.lives(driver_); life != life_ || !guard_) {
    life_ = life;
    guard_.emplace(std::vector{kZero}, silence_);
    guard_->greet();
    roll_out_ = {};
  }
  if (!world_.running(driver_)) guard_->gone(now());
  guard_->tick(now());
  pass();
  world_.at(world_.now() + kPeriod, [this] { watch(); });
}

/// What the driver writes goes its own way: only the guard's own words are left to be sent.
void SimulatedGuard::hear(const geometry::Twist2& told) {
  roll_out_.drive(told, now());
  const auto rest = roll_out_.rest(stopping_);
  will_ = rest.twist;
  guard_->will({&kWill, 1}, rest.lasts);
  guard_->heard(runtime::Outbox::Kind::kLatest, kDriven, now());
  guard_->sent(guard_->output().size());
}

void SimulatedGuard::pass() {
  const auto output = guard_->output();
  const bool speaks = !output.empty(), willed = speaks && output.back() == kWill;
  guard_->sent(output.size());
  if (!speaks) return;
  usher_sim_msgs::msg::BaseCommand command;
  if (willed) command.w(will_.w);
  world_.publish(topics::kSimBaseCommand, command, "usher-guard");
}

}  // namespace usher::operations
