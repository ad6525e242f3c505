#include "tasks/meeting/core/faces.hpp"

#include <algorithm>
#include <cmath>

namespace usher::meeting {

namespace {

constexpr double kFarthest = 20.0;    // [m] no camera sees a face from there
constexpr double kLargest = 10000.0;  // [pixels] of an image

bool sane(const Face& face, double image_width) {
  return std::isfinite(face.left) && std::isfinite(face.top) && face.width >= 1.0 &&
         face.width <= image_width && face.height >= 1.0 && face.height <= kLargest &&
         std::abs(face.left) <= kLargest && std::abs(face.top) <= kLargest && face.depth > 0.0 &&
         face.depth <= kFarthest && face.range >= 0.0 && face.range <= kFarthest &&
         std::abs(face.bearing) <= geometry::kPi;
}

double column_of(const Face& face) { return face.left + 0.5 * face.width; }
double row_of(const Face& face) { return face.top + 0.5 * face.height; }

}  // namespace

std::size_t Faces::place() {
  const std::size_t before = faces.size();
  const bool image = image_width >= 1.0 && image_width <= kLargest;
  if (!image || !pose || !pose->finite()) {
    faces.clear();
    return before;
  }
  std::erase_if(faces, [this](const Face& face) { return !sane(face, image_width); });
  for (Face& face : faces) {
    face.at =
        *pose * Point2(face.range * std::cos(face.bearing), face.range * std::sin(face.bearing));
  }
  return before - faces.size();
}

/// Where a column of an image lies after the camera has turned.
double FaceTrack::shifted(double column, double image_width, double turn) const {
  const double focal = 0.5 * image_width / std::tan(0.5 * field_of_view_);
  const double bearing = std::atan2(0.5 * image_width - column, focal) - turn;
  constexpr double kBeside = 1.5;  // [rad] behind the camera there are no columns
  return 0.5 * image_width - focal * std::tan(std::clamp(bearing, -kBeside, kBeside));
}

bool FaceTrack::take(const Faces& message) {
  if (message.faces.empty() || !message.pose) {
    forget();
    return false;
  }
  const Face* found = nullptr;
  if (successive_ == 0) {
    found = &*std::min_element(message.faces.begin(), message.faces.end(),
                               [](const Face& a, const Face& b) { return a.depth < b.depth; });
  } else {
    const double turn = geometry::shortest_turn(yaw_, message.pose->yaw);
    const double column = shifted(column_of(face_), message.image_width, turn);
    const double row = row_of(face_);
    const auto apart = [&](const Face& face) {
      return std::hypot(column_of(face) - column, row_of(face) - row);
    };
    const Face& closest =
        *std::min_element(message.faces.begin(), message.faces.end(),
                          [&](const Face& a, const Face& b) { return apart(a) < apart(b); });
    if (std::abs(column_of(closest) - column) <= 0.5 * face_.width &&
        std::abs(row_of(closest) - row) <= 0.5 * face_.height)
      found = &closest;
  }
  if (found == nullptr) {
    forget();
    return false;
  }
  face_ = *found;
  yaw_ = message.pose->yaw;
  ++successive_;
  return true;
}

}  // namespace usher::meeting
