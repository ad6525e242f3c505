#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "runtime/api/host.hpp"
#include "runtime/engine/platform.hpp"
#include "usher_msgs.h"

namespace usher::runtime {

/// What the heartbeat says: the component's own words, its counters, and how long its handlers
/// take. A component whose handlers take too long again and again is degraded, whatever it says.
class Heart final : public Health {
 public:
  static constexpr std::size_t kMaxCounters = 64;  ///< more are kept but not sent
  /// So many handlers over the limit within kSlowWindow are no accident of the scheduler.
  static constexpr std::size_t kSlowHandlers = 5;
  static constexpr auto kSlowWindow = std::chrono::seconds(1);

  /// `handler_limit`: how long a handler may take.
  Heart(const std::string& component_name, const std::string& host, Duration handler_limit);

  void set(HealthState state, std::string reason = {}) override;
  std::uint64_t& counter(const std::string& name) override { return counters_[name]; }

  /// The engine's way to say that the component has ended.
  void end(const std::string& reason);
  /// "input " "scan" took so long, until `now`.
  void handler_took(Duration duration, Time now, const char* kind, const std::string& subject);
  /// The message to write now; the handler times start anew.
  const usher_msgs::msg::Heartbeat& beat(Time now, const Resources& resources,
                                         std::uint64_t samples_lost);

 private:
  bool slow(Time now) const;

  const Duration handler_limit_;
  std::map<std::string, std::uint64_t> counters_;
  Duration longest_{}, total_{};
  std::array<Time, kSlowHandlers> slow_at_{};  ///< of the last ones, a ring
  std::size_t slow_count_ = 0;
  std::string slow_reason_;
  std::uint8_t state_ = 0;  ///< the component's own words
  std::string reason_;
  usher_msgs::msg::Heartbeat message_;
};

}  // namespace usher::runtime
