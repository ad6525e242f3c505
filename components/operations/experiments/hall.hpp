#pragma once

#include <string>
#include <utility>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// A building of one room for one experiment, with nothing to guide to but what `places` names.
struct Hall {
  std::string world;      ///< as in world.yaml
  std::string people{};   ///< as in people.yaml; empty = nobody
  geometry::Pose2 start;  ///< the location "start"
  std::vector<std::pair<std::string, geometry::Pose2>> places{};  ///< other locations, by name
};

/// A deployment of `deploy/MANIFEST.yaml` in the hall: writes its site into `folder`, which exists.
Result<Deployment> deploy_in_hall(const Hall& hall, const std::string& manifest,
                                  const std::string& folder, const Installation& installation,
                                  const std::vector<Override>& overrides);

}  // namespace usher::operations
