// Localization on real logs from raw wheel odometry and laser, on a map made from every second scan
// at its reference pose, with the default parameters.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "localization/amcl/core/amcl.hpp"
#include "mapping/map_server/core/carmen_log.hpp"
#include "mapping/map_server/core/map_from_scans.hpp"
#include "support/data.hpp"

namespace usher {
namespace {

struct Log {
  std::vector<map_server::CarmenScan> scans;
  std::vector<geometry::Pose2> reference;
  grid::OccupancyGrid map;
};

Log read_log(const std::string& path) {
  Log log;
  log.scans = map_server::read_carmen_log(path).value();
  const std::string reference =
      path.substr(0, path.size() - std::string(".clf.gz").size()) + ".ref.txt.gz";
  log.reference = map_server::read_reference_poses(reference).value();
  map_server::MapFromScans mapper({});
  for (std::size_t i = 0; i < log.scans.size(); i += 2) {
    const auto& scan = log.scans[i];
    EXPECT_TRUE(
        mapper.add({log.reference[i], scan.angle_min(), scan.angle_increment(), scan.ranges}).ok());
  }
  log.map = mapper.map();
  return log;
}

struct Tracking {
  double mean = 0.0, largest = 0.0;  // [m] distance from the reference, over every scan of the log
  std::size_t lost = 0;              // updates after which the filter itself says so
};

Tracking track(const Log& log, std::uint64_t seed) {
  amcl::Amcl amcl({}, seed);
  EXPECT_TRUE(amcl.set_map(log.map).ok());
  EXPECT_TRUE(
      amcl.set_initial_pose(log.reference[0], Eigen::Vector3d(0.25, 0.25, 0.06).asDiagonal()).ok());
  Tracking result;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const auto& scan = log.scans[i];
    const auto update = amcl.update(scan.odom_T_laser, {{},
                                                        scan.angle_min(),
                                                        scan.angle_increment(),
                                                        0.02,
                                                        map_server::kCarmenMaxRange,
                                                        scan.ranges});
    const double error =
        distance(amcl.estimate()->map_T_odom() * scan.odom_T_laser, log.reference[i]);
    result.mean += error / static_cast<double>(log.scans.size());
    result.largest = std::max(result.largest, error);
    result.lost += update.outcome == amcl::Outcome::kUpdated &&
                   amcl.estimate()->quality.confidence == amcl::Confidence::kLost;
  }
  return result;
}

void expect_tracked(const std::string& path, double mean_bound) {
  const Log log = read_log(path);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Tracking tracking = track(log, seed);
    EXPECT_LE(tracking.mean, mean_bound) << "seed " << seed;
    EXPECT_LE(tracking.largest, 1.5) << "seed " << seed;
    EXPECT_EQ(tracking.lost, 0U) << "seed " << seed;
    std::printf("mean %.4f m, largest %.3f m, %zu scans\n", tracking.mean, tracking.largest,
                log.scans.size());
  }
}

TEST(TrackingLog, Freiburg079OverTheWholeLog) {
  USHER_REQUIRE_DATA(path, "carmen/rawodom/freiburg-079.clf.gz");
  expect_tracked(path, 0.05);
}

TEST(TrackingLog, IntelInStepsOfAMetre) {
  USHER_REQUIRE_DATA(path, "carmen/rawodom/intel.clf.gz");
  expect_tracked(path, 0.05);
}

TEST(TrackingLog, CsailInStepsOfAMetre) {
  USHER_REQUIRE_DATA(path, "carmen/rawodom/csail.clf.gz");
  expect_tracked(path, 0.05);
}

}  // namespace
}  // namespace usher
