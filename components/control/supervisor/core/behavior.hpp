#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/base_obedience/core/base_obedience.hpp"

namespace usher::supervisor {

using drive::Time;

/// The states of fig. 6.9 of the thesis, and Fault. The numbers are those on the wire.
enum class State : std::uint8_t {
  kInitialise = 0,        ///< until everything that is needed was there once
  kInactive = 1,          ///< between two behaviors, and while something is missing: nothing moves
  kInteraction = 2,       ///< the default: faces the visitor
  kNavigationStart = 3,   ///< a goal is chosen, the visitor gets ready
  kNavigationActive = 4,  ///< the navigation drives
  kNavigationEnd = 5,     ///< the navigation no longer drives
  kManual = 6,            ///< an operator drives
  kFault = 7,             ///< a latched fault: until an operator clears it
};

std::string_view text(State state);

/// What a state enables (table 6.1 of the thesis).
struct Enables {
  bool movement = false;             ///< movement_control passes anything at all
  bool manual = false;               ///< its manual source
  bool interaction = false;          ///< its interaction source
  bool navigation = false;           ///< its navigation source
  bool interaction_control = false;  ///< the component
  bool operator==(const Enables&) const = default;
};

constexpr Enables enables_of(State state) {
  switch (state) {
    case State::kInteraction:
      return {true, false, true, false, true};
    case State::kNavigationActive:
      return {true, false, false, true, false};
    case State::kManual:
      return {true, true, false, false, false};
    default:
      return {};
  }
}

/// The state machine. Behaviors change only through Inactive, which lasts at least `dwell`, so that
/// the commands of the last behavior are gone before the next one drives. A loss leads to Inactive
/// and, when all is well again, back to what was wanted; a fault forgets what was wanted.
///
// clang-format off
///   Initialise                       -> Inactive            when able
///   Inactive                         -> Manual | Navigation start | Navigation active | Interaction   as wanted
///   Interaction, Manual              -> Inactive            when something else is wanted
///   Navigation start                 -> Navigation active   when the visitor is ready
///   Navigation start, active         -> Navigation end      when it is over; -> Inactive for Manual or a new goal
///   Navigation end                   -> Inactive            after `dwell`
///   all but Initialise               -> Inactive            when not able
///   all                              -> Fault -> Inactive   while a latched fault is there
// clang-format on
class Behavior {
 public:
  explicit Behavior(Time dwell) : dwell_(dwell) {}

  // What is wanted. The caller has judged whether it may be wanted now.
  void manual(bool on);     ///< an operator takes over: a running guidance ends
  void navigation_start();  ///< a new goal
  void navigation_go();     ///< the visitor is ready
  void navigation_end();

  bool navigation_wanted() const { return navigation_ != Navigation::kNone; }
  bool navigation_going() const { return navigation_ == Navigation::kGoing; }
  bool manual_wanted() const { return manual_; }

  /// One step; repeated calls at the same time change nothing more.
  State step(bool able, bool fault, Time now);
  State state() const { return state_; }

 private:
  enum class Navigation { kNone, kStarting, kGoing };

  State wanted() const;
  State next(bool able, bool fault, Time now);

  Time dwell_;
  State state_ = State::kInitialise;
  std::optional<Time> settled_since_;  ///< in this state, and able
  bool manual_ = false;
  bool new_goal_ = false;  ///< a goal was replaced while it was driven to
  Navigation navigation_ = Navigation::kNone;
};

}  // namespace usher::supervisor
