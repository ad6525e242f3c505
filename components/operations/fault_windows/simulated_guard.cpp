#include "operations/fault_windows/simulated_guard.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "idl/topics.hpp"

namespace usher::operations {

namespace {

using namespace std::chrono_literals;

constexpr auto kPeriod = 5ms;  // more than the end of a driver takes to be seen
// The line carries no bytes here: one stands for whatever the driver writes, one for zero.
constexpr std::uint8_t kZero = 0;
constexpr std::array<std::uint8_t, 1> kDriven = {1};

}  // namespace

SimulatedGuard::SimulatedGuard(runtime::LockstepWorld& world, std::string driver,
                               runtime::Guard::Time silence)
    : world_(world), driver_(std::move(driver)), silence_(silence) {
  // Before whatever a fault does to the line, which lies behind the guard.
  world_.tamper_bytes(std::string(topics::kSimBaseCommand.name),
                      [this](const runtime::Guid& writer, runtime::Bytes&) {
                        if (world_.participant_of(writer) == driver_) hear();
                        return true;
                      });
  watch();
}

void SimulatedGuard::watch() {
  if (const std::uint64_t life = world_.lives(driver_); life != life_ || !guard_) {
    life_ = life;
    guard_.emplace(std::vector{kZero}, silence_);
    guard_->greet();
  }
  if (!world_.running(driver_)) guard_->gone(now());
  guard_->tick(now());
  pass();
  world_.at(world_.now() + kPeriod, [this] { watch(); });
}

/// What the driver writes goes its own way: nothing but a zero is ever left to be sent.
void SimulatedGuard::hear() {
  guard_->heard(runtime::Outbox::Kind::kLatest, kDriven, now());
  guard_->sent(guard_->output().size());
}

void SimulatedGuard::pass() {
  const auto output = guard_->output();
  const bool zero = std::ranges::find(output, kZero) != output.end();
  guard_->sent(output.size());
  if (zero) world_.publish(topics::kSimBaseCommand, {}, "usher-guard");
}

}  // namespace usher::operations
