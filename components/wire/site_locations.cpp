#include "wire/site_locations.hpp"

namespace usher::wire {

std::vector<SiteLocation> read_locations(runtime::Parameters& parameters) {
  using runtime::ParameterKind;
  const auto records = parameters.records(
      "site.locations",
      {{"name", ParameterKind::kText, "-", {}, "Identifier, unique."},
       {"title", ParameterKind::kText, "-", {}, "For people."},
       {"x", ParameterKind::kNumber, "m", {-1e4, 1e4}, "Where the robot stands, in map."},
       {"y", ParameterKind::kNumber, "m", {-1e4, 1e4}, "The same."},
       {"yaw", ParameterKind::kNumber, "rad", {-6.3, 6.3}, "Which way it looks."}},
      "Known locations of the site.");
  std::vector<SiteLocation> locations;
  locations.reserve(records.size());
  for (const auto& record : records) {
    locations.push_back({record.text("name"),
                         record.text("title"),
                         {record.number("x"), record.number("y"), record.number("yaw")}});
  }
  return locations;
}

}  // namespace usher::wire
