#include "runtime/guard/guard.hpp"

#include <cassert>
#include <utility>

namespace usher::runtime {

Guard::Guard(std::vector<std::uint8_t> safe, Time silence)
    : safe_(std::move(safe)), silence_(silence), repeat_(silence / kRepeats) {
  assert(!safe_.empty() && silence > Time::zero());
}

void Guard::greet() {
  assert(!heard_at_ && outbox_.empty());
  // No driver's velocity takes their place.
  for (int i = 0; i < kGreetings; ++i) {
    const bool taken = outbox_.push(Outbox::Kind::kEach, safe_);
    assert(taken);
    static_cast<void>(taken);
  }
}

bool Guard::heard(Outbox::Kind kind, std::span<const std::uint8_t> message, Time now) {
  heard_at_ = now;
  overruling_ = false;
  // A safe message has room even behind a large one that is on its way.
  if (message.size() + safe_.size() > Outbox::kMostBytes) return false;
  return outbox_.push(kind, message);
}

void Guard::put_safe(Time now) {
  outbox_.drop_unsent();
  const bool taken = outbox_.push(Outbox::Kind::kLatest, safe_);
  assert(taken);
  static_cast<void>(taken);
  safe_at_ = now;
}

void Guard::gone(Time now) {
  if (gone_) return;
  gone_ = true;
  if (!heard_at_) return;
  overruling_ = true;
  farewells_ = kFarewells - 1;
  put_safe(now);
}

void Guard::tick(Time now) {
  const auto next = due();
  if (!next || now < *next) return;
  if (gone_) --farewells_;
  overruling_ = true;
  put_safe(now);
}

std::optional<Guard::Time> Guard::due() const {
  if (!heard_at_) return std::nullopt;
  if (gone_) return farewells_ > 0 ? std::optional<Time>(safe_at_ + kFarewellEvery) : std::nullopt;
  return overruling_ ? safe_at_ + repeat_ : *heard_at_ + silence_;
}

}  // namespace usher::runtime
