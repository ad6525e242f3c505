#include "foundation/geometry/footprint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace usher::geometry {
namespace {

constexpr double kShortestSide = 1e-3;

double cross(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }

std::string corner_text(std::size_t i, const Point2& p) {
  return "corner " + std::to_string(i) + " (" + std::to_string(p.x()) + ", " +
         std::to_string(p.y()) + ")";
}

}  // namespace

Footprint::Footprint(std::vector<Point2> corners) : corners_(std::move(corners)) {
  inscribed_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Point2 along = (corners_[(i + 1) % corners_.size()] - corners_[i]).normalized();
    Side side{along.y(), -along.x(), 0.0};
    side.offset = side.normal_x * corners_[i].x() + side.normal_y * corners_[i].y();
    sides_.push_back(side);
    inscribed_ = std::min(inscribed_, side.offset);
    circumscribed_ = std::max(circumscribed_, corners_[i].norm());
  }
}

Result<Footprint> Footprint::make(std::span<const Point2> given) {
  const std::size_t n = given.size();
  if (n < 3 || n > kMaxCorners) {
    return Error{"footprint: expected 3 to 64 corners, found " + std::to_string(n)};
  }
  std::vector<Point2> corners(given.begin(), given.end());
  double area = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!corners[i].allFinite())
      return Error{"footprint: " + corner_text(i, corners[i]) + " is not finite"};
    area += cross(corners[i], corners[(i + 1) % n]);
  }
  if (area < 0.0) std::reverse(corners.begin(), corners.end());
  double turned = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 in = corners[i] - corners[(i + n - 1) % n];
    const Point2 out = corners[(i + 1) % n] - corners[i];
    if (out.norm() < kShortestSide) {
      return Error{"footprint: expected sides of at least 1 mm, found a shorter one at " +
                   corner_text(i, corners[i])};
    }
    if (cross(in, out) < 0.0) {
      return Error{"footprint: expected a convex outline, found a reflex " +
                   corner_text(i, corners[i])};
    }
    turned += std::atan2(cross(in, out), in.dot(out));
  }
  if (turned > 3.0 * kPi) return Error{"footprint: the outline crosses itself"};
  Footprint footprint(std::move(corners));
  if (!(footprint.inscribed_ > 0.0)) {
    return Error{"footprint: expected the base's origin inside the outline, found it outside"};
  }
  return footprint;
}

Footprint Footprint::rectangle(double length, double width) {
  const double x = 0.5 * length;
  const double y = 0.5 * width;
  return Footprint({{x, -y}, {x, y}, {-x, y}, {-x, -y}});
}

double Footprint::half_width() const {
  double farthest = 0.0;
  for (const Point2& corner : corners_) farthest = std::max(farthest, std::abs(corner.y()));
  return farthest;
}

double Footprint::distance(const Point2& point) const {
  bool inside = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Side& side = sides_[i];
    if (side.normal_x * point.x() + side.normal_y * point.y() > side.offset) inside = false;
    const Point2& a = corners_[i];
    const Point2 along = corners_[(i + 1) % corners_.size()] - a;
    const double t = std::clamp((point - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (a + t * along - point).norm());
  }
  return inside ? 0.0 : nearest;
}

Footprint Footprint::grown(double padding) const {
  const std::size_t n = sides_.size();
  std::vector<Point2> corners(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Side& a = sides_[(i + n - 1) % n];
    const Side& b = sides_[i];
    const double determinant = a.normal_x * b.normal_y - a.normal_y * b.normal_x;
    if (determinant < 1e-9) {  // sides in line: the corner moves straight out
      corners[i] = corners_[i] + padding * Point2(b.normal_x, b.normal_y);
      continue;
    }
    const double da = a.offset + padding;
    const double db = b.offset + padding;
    corners[i] = {(da * b.normal_y - db * a.normal_y) / determinant,
                  (db * a.normal_x - da * b.normal_x) / determinant};
  }
  return Footprint(std::move(corners));
}

}  // namespace usher::geometry
