#include "runtime/engine/inbox.hpp"

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

namespace usher::runtime {
namespace {

bool earlier(const Arrival& a, const Arrival& b) {
  return std::tie(a.at, a.order, a.ticket) < std::tie(b.at, b.order, b.ticket);
}

}  // namespace

Inbox::Inbox(Platform& platform, std::size_t max_posted, std::size_t max_writers)
    : platform_(&platform), max_posted_(max_posted), max_writers_(max_writers) {}

std::uint32_t Inbox::add_input(const InputDeclaration& declaration) {
  assert(declaration.qos.depth > 0);
  const bool handled = static_cast<bool>(declaration.on_sample);
  Mailbox mailbox;
  mailbox.type = declaration.type;
  mailbox.depth = handled ? static_cast<std::size_t>(declaration.qos.depth) : 1;
  mailbox.wakes = handled;
  mailboxes_.push_back(std::move(mailbox));
  counts_.emplace_back();
  return static_cast<std::uint32_t>(mailboxes_.size() - 1);
}

Inbox::Slot& Inbox::slot_of(Mailbox& mailbox, const Guid& writer) {
  auto& slots = mailbox.slots;
  const auto known = std::find_if(slots.begin(), slots.end(),
                                  [&](const Slot& slot) { return slot.writer == writer; });
  if (known != slots.end()) return *known;
  if (slots.size() < max_writers_) {
    slots.emplace_back();
    slots.back().ring.resize(mailbox.depth);
  } else {
    // The writer that was silent for longest is forgotten, with what it left.
    const auto oldest = std::min_element(
        slots.begin(), slots.end(), [](const Slot& a, const Slot& b) { return a.heard < b.heard; });
    mailbox.counts.lost += oldest->count;
    mailbox.waiting -= oldest->count;
    std::swap(*oldest, slots.back());
    slots.back().count = 0;
    slots.back().last_number = 0;
  }
  slots.back().writer = writer;
  return slots.back();
}

void Inbox::deliver(std::uint32_t input, std::shared_ptr<const void> message, const Guid& writer,
                    std::uint64_t number, bool same_host) {
  const std::lock_guard lock(mutex_);
  if (platform_ == nullptr) return;
  Mailbox& mailbox = mailboxes_[input];
  if (message == nullptr) {
    ++mailbox.counts.rejected;
    return;
  }
  Slot& slot = slot_of(mailbox, writer);
  const Time now = platform_->now();
  slot.heard = now;
  // A writer numbers its samples; a latched value that comes again after a new match is not news.
  if (number <= slot.last_number) return;
  slot.last_number = number;
  if (slot.count == mailbox.depth) {
    slot.first = (slot.first + 1) % mailbox.depth;
    if (mailbox.wakes) ++mailbox.counts.lost;
  } else {
    ++slot.count;
    ++mailbox.waiting;
  }
  Arrival& arrival = slot.ring[(slot.first + slot.count - 1) % mailbox.depth];
  arrival.at = now;
  arrival.order = input + 1;
  arrival.ticket = next_ticket_++;
  const auto stamp = same_host ? mailbox.type->stamp(message.get()) : std::nullopt;
  arrival.sample.info = {writer, now, number, same_host, stamp && *stamp <= now ? *stamp : now};
  arrival.sample.message = std::move(message);
  if (mailbox.wakes) signal();
}

void Inbox::post(std::function<void()> event) {
  const std::lock_guard lock(mutex_);
  if (platform_ == nullptr) return;
  if (posted_.size() < max_posted_) {
    Arrival arrival;
    arrival.at = platform_->now();
    arrival.ticket = next_ticket_++;
    arrival.posted = std::move(event);
    posted_.push_back(std::move(arrival));
  } else {
    overflow_ = true;
  }
  signal();
}

void Inbox::signal() {
  if (!work_.exchange(true, std::memory_order_acq_rel)) platform_->wake();
}

bool Inbox::take(std::vector<Arrival>& batch) {
  batch.clear();
  bool complete = true;
  {
    const std::lock_guard lock(mutex_);
    work_.store(false, std::memory_order_release);
    for (Arrival& arrival : posted_) batch.push_back(std::move(arrival));
    posted_.clear();
    for (std::size_t i = 0; i < mailboxes_.size(); ++i) {
      Mailbox& mailbox = mailboxes_[i];
      counts_[i] = mailbox.counts;
      if (mailbox.waiting == 0) continue;
      for (Slot& slot : mailbox.slots) {
        for (; slot.count > 0; --slot.count) {
          batch.push_back(std::move(slot.ring[slot.first]));
          slot.first = (slot.first + 1) % mailbox.depth;
        }
      }
      mailbox.waiting = 0;
    }
    complete = !std::exchange(overflow_, false);
  }
  if (batch.size() > 1) std::sort(batch.begin(), batch.end(), earlier);
  return complete;
}

void Inbox::close() {
  const std::lock_guard lock(mutex_);
  platform_ = nullptr;
  work_.store(false, std::memory_order_release);
  for (Mailbox& mailbox : mailboxes_) mailbox.slots.clear();
  posted_.clear();
}

}  // namespace usher::runtime
