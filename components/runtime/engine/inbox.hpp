#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "runtime/api/ports.hpp"
#include "runtime/engine/platform.hpp"

namespace usher::runtime {

/// A sample or a posted event on its way to a handler.
struct Arrival {
  static constexpr std::uint32_t kPosted = 0;

  Time at{};
  std::uint32_t order = kPosted;  ///< 1 + index of the input; posted events go first
  std::uint64_t ticket = 0;       ///< in the order in which the inbox was entered
  InputPort::Sample sample;
  std::function<void()> posted;
};

/// Where everything waits that enters a component from outside: a mailbox per input with a slot per
/// writer, and posted events. Any thread puts, the dispatcher takes. It outlives its engine as long
/// as somebody may still put.
class Inbox {
 public:
  struct Counts {
    std::uint64_t lost = 0;
    std::uint64_t rejected = 0;
  };

  Inbox(Platform& platform, std::size_t max_posted, std::size_t max_writers);

  /// An input that runs no handler keeps the newest sample only, loses none and wakes nobody.
  /// Before the first deliver.
  std::uint32_t add_input(const InputDeclaration& declaration);

  // --- Any thread
  void deliver(std::uint32_t input, std::shared_ptr<const void> message, const Guid& writer,
               std::uint64_t number, bool same_host);
  void post(std::function<void()> event);
  bool has_work() const { return work_.load(std::memory_order_acquire); }

  // --- Dispatcher
  /// Moves everything that waits into `batch` (replaced), ordered by arrival, then by declaration;
  /// false when so many events were posted that some were dropped. Updates the counts.
  bool take(std::vector<Arrival>& batch);
  const Counts& counts(std::uint32_t input) const { return counts_[input]; }
  /// From now on everything that is put is dropped.
  void close();

 private:
  /// What one writer has sent: the last `depth` samples.
  struct Slot {
    Guid writer{};
    std::uint64_t last_number = 0;
    Time heard{};
    std::size_t first = 0, count = 0;
    std::vector<Arrival> ring;
  };
  struct Mailbox {
    const MessageType* type = nullptr;
    std::size_t depth = 1;
    bool wakes = true;
    std::size_t waiting = 0;
    std::vector<Slot> slots;
    Counts counts;
  };

  Slot& slot_of(Mailbox& mailbox, const Guid& writer);
  void signal();

  mutable std::mutex mutex_;
  Platform* platform_;  ///< null after close
  const std::size_t max_posted_, max_writers_;
  std::atomic<bool> work_{false};
  std::uint64_t next_ticket_ = 0;
  std::vector<Mailbox> mailboxes_;
  std::vector<Arrival> posted_;
  bool overflow_ = false;
  std::vector<Counts> counts_;  ///< the dispatcher's copy
};

}  // namespace usher::runtime
