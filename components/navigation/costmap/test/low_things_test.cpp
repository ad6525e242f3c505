#include "navigation/costmap/core/low_things.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "navigation/costmap/core/obstacle_layer.hpp"

namespace usher::costmap {
namespace {

TEST(LowThings, SomebodyInTheLineOfSightHidesTheFloorBehindHim) {
  const auto directions = beam_directions(-0.4, 0.4, 3);
  const geometry::Pose2 camera{1.0, 2.0, geometry::kPi / 2};
  const auto see = [&](std::vector<geometry::Point2> people) {
    std::vector<float> ranges{2.0F, 2.0F, -2.0F};
    drop_what_people_hide(directions, camera, people, ranges);
    return ranges;
  };
  const auto in_front = see({{1.0, 3.2}});  // nearer than 0.35 m to the middle ray alone
  EXPECT_FLOAT_EQ(in_front[0], 2.0F);
  EXPECT_TRUE(std::isnan(in_front[1]));
  EXPECT_FLOAT_EQ(in_front[2], -2.0F) << "nothing low up to there";
  EXPECT_TRUE(std::isnan(see({{1.0, 2.5}})[0])) << "so near that he hides all";
  EXPECT_FLOAT_EQ(see({{1.0, 4.5}})[1], 2.0F) << "behind it";
  EXPECT_FLOAT_EQ(see({{1.0, 1.5}})[1], 2.0F) << "behind the camera";
  EXPECT_FLOAT_EQ(see({})[1], 2.0F);
}

TEST(LowThings, AFootIsNothingLowUpToThereAndTheOthersAreNoFeet) {
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  const auto directions = beam_directions(-0.4, 0.2, 5);
  const std::vector<float> ranges{2.0F, 1.0F, nan, infinity, -3.0F};
  std::vector<float> alone, feet;
  std::vector<std::size_t> asked;
  const auto is_foot = [&](std::size_t bearing, const geometry::Point2& place) {
    asked.push_back(bearing);
    EXPECT_NEAR(place.norm(), static_cast<double>(ranges[bearing]), 1e-6);
    return place.norm() < 1.5;
  };
  keep_own(ranges, directions, is_foot, feet);
  EXPECT_EQ(asked, (std::vector<std::size_t>{0, 1})) << "what is no place is not asked for";
  keep_own(ranges, directions, std::not_fn(is_foot), alone);
  EXPECT_EQ(alone[0], 2.0F);
  EXPECT_EQ(feet[0], -2.0F);
  EXPECT_EQ(alone[1], -1.0F);
  EXPECT_EQ(feet[1], 1.0F);
  for (const auto* both : {&alone, &feet}) {
    EXPECT_TRUE(std::isnan((*both)[2]));
    EXPECT_EQ((*both)[3], infinity);
    EXPECT_EQ((*both)[4], -3.0F);
  }
}

}  // namespace
}  // namespace usher::costmap
