#pragma once

#include <string_view>

#include "runtime/api/message_type.hpp"

namespace usher::runtime {

/// The message type that the catalogue (idl/topics.hpp) gives the topic, without "rt/"; null for a
/// topic that is not in it.
const MessageType* message_type_by_topic(std::string_view topic);

/// By type name on the wire ("sensor_msgs::msg::dds_::LaserScan_"); null for types that this
/// program does not know.
const MessageType* message_type_by_name(std::string_view wire_name);

}  // namespace usher::runtime
