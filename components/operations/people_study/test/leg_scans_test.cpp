#include "operations/people_study/leg_scans.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace usher::people_study {
namespace {

constexpr const char* kHead =
    "# frame laser angle_min -0.1 angle_max 0.1 angle_inc 0.05 range_min 0.03 range_max 11.0 beams "
    "5\n";

TEST(LegRecording, ReadsScansAndTheMarksOfTheScanBefore) {
  const auto read = parse_leg_recording(
      std::string(kHead) + "S 1.5 2.0 inf 0.006 2.5 3.0\nL 1.5 1 1.0 -0.5\nS 1.6 1 1 1 1 1\n", "a");
  ASSERT_TRUE(read) << read.error();
  EXPECT_DOUBLE_EQ(read->angle_min, -0.1);
  EXPECT_DOUBLE_EQ(read->angle_increment, 0.05);
  ASSERT_EQ(read->scans.size(), 2U);
  const MarkedScan& scan = read->scans.front();
  ASSERT_EQ(scan.ranges.size(), 5U);
  EXPECT_TRUE(std::isinf(scan.ranges[1]));
  EXPECT_TRUE(std::isnan(scan.ranges[2]));
  EXPECT_THAT(scan.legs, testing::ElementsAre(geometry::Point2(1.0, -0.5)));
  EXPECT_TRUE(read->scans.back().legs.empty());
}

TEST(LegRecording, SaysWhatIsWrongAndWhere) {
  const auto error = [](const std::string& text) { return parse_leg_recording(text, "a").error(); };
  EXPECT_THAT(error("S 1 2 3\n"), testing::StartsWith("a:1: expected a line '# angle_min"));
  EXPECT_THAT(error(std::string(kHead) + "S 1 2 x\n"),
              testing::StartsWith("a:2: expected a range, found 'x'"));
  EXPECT_THAT(error(std::string(kHead) + "L 1 0\n"),
              testing::StartsWith("a:2: expected a scan before"));
  EXPECT_THAT(error(std::string(kHead) + "S 1 2\nL 1 2 1 1 1\n"),
              testing::StartsWith("a:3: expected x and y of leg 2"));
  EXPECT_THAT(error("Q\n"), testing::StartsWith("a:1: expected #, S or L"));
}

TEST(LegsByWidth, AreAsWideAsALegAndNoFarther) {
  std::vector<float> ranges(60, 4.0F);
  for (std::size_t i = 10; i < 15; ++i) ranges[i] = 1.5F;  // 0.12 m wide
  for (std::size_t i = 30; i < 50; ++i) ranges[i] = 1.5F;  // 0.57 m
  const people_detector::ScanView scan{0.0, 0.02, ranges};
  const auto legs = legs_by_width(scan, 3.0);
  ASSERT_EQ(legs.size(), 1U);
  EXPECT_LT((legs[0] - 1.5 * geometry::Point2(std::cos(0.24), std::sin(0.24))).norm(), 0.01);
  EXPECT_TRUE(legs_by_width(scan, 1.0).empty());
}

TEST(MapOf, HoldsWhatStandsAndNotWhoWalksBy) {
  LegRecording recording{"a", 0.0, 0.01, {}};
  for (std::size_t i = 0; i < 20; ++i) {
    MarkedScan& scan = recording.scans.emplace_back();
    scan.ranges.assign(100, 3.0F);
    for (std::size_t k = 0; k < 5; ++k) scan.ranges[5 * i + k] = 1.0F;
  }
  const grid::OccupancyGrid map = map_of(recording, 5.0);
  EXPECT_EQ(map.at(map.geometry().cell_at(3.0 * std::cos(0.5), 3.0 * std::sin(0.5))),
            grid::kOccupied);
  EXPECT_EQ(map.at(map.geometry().cell_at(std::cos(0.5), std::sin(0.5))), grid::kFree);
}

}  // namespace
}  // namespace usher::people_study
