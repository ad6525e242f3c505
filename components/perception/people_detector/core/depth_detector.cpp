#include "perception/people_detector/core/depth_detector.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "foundation/result/bounds.hpp"

namespace usher::people_detector {

namespace {

constexpr double kSteepest = 1.2;   // [rad]
constexpr double kBodyDepth = 0.1;  // [m] from the visible surface to the body's middle
constexpr double kBeside = 0.55;    // [m] nearer to somebody surer by far ...
constexpr float kEcho = 0.35F;      // ... than by this is no other one
constexpr double kSamePlace = 0.2;  // [m] nearer votes are for the same place
constexpr float kSilence = -3.0F;   // log odds of a window that has no vote, or of none
constexpr float kHopeless = -6.0F;  // log odds
constexpr int kFew = 4;             // votes

}  // namespace

Status check(const DetectorConfig& c) {
  return within({{"nearest", c.windows.nearest, 0.2, 2.0},
                 {"farthest", c.windows.farthest, 1.0, 8.0},
                 {"least_extent", c.windows.least_extent, 0.1, 1.0},
                 {"step", c.windows.step, 0.02, 0.2},
                 {"threshold", c.threshold, -10.0, 10.0},
                 {"same", c.same, 0.1, 1.0}});
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

/// People look the same in a mirror: what may show one is judged both ways.
Verdict DepthDetector::look(const Candidate& candidate) {
  windows_.describe(candidate, inputs_);
  const Verdict one = classifier_.judge(inputs_);
  if (one.score < kHopeless) return one;
  Windows::mirror(inputs_, mirrored_);
  const Verdict other = classifier_.judge(mirrored_);
  return {0.5F * (one.score + other.score), 0.5F * (one.forward + other.forward),
          0.5F * (one.left - other.left)};
}

bool DepthDetector::are_near(const Vote& a, const Vote& b, double reach) {
  const auto forward = static_cast<double>(a.forward - b.forward);
  const auto left = static_cast<double>(a.left - b.left);
  return forward * forward + left * left < reach * reach;
}

bool DepthDetector::is_taken(const Vote& vote) const {
  return std::any_of(taken_.begin(), taken_.end(), [&](const Vote& other) {
    return are_near(vote, other, config_.same) ||
           (vote.score < kEcho * other.score && are_near(vote, other, kBeside));
  });
}

/// How sure it is that somebody is there: the best vote, and the best few for the same place; one
/// that stands alone counts less.
float DepthDetector::score_of(const Vote& best) const {
  float sum = 0.0F;
  int count = 0;
  for (const Vote& one : votes_) {
    if (count == kFew) break;
    if (are_near(one, best, kSamePlace)) sum += one.score, ++count;
  }
  sum += kSilence * static_cast<float>(kFew - count);
  return 0.5F * (best.score + sum / float{kFew});
}

/// The mean of the votes for the same place as the best one.
Sighting DepthDetector::settle(const Vote& best, float score) const {
  double weights = 0.0, left = 0.0, forward = 0.0;
  for (const Vote& one : votes_) {
    if (!are_near(one, best, kSamePlace)) continue;
    const double weight = static_cast<double>(one.score - kSilence) + 1e-3;
    weights += weight;
    left += weight * static_cast<double>(one.left);
    forward += weight * static_cast<double>(one.forward);
  }
  left /= weights, forward /= weights;
  const Windows::Top top =
      windows_.top({static_cast<float>(forward - kBodyDepth), static_cast<float>(left), 0.0F});
  return {forward, left, top.height, static_cast<double>(score), {}, top.head_hidden};
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
  votes_.clear();
  int order = 0;
  for (const Candidate& candidate : windows_.candidates()) {
    ++order;
    const Verdict verdict = look(candidate);
    if (verdict.score <= kSilence) continue;
    votes_.push_back(
        {candidate.forward + verdict.forward, candidate.left + verdict.left, verdict.score, order});
  }
  std::sort(votes_.begin(), votes_.end(), [](const Vote& a, const Vote& b) {
    return a.score != b.score ? a.score > b.score : a.order < b.order;
  });
  taken_.clear();
  sightings_.clear();
  for (const Vote& vote : votes_) {
    if (is_taken(vote)) continue;
    taken_.push_back(vote);
    const float score = score_of(vote);
    if (static_cast<double>(score) <= config_.threshold) continue;
    sightings_.push_back(settle(vote, score));
  }
  std::sort(sightings_.begin(), sightings_.end(), [](const Sighting& a, const Sighting& b) {
    return std::hypot(a.forward, a.left) < std::hypot(b.forward, b.left);
  });
  return std::span<const Sighting>(sightings_);
}

}  // namespace usher::people_detector
