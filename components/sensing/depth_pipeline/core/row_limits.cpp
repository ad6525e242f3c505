#include "sensing/depth_pipeline/core/row_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "foundation/geometry/angle.hpp"
#include "foundation/result/bounds.hpp"

namespace usher::depth_pipeline {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNoRoll = 1e-5;  // [rad]
constexpr int kBlock = 16;

/// Metres to millimetres, rounded down; never more than `most`.
std::uint16_t millimeters(double meters, int most) {
  if (!(meters > 0.0)) return 0;
  return static_cast<std::uint16_t>(std::min(std::floor(meters * 1e3), static_cast<double>(most)));
}

/// The smallest positive solution of a z^2 + b z + c = 0 (a >= 0), infinity when there is none.
double first_root(double a, double b, double c) {
  if (a < 1e-12) return b != 0.0 && -c / b > 0.0 ? -c / b : kInfinity;
  const double discriminant = b * b - 4.0 * a * c;
  if (discriminant < 0.0) return kInfinity;
  const double root = std::sqrt(discriminant);
  // The two solutions without cancellation.
  const double q = -0.5 * (b + std::copysign(root, b));
  const double one = q / a;
  const double two = q != 0.0 ? c / q : kInfinity;
  const double low = std::min(one, two);
  const double high = std::max(one, two);
  return low > 0.0 ? low : high > 0.0 ? high : kInfinity;
}

}  // namespace

Status check(const FloorModel& model) {
  return within({{"floor_margin", model.floor_margin, 0.0, 0.5},
                 {"angle_margin", model.angle_margin, 0.0, 0.1},
                 {"noise_factor", model.noise_factor, 0.0, 10.0},
                 {"noise_base", model.noise_base, 0.0, 0.1},
                 {"noise_growth", model.noise_growth, 0.0, 0.05},
                 {"noise_grazing", model.noise_grazing, 0.0, 0.001},
                 {"ceiling", model.ceiling, 0.3, 4.0},
                 {"low_height", model.low_height, 0.0, 2.0},
                 {"drop_depth", model.drop_depth, 0.02, 1.0},
                 {"drop_range", model.drop_range, 0.0, 6.0}});
}

FloorModel for_structured_light(FloorModel model) {
  model.noise_base = 0.0012;
  model.noise_growth = 0.0028;  // 0.0019 of noise, and steps of 0.00285 z^2
  return model;
}

FloorPrediction::FloorPrediction(const Intrinsics& intrinsics, const FloorModel& model,
                                 double max_depth)
    : intrinsics_(intrinsics),
      model_(model),
      max_depth_(max_depth),
      limits_(static_cast<std::size_t>(kStrips * intrinsics.height)),
      scales_(static_cast<std::size_t>(intrinsics.height)) {}

int FloorPrediction::first_column(int strip) const {
  const int blocks = (intrinsics_.width + kBlock - 1) / kBlock;
  return blocks * strip / strips_ * kBlock;
}

double FloorPrediction::floor_depth(int row) const {
  const double y = (row - intrinsics_.cy) / intrinsics_.fy;
  const double slope = std::sin(pose_.down) + y * std::cos(pose_.down) * std::cos(pose_.roll);
  return slope > 0.0 ? pose_.height / slope : kInfinity;
}

/// Noise [m] of the depth of the floor in a row, for being looked at along it.
double FloorPrediction::grazing(double slope, double forward) const {
  if (model_.noise_grazing <= 0.0 || slope <= 0.0) return 0.0;
  const double depth = std::min(pose_.height / slope, max_depth_);
  const double from_along = std::max(0.02, std::atan2(slope, forward));
  const double ratio = std::max(0.0, geometry::kPi / 2.0 - from_along) / from_along;
  return model_.noise_grazing * depth * std::sqrt(depth) * ratio * ratio;
}

RowLimits FloorPrediction::limits_of(double slope, double forward) const {
  const double h = pose_.height;
  const double m = model_.floor_margin;
  const double a = model_.angle_margin;
  const double steep = std::abs(slope);
  const double base = model_.noise_factor * steep * (model_.noise_base + grazing(slope, forward));
  const double growth = model_.noise_factor * steep * model_.noise_growth;

  // A point at depth z is h - slope z high.
  double obstacle = max_depth_;
  if (slope + a > 0.0) {
    obstacle = h > m + base ? std::min(obstacle, first_root(growth, slope + a, base + m - h)) : 0.0;
  }
  if (slope < 0.0) {
    obstacle = h < model_.ceiling ? std::min(obstacle, (model_.ceiling - h) / -slope) : 0.0;
  }
  RowLimits limits;
  limits.obstacle = millimeters(obstacle, kMaxDepth);
  double high = h > model_.low_height ? max_depth_ : 0.0;
  if (slope > 0.0) high = (h - model_.low_height) / slope;
  limits.high = millimeters(high, kMaxDepth);

  const double floor = slope > 0.0 ? h / slope * forward : kInfinity;
  if (floor > 0.0 && floor <= model_.drop_range) {
    const double fall = first_root(growth, a - slope, h + model_.drop_depth + base);
    if (fall < max_depth_) {
      limits.floor = millimeters(floor, kMaxDepth);
      limits.fall = static_cast<std::uint16_t>(millimeters(fall, kMaxDepth) + 1);
    }
  }
  return limits;
}

void FloorPrediction::predict(const CameraPose& pose) {
  pose_ = pose;
  strips_ = std::abs(pose.roll) < kNoRoll ? 1 : kStrips;
  const double sine = std::sin(pose.down);
  const double cosine = std::cos(pose.down);
  for (int row = 0; row < intrinsics_.height; ++row) {
    const double y = (row - intrinsics_.cy) / intrinsics_.fy;
    const double forward = std::clamp(cosine - y * sine, 0.0, 1.99);
    scales_[static_cast<std::size_t>(row)].forward =
        static_cast<std::uint16_t>(std::lround(forward * 32768.0));
    for (int strip = 0; strip < strips_; ++strip) {
      const double column = 0.5 * (first_column(strip) + first_column(strip + 1) - 1);
      const double x = (column - intrinsics_.cx) / intrinsics_.fx;
      const double level = y * std::cos(pose.roll) + x * std::sin(pose.roll);
      const double slope = sine + (strips_ == 1 ? y : level) * cosine;
      limits_[static_cast<std::size_t>(strip * intrinsics_.height + row)] =
          limits_of(slope, forward);
    }
  }
}

}  // namespace usher::depth_pipeline
