#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::meeting {

using geometry::Point2;
using geometry::Pose2;
/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

/// A face in an image, as the face detector tells it.
struct Face {
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;  ///< [pixels] rectangle
  double depth = 0.0;                                       ///< [m] along the optical axis
  double range = 0.0;                                       ///< [m] from the robot, along the floor
  double bearing = 0.0;                                     ///< [rad] {-pi..pi, positive left}
  Point2 at{0, 0};                                          ///< [m] in map; set by Faces::place()
};

/// One message of the face detector.
struct Faces {
  double image_width = 0.0;   ///< [pixels]
  std::optional<Pose2> pose;  ///< of the robot in map when the image was taken
  std::vector<Face> faces;

  /// Takes out what is no rectangle in an image, or lies nowhere; says where the rest is in map.
  /// Returns how many were taken out. Without a pose that is finite all are.
  std::size_t place();
};

/// Follows one face from message to message (meeting report III-B-5): at first the rectangle that
/// is nearest by its depth, then the one whose middle is closest to the last one's, if it lies
/// within that; what the robot has turned in between is taken off. A message without such a face
/// ends it.
class FaceTrack {
 public:
  /// `field_of_view` [rad] of the image's width, to know how far a turn shifts it.
  explicit FaceTrack(double field_of_view) : field_of_view_(field_of_view) {}

  /// A message whose faces were placed. True: it has the face, or a first one.
  bool take(const Faces& message);
  void forget() { successive_ = 0; }

  /// Messages in a row that have it; 0: there is none.
  int successive() const { return successive_; }
  /// As seen last; only while there is one.
  const Face& face() const { return face_; }

 private:
  double shifted(double column, double image_width, double turn) const;

  double field_of_view_;
  int successive_ = 0;
  Face face_;
  double yaw_ = 0.0;
};

}  // namespace usher::meeting
