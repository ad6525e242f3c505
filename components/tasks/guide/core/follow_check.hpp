#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>

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
  Time grace = std::chrono::seconds(8);          ///< after a departure the visitor steps behind
  Time call = std::chrono::seconds(5);           ///< waiting for so long: calls, and again
  Time give_up = std::chrono::seconds(60);       ///< waiting for so long: the visitor is lost
};

/// The visitor as seen while guiding.
struct FollowerSighting {
  bool seen = false;
  double gap = std::numeric_limits<double>::quiet_NaN();  ///< [m] from the robot; when seen
};

/// Whether the visitor keeps up with the robot: fits the pace to the gap, waits, calls, gives up.
///
///   following <-> lagging -> awaited <-> called -> lost;  awaited, called -> following
///   anything -> unknown while nobody looks: the robot drives as if the visitor followed
class FollowCheck {
 public:
  explicit FollowCheck(const FollowLimits& limits) : limits_(limits) {}

  /// The robot starts to move (again).
  void depart(Time now);
  /// At 5 Hz or faster. Nothing: nobody looks. A gap that is not finite counts as not seen.
  void update(const std::optional<FollowerSighting>& sighting, Time now);

  Follower state() const { return state_; }
  bool waits() const { return state_ == Follower::kAwaited || state_ == Follower::kCalled; }
  /// Waited for too long.
  bool lost() const { return lost_; }
  /// How often it has called while waiting; grows by one at each call.
  std::uint32_t calls() const { return calls_; }
  /// [m/s] at most `cap`; falls with the gap, zero while waiting.
  double pace(double cap) const;
  /// [m] the last one that was seen; NaN: never
  double gap() const { return gap_; }

 private:
  FollowLimits limits_;
  Follower state_ = Follower::kUnknown;
  double gap_ = kNothing;
  bool lost_ = false;
  std::uint32_t calls_ = 0;
  Time departed_{};
  Time waiting_since_{};
  Time called_{};
  std::optional<Time> unseen_since_;
};

}  // namespace usher::guide
