#include "perception/people_detector/core/person_ahead.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace usher::people_detector {
namespace {

using geometry::Pose2;
using geometry::Twist2;

constexpr double kNow = 100.0;

Track somebody(double x, double y, double vx = 0.0, double vy = 0.0) {
  Track track;
  track.state << x, y, vx, vy;
  track.seen.fill(kNow - 0.1);
  return track;
}

std::optional<PersonInTheWay> ahead(const std::vector<Track>& people,
                                    const Twist2& twist = {0.8, 0}, const Pose2& base = {}) {
  return person_ahead(people, kNow, base, twist, {});
}

TEST(PersonAhead, IsWhoStandsInTheWayAndNobodyElse) {
  EXPECT_FALSE(ahead({}));
  EXPECT_TRUE(ahead({somebody(2.5, 0.0)}));
  EXPECT_TRUE(ahead({somebody(2.0, 0.7)}));
  EXPECT_FALSE(ahead({somebody(2.0, 1.2)})) << "beside the way";
  EXPECT_FALSE(ahead({somebody(4.5, 0.0)})) << "far away";
  EXPECT_FALSE(ahead({somebody(-1.0, 0.0)})) << "behind";
  EXPECT_TRUE(ahead({somebody(0.1, 0.8)})) << "close beside the robot";
  EXPECT_TRUE(ahead({somebody(2.0, 0.0)}, {0.0, 0.0})) << "a robot that stands drives on next";
}

TEST(PersonAhead, FollowsTheArc) {
  const double radius = 2.0;
  for (const double side : {1.0, -1.0}) {
    const Twist2 turning{0.8, side * 0.8 / radius};
    const Pose2 later = geometry::integrate({}, turning, 2.4 / 0.8);
    EXPECT_TRUE(ahead({somebody(later.x, later.y)}, turning));
    EXPECT_FALSE(ahead({somebody(later.x, later.y)})) << "straight on leads elsewhere";
    EXPECT_FALSE(ahead({somebody(2.8, -side * 0.4)}, turning));
  }
}

TEST(PersonAhead, ForeseesWhoWillBeThere) {
  EXPECT_TRUE(ahead({somebody(2.0, 1.6, 0.0, -1.2)}));
  EXPECT_FALSE(ahead({somebody(2.0, 1.6, 0.0, 1.2)}));
}

TEST(PersonAhead, IsTheNearestWithPlaceAndSpeed) {
  const Pose2 base{5.0, 3.0, geometry::kPi / 2};
  const auto person = ahead({somebody(5.0, 5.8), somebody(4.6, 5.0, 0.0, -1.0)}, {0.8, 0.0}, base);
  ASSERT_TRUE(person);
  EXPECT_NEAR(person->distance, std::hypot(2.0, 0.4), 1e-9);
  EXPECT_NEAR(person->bearing, std::atan2(0.4, 2.0), 1e-9);
  EXPECT_NEAR(person->closing_speed, 2.0 / std::hypot(2.0, 0.4), 1e-9);
}

TEST(PersonAhead, IsNobodyWhoWasNotSeenLately) {
  Track hidden = somebody(2.0, 0.0);
  hidden.seen.fill(kNow - 1.0);
  EXPECT_FALSE(ahead({hidden}));
}

}  // namespace
}  // namespace usher::people_detector
