#pragma once

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::map_server {

/// Publishes the site's map, once and for everybody who comes later. Without a map that can be read
/// it ends with a fault.
class MapServerComponent final : public runtime::Component {
 public:
  explicit MapServerComponent(runtime::Host& host);

 private:
  runtime::Output<nav_msgs::msg::OccupancyGrid> map_;
};

}  // namespace usher::map_server
