#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace usher::operations {

/// A moment of a journey, as it really is.
struct FollowMoment {
  double t = 0.0;        ///< [s] {grows}
  bool drives = false;   ///< the robot moves
  bool waits = false;    ///< the guide says that it waits for the visitor
  double gap = 0.0;      ///< [m] between the middles of robot and visitor
  bool visible = false;  ///< no wall hides the visitor
};

/// What became of the visitor on a journey. A *loss* begins when the visitor is farther behind than
/// where a guide has to wait, or behind a wall, and ends when that is over.
class FollowJudge {
 public:
  static constexpr double kFar = 4.3;    ///< [m] the guide has to wait at 4 m, measured by a camera
  static constexpr double kNear = 3.0;   ///< [m] a visitor so near and visible needs no waiting
  static constexpr double kShort = 2.0;  ///< [s] a loss that ends by itself within this is none

  void take(const FollowMoment& moment);
  /// The journey is over: a loss that goes on counts up to the last moment.
  void finish();

  double largest_gap() const { return largest_gap_; }  ///< [m] while the guide did not wait
  double largest_gap_driving() const { return largest_gap_driving_; }  ///< [m] braking included
  /// How long each loss went unnoticed [s].
  const std::vector<double>& losses() const { return losses_; }
  std::size_t waits() const { return waits_; }
  double waited() const { return waited_; }  ///< [s]
  /// Waits for a visitor who was near and in sight.
  std::size_t needless_waits() const { return needless_waits_; }

 private:
  double largest_gap_ = 0.0, largest_gap_driving_ = 0.0, waited_ = 0.0;
  std::vector<double> losses_;
  std::size_t waits_ = 0, needless_waits_ = 0;
  std::optional<double> lost_since_;  ///< [s]
  bool noticed_ = false;
  std::optional<FollowMoment> last_;
};

}  // namespace usher::operations
