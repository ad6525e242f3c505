#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/map_server/core/map_from_log.hpp"

namespace usher::map_server {
namespace {

using testing::HasSubstr;

/// One beam ahead that ends after `range`.
CarmenScan one_beam(float range, std::size_t line) {
  CarmenScan scan;
  scan.ranges = {90.0F, range, 90.0F};
  scan.line = line;
  return scan;
}

TEST(MapFromLog, TakesEveryNthScanFromItsReferencePose) {
  const std::vector<CarmenScan> scans = {one_beam(1.0F, 1), one_beam(2.0F, 2), one_beam(3.0F, 3)};
  const std::vector<geometry::Pose2> reference = {
      {0.025, 0.025, 0}, {0.025, 10.025, 0}, {0.025, 20.025, 0}};
  const auto all = map_from_log(scans, reference);
  const auto half = map_from_log(scans, reference, 2);
  ASSERT_TRUE(all.ok() && half.ok());
  const auto value = [](const grid::OccupancyGrid& map, double x, double y) {
    return map.value_or(map.geometry().cell_at(x, y), grid::kUnknown);
  };
  EXPECT_EQ(value(*all, 1.025, 0.025), grid::kOccupied);
  EXPECT_EQ(value(*all, 2.025, 10.025), grid::kOccupied);
  EXPECT_EQ(value(*half, 1.025, 0.025), grid::kOccupied);
  EXPECT_EQ(value(*half, 2.025, 10.025), grid::kUnknown);
  EXPECT_EQ(value(*half, 3.025, 20.025), grid::kOccupied);
}

TEST(MapFromLog, RefusesWhatDoesNotFit) {
  const std::vector<CarmenScan> scans = {one_beam(1.0F, 7)};
  const std::vector<geometry::Pose2> none, far = {{1e9, 0, 0}}, here = {{0, 0, 0}};
  EXPECT_THAT(map_from_log(scans, none).error(), HasSubstr("each of the 1 scans, found 0"));
  EXPECT_THAT(map_from_log(scans, here, 0).error(), HasSubstr("at least 1"));
  EXPECT_THAT(map_from_log(scans, far).error(), HasSubstr("line 7"));
  const std::vector<CarmenScan> blind = {one_beam(90.0F, 1)};
  EXPECT_THAT(map_from_log(blind, here).error(), HasSubstr("no beam"));
}

}  // namespace
}  // namespace usher::map_server
