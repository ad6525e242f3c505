#pragma once

#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// What a deployment's components were given of the site.
struct SiteRoom {
  std::string name;
  geometry::Point2 low{0, 0}, high{0, 0};  ///< [m] in map, between its walls
  bool contains(const geometry::Point2& point) const {
    return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
  }
};

Result<grid::OccupancyGrid> site_map(const Deployment& deployment);
struct SitePlace {
  std::string name;
  geometry::Pose2 pose;  ///< of base_footprint in map
};

/// The site's locations.
Result<std::vector<SitePlace>> site_places(const Deployment& deployment);
/// Names of the locations; the robot usually starts at the first one.
Result<std::vector<std::string>> site_locations(const Deployment& deployment);
Result<std::vector<SiteRoom>> site_meeting_rooms(const Deployment& deployment);
/// The robot's outline on the floor, in base_footprint [m].
Result<std::vector<geometry::Point2>> robot_footprint(const Deployment& deployment);
/// The file of the building around the robot (world.yaml).
Result<std::string> site_world(const Deployment& deployment);

/// Another value of the site for all who were given it.
void set_site_value(Deployment& deployment, const std::string& name, const std::string& yaml);
/// Another value of one component's own parameter.
void set_value(Deployment& deployment, const std::string& component, const std::string& name,
               const std::string& yaml);

}  // namespace usher::operations
