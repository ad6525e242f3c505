#pragma once

#include <cstdint>

#include "runtime/api/time.hpp"
#include "tasks/service/core/robot.hpp"
#include "tasks/service/core/screen.hpp"
#include "usher_msgs.h"

namespace usher::service {

/// A state of the supervisor on the wire; one that is none is kUnknown.
Supervisor supervisor_from(std::uint8_t state);
/// A command to the supervisor on the wire.
std::uint8_t command_for(RequestKind kind);

/// A screen without what is known of the robot (table 6.2 of the thesis), which the task adds.
usher_msgs::msg::DialogueScreen to_message(const Screen& screen, runtime::Time now);

}  // namespace usher::service
