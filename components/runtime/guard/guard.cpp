#include "runtime/guard/guard.hpp"

#include <algorithm>
#include <cassert>

namespace usher::runtime {

Guard::Guard(std::vector<std::uint8_t> safe, Time silence)
    : safe_(std::move(safe)), silence_(silence) {
  assert(!safe_.empty() && silence > Time::zero());
  waiting_.reserve(kMostWaiting + safe_.size());
  lengths_.reserve(kMostMessages + 1);
}

void Guard::append(std::span<const std::uint8_t> message) {
  waiting_.insert(waiting_.end(), message.begin(), message.end());
  lengths_.push_back(message.size());
}

bool Guard::heard(std::span<const std::uint8_t> message, Time now) {
  heard_at_ = now;
  overruling_ = false;
  if (message.empty()) return true;
  if (waiting_.size() + message.size() > kMostWaiting || lengths_.size() == kMostMessages)
    return false;
  append(message);
  return true;
}

void Guard::put_safe(Time now) {
  const std::size_t kept = first_under_way_ ? lengths_.front() : 0;
  waiting_.resize(kept);
  lengths_.resize(first_under_way_ ? 1 : 0);
  append(safe_);
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
  if (gone_) return farewells_ > 0 ? std::optional<Time>(safe_at_ + kRepeat) : std::nullopt;
  return overruling_ ? safe_at_ + kRepeat : *heard_at_ + silence_;
}

std::span<const std::uint8_t> Guard::output() const { return waiting_; }

void Guard::sent(std::size_t count) {
  assert(count <= waiting_.size());
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
  std::size_t whole = 0;
  while (whole < lengths_.size() && count >= lengths_[whole]) count -= lengths_[whole++];
  lengths_.erase(lengths_.begin(), lengths_.begin() + static_cast<std::ptrdiff_t>(whole));
  if (whole > 0) first_under_way_ = false;
  if (count > 0) {
    lengths_.front() -= count;
    first_under_way_ = true;
  }
}

}  // namespace usher::runtime
