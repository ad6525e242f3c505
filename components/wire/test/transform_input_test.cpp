#include "wire/transform_input.hpp"

#include <gmock/gmock.h>

#include "runtime/testing/test_host.hpp"
#include "wire/frames.hpp"

namespace usher::wire {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

/// What became known of the scans that a Waiter was given: their frames, in order.
std::vector<std::string> placed;
Eigen::Vector3d place_of_laser;  // in odom, of the last one

/// Wants to know where each scan was made.
class Waiter final : public runtime::Component {
 public:
  explicit Waiter(runtime::Host& host) : transforms_(host) {
    host.input(topics::kScan, {}, [this](const auto& scan, const auto&) {
      const std::string frame = scan.header().frame_id();
      const std::string name = frame + std::to_string(scan.header().stamp().nanosec() / 1'000'000);
      transforms_.when_known(frames::kOdom, frame, from_message(scan.header().stamp()),
                             [name](const geometry::Pose3& odom_T_sensor) {
                               placed.push_back(name);
                               place_of_laser = odom_T_sensor.translation;
                             });
    });
  }

 private:
  TransformInput transforms_;
};

class TransformInputTest : public testing::Test {
 protected:
  TransformInputTest() {
    placed.clear();
    host.run_for(milliseconds(10));
    tf2_msgs::msg::TFMessage fixed;
    for (const char* sensor : {"laser", "sonar"}) {
      fixed.transforms().push_back(
          transform(host.now(), frames::kBaseFootprint, sensor, geometry::Pose3{}));
    }
    host.publish(topics::kTfStatic, fixed);
    host.run_for(milliseconds(1));
  }
  runtime::Time at(int ms) const { return start + milliseconds(ms); }
  /// A scan of `frame`, made `ms` milliseconds after the start.
  void scan(const char* frame, int ms) {
    sensor_msgs::msg::LaserScan message;
    message.header(header(at(ms), frame));
    host.publish(topics::kScan, message);
    host.run_for(milliseconds(1));
  }
  /// The base's place `ms` milliseconds after the start.
  void odometry(int ms) {
    tf2_msgs::msg::TFMessage moving;
    moving.transforms().push_back(
        transform(at(ms), frames::kOdom, frames::kBaseFootprint, geometry::Pose3{}));
    host.publish(topics::kTf, moving);
    host.run_for(milliseconds(1));
  }
  std::uint64_t dropped() {
    host.run_for(milliseconds(200));  // for a heartbeat
    return host.counter("tf: dropped");
  }

  runtime::TestHost host{runtime::component_factory<Waiter>("waiter")};
  runtime::Time start =
      runtime::Time(std::chrono::seconds(host.now().time_since_epoch().count() / 1'000'000'000));
};

TEST_F(TransformInputTest, WorkRunsAtOnceWhereTheTransformIsKnown) {
  odometry(10);
  scan("laser", 10);
  EXPECT_THAT(placed, ElementsAre("laser10"));
}

TEST_F(TransformInputTest, PeopleDoNotFillTheBuffer) {
  for (int id = 0; id < 100; ++id) {
    tf2_msgs::msg::TFMessage moving;
    moving.transforms().push_back(
        transform(at(0), frames::kOdom, frames::kPerson + std::to_string(id), geometry::Pose3{}));
    host.publish(topics::kTf, moving);
    host.run_for(milliseconds(1));
  }
  odometry(110);
  scan("laser", 110);
  EXPECT_THAT(placed, ElementsAre("laser110"));
  host.run_for(milliseconds(200));
  EXPECT_EQ(host.counter("tf: refused"), 0U);
}

TEST_F(TransformInputTest, AnotherMountThanTheFirstIsRefusedAndCounted) {
  tf2_msgs::msg::TFMessage fixed;
  geometry::Pose3 elsewhere;
  elsewhere.translation.x() = 1.0;
  fixed.transforms().push_back(transform(host.now(), frames::kBaseFootprint, "laser", elsewhere));
  host.publish(topics::kTfStatic, fixed);
  odometry(10);
  scan("laser", 10);
  ASSERT_THAT(placed, ElementsAre("laser10"));
  EXPECT_EQ(place_of_laser.x(), 0.0);
  host.run_for(milliseconds(200));
  EXPECT_EQ(host.counter("tf: refused"), 1U);
}

TEST_F(TransformInputTest, WorkRunsInTheHandlerThatMakesTheTransformKnown) {
  odometry(10);
  scan("laser", 40);
  EXPECT_THAT(placed, IsEmpty());
  odometry(40);
  EXPECT_THAT(placed, ElementsAre("laser40"));
}

TEST_F(TransformInputTest, ASourceWhoseFrameIsUnknownDelaysNoOther) {
  odometry(10);
  scan("nowhere", 10);
  scan("laser", 10);
  EXPECT_THAT(placed, ElementsAre("laser10")) << "known, so not delayed";
  scan("laser", 40);
  odometry(40);
  EXPECT_THAT(placed, ElementsAre("laser10", "laser40")) << "nor behind it in the queue";
}

TEST_F(TransformInputTest, OneSourceKeepsItsOrder) {
  odometry(10);
  scan("laser", 60);
  scan("laser", 20);  // known, but it came later
  scan("sonar", 20);
  EXPECT_THAT(placed, ElementsAre("sonar20"));
  odometry(60);
  EXPECT_THAT(placed, ElementsAre("sonar20", "laser60", "laser20"));
}

TEST_F(TransformInputTest, WorkThatWaitedTooLongIsDroppedAndCounted) {
  odometry(10);
  scan("nowhere", 10);
  scan("laser", 300);
  host.run_for(milliseconds(150));
  odometry(160);  // does not reach
  odometry(300);
  EXPECT_THAT(placed, IsEmpty());
  EXPECT_EQ(dropped(), 2U);
}

TEST_F(TransformInputTest, ASourceThatFloodsPushesOutItsOwnWorkOnly) {
  odometry(10);
  scan("laser", 40);
  for (int i = 0; i < 40; ++i) scan("nowhere", i);
  odometry(40);
  EXPECT_THAT(placed, ElementsAre("laser40"));
  EXPECT_EQ(dropped(), 40U - 15U);
}

}  // namespace
}  // namespace usher::wire
