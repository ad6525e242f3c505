#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/distance_field.hpp"
#include "foundation/result/result.hpp"
#include "perception/people_detector/core/tracker.hpp"

namespace usher::people_detector {

struct LegFinderConfig {
  double wall = 0.2;       ///< [m] {0.05..1} nearer to something on the map it belongs to that
  double jump = 0.2;       ///< [m] {0.05..1} neighbours farther apart are two things
  double widest = 0.8;     ///< [m] {0.2..2} wider is nobody
  double stride = 0.45;    ///< [m] {0..1} things nearer than this are one person's legs
  double body = 0.12;      ///< [m] {0..0.5} from what is seen to the person's middle
  double farthest = 7.0;   ///< [m] {1..30}
  std::size_t fewest = 3;  ///< {1..50} beams on a person
  double sigma = 0.1;      ///< [m] {0.01..0.5} standard deviation of a found position
};
Status check(const LegFinderConfig& config);

/// A planar scan; ranges that are not finite saw nothing.
struct ScanView {
  double angle_min = 0.0, angle_increment = 0.0;  ///< [rad]
  std::span<const float> ranges;                  ///< [m]
};

/// Finds in a planar scan what may be somebody: things of a person's width that are not on the map.
/// A chair looks the same; the tracker believes only what walks.
class LegFinder {
 public:
  static Result<LegFinder> make(const LegFinderConfig& config);

  void set_map(const grid::OccupancyGrid& map);
  bool has_map() const { return !walls_.empty(); }
  /// Whether something on the map is nearer than `distance` [m] {0..wall}; false without a map.
  bool on_the_map(const geometry::Point2& in_map, double distance) const {
    return has_map() && walls_.interpolated(in_map).distance < distance;
  }

  /// Candidates in odom; none without a map. Valid until the next call.
  std::span<const Observation> find(const ScanView& scan, const geometry::Pose2& map_T_scan,
                                    const geometry::Pose2& odom_T_scan);

 private:
  struct Thing {
    geometry::Point2 sum = geometry::Point2::Zero();  ///< of its points, in the scan's frame
    geometry::Point2 first = geometry::Point2::Zero(), last = geometry::Point2::Zero();
    std::size_t beams = 0;
    geometry::Point2 middle() const { return sum / static_cast<double>(beams); }
  };

  explicit LegFinder(const LegFinderConfig& config) : config_(config) {}
  void collect(const ScanView& scan, const geometry::Pose2& map_T_scan);
  void join_legs();

  LegFinderConfig config_;
  grid::DistanceField walls_;
  std::vector<Thing> things_;
  std::vector<Observation> found_;
};

}  // namespace usher::people_detector
