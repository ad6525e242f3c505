#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace usher::meeting {

/// The states of fig. 4 of the meeting report; revisit, look back, done and ended are ours. The
/// numbers are those on the wire.
enum class State : std::uint8_t {
  kInitialise = 0,  ///< waits for map, pose and the rest of the robot
  kIdle = 1,        ///< waits for a request
  kToRoom = 2,      ///< drives to the next meeting room
  kScanRoom = 3,    ///< turns round in it
  kCheckRoom = 4,   ///< is that a face?
  kExplore = 5,     ///< looks for people
  kCheckFace = 6,   ///< centers a face: is it one?
  kRevisit = 7,     ///< drives to where somebody was seen on the way
  kApproach = 8,    ///< drives to just in front of the person
  kInvite = 9,      ///< would you like to come?
  kGuide = 10,      ///< brings the person to the room
  kLookBack = 11,   ///< turns round: does the person follow?
  kArrived = 12,    ///< one more is there
  kDone = 13,       ///< everybody is there
  kEnded = 14,      ///< over before that
};
inline constexpr std::size_t kStates = 15;

enum class Cause : std::uint8_t {
  kReady,      ///< the robot can serve
  kNotReady,   ///< it cannot
  kRequest,    ///< a meeting is called
  kArrived,    ///< the navigator reached the place
  kNoWay,      ///< it did not, or has no room to turn
  kFace,       ///< a face is seen
  kLost,       ///< it was none, nobody is there, or nobody follows
  kUnseen,     ///< the person was not seen for a while
  kConfirmed,  ///< three messages agree on it
  kNear,       ///< they do, and the robot stands before the person already
  kScanned,    ///< nobody in the whole round
  kSeenThen,   ///< somebody was seen on the way here
  kYes,        ///< the person comes along
  kNo,         ///< or does not
  kTimeout,    ///< no answer
  kMore,       ///< persons are missing
  kEnough,     ///< all are there
  kLimit,      ///< the mission's time is over
  kFailure,    ///< the robot cannot go on
  kCancelled,  ///< somebody gave the mission up
  kDelay,      ///< it was shown long enough
  kElsewhere,  ///< another robot of the fleet does it, or does it no more
};
inline constexpr std::size_t kCauses = 22;

inline constexpr std::uint32_t kMostPersons = 100;  ///< that one mission brings
inline constexpr double kLongestMission = 3600.0;   ///< [s]

/// The numbers are those on the wire.
enum class Outcome : std::uint8_t { kOpen = 0, kComplete, kTimeOver, kFailed, kCancelled };

struct Edge {
  State from;
  State to;
  Cause cause;
};

/// Of a mission that goes on.
constexpr bool active(State state) { return state >= State::kToRoom && state <= State::kArrived; }

namespace edges {
/// How a mission goes.
inline constexpr std::array kWay{
    Edge{State::kInitialise, State::kIdle, Cause::kReady},
    Edge{State::kIdle, State::kInitialise, Cause::kNotReady},
    Edge{State::kIdle, State::kToRoom, Cause::kRequest},
    Edge{State::kToRoom, State::kScanRoom, Cause::kArrived},
    Edge{State::kToRoom, State::kToRoom, Cause::kNoWay},
    Edge{State::kScanRoom, State::kCheckRoom, Cause::kFace},
    Edge{State::kScanRoom, State::kExplore, Cause::kScanned},
    Edge{State::kScanRoom, State::kToRoom, Cause::kNoWay},
    Edge{State::kCheckRoom, State::kScanRoom, Cause::kLost},
    Edge{State::kCheckRoom, State::kToRoom, Cause::kConfirmed},
    Edge{State::kExplore, State::kCheckFace, Cause::kFace},
    Edge{State::kExplore, State::kRevisit, Cause::kSeenThen},
    Edge{State::kExplore, State::kExplore, Cause::kNoWay},
    Edge{State::kCheckFace, State::kApproach, Cause::kConfirmed},
    Edge{State::kCheckFace, State::kInvite, Cause::kNear},
    Edge{State::kCheckFace, State::kExplore, Cause::kLost},
    Edge{State::kRevisit, State::kCheckFace, Cause::kFace},
    Edge{State::kRevisit, State::kExplore, Cause::kNoWay},
    Edge{State::kRevisit, State::kExplore, Cause::kLost},
    Edge{State::kApproach, State::kInvite, Cause::kArrived},
    Edge{State::kApproach, State::kExplore, Cause::kNoWay},
    Edge{State::kInvite, State::kGuide, Cause::kYes},
    Edge{State::kInvite, State::kExplore, Cause::kNo},
    Edge{State::kInvite, State::kExplore, Cause::kTimeout},
    Edge{State::kGuide, State::kLookBack, Cause::kUnseen},
    Edge{State::kGuide, State::kLookBack, Cause::kArrived},
    Edge{State::kGuide, State::kGuide, Cause::kNoWay},
    Edge{State::kGuide, State::kExplore, Cause::kNoWay},
    Edge{State::kGuide, State::kExplore, Cause::kNo},
    Edge{State::kLookBack, State::kGuide, Cause::kConfirmed},
    Edge{State::kLookBack, State::kGuide, Cause::kNoWay},
    Edge{State::kLookBack, State::kArrived, Cause::kConfirmed},
    Edge{State::kLookBack, State::kExplore, Cause::kLost},
    Edge{State::kLookBack, State::kExplore, Cause::kNo},
    Edge{State::kArrived, State::kExplore, Cause::kMore},
    Edge{State::kArrived, State::kDone, Cause::kEnough},
    Edge{State::kDone, State::kIdle, Cause::kDelay},
    Edge{State::kEnded, State::kIdle, Cause::kDelay},
};
/// What other robots of a fleet bring about: a room is found or looked for by one of them, a person
/// is asked by one of them, enough are there.
inline constexpr std::array kFleet{
    Edge{State::kToRoom, State::kExplore, Cause::kElsewhere},
    Edge{State::kScanRoom, State::kExplore, Cause::kElsewhere},
    Edge{State::kCheckRoom, State::kExplore, Cause::kElsewhere},
    Edge{State::kExplore, State::kToRoom, Cause::kElsewhere},
    Edge{State::kCheckFace, State::kExplore, Cause::kElsewhere},
    Edge{State::kRevisit, State::kExplore, Cause::kElsewhere},
    Edge{State::kApproach, State::kExplore, Cause::kElsewhere},
    Edge{State::kInvite, State::kExplore, Cause::kElsewhere},
    Edge{State::kExplore, State::kDone, Cause::kEnough},
    Edge{State::kCheckFace, State::kDone, Cause::kEnough},
    Edge{State::kRevisit, State::kDone, Cause::kEnough},
    Edge{State::kApproach, State::kDone, Cause::kEnough},
    Edge{State::kInvite, State::kDone, Cause::kEnough},
};
/// What ends it from anywhere.
inline constexpr std::array kEnds{Cause::kLimit, Cause::kFailure, Cause::kCancelled};
inline constexpr std::size_t kActive =
    static_cast<std::size_t>(State::kArrived) - static_cast<std::size_t>(State::kToRoom) + 1;
}  // namespace edges

/// Every edge there is; to take another one is a programming error.
inline constexpr auto kEdges = [] {
  std::array<Edge, edges::kWay.size() + edges::kFleet.size() + edges::kActive * edges::kEnds.size()>
      all{};
  auto next = std::copy(edges::kWay.begin(), edges::kWay.end(), all.begin());
  next = std::copy(edges::kFleet.begin(), edges::kFleet.end(), next);
  for (std::size_t i = 0; i < edges::kActive; ++i) {
    const auto from = static_cast<State>(static_cast<std::size_t>(State::kToRoom) + i);
    for (const Cause cause : edges::kEnds) *next++ = {from, State::kEnded, cause};
  }
  return all;
}();

std::string_view text(State state);
std::string_view text(Cause cause);

}  // namespace usher::meeting
