#pragma once

#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "runtime/api/host.hpp"

namespace usher::wire {

/// A room to which people are brought, and in which nobody is looked for.
struct MeetingRoom {
  std::string name;                        ///< of the location where the robot turns round in it
  geometry::Point2 low{0, 0}, high{0, 0};  ///< [m] in map, between its walls
};

/// From the parameter site.meeting_rooms. Walls that are none end the component with the reason.
std::vector<MeetingRoom> read_meeting_rooms(runtime::Host& host);

}  // namespace usher::wire
