#include "sensing/depth_pipeline/core/floor_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace usher::depth_pipeline {

namespace {

constexpr int kRowStep = 4;
constexpr int kColumnStep = 12;
constexpr int kPasses = 3;
constexpr double kLeastSpread = 0.01;  // [m^2] variance that an angle can be seen from
constexpr std::size_t kMostSamples = 4096;

/// A pixel that may be floor, by the prediction.
struct Sample {
  double forward, left, height;  // [m]
};

/// height = a + b forward + c left
struct Plane {
  Eigen::Vector3d abc = Eigen::Vector3d::Zero();
  int samples = 0;
  double residual = 0.0;
};

struct Sums {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double squares = 0.0;
  int count = 0;
};

/// The pixels within the widest band around the prediction.
std::span<const Sample> collect(const DepthImage& image, const Intrinsics& camera,
                                const CameraPose& pose, const FloorFitConfig& config,
                                std::span<Sample> samples) {
  std::size_t count = 0;
  const double sine = std::sin(pose.down);
  const double cosine = std::cos(pose.down);
  for (int row = kRowStep / 2; row < image.height; row += kRowStep) {
    const double y = (row - camera.cy) / camera.fy;
    const double slope = sine + y * cosine;
    const double forward = cosine - y * sine;
    if (slope * config.reach < pose.height * 0.5 * forward) continue;  // too far or no floor
    const auto* line = image.millimeters.data() + static_cast<std::ptrdiff_t>(row) * image.width;
    for (int column = kColumnStep / 2; column < image.width; column += kColumnStep) {
      if (line[column] == 0 || count == samples.size()) continue;
      const double z = 1e-3 * line[column];
      const double distance = z * forward;
      const double height = pose.height - z * slope;
      if (distance > config.reach ||
          std::abs(height) > config.band + config.band_growth * distance) {
        continue;
      }
      samples[count++] = {distance, -z * (column - camera.cx) / camera.fx, height};
    }
  }
  return samples.first(count);
}

Sums sum_up(std::span<const Sample> samples, const Plane& plane, double band, double growth) {
  double n = 0, x = 0, y = 0, h = 0, xx = 0, xy = 0, yy = 0, xh = 0, yh = 0, hh = 0;
  for (const Sample& s : samples) {
    const double off = s.height - plane.abc[0] - plane.abc[1] * s.forward - plane.abc[2] * s.left;
    if (std::abs(off) > band + growth * s.forward) continue;
    n += 1.0, x += s.forward, y += s.left, h += s.height;
    xx += s.forward * s.forward, xy += s.forward * s.left, yy += s.left * s.left;
    xh += s.forward * s.height, yh += s.left * s.height, hh += s.height * s.height;
  }
  Sums sums;
  sums.a << n, x, y, x, xx, xy, y, xy, yy;
  sums.b << h, xh, yh;
  sums.squares = hh;
  sums.count = static_cast<int>(n);
  return sums;
}

std::optional<Plane> solve(const Sums& sums, const FloorFitConfig& config) {
  if (sums.count < config.least_samples) return std::nullopt;
  const double n = sums.count;
  const auto variance = [&](int i) {
    const double mean = sums.a(0, i) / n;
    return sums.a(i, i) / n - mean * mean;
  };
  if (variance(1) < kLeastSpread) return std::nullopt;
  Plane plane;
  plane.samples = sums.count;
  if (variance(2) < kLeastSpread) {
    plane.abc.head<2>() = sums.a.topLeftCorner<2, 2>().ldlt().solve(sums.b.head<2>());
  } else {
    plane.abc = sums.a.ldlt().solve(sums.b);
  }
  const double rest =
      sums.squares - 2.0 * plane.abc.dot(sums.b) + plane.abc.dot(sums.a * plane.abc);
  plane.residual = std::sqrt(std::max(0.0, rest / n));
  return plane;
}

}  // namespace

std::optional<FloorFit> fit_floor(const DepthImage& image, const Intrinsics& intrinsics,
                                  const CameraPose& predicted, const FloorFitConfig& config) {
  std::array<Sample, kMostSamples> memory;
  const auto samples = collect(image, intrinsics, predicted, config, memory);
  Plane plane;
  for (int pass = 0; pass < kPasses; ++pass) {
    const double share = 1.0 - static_cast<double>(pass) / (kPasses - 1);
    const double band = config.narrowest + share * (config.band - config.narrowest);
    const auto better = solve(sum_up(samples, plane, band, share * config.band_growth), config);
    if (!better) return std::nullopt;
    plane = *better;
  }
  FloorFit fit;
  fit.pose = predicted;
  fit.pose.height -= plane.abc[0];
  fit.pose.down += plane.abc[1];
  fit.pose.roll -= plane.abc[2] / std::cos(predicted.down);
  fit.samples = plane.samples;
  fit.residual = plane.residual;
  if (std::abs(plane.abc[0]) > config.max_height || std::abs(plane.abc[1]) > config.max_angle ||
      std::abs(plane.abc[2]) > config.max_angle) {
    return std::nullopt;
  }
  return fit;
}

}  // namespace usher::depth_pipeline
