#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "runtime/api/time.hpp"

namespace usher::runtime {

/// Serialised messages: XCDR1 with its 4-byte encapsulation header.
using Bytes = std::vector<std::uint8_t>;

/// What the runtime knows of a message type; one object per type, alive for ever.
struct MessageType {
  std::string_view name;  ///< on the wire, for example "sensor_msgs::msg::dds_::LaserScan_"

  /// Replaces the content of `cdr`. Fails (false) only when memory runs out.
  bool (*serialize)(const void* message, Bytes& cdr);

  /// Null for bytes that are not a message of this type: truncated, wrong encapsulation, absurd
  /// lengths.
  std::shared_ptr<const void> (*deserialize)(std::span<const std::uint8_t> cdr);

  /// The stamp that the message carries (its header's, or its own member `stamp`), where it carries
  /// one.
  std::optional<Time> (*stamp)(const void* message);
};

/// The type object of a generated message class. Defined for every type that a topic of the
/// catalogue carries (runtime/dds/message_types.cpp lists them); a missing one is a link error.
template <class Message>
const MessageType& message_type();

}  // namespace usher::runtime
