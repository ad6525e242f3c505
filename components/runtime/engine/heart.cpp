#include "runtime/engine/heart.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace usher::runtime {

using usher_msgs::msg::Heartbeat;
namespace constants = usher_msgs::msg::Heartbeat_Constants;

static_assert(static_cast<int>(HealthState::kStarting) == constants::STATE_STARTING);
static_assert(static_cast<int>(HealthState::kOk) == constants::STATE_OK);
static_assert(static_cast<int>(HealthState::kDegraded) == constants::STATE_DEGRADED);
static_assert(static_cast<int>(HealthState::kFault) == constants::STATE_FAULT);

Heart::Heart(const std::string& component_name, const std::string& host, Duration handler_limit)
    : handler_limit_(handler_limit), state_(constants::STATE_STARTING) {
  message_.component_name(component_name);
  message_.host(host);
  message_.idl_digest(USHER_IDL_DIGEST);
}

void Heart::set(HealthState state, std::string reason) {
  if (state == HealthState::kFault) throw std::logic_error("a component ends with fault()");
  state_ = static_cast<std::uint8_t>(state);
  reason_ = state == HealthState::kOk ? std::string{} : std::move(reason);
}

void Heart::end(const std::string& reason) {
  state_ = constants::STATE_FAULT;
  reason_ = reason;
}

void Heart::handler_took(Duration duration, Time now, const char* kind,
                         const std::string& subject) {
  longest_ = std::max(longest_, duration);
  total_ += duration;
  if (duration <= handler_limit_) return;
  slow_at_[slow_count_++ % kSlowHandlers] = now;
  const auto text = [](Duration time) {
    return std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(time).count());
  };
  slow_reason_ = "slow: " + std::string(kind) + subject + " took " + text(duration) +
                 " ms, at most " + text(handler_limit_) + " ms";
}

bool Heart::slow(Time now) const {
  return slow_count_ >= kSlowHandlers &&
         now - slow_at_[slow_count_ % kSlowHandlers] <= Duration(kSlowWindow);
}

const Heartbeat& Heart::beat(Time now, const Resources& resources, std::uint64_t samples_lost) {
  const auto since_epoch = now.time_since_epoch();
  const auto whole = std::chrono::floor<std::chrono::seconds>(since_epoch);
  message_.header().stamp().sec(static_cast<std::int32_t>(whole.count()));
  message_.header().stamp().nanosec(static_cast<std::uint32_t>((since_epoch - whole).count()));
  const bool is_slow = state_ == constants::STATE_OK && slow(now);
  message_.state(is_slow ? constants::STATE_DEGRADED : state_);
  if (const std::string& why = is_slow ? slow_reason_ : reason_; message_.reason() != why)
    message_.reason(why);
  message_.cpu_percent(resources.cpu_percent);
  message_.memory_bytes(resources.memory_bytes);
  message_.handler_time_max(static_cast<float>(seconds(longest_)));
  message_.handler_time_total(static_cast<float>(seconds(total_)));
  message_.samples_lost(samples_lost);
  longest_ = total_ = Duration::zero();
  // Counters are never removed, so names need writing only when one was added.
  auto& sent = message_.counters();
  const std::size_t count = std::min(counters_.size(), kMaxCounters);
  const bool same_names = sent.size() == count && counters_.size() <= kMaxCounters;
  sent.resize(count);
  auto counter = counters_.begin();
  for (std::size_t i = 0; i < count; ++i, ++counter) {
    if (!same_names) sent[i].name(counter->first);
    sent[i].count(counter->second);
  }
  return message_;
}

}  // namespace usher::runtime
