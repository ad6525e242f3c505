#include "perception/people_detector/core/leg_finder.hpp"

#include <cmath>

#include "foundation/result/bounds.hpp"

namespace usher::people_detector {

using geometry::Point2;

Status check(const LegFinderConfig& c) {
  return within({{"wall", c.wall, 0.05, 1.0, "m"},
                 {"jump", c.jump, 0.05, 1.0, "m"},
                 {"widest", c.widest, 0.2, 2.0, "m"},
                 {"stride", c.stride, 0.0, 1.0, "m"},
                 {"body", c.body, 0.0, 0.5, "m"},
                 {"farthest", c.farthest, 1.0, 30.0, "m"},
                 {"fewest", static_cast<double>(c.fewest), 1, 50},
                 {"sigma", c.sigma, 0.01, 0.5, "m"}});
}

Result<LegFinder> LegFinder::make(const LegFinderConfig& config) {
  if (const Status status = check(config); !status) return Error{status.error()};
  return LegFinder(config);
}

void LegFinder::set_map(const grid::OccupancyGrid& map) {
  walls_.build(map, config_.wall + 2.0 * map.resolution());
}

/// Runs of neighbouring beams that meet something which is not on the map.
void LegFinder::collect(const ScanView& scan, const geometry::Pose2& map_T_scan) {
  things_.clear();
  bool open = false;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto range = static_cast<double>(scan.ranges[i]);
    if (!(range > 0.0 && range <= config_.farthest)) {
      open = false;
      continue;
    }
    const double angle = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    const Point2 point = range * Point2(std::cos(angle), std::sin(angle));
    if (on_the_map(map_T_scan * point, config_.wall)) {
      open = false;
      continue;
    }
    if (!open || (point - things_.back().last).norm() > config_.jump) {
      things_.emplace_back().first = point;
      open = true;
    }
    Thing& thing = things_.back();
    thing.sum += point;
    thing.last = point;
    ++thing.beams;
  }
  std::erase_if(things_, [this](const Thing& thing) {
    return (thing.last - thing.first).norm() > config_.widest;
  });
}

/// Two legs, and a leg behind the other that parts it, are one person.
void LegFinder::join_legs() {
  for (std::size_t i = 0; i < things_.size(); ++i) {
    for (std::size_t k = i + 1; k < things_.size(); ++k) {
      Thing& thing = things_[i];
      const Thing& other = things_[k];
      const bool near = (thing.middle() - other.middle()).norm() < config_.stride;
      if (!near || (other.last - thing.first).norm() > config_.widest) continue;
      thing.sum += other.sum;
      thing.beams += other.beams;
      thing.last = other.last;
      things_.erase(things_.begin() + static_cast<std::ptrdiff_t>(k--));
    }
  }
}

std::span<const Observation> LegFinder::find(const ScanView& scan,
                                             const geometry::Pose2& map_T_scan,
                                             const geometry::Pose2& odom_T_scan) {
  found_.clear();
  if (!has_map() || !map_T_scan.finite() || !odom_T_scan.finite()) return found_;
  collect(scan, map_T_scan);
  join_legs();
  for (const Thing& thing : things_) {
    if (thing.beams < config_.fewest) continue;
    const Point2 middle = thing.middle();
    const double range = middle.norm();
    found_.push_back({odom_T_scan * Point2(middle * ((range + config_.body) / range)),
                      config_.sigma * config_.sigma * Eigen::Matrix2d::Identity(), 0.0});
  }
  return found_;
}

}  // namespace usher::people_detector
