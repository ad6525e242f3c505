#include <gtest/gtest.h>

#include "navigation/costmap/test/room.hpp"
#include "wire/low_scan.hpp"

namespace usher::costmap {
namespace {

TEST_F(Component, KeepsWhatADepthCameraSawThatFallsSilent) {
  for (const auto* topic : {&topics::kKinectScan, &topics::kKinectScanLow, &topics::kRearScan}) {
    SCOPED_TRACE(topic->name);
    base.x += 6.0;  // what the one before saw is out of the window
    give_map();
    run(200);
    for (int i = 0; i < 10; ++i) host.publish(*topic, scan("laser", 1.0F)), run(40);
    EXPECT_EQ(local_cost(base.x + 1.0, 0.0), kLethalCost);
    run(1500);  // its age is 0.5 s
    EXPECT_EQ(local_cost(base.x + 1.0, 0.0), kLethalCost) << "no laser clears what it cannot see";
    EXPECT_EQ(local_cost(base.x + 2.0, 0.0), kLethalCost) << "the laser goes on";
    EXPECT_EQ(reason(), "");
  }
}

TEST_F(Component, ForgetsALowThingThatIsGoneBeforeAWall) {
  give_map();
  run(200);
  const auto see = [&](float range) {
    for (int i = 0; i < 10; ++i)
      host.publish(topics::kKinectScanLow, scan("laser", range)), run(40);
  };
  see(2.2F);
  EXPECT_EQ(local_cost(2.22, 0.17), kLethalCost);
  see(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(local_cost(2.22, 0.17), kLethalCost) << "nothing is known";
  see(-2.9F);
  EXPECT_LT(local_cost(2.22, 0.17), kLethalCost) << "a wall is at 2.9 m, and nothing low before it";
  EXPECT_LT(local_cost(2.9, 0.17), kLethalCost) << "the wall is for other layers";
}

TEST_F(Component, RemembersTheFootOfAThingAsLongAsTheLaserSeesIt) {
  for (const bool mapped : {false, true}) {
    if (mapped) {
      for (int y = 0; y < map.height(); ++y) map.at({120, y}) = grid::kOccupied;  // x = 2 m
    }
    give_map();
    look(2.03F, 300);
    for (int i = 0; i < 5; ++i) {
      host.publish(topics::kKinectScanLow, scan("laser", 1.7F));
      look(2.03F, 40);
    }
    look(2.03F, 2000);
    EXPECT_EQ(local_cost(1.72, 0.0), kLethalCost) << "the camera looks over it";
    look(3.5F, 1500);  // who stood there has gone, or a door is open
    EXPECT_EQ(local_cost(1.72, 0.0) == kLethalCost, mapped) << "what stands before a wall stays";
    EXPECT_EQ(global_cost(1.72, 0.0) >= kPassing, mapped);
  }
}

TEST_F(Component, RemembersADropBesideSomebodyWhoHasLeft) {
  for (const float intensity : {1.0F, wire::kDrop}) {
    SCOPED_TRACE(intensity);
    give_map();
    look(2.03F, 300);  // he stands at the top of the stairs
    for (int i = 0; i < 5; ++i) {
      auto low = scan("laser", 1.7F);
      low.intensities().assign(low.ranges().size(), intensity);
      host.publish(topics::kKinectScanLow, low);
      look(2.03F, 40);
    }
    EXPECT_EQ(local_cost(1.72, 0.0), kLethalCost);
    look(3.5F, 1500);
    const bool drop = intensity == wire::kDrop;
    EXPECT_EQ(local_cost(1.72, 0.0) == kLethalCost, drop) << "a thing may have been his foot";
    EXPECT_EQ(global_cost(1.72, 0.0) >= kPassing, drop);
  }
}

TEST_F(Component, RemembersNoFloorThatSomebodyHides) {
  give_map();
  laser_range = 3.5F;
  run(200);
  const auto see = [&](double aside, float unseen, float intensity = wire::kDrop) {
    for (int i = 0; i < 5; ++i) {
      tell_of(0.6, aside, unseen);
      run(20);
      auto low = scan("laser", 2.2F);
      low.intensities().assign(low.ranges().size(), intensity);
      host.publish(topics::kKinectScanLow, low);
      run(20);
    }
  };
  see(0.2, 0.0F);
  EXPECT_LT(local_cost(2.22, 0.0), kLethalCost);
  see(0.2, 1.5F);
  EXPECT_LT(local_cost(2.22, 0.0), kLethalCost) << "too near to be detected";
  see(0.2, 0.0F, wire::kDropBehindFloor);
  EXPECT_EQ(local_cost(2.22, 0.0), kLethalCost) << "the floor before it is seen: nobody hides it";
}

TEST_F(Component, RemembersFloorThatIsMissingBesideTheLineToSomebody) {
  give_map();
  laser_range = 3.5F;
  run(200);
  for (int i = 0; i < 5; ++i) {
    tell_of(0.6, 1.0);
    host.publish(topics::kKinectScanLow, scan("laser", 2.2F));
    run(20);
  }
  EXPECT_EQ(local_cost(2.22, 0.0), kLethalCost) << "he is not in the line of sight";
}

TEST_F(Component, KeepsWhatIsTooNearForTheKinectToSee) {
  laser_range = 3.5F;
  give_map();
  run(200);
  const auto see = [&](float range) {
    auto message = scan("laser", range);
    message.intensities().assign(message.ranges().size(), 0.9F);
    host.publish(topics::kKinectScan, message);
    run(40);
  };
  for (; base.x < 0.65; base.x += 0.02) {  // a belt at 1.4 m, over the laser
    const auto gap = static_cast<float>(1.4 - base.x);
    see(gap > 0.85F ? gap : kNothing);
  }
  for (int i = 0; i < 2500; ++i) see(kNothing);
  EXPECT_EQ(local_cost(1.4, 0.0), kLethalCost) << "0.75 m ahead, 100 s later";
  usher_msgs::msg::CostmapRequest recovery;
  recovery.id(1);
  host.publish(topics::kCostmapRequest, recovery);
  see(kNothing);
  EXPECT_EQ(local_cost(1.4, 0.0), kLethalCost) << "a recovery would not see it again";
  base.x = 0.3;
  for (int i = 0; i < 5; ++i) see(kNothing);
  EXPECT_LT(local_cost(1.4, 0.0), kLethalCost) << "gone, as is seen from afar";
}

TEST_F(Component, RemembersNothingNearThatTheKinectIsNotSureOf) {
  laser_range = 3.5F;
  give_map();
  run(200);
  for (const float sure : {0.5F, 0.9F}) {
    for (const float range : {1.1F, kNothing}) {
      base.x = range == kNothing ? 0.4 : 0.0;
      for (int i = 0; i < 5; ++i) {
        auto message = scan("laser", range);
        message.intensities().assign(message.ranges().size(), sure);
        host.publish(topics::kKinectScan, message);
        run(40);
      }
      EXPECT_EQ(local_cost(1.12, 0.0) == kLethalCost, range == 1.1F || sure == 0.9F);
    }
  }
}

TEST_F(Component, RemembersNobodyWhoIsTooNearForTheKinect) {
  laser_range = 3.5F;
  give_map();
  run(200);
  const auto see = [&](float range, bool told = true) {
    for (int i = 0; i < 5; ++i) {
      if (told) tell_of(1.25, 0.0);
      host.publish(topics::kKinectScan, scan("laser", range));
      run(40);
    }
  };
  see(1.1F);
  EXPECT_EQ(local_cost(1.12, 0.0), kLethalCost);
  base.x = 0.4;
  run(2500);
  see(kNothing, false);
  EXPECT_LT(local_cost(1.12, 0.0), kLethalCost) << "he has left, and nobody saw him go";
}

TEST_F(Component, RemembersNothingThatCameToItByItself) {
  laser_range = 3.5F;
  give_map();
  run(200);
  base.x = -0.6;
  surely_see(kNothing);
  base.x = 0.0;
  for (const float range : {0.7F, 0.95F}) {  // nobody told of him: he is too near for that, too
    surely_see(range);
    EXPECT_EQ(local_cost(static_cast<double>(range) + 0.02, 0.0), kLethalCost);
    base.x += 0.2;
    surely_see(kNothing);
    base.x -= 0.2;
    EXPECT_LT(local_cost(static_cast<double>(range) + 0.02, 0.0), kLethalCost) << range;
  }
}

TEST_F(Component, KeepsWhatIsNearThoughItTurnedToItOrMeasuresItACellNearer) {
  laser_range = 3.5F;
  give_map();
  run(200);
  surely_see(0.7F);  // nobody has seen the place before
  surely_see(kNothing);
  EXPECT_EQ(local_cost(0.72, 0.0), kLethalCost);
  base.x += 2.0;
  surely_see(kNothing);
  surely_see(1.2F);
  base.x += 0.3;
  for (const float nearer : {0.84F, 0.96F}) {
    surely_see(nearer);
    surely_see(kNothing);
    EXPECT_EQ(local_cost(base.x + 0.92, 0.0), kLethalCost) << nearer;
  }
}

TEST_F(Component, ForgetsADoorLeafThatOpensBeforeIt) {
  give_map();
  for (int i = 0; i < 5; ++i) {
    look(1.12F, 40);
    host.publish(topics::kKinectScan, scan("laser", 1.1F));
  }
  look(1.12F, 100);
  EXPECT_EQ(local_cost(1.12, 0.0), kLethalCost);
  base.x = 0.4;
  for (int i = 0; i < 5; ++i) {
    look(3.5F, 40);
    host.publish(topics::kKinectScan, scan("laser", kNothing));
  }
  look(3.5F, 100);
  EXPECT_LT(local_cost(1.12, 0.0), kLethalCost) << "the laser saw it, too, and sees nothing now";
}

TEST_F(Component, RemembersNothingNearWhileNobodyTellsOfPeople) {
  laser_range = 3.5F;
  give_map();
  run(200);
  tell_of(0.0, 3.0);
  run(1000);
  for (int i = 0; i < 5; ++i) host.publish(topics::kKinectScan, scan("laser", 1.1F)), run(40);
  EXPECT_EQ(local_cost(1.12, 0.0), kLethalCost);
  base.x = 0.4;
  for (int i = 0; i < 5; ++i) host.publish(topics::kKinectScan, scan("laser", kNothing)), run(40);
  EXPECT_LT(local_cost(1.12, 0.0), kLethalCost) << "it may have been somebody";
}

TEST_F(Component, KnowsTheBeltBehindWhichSomebodyComesToStand) {
  for (const int before : {1000, 3000}) {  // [ms] that it was seen too near to be seen again
    SCOPED_TRACE(before);
    base.x += 6.0;
    laser_range = 3.5F;
    give_map();
    run(200);
    for (int i = 0; i < 5; ++i) {
      tell_of(base.x - 2.0, 0.0);  // somebody else
      host.publish(topics::kKinectScan, scan("laser", 1.1F));
      run(40);
    }
    base.x += 0.4;
    run(before);
    for (int i = 0; i < 5; ++i) {
      tell_of(base.x + 0.95, 0.0);
      host.publish(topics::kKinectScan, scan("laser", 0.85F));
      run(40);
    }
    run(2500);
    for (int i = 0; i < 5; ++i) host.publish(topics::kKinectScan, scan("laser", kNothing)), run(40);
    const bool belt = local_cost(base.x + 0.72, 0.0) == kLethalCost;
    EXPECT_EQ(belt, before == 3000) << "what was seen shortly before may have been himself";
  }
}

TEST_F(Component, PlansAroundWhatASlowCameraSeesBetweenTheScansOfAFastLaser) {
  give_map();
  run(200);
  for (int i = 0; i < 100; ++i) {
    if (i % 5 == 0)
      host.publish(topics::kRearScan, scan("laser", 1.0F));
    else
      host.publish(topics::kScanFiltered, scan());
    run(20, false);
  }
  EXPECT_EQ(global_cost(1.02, 0.02), 252) << "the highest that a planner crosses";
}

class LooksBack : public Component {
 protected:
  LooksBack() {
    tf2_msgs::msg::TFMessage fixed;
    fixed.transforms().push_back(wire::transform(host.now(), frames::kBaseFootprint, "rear",
                                                 geometry::to_space({0.0, 0.0, geometry::kPi})));
    host.publish(topics::kTfStatic, fixed);
    give_map();
    run(200);
  }
  void see(float range, int times = 1) {
    for (int i = 0; i < times; ++i) host.publish(topics::kRearScan, scan("rear", range)), run(60);
  }
  /// Somebody is told of there, and the camera sees that far.
  void follow(double x, float range, int times) {
    for (int i = 0; i < times; ++i) {
      tell_of(x, 0.0);
      see(range);
    }
  }
};

TEST_F(LooksBack, AndKeepsTheLowBoxThatItBacksUpTo) {
  for (; base.x > -0.8; base.x -= 0.02) {  // the box is at -1.5 and leaves the image at 1.1 m
    const auto gap = static_cast<float>(base.x + 1.5);
    see(gap > 1.1F ? gap : kNothing);
  }
  EXPECT_EQ(local_cost(-1.5, 0.0), kLethalCost);
  base.x = 0.0;
  see(kNothing, 10);
  EXPECT_LT(local_cost(-1.5, 0.0), kLethalCost) << "gone, as is seen from afar";
}

TEST_F(LooksBack, AndForgetsWhereSomebodyStoodWhoWalksOn) {
  follow(-0.95, 0.82F, 10);
  EXPECT_EQ(local_cost(-0.82, 0.0), kLethalCost);
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  follow(-0.95, unknown, 10);
  EXPECT_EQ(local_cost(-0.82, 0.0), kLethalCost) << "too near to be measured, perhaps";
  follow(-1.2, 1.02F, 10);
  EXPECT_LT(local_cost(-0.82, 0.0), kLethalCost) << "he stepped back: it may turn there";
  EXPECT_EQ(local_cost(-1.02, 0.0), kLethalCost);
}

TEST_F(LooksBack, AndKeepsTheBoxFarFromWhoeverFollows) {
  see(0.82F, 10);
  follow(-1.6, kNothing, 10);
  EXPECT_EQ(local_cost(-0.82, 0.0), kLethalCost) << "0.8 m before him";
  follow(-1.1, kNothing, 10);
  EXPECT_LT(local_cost(-0.82, 0.0), kLethalCost) << "the price: a box at his feet";
}

}  // namespace
}  // namespace usher::costmap
