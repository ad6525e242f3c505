#include "navigation/explorer/core/seen_area.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foundation/grid/test/rooms.hpp"

namespace usher::explorer {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

SeenArea area_of(const grid::OccupancyGrid& map, const std::vector<Rectangle>& leave_out = {},
                 const Camera& camera = {}) {
  auto made = SeenArea::create(camera);
  EXPECT_TRUE(made.ok());
  made->set_map(map, leave_out);
  return std::move(made).value();
}

TEST(SeenArea, SeesTheSectorBetweenNearestAndFarthest) {
  const auto map = grid::hall();
  auto seen = area_of(map);
  const Pose2 robot{8.02, 5.01, 0.7};
  seen.look(robot);
  const double half = Camera{}.field_of_view / 2.0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] != grid::kFree) continue;
    const Point2 in_robot =
        geometry::inverse(robot) * map.geometry().center(map.geometry().cell(i));
    const double range = in_robot.norm();
    const double bearing = std::abs(std::atan2(in_robot.y(), in_robot.x()));
    const double cell = 0.036;  // half of its diagonal
    const double edge = cell / range;
    if (range > 0.3 + cell && range < 3.5 - cell && bearing < half - edge) {
      EXPECT_TRUE(seen.seen(i)) << range << " m, " << bearing << " rad";
    } else if (range < 0.3 - 2 * cell || range > 3.5 + 2 * cell || bearing > half + edge) {
      EXPECT_FALSE(seen.seen(i)) << range << " m, " << bearing << " rad";
    }
  }
}

TEST(SeenArea, DoesNotSeeThroughWallsNorIntoTheUnknown) {
  auto map = grid::hall();
  grid::block(map, 6.0, 0.0, 6.1, 10.0);
  for (int y = 0; y < map.height(); ++y) map.at({100, y}) = grid::kUnknown;
  auto seen = area_of(map);
  seen.look({4.5, 5.0, 0.0});
  seen.look({5.5, 5.0, 0.0});
  seen.look({5.5, 5.0, geometry::kPi});
  EXPECT_GT(seen.seen_cells(), 50U);
  for (int y = 1; y < 199; ++y)
    EXPECT_FALSE(seen.seen(map.geometry().index({123, y}))) << "behind the wall";
  seen.forget();
  seen.look({5.5, 5.0, geometry::kPi});
  EXPECT_FALSE(seen.seen(map.geometry().index({99, 100}))) << "behind the unknown";
}

TEST(SeenArea, AThingNearerThanTheNearestHidesAll) {
  auto map = grid::hall();
  grid::block(map, 5.15, 4.0, 5.2, 6.0);
  auto seen = area_of(map);
  EXPECT_EQ(seen.look({5.02, 5.0, 0.0}), 0U);
}

TEST(SeenArea, CountsWhatIsLeftOutNeitherAsWantedNorAsSeen) {
  const auto map = grid::hall();
  auto whole = area_of(map);
  auto part = area_of(map, {{{0.0, 0.0}, {10.0, 10.0}}});
  EXPECT_NEAR(static_cast<double>(part.wanted_cells()),
              static_cast<double>(whole.wanted_cells()) / 2.0, 200.0);
  EXPECT_EQ(part.look({3.0, 5.0, 0.0}), 0U);
  EXPECT_GT(part.look({9.0, 5.0, 0.0}), 500U) << "but it sees across";
}

TEST(SeenArea, CountsEachCellOnceUntilItIsForgotten) {
  auto seen = area_of(grid::hall());
  const auto first = seen.look({8, 5, 0});
  EXPECT_EQ(seen.seen_cells(), first);
  EXPECT_EQ(seen.look({8, 5, 0}), 0U);
  EXPECT_EQ(seen.view({8, 5, 0}).size(), first);
  EXPECT_NEAR(seen.coverage(),
              static_cast<double>(first) / static_cast<double>(seen.wanted_cells()), 1e-12);
  EXPECT_LE(first, seen.most_in_view());
  seen.forget();
  EXPECT_EQ(seen.seen_cells(), 0U);
  EXPECT_EQ(seen.look({8, 5, 0}), first);
}

TEST(SeenArea, TheGainOfPosesIsWhatLookingFromThemShows) {
  const auto map = grid::clutter(3);
  auto seen = area_of(map);
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    std::vector<Pose2> poses;
    for (int k = 0; k < 4; ++k)
      poses.push_back({random.uniform(1, 19), random.uniform(1, 9), random.uniform(-3, 3)});
    const std::size_t gain = seen.gain(poses);
    std::size_t shown = 0;
    for (const Pose2& pose : poses) shown += seen.look(pose);
    EXPECT_EQ(gain, shown);
  }
}

TEST(SeenArea, TheGainsAroundAPlaceAreThoseOfItsPoses) {
  const auto map = grid::clutter(5);
  auto seen = area_of(map);
  Random random(6);
  for (int i = 0; i < 30; ++i) {
    const Point2 place(random.uniform(1, 19), random.uniform(1, 9));
    SeenArea::Gains gains;
    seen.gains(place, gains);
    for (int d = 0; d < SeenArea::kDirections; d += 7) {
      const Pose2 pose{place.x(), place.y(), 2.0 * geometry::kPi * d / SeenArea::kDirections};
      const auto exact = static_cast<double>(seen.gain({&pose, 1}));
      EXPECT_NEAR(gains[static_cast<std::size_t>(d)], exact, 0.1 * exact + 140.0);
    }
    seen.look({place.x(), place.y(), random.uniform(-3, 3)});
  }
}

TEST(SeenArea, SeesNothingFromNowhere) {
  SeenArea empty = std::move(SeenArea::create({})).value();
  EXPECT_EQ(empty.look({1, 1, 0}), 0U);
  EXPECT_EQ(empty.coverage(), 0.0);
  auto seen = area_of(grid::hall());
  SeenArea::Gains gains;
  for (const Pose2& pose :
       {Pose2{kNan, 5, 0}, Pose2{5, 5, kNan}, Pose2{-3, 5, 0}, Pose2{1e9, 5, 0}}) {
    EXPECT_EQ(seen.look(pose), 0U);
    EXPECT_TRUE(seen.view(pose).empty());
    EXPECT_EQ(seen.gain({&pose, 1}), 0U);
  }
  seen.gains({kNan, 5}, gains);
  EXPECT_EQ(gains, SeenArea::Gains{});
}

TEST(SeenArea, RefusesACameraThatIsNone) {
  EXPECT_FALSE(SeenArea::create({.field_of_view = 7.0}));
  EXPECT_FALSE(SeenArea::create({.farthest = kNan}));
  const auto made = SeenArea::create({.nearest = 4.0, .farthest = 3.0});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error(), "nearest must be below farthest");
}

}  // namespace
}  // namespace usher::explorer
