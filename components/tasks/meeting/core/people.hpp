#pragma once

#include <optional>
#include <vector>

#include "tasks/meeting/core/faces.hpp"

namespace usher::meeting {

/// Where somebody stands who need not be asked (again), and people who were seen on the way and are
/// still to be asked. People do not move once they were seen, as in the meeting report.
class People {
 public:
  static constexpr std::size_t kMost = 64;  ///< of each kind; the oldest are forgotten

  /// Nobody is known.
  void forget();

  /// Faces within `radius` [m] of this point are left alone until then.
  void leave_alone(const Point2& at, double radius, Time until, Time now);
  bool left_alone(const Point2& at, Time now) const;

  /// Somebody was seen there. Nothing new within `radius` of one who is remembered.
  void remember(const Point2& at, double radius);
  /// Those within `radius` of a point are not to be visited any more.
  void forget_near(const Point2& at, double radius);
  const std::vector<Point2>& remembered() const { return remembered_; }

 private:
  struct Spot {
    Point2 at;
    double radius;
    Time until;
  };
  std::vector<Spot> alone_;
  std::vector<Point2> remembered_;
};

}  // namespace usher::meeting
