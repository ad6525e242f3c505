#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "runtime/api/time.hpp"

namespace usher::runtime {

/// What happens next on the virtual clock: a binary heap over (time, rank, order), so that the
/// order of equal times is the same in every run.
class Schedule {
 public:
  /// At one moment: first what the world does, then deliveries, then turns in the order of the
  /// components.
  enum class Rank : std::uint8_t { kAction, kDelivery, kTurn };
  struct Event {
    Time at;
    Rank rank;
    std::uint64_t order;
    std::uint32_t index;  ///< of the action, delivery or component
  };

  explicit Schedule(Time start) : now_(start) {}

  Time now() const { return now_; }
  void advance_to(Time time) { now_ = time; }

  void add_action(Time at, std::function<void()> action);
  void add_delivery(Time at, std::uint32_t index) {
    push({at, Rank::kDelivery, next_order_++, index});
  }
  void add_turn(Time at, std::uint32_t component) { push({at, Rank::kTurn, component, component}); }

  /// Takes the next event that is due until `limit` and moves the clock there; false when there is
  /// none.
  bool next(Time limit, Event& event);
  std::function<void()> take_action(std::uint32_t index);

 private:
  void push(const Event& event);

  Time now_;
  std::uint64_t next_order_ = 0;
  std::vector<Event> heap_;
  std::vector<std::function<void()>> actions_;
  std::vector<std::uint32_t> free_actions_;
};

}  // namespace usher::runtime
