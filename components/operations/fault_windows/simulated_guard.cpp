#include "operations/fault_windows/simulated_guard.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "idl/topics.hpp"

namespace usher::operations {

namespace {

using namespace std::chrono_literals;

constexpr auto kSilence = 100ms;  // guard_silence of segway_rmp
constexpr auto kPeriod = 5ms;     // more than the end of a driver takes to be seen
// The line carries no bytes here: one stands for whatever the driver writes, one for zero.
constexpr std::uint8_t kZero = 0;
constexpr std::array<std::uint8_t, 1> kDriven = {1};

}  // namespace

SimulatedGuard::SimulatedGuard(runtime::LockstepWorld& world, std::string driver)
    : world_(world), driver_(std::move(driver)) {
  world_.observe(topics::kSimBaseCommand, [this](const auto&, const auto& info) {
    if (!guard_ || world_.participant_of(info.writer) != driver_) return;
    guard_->heard(runtime::Outbox::Kind::kLatest, kDriven, now());
    pass();
  });
  watch();
}

void SimulatedGuard::watch() {
  if (const std::uint64_t life = world_.lives(driver_); life != life_ || !guard_) {
    life_ = life;
    guard_.emplace(std::vector{kZero}, kSilence);
    guard_->greet();
  }
  if (!world_.running(driver_)) guard_->gone(now());
  guard_->tick(now());
  pass();
  world_.at(world_.now() + kPeriod, [this] { watch(); });
}

void SimulatedGuard::pass() {
  const auto output = guard_->output();
  const bool zero = std::ranges::find(output, kZero) != output.end();
  guard_->sent(output.size());
  if (zero) world_.publish(topics::kSimBaseCommand, {}, "usher-guard");
}

}  // namespace usher::operations
