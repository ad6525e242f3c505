#pragma once

#include <cstdint>

namespace usher {

/// Of a goal, whoever pursues it; the values of GoalStatus in usher_msgs.
enum class GoalState : std::uint8_t {
  kIdle = 0,
  kActive = 1,
  kWaiting = 2,
  kSucceeded = 3,
  kFailed = 4,
  kCancelled = 5,
  kReplaced = 6,
};

}  // namespace usher
