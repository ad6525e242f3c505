#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/result/result.hpp"

namespace usher::navigator {

/// A place that has a name.
struct Location {
  std::string name;      ///< identifier, unique
  std::string title;     ///< for people
  geometry::Pose2 pose;  ///< in map: where the robot stands when it is there
};

/// The known locations of a site.
class Locations {
 public:
  static constexpr std::size_t kMost = 1000;

  Locations() = default;
  /// Names must be unique and not empty, poses finite, at most kMost; the error names the location.
  static Result<Locations> create(std::vector<Location> locations);

  const std::vector<Location>& all() const { return locations_; }
  /// The location of this name, exactly; the error lists the names that are close (at most five),
  /// or some of the known ones when none is: "unknown location \"kichen\", did you mean kitchen?"
  Result<Location> find(std::string_view name) const;

 private:
  std::vector<Location> locations_;
};

}  // namespace usher::navigator
