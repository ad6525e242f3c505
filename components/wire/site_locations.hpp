#pragma once

#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "runtime/api/parameters.hpp"

namespace usher::wire {

/// A place of the site that has a name, as it is written there.
struct SiteLocation {
  std::string name;      ///< identifier
  std::string title;     ///< for people
  geometry::Pose2 pose;  ///< in map: where the robot stands when it is there
};

/// From the parameter site.locations; empty when it is not set. Names may repeat.
std::vector<SiteLocation> read_locations(runtime::Parameters& parameters);

}  // namespace usher::wire
