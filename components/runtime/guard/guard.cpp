#include "runtime/guard/guard.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace usher::runtime {

Guard::Guard(std::vector<std::uint8_t> safe, Time silence)
    : safe_(std::move(safe)), silence_(silence), repeat_(silence / kRepeats) {
  assert(!safe_.empty() && silence > Time::zero());
  will_.reserve(kMostWillBytes);
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
  if (message.size() + kMostWillBytes + safe_.size() > Outbox::kMostBytes) return false;
  return outbox_.push(kind, message);
}

void Guard::will(std::span<const std::uint8_t> message, Time lasts) {
  const bool counts = message.size() <= kMostWillBytes && lasts > Time::zero();
  will_.assign(message.begin(), counts ? message.end() : message.begin());
  will_lasts_ = std::min<Time>(lasts, kLongestWill);
}

bool Guard::will_counts(Time now) const {
  return silent_since_ && !will_.empty() && now - *silent_since_ < will_lasts_ &&
         !says_farewell(now);
}

void Guard::overrule(Time now) {
  overruling_ = true;
  if (!silent_since_) silent_since_ = now;
  if (says_farewell(now)) --farewells_;
  outbox_.drop_unsent();
  const bool taken = outbox_.push(Outbox::Kind::kLatest, will_counts(now) ? will_ : safe_);
  assert(taken);
  static_cast<void>(taken);
  safe_at_ = now;
}

void Guard::gone(Time now) {
  if (gone_) return;
  gone_ = true;
  farewell_at_ = now;
  if (!heard_at_) return;
  farewells_ = kFarewells;
  if (!will_.empty()) farewell_at_ = std::max(now, silent_since_.value_or(now) + will_lasts_);
  overrule(now);
}

void Guard::port_wanted(Time now) {
  if (!gone_ || says_farewell(now)) return;
  farewell_at_ = now;
  overrule(now);
}

void Guard::tick(Time now) {
  const auto next = due();
  if (next && now >= *next) overrule(now);
}

std::optional<Guard::Time> Guard::due() const {
  if (!heard_at_) return std::nullopt;
  if (!gone_) return overruling_ ? safe_at_ + repeat_ : *heard_at_ + silence_;
  if (farewells_ == 0) return std::nullopt;
  return says_farewell(safe_at_) ? safe_at_ + kFarewellEvery
                                 : std::min(safe_at_ + repeat_, farewell_at_);
}

}  // namespace usher::runtime
