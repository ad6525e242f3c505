#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>

#include "foundation/geometry/pose2.hpp"
#include "tasks/guide/core/screen.hpp"

namespace usher::guide {

/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

struct FollowLimits {
  double near = 2.0;     ///< [m] up to here the robot drives at its own pace
  double far = 4.0;      ///< [m] here it stops and waits; braking takes it 1.5 m farther
  double resume = 2.5;   ///< [m] it goes on when the visitor is nearer than this
  double slowest = 0.4;  ///< [m/s] pace just before it stops
  Time unseen = std::chrono::milliseconds(900);  ///< nobody there for so long: waits
  /// After a departure the visitor steps behind: for so long, until he was seen there by a robot
  /// that has set off, or until it has gone so far.
  Time grace = std::chrono::seconds(8);
  double grace_way = 2.5;                   ///< [m]
  Time call = std::chrono::seconds(5);      ///< waiting for so long: calls, and again
  Time give_up = std::chrono::seconds(60);  ///< waiting for so long: the visitor is lost
};

/// The visitor as seen while guiding.
struct FollowerSighting {
  bool seen = false;
  /// [m] from the robot, 0: he walks ahead; when seen
  double gap = std::numeric_limits<double>::quiet_NaN();
  bool behind = false;  ///< the robot; when seen
};

/// Whether the visitor keeps up with the robot: fits the pace to the gap, waits, calls, gives up.
///
///   following <-> lagging -> awaited <-> called -> lost;  awaited, called -> following
///   following, lagging -> unknown while nobody looks: the robot drives as if the visitor followed.
///   One that waits goes on waiting then: that nobody looks does not bring the visitor back.
class FollowCheck {
 public:
  explicit FollowCheck(const FollowLimits& limits) : limits_(limits) {}

  /// The robot starts to move (again).
  void depart(Time now);
  /// The robot stands and goes on when the visitor is there.
  void await(Time now);
  /// At 5 Hz or faster. `robot`: [m] in map, nothing: not known. No sighting: nobody looks. A gap
  /// that is not finite counts as not seen.
  void update(const std::optional<FollowerSighting>& sighting,
              const std::optional<geometry::Point2>& robot, Time now);

  Follower state() const { return state_; }
  bool waits() const { return state_ == Follower::kAwaited || state_ == Follower::kCalled; }
  /// Waited for too long.
  bool lost() const { return lost_; }
  /// How often it has called while waiting; grows by one at each call.
  std::uint32_t calls() const { return calls_; }
  /// [m/s] at most `cap`; falls with the gap; while waiting the slowest, to go on with.
  double pace(double cap) const;
  /// [m] the last one that was seen; NaN: never
  double gap() const { return gap_; }

 private:
  FollowLimits limits_;
  Follower state_ = Follower::kUnknown;
  bool lost_ = false;
  bool grace_ = true;  ///< he may still be stepping behind
  std::uint32_t calls_ = 0;
  double gap_ = kNothing;
  Time departed_{};
  std::optional<geometry::Point2> departed_from_;
  Time waiting_since_{};
  Time called_{};
  std::optional<Time> unseen_since_;
};

}  // namespace usher::guide
