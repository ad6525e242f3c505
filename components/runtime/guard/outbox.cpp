#include "runtime/guard/outbox.hpp"

#include <cassert>

namespace usher::runtime {

Outbox::Outbox() {
  bytes_.reserve(kMostBytes);
  messages_.reserve(kMostMessages);
}

bool Outbox::push(Kind kind, std::span<const std::uint8_t> message) {
  if (message.empty()) return true;
  if (kind != Kind::kEach) drop(kind);
  if (bytes_.size() + message.size() > kMostBytes || messages_.size() == kMostMessages)
    return false;
  bytes_.insert(bytes_.end(), message.begin(), message.end());
  messages_.push_back({kind, message.size()});
  return true;
}

/// There is at most one of it that was not begun.
void Outbox::drop(Kind kind) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < messages_.size(); ++i) {
    const Message& message = messages_[i];
    if (message.kind == kind && (i > 0 || !first_under_way_)) {
      const auto from = bytes_.begin() + static_cast<std::ptrdiff_t>(begin);
      bytes_.erase(from, from + static_cast<std::ptrdiff_t>(message.length));
      messages_.erase(messages_.begin() + static_cast<std::ptrdiff_t>(i));
      return;
    }
    begin += message.length;
  }
}

std::span<const std::uint8_t> Outbox::first() const {
  return messages_.empty() ? waiting() : waiting().first(messages_.front().length);
}

void Outbox::sent(std::size_t count) {
  assert(count <= bytes_.size());
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(count));
  std::size_t whole = 0;
  while (whole < messages_.size() && count >= messages_[whole].length)
    count -= messages_[whole++].length;
  messages_.erase(messages_.begin(), messages_.begin() + static_cast<std::ptrdiff_t>(whole));
  if (whole > 0) first_under_way_ = false;
  if (count > 0) {
    messages_.front().length -= count;
    first_under_way_ = true;
  }
}

void Outbox::drop_unsent() {
  if (!first_under_way_) return clear();
  bytes_.resize(messages_.front().length);
  messages_.resize(1);
}

void Outbox::clear() {
  bytes_.clear();
  messages_.clear();
  first_under_way_ = false;
}

}  // namespace usher::runtime
