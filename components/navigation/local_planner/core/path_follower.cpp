#include "navigation/local_planner/core/path_follower.hpp"

namespace usher::local_planner {

const char* to_string(Reason reason) {
  switch (reason) {
    case Reason::kFollowing:
      return "following the path";
    case Reason::kTight:
      return "passing a tight place";
    case Reason::kTurning:
      return "turning to the path";
    case Reason::kTurningToGoal:
      return "turning to the goal's direction";
    case Reason::kReached:
      return "goal reached";
    case Reason::kBraking:
      return "braking: no way that can be stopped on";
    case Reason::kBlocked:
      return "blocked";
    case Reason::kGivingWay:
      return "giving way to somebody";
    case Reason::kTouching:
      return "an obstacle inside the footprint";
    case Reason::kRecovering:
      return "recovering";
    case Reason::kNoPath:
      return "no path";
    case Reason::kInvalidInput:
      return "invalid input";
  }
  return "unknown";
}

}  // namespace usher::local_planner
