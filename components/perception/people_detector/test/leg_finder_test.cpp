#include "perception/people_detector/core/leg_finder.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "room_scan.hpp"

namespace usher::people_detector {
namespace {

using geometry::Point2;
using geometry::Pose2;

LegFinder finder() {
  LegFinder legs = LegFinder::make({}).value();
  legs.set_map(room_map());
  return legs;
}
ScanView view(const RoomScan& scan) { return {scan.angle_min, scan.increment, scan.ranges}; }

TEST(LegFinder, FindsWhoIsNotOnTheMapAtTheirPlace) {
  LegFinder legs = finder();
  for (const double yaw : {0.0, 1.2, -2.0}) {
    const Pose2 sensor{1.0, 2.0, yaw};
    const Pose2 map_T_odom{0.3, -0.2, 0.4};
    const Pose2 odom_T_sensor = geometry::inverse(map_T_odom) * sensor;
    const Point2 person = sensor * Point2(1.8, 0.4);
    const RoomScan scan = scan_room(sensor, {{person, 0.25}});
    const auto found = legs.find(view(scan), sensor, odom_T_sensor);
    ASSERT_EQ(found.size(), 1U) << yaw;
    EXPECT_LT((map_T_odom * found[0].position - person).norm(), 0.12);
  }
}

TEST(LegFinder, TakesTwoLegsForOnePersonAndTwoPeopleForTwo) {
  LegFinder legs = finder();
  const Pose2 sensor{1.0, 2.0, 0.0};
  const auto count = [&](std::vector<RoomScan::Disc> discs) {
    return legs.find(view(scan_room(sensor, discs)), sensor, sensor).size();
  };
  EXPECT_EQ(count({{{3.0, 1.85}, 0.07}, {{3.0, 2.15}, 0.07}}), 1U) << "side by side";
  EXPECT_EQ(count({{{2.8, 1.95}, 0.07}, {{3.1, 2.15}, 0.07}}), 1U) << "in a step";
  EXPECT_EQ(count({{{3.0, 1.5}, 0.2}, {{3.0, 2.5}, 0.2}}), 2U);
}

TEST(LegFinder, FindsNothingInWallsFreeSpaceAndWideThings) {
  LegFinder legs = finder();
  const Pose2 sensor{1.0, 2.0, 0.3};
  EXPECT_TRUE(legs.find(view(scan_room(sensor, {})), sensor, sensor).empty());
  const Pose2 off{1.05, 1.95, 0.31};  // localization is never exact
  EXPECT_TRUE(legs.find(view(scan_room(sensor, {})), off, off).empty());
  const Point2 cupboard = sensor * Point2(2.0, 0.0);
  EXPECT_TRUE(legs.find(view(scan_room(sensor, {{cupboard, 0.7}})), sensor, sensor).empty());
}

TEST(LegFinder, BadInputFindsNobody) {
  LegFinder legs = finder();
  const Pose2 sensor{1.0, 2.0, 0.0};
  RoomScan scan = scan_room(sensor, {{{3.0, 2.0}, 0.25}});
  const Pose2 nowhere{std::nan(""), 0.0, 0.0};
  EXPECT_TRUE(legs.find(view(scan), nowhere, sensor).empty());
  EXPECT_TRUE(legs.find(view(scan), sensor, nowhere).empty());
  EXPECT_TRUE(LegFinder::make({}).value().find(view(scan), sensor, sensor).empty()) << "no map";
  EXPECT_TRUE(legs.find({}, sensor, sensor).empty());
  for (float& range : scan.ranges) range = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(legs.find(view(scan), sensor, sensor).empty());
  for (float& range : scan.ranges) range = -1.0F;
  EXPECT_TRUE(legs.find(view(scan), sensor, sensor).empty());
  EXPECT_EQ(LegFinder::make({.wall = std::nan("")}).error(),
            "wall must be in [0.05, 1] m, got nan");
}

}  // namespace
}  // namespace usher::people_detector
