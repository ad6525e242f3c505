#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "drivers/base_obedience/core/writer_id.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/kinematics/stopping_distance.hpp"
#include "operations/fault_windows/fault.hpp"

namespace usher::operations {

/// How a window ended.
enum class WindowEnd : std::uint8_t {
  kDrives,       ///< on its way
  kArrived,      ///< the navigator says so
  kWaits,        ///< on its way, and says what it waits for
  kStands,       ///< stopped, and the operator reads why
  kGaveUp,       ///< the navigation ended, with its reason
  kUnexplained,  ///< stands, and nobody says why
};
std::string_view text(WindowEnd end);

struct Judgement {
  WindowEnd end = WindowEnd::kUnexplained;
  std::string reason;               ///< what the operator reads; empty where it drives
  std::uint32_t deaf_contacts = 0;  ///< while the base heard nobody
  std::string violation;            ///< the first law that was broken, and how; empty = none

  bool passed() const { return violation.empty(); }
};

/// Reads what is on the wire of the movement chain and what the robot really does, and says whether
/// the laws held. Knows nothing of how the chain works, and trusts none of it.
///
///  - Nothing is touched that was visible (a contact of the ground truth); what a base touches that
///    hears nobody, its line being cut, is counted apart.
///  - The wheels are told to move only what the holder of a live grant commanded, under its epoch,
///    in growing order, finite, at most 120 ms ago.
///  - Without that they are told zero, but for the turn rate that keeps the robot on its arc while
///    it rolls, and it stands within its measured stopping distance.
///  - What is commanded is within what enabled sources wished during the last second, and within
///    the limit in force.
///  - While a fault lasts that must stop the robot, it stands, nobody has the right to drive where
///    that must be revoked, and an operator reads why in the supervisor's status or in that of the
///    navigation.
///  - In the end it is on its way, or stands and says why.
///
/// Time [s] counts from the start of the run and does not go back between calls. Pure; O(1) memory
/// but for the last seconds.
class WindowJudge {
 public:
  using Writer = drive::WriterId;

  struct Limits {
    double expiry = 0.12;       ///< [s] of a grant and of a command
    double slack = 0.015;       ///< [s] the base driver's cycle, and ways on the wire
    double hold = 0.4;          ///< [s] the base goes on with its last command, then it stops
    double fastest = 1.5;       ///< [m/s] {> 0} absolute
    double fastest_turn = 1.5;  ///< [rad/s] {> 0} absolute
    double memory = 1.0;        ///< [s] in which a wish may be ramped down
    kinematics::StoppingDistance stopping;
  };

  WindowJudge() : WindowJudge(Limits{}) {}
  explicit WindowJudge(Limits limits) : limits_(std::move(limits)) {}

  // --- What is really so
  void truth(double t, const geometry::Pose2& pose, const geometry::Twist2& twist,
             std::uint32_t contacts, const std::string& contact_with);

  // --- What is on the wire. `foreign` is whoever must not write there.
  void grant(double t, bool foreign, bool granted, const Writer& holder, std::uint64_t epoch);
  void command(double t, const Writer& writer, std::uint64_t epoch, std::uint64_t number,
               const geometry::Twist2& twist);
  /// movement_control's word, by whom ever else it is ignored.
  void chosen(double t, const geometry::Twist2& twist);
  /// Sources as in MovementStatus: 1 manual, 2 interaction, 3 navigation.
  void wish(double t, std::size_t source, const geometry::Twist2& twist);
  void enable(double t, const std::array<bool, 4>& sources);
  void limit(double t, double linear);
  void wheels(double t, const geometry::Twist2& twist);

  // --- What an operator reads: a line for each thing that is not as it should be.
  void told(double t, const std::vector<std::string>& lines);
  /// State and reason of the navigation; the numbers are those of GoalStatus.
  void navigation(double t, std::uint8_t state, const std::string& reason);

  void hit(double t, std::vector<Expectation> expectations);
  Judgement judgement(double t) const;

 private:
  struct At {
    double t = 0.0;
    geometry::Twist2 twist;
  };
  struct Place {
    double t = 0.0;
    geometry::Pose2 pose;
  };
  struct Wish {
    double t = 0.0;
    std::size_t source = 0;
    geometry::Twist2 twist;
  };
  /// A robot that must stand from here on.
  struct Stop {
    double t = 0.0;
    geometry::Pose2 from;
    double speed = 0.0;
    std::optional<geometry::Pose2> settled{};
  };

  void violate(double t, const std::string& what);
  bool granted(double t) const {
    const bool withdrawn = withdrawn_at_ && t - *withdrawn_at_ > limits_.slack;
    return granted_at_ && t - *granted_at_ <= expiry() && !withdrawn;
  }
  double expiry() const { return limits_.expiry + limits_.slack; }
  bool wheels_stand(double t) const;
  bool deaf(double t) const;
  bool rolls_out(double t, const geometry::Twist2& twist) const;
  void judge_stop(double t, std::optional<Stop>& stop, bool must, const char* why);
  void judge_expectations(double t);
  void judge_words(double t);
  bool reads(const Expectation& expectation, double t) const;
  /// What an operator reads now.
  std::vector<std::string> lines(double t) const;

  Limits limits_;
  std::uint32_t contacts_ = 0, deaf_contacts_ = 0;
  std::optional<Place> place_;
  geometry::Twist2 speed_;
  std::deque<Place> places_;  ///< of the last 5 s
  std::deque<At> speeds_;     ///< of the longest stop
  std::deque<At> obeyed_;     ///< what the wheels were told by right, likewise
  double rolled_at_ = -1e9;   ///< when it last rolled
  std::optional<double> granted_at_, withdrawn_at_;
  Writer holder_ = drive::kNobody;
  std::uint64_t epoch_ = 0;
  std::optional<std::uint64_t> number_;
  std::deque<At> valid_;  ///< commands that may be driven
  std::deque<Wish> wishes_;
  std::array<std::optional<double>, 4> enabled_at_;  ///< each source was last
  std::deque<std::pair<double, double>> limits_told_;
  double within_limit_at_ = 0.0;
  std::optional<At> wheels_;
  std::optional<double> told_to_drive_;  ///< when the wheels were last told more than to stand
  std::optional<Stop> without_grant_;
  std::vector<std::optional<Stop>> expected_stops_, barred_;
  std::vector<std::string> lines_;  ///< that were not there before the hit
  std::set<std::string> before_;
  double told_at_ = 0.0;
  std::uint8_t navigation_ = 0;
  std::string navigation_reason_;
  std::pair<double, std::string> waited_;     ///< when the navigation last told a reason, and which
  std::pair<double, std::string> read_last_;  ///< likewise of the lines that an operator reads
  std::optional<double> hit_;
  std::vector<Expectation> expectations_;
  std::string violation_;
};

}  // namespace usher::operations
