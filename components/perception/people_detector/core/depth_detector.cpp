#include "perception/people_detector/core/depth_detector.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "foundation/result/bounds.hpp"

namespace usher::people_detector {

namespace {

constexpr double kSteepest = 1.2;  // [rad]

}  // namespace

Status check(const DetectorConfig& c) {
  return within({{"nearest", c.windows.nearest, 0.2, 2.0},
                 {"farthest", c.windows.farthest, 1.0, 8.0},
                 {"least_extent", c.windows.least_extent, 0.1, 1.0},
                 {"step", c.windows.step, 0.02, 0.2},
                 {"threshold", c.threshold, -10.0, 10.0},
                 {"same_left", c.same_left, 0.1, 1.0},
                 {"same_forward", c.same_forward, 0.1, 2.0},
                 {"body_depth", c.body_depth, 0.0, 0.3}});
}

Result<DepthDetector> DepthDetector::make(const imaging::Intrinsics& intrinsics,
                                          const DetectorConfig& config, const Network& network) {
  if (const Status status = imaging::check(intrinsics); !status) return Error{status.error()};
  if (const Status status = check(config); !status) return Error{status.error()};
  return DepthDetector(intrinsics, config, network);
}

DepthDetector::DepthDetector(const imaging::Intrinsics& intrinsics, const DetectorConfig& config,
                             const Network& network)
    : intrinsics_(intrinsics),
      config_(config),
      windows_(intrinsics, config.windows),
      classifier_(network) {}

bool DepthDetector::is_taken(const Candidate& place) const {
  return std::any_of(taken_.begin(), taken_.end(), [&](const Candidate& other) {
    return std::abs(static_cast<double>(place.left - other.left)) < config_.same_left &&
           std::abs(static_cast<double>(place.forward - other.forward)) < config_.same_forward;
  });
}

/// The middle of the windows around the best one that show the same person.
Sighting DepthDetector::refine(const Scored& best) const {
  double weights = 0.0, left = 0.0, forward = 0.0;
  for (const Scored& one : scored_) {
    const auto aside = static_cast<double>(one.place.left - best.place.left);
    const auto behind = static_cast<double>(one.place.forward - best.place.forward);
    if (std::abs(aside) > 0.5 * config_.same_left || std::abs(behind) > 0.25) continue;
    const double weight = static_cast<double>(one.score) - config_.threshold + 1e-3;
    weights += weight;
    left += weight * static_cast<double>(one.place.left);
    forward += weight * static_cast<double>(one.place.forward);
  }
  Candidate middle = best.place;
  middle.left = static_cast<float>(left / weights);
  middle.forward = static_cast<float>(forward / weights);
  return {static_cast<double>(middle.forward) + config_.body_depth,
          static_cast<double>(middle.left), windows_.top(middle), static_cast<double>(best.score)};
}

Result<std::span<const Sighting>> DepthDetector::find(const imaging::DepthImage& image,
                                                      const View& view) {
  const auto pixels =
      static_cast<std::size_t>(intrinsics_.width) * static_cast<std::size_t>(intrinsics_.height);
  if (image.width != intrinsics_.width || image.height != intrinsics_.height ||
      image.millimeters.size() != pixels) {
    return Error{"expected an image of " + std::to_string(intrinsics_.width) + " x " +
                 std::to_string(intrinsics_.height) + ", got " + std::to_string(image.width) +
                 " x " + std::to_string(image.height) + " with " +
                 std::to_string(image.millimeters.size()) + " pixels"};
  }
  if (!(view.height >= 0.05 && view.height <= 3.0) || !(std::abs(view.down) <= kSteepest) ||
      !(std::abs(view.roll) <= kSteepest)) {
    return Error{"expected a camera 0.05 to 3 m high and at most 1.2 rad steep, got " +
                 std::to_string(view.height) + " m, " + std::to_string(view.down) + " rad"};
  }
  windows_.take(image, view);
  scored_.clear();
  int order = 0;
  for (const Candidate& candidate : windows_.candidates()) {
    ++order;
    windows_.describe(candidate, inputs_);
    const float score = classifier_.score(inputs_);
    if (static_cast<double>(score) > config_.threshold)
      scored_.push_back({candidate, score, order});
  }
  std::sort(scored_.begin(), scored_.end(), [](const Scored& a, const Scored& b) {
    return a.score != b.score ? a.score > b.score : a.order < b.order;
  });
  taken_.clear();
  sightings_.clear();
  for (const Scored& one : scored_) {
    if (is_taken(one.place)) continue;
    taken_.push_back(one.place);
    sightings_.push_back(refine(one));
  }
  std::sort(sightings_.begin(), sightings_.end(), [](const Sighting& a, const Sighting& b) {
    return std::hypot(a.forward, a.left) < std::hypot(b.forward, b.left);
  });
  return std::span<const Sighting>(sightings_);
}

}  // namespace usher::people_detector
