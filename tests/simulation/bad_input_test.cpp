// Scans and odometry that are not what they should be from their own writers, and foreign maps,
// while the whole simulated robot drives: counted in a heartbeat, nobody crashes, and a robot that
// gets nothing else stops.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "simulation/driving_robot.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

class BadInput : public DrivingRobot {
 protected:
  /// From now on the topic's right writer writes these in turn, and now and then no message at all.
  template <class Message>
  void spoil(const topics::Topic<Message>& topic, std::vector<Message> bad) {
    runtime::LockstepWorld& world = run_->world();
    world.tamper(topic, [&world, bad = std::move(bad), next = std::size_t{0}](
                            const runtime::Guid&, Message& message) mutable {
      message = bad[next++ % bad.size()];
      message.header().stamp(wire::to_message(world.now()));
      return true;
    });
    world.tamper_bytes(std::string(topic.name),
                       [next = 0](const runtime::Guid&, runtime::Bytes& cdr) mutable {
                         if (++next % 4 == 0) cdr = {0, 1, 0, 0, 7, 7};
                         return true;
                       });
  }
};

sensor_msgs::msg::LaserScan scan(std::size_t beams, float range, float increment) {
  sensor_msgs::msg::LaserScan message;
  message.header().frame_id("laser");
  message.angle_min(-2.3562F);
  message.angle_max(2.3562F);
  message.angle_increment(increment);
  message.range_min(0.05F);
  message.range_max(20.0F);
  message.ranges(std::vector<float>(beams, range));
  return message;
}

nav_msgs::msg::Odometry odometry(double x, double v) {
  nav_msgs::msg::Odometry message;
  message.header().frame_id("odom");
  message.child_frame_id("base_footprint");
  message.pose().pose().position().x(x);
  message.pose().pose().orientation().w(1.0);
  message.twist().twist().linear().x(v);
  return message;
}

nav_msgs::msg::OccupancyGrid map(std::uint32_t width, std::uint32_t height, float resolution,
                                 std::size_t cells) {
  nav_msgs::msg::OccupancyGrid message;
  message.header().frame_id("map");
  message.info().width(width);
  message.info().height(height);
  message.info().resolution(resolution);
  message.info().origin().orientation().w(1.0);
  message.data(std::vector<std::int8_t>(cells, 0));
  return message;
}

TEST_F(BadInput, ScansAreCountedAndTheRobotStandsWhenThereAreNoOthers) {
  spoil(topics::kScan, {scan(0, 1.0F, 0.0087F), scan(541, 1.0F, 0.0F), scan(541, 1.0F, kNan),
                        scan(1'000'000, 1.0F, 0.0087F), scan(3, 1.0F, -1e30F)});
  run_->world().run_for(seconds(4));
  EXPECT_LT(std::abs(speed()), 0.1);
  EXPECT_GE(count("scan_filter", "scans: rejected"), 100U) << run_->complaints();
  EXPECT_GE(count("scan_filter", "scan: rejected"), 40U) << run_->complaints();
  EXPECT_EQ(faults_, 0);
}

TEST_F(BadInput, ABlindLaserStopsTheRobot) {
  spoil(topics::kScan, {scan(541, kNan, 0.00873F), scan(541, 0.0F, 0.00873F),
                        scan(541, std::numeric_limits<float>::infinity(), 0.00873F)});
  run_->world().run_for(seconds(4));
  EXPECT_LT(std::abs(speed()), 0.1);
  EXPECT_GE(count("scan_filter", "scans: rejected"), 100U) << run_->complaints();
  EXPECT_EQ(faults_, 0);
}

TEST_F(BadInput, OdometryIsCountedByAllWhoReadIt) {
  spoil(topics::kOdom,
        {odometry(std::nan(""), 0.5), odometry(0.0, std::nan("")), odometry(0.0, -1e300)});
  run_->world().run_for(seconds(3));
  for (const char* reader : {"local_planner", "navigator"}) {
    EXPECT_GE(count(reader, "odom: rejected"), 60U) << reader << "\n" << run_->complaints();
    EXPECT_GE(count(reader, "inputs: rejected"), 10U) << reader << "\n" << run_->complaints();
  }
  EXPECT_LT(std::abs(speed()), 0.1) << "nothing tells it how fast it is";
  EXPECT_LT(run_->record().summary().localization_max, 0.2) << "tf is as good as before";
  EXPECT_EQ(run_->record().summary().contacts, 0U);
  EXPECT_EQ(faults_, 0);
}

TEST_F(BadInput, MapsAreCountedAndTheGoodOneStays) {
  const nav_msgs::msg::OccupancyGrid bad[] = {
      map(0, 0, 0.05F, 0), map(100, 100, kNan, 10'000), map(65'535, 65'535, 0.05F, 3),
      map(100, 100, 0.05F, 9'999), map(100, 100, -1.0F, 10'000)};
  std::size_t next = 0;
  flood(seconds(3), [&] {
    run_->world().publish(topics::kMap, bad[next++ % std::size(bad)]);
    run_->world().publish_bytes(topics::kMap, {0, 1, 0, 0}, "other");
  });
  for (const char* reader : {"amcl", "costmap"})
    EXPECT_GE(count(reader, "map: rejected"), 100U) << reader << "\n" << run_->complaints();
  EXPECT_EQ(faults_, 0);
  EXPECT_LT(run_->record().summary().localization_max, 0.2);
  EXPECT_EQ(run_->record().summary().contacts, 0U);
}

}  // namespace
}  // namespace usher::operations
