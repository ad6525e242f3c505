#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "foundation/grid/ray_cast.hpp"
#include "foundation/random/random.hpp"
#include "mapping/map_server/core/map_from_scans.hpp"

namespace usher::map_server {
namespace {

using grid::Cell;
using grid::kFree;
using grid::kOccupied;
using grid::kUnknown;

TEST(MapFromScans, IsEmptyBeforeTheFirstBeam) {
  MapFromScans mapper({});
  EXPECT_TRUE(mapper.map().empty());
  const std::vector<float> none = {0.0F, -1.0F, std::nanf(""), 1e9F};
  EXPECT_TRUE(mapper.add({{}, 0.0, 0.1, none}).ok());
  EXPECT_TRUE(mapper.map().empty());
}

TEST(MapFromScans, ABeamFreesItsWayAndOccupiesItsEnd) {
  MapFromScans mapper({});
  const std::vector<float> one = {1.0F};
  ASSERT_TRUE(mapper.add({{0.025, 0.025, 0.0}, 0.0, 0.1, one}).ok());
  const grid::OccupancyGrid map = mapper.map();
  EXPECT_EQ(map.width(), 23);  // cells 0..20 and a border
  EXPECT_EQ(map.height(), 3);
  EXPECT_NEAR(map.geometry().origin_x, -0.05, 1e-9);
  EXPECT_EQ(map.at({21, 1}), kOccupied);
  for (int x = 1; x <= 20; ++x) EXPECT_EQ(map.at({x, 1}), kFree);
  EXPECT_EQ(std::count(map.begin(), map.end(), kUnknown), 23 * 3 - 21);
}

TEST(MapFromScans, TheMajorityOfBeamsDecides) {
  MapFromScans mapper({});
  const std::vector<float> near = {1.0F}, far = {2.0F};
  ASSERT_TRUE(mapper.add({{0.025, 0.025, 0.0}, 0.0, 0.1, near}).ok());  // somebody passed by
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(mapper.add({{0.025, 0.025, 0.0}, 0.0, 0.1, far}).ok());
  const grid::OccupancyGrid map = mapper.map();
  EXPECT_EQ(map.at(map.geometry().cell_at(1.025, 0.025)), kFree);
  EXPECT_EQ(map.at(map.geometry().cell_at(2.025, 0.025)), kOccupied);
}

TEST(MapFromScans, RebuildsARoomFromItsScansInAnyOrder) {
  grid::OccupancyGrid room({120, 80, 0.05, -2.0, -1.0}, kFree);
  for (int x = 0; x < 120; ++x) room.at({x, 0}) = room.at({x, 79}) = kOccupied;
  for (int y = 0; y < 80; ++y) room.at({0, y}) = room.at({119, y}) = kOccupied;
  for (int y = 20; y < 40; ++y) room.at({60, y}) = kOccupied;
  Random random(1);
  struct Seen {
    geometry::Pose2 pose;
    std::vector<float> ranges;
  };
  std::vector<Seen> scans(60);
  for (Seen& seen : scans) {
    seen.pose = {random.uniform(-1.5, 3.5), random.uniform(-0.5, 2.5), random.uniform(-3, 3)};
    for (int i = 0; i < 720; ++i) {
      const auto hit = grid::cast_ray(room.geometry(), seen.pose.position(),
                                      seen.pose.yaw + i * geometry::kPi / 360, 30.0,
                                      [&](Cell cell) { return room.at(cell) == kOccupied; });
      seen.ranges.push_back(hit ? static_cast<float>(hit->range + 0.01) : 80.0F);
    }
  }
  MapFromScans forward({}), backward({});
  for (const Seen& seen : scans)
    ASSERT_TRUE(forward.add({seen.pose, 0.0, geometry::kPi / 360, seen.ranges}).ok());
  std::reverse(scans.begin(), scans.end());
  for (const Seen& seen : scans)
    ASSERT_TRUE(backward.add({seen.pose, 0.0, geometry::kPi / 360, seen.ranges}).ok());
  const grid::OccupancyGrid map = forward.map();
  EXPECT_EQ(map.values(), backward.map().values());
  int wrong = 0;
  for (int y = 1; y < 79; ++y) {
    for (int x = 1; x < 119; ++x) {
      const auto value = map.at(map.geometry().cell_at(room.geometry().center({x, y})));
      wrong += value != kUnknown && value != room.at({x, y});
    }
  }
  EXPECT_LT(wrong, 30);
}

TEST(MapFromScans, RefusesPosesThatAreNone) {
  MapFromScans mapper({});
  const std::vector<float> one = {1.0F};
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(mapper.add({{kNan, 0, 0}, 0, 0.1, one}).ok());
  EXPECT_FALSE(mapper.add({{0, 0, 0}, kNan, 0.1, one}).ok());
  EXPECT_FALSE(mapper.add({{1e9, 0, 0}, 0, 0.1, one}).ok());
}

TEST(MapFromScans, LimitsItsSizeAndKeepsWhatItHas) {
  MappingParameters parameters;
  parameters.max_cells = 200'000;
  MapFromScans mapper(parameters);
  const std::vector<float> one = {1.0F};
  ASSERT_TRUE(mapper.add({{0, 0, 0}, 0, 0.1, one}).ok());
  const auto before = mapper.map();
  EXPECT_THAT(mapper.add({{1000, 1000, 0}, 0, 0.1, one}).error(),
              testing::HasSubstr("200000 cells"));
  EXPECT_EQ(mapper.map(), before);
}

}  // namespace
}  // namespace usher::map_server
