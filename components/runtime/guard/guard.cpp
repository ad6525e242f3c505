#include "runtime/guard/guard.hpp"

#include <cassert>
#include <utility>

namespace usher::runtime {

Guard::Guard(std::vector<std::uint8_t> safe, Time silence)
    : safe_(std::move(safe)), silence_(silence), repeat_(silence / kRepeats) {
  assert(!safe_.empty() && silence > Time::zero());
  will_.reserve(kLongestWill);
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
  silent_since_.reset();
  // A safe message has room even behind a large one that is on its way.
  if (message.size() + kLongestWill + safe_.size() > Outbox::kMostBytes) return false;
  return outbox_.push(kind, message);
}

void Guard::will(std::span<const std::uint8_t> message, Time lasts) {
  const bool counts = message.size() <= kLongestWill && lasts > Time::zero();
  will_.assign(message.begin(), counts ? message.end() : message.begin());
  will_lasts_ = lasts;
}

void Guard::overrule(Time now) {
  overruling_ = true;
  outbox_.drop_unsent();
  const bool willed =
      silent_since_ && !gone_ && !will_.empty() && now - *silent_since_ < will_lasts_;
  const bool taken = outbox_.push(Outbox::Kind::kLatest, willed ? will_ : safe_);
  assert(taken);
  static_cast<void>(taken);
  safe_at_ = now;
}

void Guard::gone(Time now) {
  if (gone_) return;
  gone_ = true;
  if (!heard_at_) return;
  farewells_ = kFarewells - 1;
  overrule(now);
}

void Guard::tick(Time now) {
  const auto next = due();
  if (!next || now < *next) return;
  if (gone_) --farewells_;
  if (!silent_since_) silent_since_ = now;
  overrule(now);
}

std::optional<Guard::Time> Guard::due() const {
  if (!heard_at_) return std::nullopt;
  if (gone_) return farewells_ > 0 ? std::optional<Time>(safe_at_ + kFarewellEvery) : std::nullopt;
  return overruling_ ? safe_at_ + repeat_ : *heard_at_ + silence_;
}

}  // namespace usher::runtime
