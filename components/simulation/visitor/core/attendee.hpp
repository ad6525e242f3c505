#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "simulation/visitor/core/visitor.hpp"

namespace usher::visitor {

/// What somebody says to an invitation.
enum class Manner : std::uint8_t {
  kComes,
  kDeclines,
  kSilent,
  kStrays,  ///< comes, but stays behind on the way; only the first time
};

/// Somebody who stands somewhere until a robot invites him to a meeting, reads the question for a
/// while, answers it once, follows the robot to the room and goes to a place in it. Stands while
/// the robot turns round to him. Times are seconds on any clock that does not go back.
class Attendee {
 public:
  enum class Walk : std::uint8_t { kStand, kFollow, kToSeat };

  /// `stray_time` is how long one who strays follows.
  Attendee(Manner manner, double reading_time, double stray_time = 0.0)
      : manner_(manner), reading_time_(reading_time), stray_time_(stray_time) {}

  /// A screen of the robot; `asked`: it stands before this person and faces him.
  void see(const Screen& screen, bool asked, double now);
  /// What to press now, if anything; once for each question.
  std::optional<std::string> answer(double now);
  std::uint64_t screen_id() const { return asked_by_; }
  Walk walk() const { return walk_; }
  bool arrived() const { return walk_ == Walk::kToSeat; }

 private:
  Manner manner_;
  double reading_time_, stray_time_;
  std::uint64_t asked_by_ = 0;  ///< id of the screen that asks; 0: nobody does
  std::uint64_t answered_ = 0;  ///< the last one that was answered
  double asked_at_ = 0.0;
  double accepted_at_ = 0.0;
  bool accepted_ = false;
  Walk walk_ = Walk::kStand;
};

}  // namespace usher::visitor
