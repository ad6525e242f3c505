#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "runtime/api/host.hpp"
#include "runtime/engine/platform.hpp"
#include "usher_msgs.h"

namespace usher::runtime {

/// What the heartbeat says: the component's own words, its counters, and how long its handlers
/// take.
class Heart final : public Health {
 public:
  static constexpr std::size_t kMaxCounters = 64;  ///< more are kept but not sent

  Heart(const std::string& component_name, const std::string& host);

  void set(HealthState state, std::string reason = {}) override;
  std::uint64_t& counter(const std::string& name) override { return counters_[name]; }

  /// The engine's way to say that the component has ended.
  void end(const std::string& reason);
  void handler_took(Duration duration);
  /// The message to write now; the handler times start anew.
  const usher_msgs::msg::Heartbeat& beat(Time now, const Resources& resources,
                                         std::uint64_t samples_lost);

 private:
  std::map<std::string, std::uint64_t> counters_;
  Duration longest_{}, total_{};
  usher_msgs::msg::Heartbeat message_;
};

}  // namespace usher::runtime
