#pragma once

#include <cstdint>
#include <string>

namespace usher::service {

/// The supervisor's states as far as they concern a task.
enum class Supervisor : std::uint8_t {
  kUnknown,     ///< nothing fresh heard
  kNotReady,    ///< initialising
  kInactive,    ///< nothing may move for now
  kAvailable,   ///< Interaction
  kNavigation,  ///< Navigation start, active, end
  kManual,
  kFault,
};

enum class RequestKind : std::uint8_t {
  kNavigationStart,  ///< a goal is chosen; carries its name
  kNavigationGo,     ///< the visitor is ready
  kNavigationEnd,
  kStop,        ///< the visitor wants to stop for a moment, or is waited for
  kMovementOn,  ///< and to go on
};

/// To the supervisor. To be repeated until it is answered.
struct Request {
  RequestKind kind = RequestKind::kNavigationEnd;
  std::string goal;
  bool operator==(const Request&) const = default;
};

}  // namespace usher::service
