#include "runtime/lockstep/schedule.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace usher::runtime {
namespace {

bool later(const Schedule::Event& a, const Schedule::Event& b) {
  return std::tie(a.at, a.rank, a.order) > std::tie(b.at, b.rank, b.order);
}

}  // namespace

void Schedule::push(const Event& event) {
  heap_.push_back(event);
  heap_.back().at = std::max(event.at, now_);
  std::push_heap(heap_.begin(), heap_.end(), later);
}

void Schedule::add_action(Time at, std::function<void()> action) {
  std::uint32_t index = 0;
  if (free_actions_.empty()) {
    index = static_cast<std::uint32_t>(actions_.size());
    actions_.push_back(std::move(action));
  } else {
    index = free_actions_.back();
    free_actions_.pop_back();
    actions_[index] = std::move(action);
  }
  push({at, Rank::kAction, next_order_++, index});
}

bool Schedule::next(Time limit, Event& event) {
  if (heap_.empty() || heap_.front().at > limit) return false;
  event = heap_.front();
  std::pop_heap(heap_.begin(), heap_.end(), later);
  heap_.pop_back();
  now_ = event.at;
  return true;
}

std::function<void()> Schedule::take_action(std::uint32_t index) {
  free_actions_.push_back(index);
  return std::exchange(actions_[index], nullptr);
}

}  // namespace usher::runtime
