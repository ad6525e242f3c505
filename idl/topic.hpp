#pragma once

#include <string_view>

namespace usher::topics {

/// Reader or writer side of the quality of service: reliability, durability and depth, nothing
/// else.
struct Qos {
  bool reliable = true;
  bool latched = false;  ///< transient local
  int depth = 1;         ///< of a writer's history and of a reader's mailbox per writer
  bool operator==(const Qos&) const = default;
};

/// The four kinds of topics . Writers are always reliable; readers of streams choose best effort.
enum class Kind { kStream, kCommand, kLatched, kEvent };

/// Who shares a topic: the components of one robot, in its own DDS domain, or all robots of a
/// fleet, in a second one.
enum class Scope { kRobot, kFleet };

/// One topic of the catalogue: its name on the wire is "rt/" + name, its type the message's ROS 2
/// type name.
template <class M>
struct Topic {
  using Message = M;
  std::string_view name;
  Kind kind = Kind::kStream;
  int depth = 1;
  double rate_hz = 0.0;  ///< nominal; 0 = on occasion
  std::string_view
      writers;  ///< component types that may write it, separated by spaces; "*" = every component
  std::string_view text;
  Scope scope = Scope::kRobot;

  constexpr Qos writer_qos() const { return {true, kind == Kind::kLatched, depth}; }
  constexpr Qos reader_qos() const {
    return {kind != Kind::kStream, kind == Kind::kLatched, depth};
  }
};

}  // namespace usher::topics
