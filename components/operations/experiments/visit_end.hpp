#pragma once

#include <optional>
#include <string>

#include "idl/topics.hpp"

namespace usher::operations {

/// How a visit stands that has not ended long after it should have.
struct OpenVisit {
  std::string dialogue;                                         ///< state of the guide
  bool stands = false;                                          ///< the robot, for a while
  std::optional<usher_msgs::msg::SupervisorStatus> supervisor;  ///< its newest word
};

/// What the visit waits for, safely: a visitor who stopped the robot, whoever else holds it, or an
/// answer to what went wrong. Nothing: it is a dead end, whether the robot stands or not.
std::optional<std::string> waits_safely_for(const OpenVisit& visit);

}  // namespace usher::operations
