#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "idl/topics.hpp"
#include "wire/repeater.hpp"

namespace usher::wire {

/// Whether a stop in the name of `client` holds; nothing while its own request is not answered yet.
/// An operator ends every stop, and a restart may forget one: who stops the robot believes this.
inline std::optional<bool> own_stop(const usher_msgs::msg::SupervisorStatus& status,
                                    const std::string& client,
                                    const Repeater<usher_msgs::msg::SupervisorRequest>& requests) {
  if (requests.waits()) return std::nullopt;
  return std::ranges::find(status.stopped_by(), client) != status.stopped_by().end();
}

}  // namespace usher::wire
