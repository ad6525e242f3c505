// A visitor walks through the zones of the thesis' figure 7.4 before the whole robot.
#include <gtest/gtest.h>

#include <cmath>

#include "foundation/geometry/angle.hpp"
#include "operations/experiments/zone_walk.hpp"
#include "support/folder.hpp"

namespace usher::operations {
namespace {

using geometry::radians;
constexpr std::size_t kTilt = 2, kRise = 3, kShake = 6;

class InteractionZones : public testing::Test {
 protected:
  void SetUp() override {
    const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
    const Installation installation{
        .programs = {}, .contracts = share + "/contracts", .share = share};
    auto walk = ZoneWalk::create(installation, folder_.path(), {}, 1);
    ASSERT_TRUE(walk.ok()) << walk.error();
    walk_ = std::move(walk).value();
    const auto ready = walk_->get_ready();
    ASSERT_TRUE(ready.ok()) << ready.error();
  }
  void go(double range, double bearing_degrees, double speed, double stay = 6.0) {
    walk_->send(range, radians(bearing_degrees), speed);
    walk_->arrive(10.0);
    walk_->run(stay);
  }
  double joint(std::size_t which) const { return walk_->now().joints[which]; }

  test::Folder folder_;
  std::unique_ptr<ZoneWalk> walk_;
};

TEST_F(InteractionZones, TheTorsoFollowsAVisitorThroughThem) {
  go(2.5, 0.0, 1.0);
  EXPECT_EQ(walk_->now().zone, "far");
  EXPECT_TRUE(walk_->now().posed);
  EXPECT_NEAR(joint(kRise), 0.08, 0.001) << "it cranes";
  EXPECT_NEAR(joint(kTilt), 0.0, 0.005);

  go(1.1, 10.0, 0.8);
  EXPECT_EQ(walk_->now().zone, "nominal");
  EXPECT_NEAR(joint(kRise), 0.04, 0.001);
  EXPECT_LT(std::abs(walk_->now().bearing), radians(18.0)) << "the base faces";
  EXPECT_GT(walk_->now().left_eye[1], walk_->now().left_eye[0]) << "green";

  go(1.1, 70.0, 1.4);
  EXPECT_EQ(walk_->now().zone, "left");
  EXPECT_NEAR(joint(kTilt), radians(10.0), 0.005) << "it leans over";
  EXPECT_NEAR(joint(kShake), radians(45.0), 0.005);
  const double yaw = walk_->now().yaw;
  walk_->run(5.0);
  EXPECT_NEAR(walk_->now().yaw, yaw, radians(2.0)) << "and the base does not turn";

  go(1.1, 0.0, 1.0);
  EXPECT_EQ(walk_->now().zone, "nominal");
  EXPECT_NEAR(joint(kTilt), 0.0, 0.005);

  go(1.1, -70.0, 1.4);
  EXPECT_EQ(walk_->now().zone, "right");
  EXPECT_NEAR(joint(kTilt), radians(-10.0), 0.005);

  go(4.6, -40.0, 1.2, 12.0);
  EXPECT_EQ(walk_->now().zone, "");
  EXPECT_EQ(walk_->now().pose, "rest");
  EXPECT_NEAR(joint(kRise), 0.02, 0.001);
}

TEST_F(InteractionZones, NobodyChattersWhereTwoMeet) {
  go(1.5, 0.0, 0.8, 2.0);
  std::string last = walk_->now().zone;
  int changes = 0;
  for (int i = 0; i < 40; ++i) {
    walk_->send(i % 2 == 0 ? 1.58 : 1.42, 0.0, 0.4);
    for (int j = 0; j < 20; ++j) {
      walk_->run(0.05);
      changes += walk_->now().zone != last;
      last = walk_->now().zone;
    }
  }
  EXPECT_LE(changes, 1);
}

TEST_F(InteractionZones, TheTorsoHoldsStillWhileTheRobotListens) {
  go(2.5, 0.0, 1.0);
  walk_->send(1.1, 0.0, 1.2);
  walk_->arrive(4.0);
  walk_->listen(true);
  walk_->run(0.5);
  const auto held = walk_->now().joints;
  walk_->run(8.0);
  EXPECT_EQ(walk_->now().joints, held);
  EXPECT_NE(held[kRise], 0.04) << "it was on its way";
  walk_->listen(false);
  walk_->run(5.0);
  EXPECT_NEAR(joint(kRise), 0.04, 0.001);
}

}  // namespace
}  // namespace usher::operations
