#include "interaction/tablet/core/place_names.hpp"

#include <gtest/gtest.h>

namespace usher::tablet {
namespace {

using geometry::Point2;

constexpr double kText = 20.0;  // [px]

/// 20 x 10 m of floor at 0.1 m, drawn at two pixels a cell, behind walls.
class Names : public testing::Test {
 protected:
  void wall(int left, int top, int right, int bottom) {
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) map_.at({x, 99 - y}) = 100;
    }
  }
  void SetUp() override {
    wall(0, 0, 199, 0), wall(0, 99, 199, 99), wall(0, 0, 0, 99), wall(199, 0, 199, 99);
  }
  std::vector<std::optional<NameBox>> place(const std::vector<PlaceName>& names,
                                            const std::vector<Box>& kept_free = {}) {
    return place_names(draw_floor_plan(map_, 0), 2.0, kText, names, kept_free);
  }
  static PlaceName name(double x, double y, double width = 100.0) {
    return {{x, y}, 3.0, {width, 24.0}, {0.6 * width, 48.0}};
  }
  grid::OccupancyGrid map_{{200, 100, 0.1, 0.0, 0.0}, 0};
};

TEST_F(Names, StandBelowTheirPlaceInOneLineWhereThereIsRoom) {
  const auto placed = place({name(200, 100)});
  ASSERT_TRUE(placed[0]);
  EXPECT_FALSE(placed[0]->two_lines);
  EXPECT_FALSE(placed[0]->crosses_wall);
  EXPECT_NEAR(placed[0]->box.center().x(), 200.0, 1e-9);
  EXPECT_NEAR(placed[0]->box.min().y(), 108.0, 1e-9) << "beside the dot and a robot on it";
}

TEST_F(Names, KeepToTheirRoom) {
  wall(0, 52, 199, 53);  // below the place, at 104 px
  wall(110, 0, 111, 53);
  const auto placed = place({name(200, 98)});
  ASSERT_TRUE(placed[0]);
  EXPECT_FALSE(placed[0]->crosses_wall);
  EXPECT_LE(placed[0]->box.max().y(), 108.0);
  EXPECT_LE(placed[0]->box.max().x(), 224.0);
}

TEST_F(Names, AreNotPutIntoTheNextRoomWhole) {
  wall(0, 52, 199, 53);
  wall(0, 42, 199, 43);  // a corridor, too low for the name
  const auto placed = place({name(200, 96)});
  ASSERT_TRUE(placed[0]);
  EXPECT_TRUE(placed[0]->crosses_wall) << "below it would be the next room's name";
  EXPECT_GT(placed[0]->box.intersection(Box(Point2(0, 84), Point2(400, 108))).volume(),
            0.5 * placed[0]->box.volume());
}

TEST_F(Names, LieOnFurnitureRatherThanAcrossAWall) {
  wall(0, 52, 199, 53);
  wall(85, 25, 115, 47);  // a table, where the name has to be
  const auto placed = place({name(200, 101)});
  ASSERT_TRUE(placed[0]);
  EXPECT_FALSE(placed[0]->crosses_wall);
  EXPECT_LT(placed[0]->box.max().y(), 108.0);
}

TEST_F(Names, CrossAWallOnlyWhenNoOtherPositionIsLeft) {
  wall(80, 0, 81, 99), wall(120, 0, 121, 99);  // a shaft of 76 pixels
  auto placed = place({name(200, 100)});
  ASSERT_TRUE(placed[0]);
  EXPECT_TRUE(placed[0]->two_lines);
  EXPECT_FALSE(placed[0]->crosses_wall);
  placed = place({name(200, 100, 84)});
  ASSERT_TRUE(placed[0]);
  EXPECT_FALSE(placed[0]->crosses_wall) << "though in one line it would cross them by little";
  placed = place({name(200, 100, 160)});
  ASSERT_TRUE(placed[0]);
  EXPECT_TRUE(placed[0]->crosses_wall);
  EXPECT_TRUE(placed[0]->two_lines) << "and then as little as can be";
}

TEST_F(Names, LeaveRoomToEachOtherAndToPlaces) {
  std::vector<PlaceName> names;
  for (int i = 0; i < 12; ++i) names.push_back(name(100 + 20 * i, 90 + 15 * (i % 3)));
  const auto placed = place(names);
  ASSERT_TRUE(placed[0]) << "the first has its choice";
  int found = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!placed[i]) continue;
    ++found;
    EXPECT_GE(placed[i]->box.min().x(), 0.0);
    for (std::size_t j = 0; j < names.size(); ++j) {
      if (i == j) continue;
      EXPECT_GT(placed[i]->box.exteriorDistance(names[j].at),
                placed[i]->box.exteriorDistance(names[i].at))
          << i << " would be taken for the name of " << j;
      EXPECT_FALSE(placed[j] && placed[i]->box.intersects(placed[j]->box));
    }
  }
  EXPECT_GE(found, 5);
}

TEST_F(Names, LeaveFreeWhatTheyAreAskedTo) {
  const Box robot(Point2(180, 80), Point2(220, 130));
  const auto placed = place({name(200, 100)}, {robot});
  ASSERT_TRUE(placed[0]);
  EXPECT_FALSE(placed[0]->box.intersects(robot));
}

TEST_F(Names, OfPlacesThatAreNotOnThePictureAreLeftOut) {
  const auto placed = place({name(-50, 100), name(200, std::nan("")), name(200, 1e300)});
  for (const auto& each : placed) EXPECT_FALSE(each);
  EXPECT_FALSE(place_names({}, 1.0, kText, std::vector{name(10, 10)}, {})[0]);
  EXPECT_FALSE(place({name(200, 100, 1e4)})[0]) << "no room at all";
}

TEST(SignBeside, StandsOnNoNameAndStaysWhereItWas) {
  const Point2 size(100, 30), picture(400, 200);
  const Point2 robot(200, 100);
  const auto side = [&](const std::vector<Box>& names, Side last) {
    return sign_beside(robot, 20.0, size, picture, names, last).side;
  };
  const Box above(Point2(150, 60), Point2(250, 75)), below(Point2(150, 130), Point2(250, 150));
  EXPECT_EQ(side({}, Side::kAbove), Side::kAbove);
  EXPECT_EQ(side({}, Side::kLeft), Side::kLeft) << "there is room still";
  EXPECT_EQ(side({above}, Side::kAbove), Side::kBelow);
  EXPECT_EQ(side({above, below}, Side::kAbove), Side::kRight);
  const Sign corner = sign_beside({5, 5}, 20.0, size, picture, {}, Side::kAbove);
  EXPECT_EQ(corner.side, Side::kBelow) << "above it would lie on the robot";
  EXPECT_TRUE(Box(Point2(0, 0), picture).contains(corner.box));
}

}  // namespace
}  // namespace usher::tablet
