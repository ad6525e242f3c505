#pragma once

#include <optional>
#include <string>

#include "idl/topics.hpp"

namespace usher::operations {

/// How a visit stands that has not ended long after it should have.
struct OpenVisit {
  bool stands = false;                                          ///< the robot, for a while
  std::optional<usher_msgs::msg::SupervisorStatus> supervisor;  ///< its newest word
};

/// Who holds the robot that stands, other than the guide, whose questions all have a time-out.
/// Nothing: it is a dead end.
std::optional<std::string> waits_safely_for(const OpenVisit& visit);

}  // namespace usher::operations
