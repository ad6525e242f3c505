#include "perception/people_detector/shell/component.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "perception/people_detector/device_sim/component.hpp"
#include "room_scan.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/appearance.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::people_detector {
namespace {

using geometry::Point2;
using geometry::Pose2;
using std::chrono::milliseconds;

class Component : public testing::Test {
 protected:
  void localize() { localized = true; }
  /// One second of a robot that stands, 50 scans; `walker` by time in the map.
  template <class Walker>
  void run(double seconds, const Walker& walker) {
    for (int i = 0; i < static_cast<int>(50 * seconds); ++i, time += 0.02) {
      if (localized) send_transform(frames::kMap, frames::kOdom, map_T_odom);
      send_transform(frames::kOdom, frames::kBaseFootprint, odom_T_base);
      send_transform(frames::kBaseFootprint, "laser_level", {0.1, 0.0, 0.0});
      const Pose2 sensor = map_T_odom * odom_T_base * Pose2{0.1, 0.0, 0.0};
      const RoomScan room = scan_room(sensor, {{walker(time), 0.25}});
      sensor_msgs::msg::LaserScan scan;
      scan.header(wire::header(host.now(), "laser_level"));
      scan.angle_min(static_cast<float>(room.angle_min));
      scan.angle_increment(static_cast<float>(room.increment));
      scan.angle_max(static_cast<float>(room.angle_min + room.increment * 540));
      scan.range_min(0.01F);
      scan.range_max(20.0F);
      scan.ranges(room.ranges);
      for (std::size_t beam = 210; blind_ahead && beam < 331; ++beam)
        scan.ranges()[beam] = std::numeric_limits<float>::quiet_NaN();
      host.publish(topics::kScanFiltered, scan);
      host.run_for(milliseconds(20));
    }
  }
  void send_transform(const char* parent, const char* child, const Pose2& pose) {
    tf2_msgs::msg::TFMessage message;
    geometry_msgs::msg::TransformStamped transform;
    transform.header(wire::header(host.now(), parent));
    transform.child_frame_id(child);
    transform.transform().translation().x(pose.x);
    transform.transform().translation().y(pose.y);
    transform.transform().rotation().z(std::sin(0.5 * pose.yaw));
    transform.transform().rotation().w(std::cos(0.5 * pose.yaw));
    message.transforms({transform});
    host.publish(topics::kTf, message);
  }

  runtime::TestHost host{runtime::component_factory<PeopleDetectorComponent>("people_detector"),
                         "robot.footprint: [0.3, 0.33, -0.3, 0.33, -0.3, -0.33, 0.3, -0.33]"};
  const Pose2 map_T_odom{0.5, 0.5, 0.3};
  const Pose2 odom_T_base{0.4, 0.6, 0.1};
  bool localized = false, blind_ahead = false;
  double time = 0.0;
};

Point2 crossing(double time) { return {3.0, 0.6 + 0.8 * time}; }
Point2 standing(double) { return {3.0, 2.0}; }

TEST_F(Component, TellsWhoWalksWhereAndHowFastInOdom) {
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, room_map()));
  localize();
  run(3.0, crossing);
  const auto people = host.last(topics::kPeople);
  ASSERT_TRUE(people && people->people().size() == 1U);
  EXPECT_EQ(people->header().frame_id(), frames::kOdom);
  const auto& person = people->people()[0];
  const Point2 seen = map_T_odom * Point2(person.x(), person.y());
  EXPECT_LT((seen - crossing(time)).norm(), 0.25);
  const Point2 velocity(person.vx(), person.vy());
  EXPECT_NEAR(velocity.norm(), 0.8, 0.2);
  EXPECT_NEAR(std::atan2(velocity.y(), velocity.x()) + map_T_odom.yaw, geometry::kPi / 2, 0.3);
  EXPECT_EQ(person.id(), 1U);
  EXPECT_TRUE(person.by_laser() && !person.by_kinect() && !person.by_rear());
  EXPECT_TRUE(std::isnan(person.height()));
  EXPECT_LT(host.written(topics::kPeople).size(), 55U) << "15 a second are enough";
}

TEST_F(Component, AChairIsNobody) {
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, room_map()));
  localize();
  run(3.0, standing);
  ASSERT_TRUE(host.last(topics::kPeople));
  EXPECT_TRUE(host.last(topics::kPeople)->people().empty());
}

TEST_F(Component, WithoutMapOrPoseItKnowsNobodyAndSaysWhy) {
  run(1.0, crossing);
  ASSERT_TRUE(host.last(topics::kPeople));
  EXPECT_TRUE(host.last(topics::kPeople)->people().empty());
  EXPECT_EQ(host.heartbeat().reason(), "no map");
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, room_map()));
  run(1.0, crossing);
  EXPECT_TRUE(host.last(topics::kPeople)->people().empty());
  EXPECT_EQ(host.heartbeat().reason(), "robot not localized");
}

TEST_F(Component, DoesNotSayThatNobodyIsInTheWayWhereItDoesNotLook) {
  run(1.0, crossing);
  ASSERT_TRUE(host.last(topics::kPersonAhead));
  EXPECT_FALSE(host.last(topics::kPersonAhead)->clear()) << "no map, no camera";
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, room_map()));
  localize();
  run(0.5, standing);
  EXPECT_TRUE(host.last(topics::kPersonAhead)->clear());
  blind_ahead = true;
  run(0.5, standing);
  EXPECT_FALSE(host.last(topics::kPersonAhead)->clear()) << "the laser leans: the floor ahead";
}

TEST_F(Component, SaysWhyAMapIsRefusedUntilThereIsABetterOne) {
  localize();
  auto message = wire::to_message(host.now(), frames::kMap, room_map());
  message.info().resolution(0.0F);
  host.publish(topics::kMap, message);
  run(1.0, crossing);
  EXPECT_TRUE(host.heartbeat().reason().starts_with("map refused: ")) << host.heartbeat().reason();
  EXPECT_EQ(host.counter("maps: rejected"), 1U);
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, room_map()));
  run(1.0, crossing);
  EXPECT_EQ(host.heartbeat().reason(), "");
}

TEST_F(Component, TakesNoWallForLegsByAnOldPose) {
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, room_map()));
  localize();
  run(2.0, crossing);
  EXPECT_EQ(host.last(topics::kPeople)->people().size(), 1U);
  localized = false;
  run(0.8, crossing);
  EXPECT_EQ(host.heartbeat().reason(), "");
  EXPECT_TRUE(host.last(topics::kPeople)->people().at(0).by_laser());
  run(1.5, crossing);
  EXPECT_EQ(host.heartbeat().reason(), "robot not localized");
  for (const auto& person : host.last(topics::kPeople)->people()) EXPECT_FALSE(person.by_laser());
}

TEST_F(Component, FallsSilentWithTheScanAndRefusesABadOne) {
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, room_map()));
  localize();
  run(0.5, crossing);
  host.run_for(milliseconds(60));
  host.clear();
  sensor_msgs::msg::LaserScan scan;
  scan.header(wire::header(host.now(), "laser_level"));
  scan.angle_increment(std::nanf(""));
  host.publish(topics::kScanFiltered, scan);
  host.run_for(milliseconds(1000));
  EXPECT_EQ(host.counter("scans: rejected"), 1U);
  EXPECT_TRUE(host.written(topics::kPeople).empty());
  EXPECT_EQ(host.heartbeat().reason(), "no scan");
}

/// With a face a person who stands is one, whom the laser alone takes for a chair.
TEST_F(Component, AFaceMakesSomebodyOfAChair) {
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, room_map()));
  localize();
  const Point2 person = inverse(map_T_odom * odom_T_base) * standing(0.0);
  usher_msgs::msg::Faces message;
  usher_msgs::msg::Face face;
  face.range(static_cast<float>(person.norm() - 0.1));
  face.bearing(static_cast<float>(std::atan2(person.y(), person.x())));
  face.elevation(1.6F);
  for (int i = 0; i < 10; ++i) {
    run(0.1, standing);
    message.header(wire::header(host.now(), frames::kBaseFootprint));
    message.faces({face});
    host.publish(topics::kFaces, message);
  }
  run(0.1, standing);
  const auto people = host.last(topics::kPeople);
  ASSERT_TRUE(people && people->people().size() == 1U);
  const auto& seen = people->people()[0];
  EXPECT_LT((map_T_odom * Point2(seen.x(), seen.y()) - standing(0.0)).norm(), 0.15);
  EXPECT_TRUE(seen.by_face() && seen.by_laser() && !seen.by_kinect());
  EXPECT_NEAR(seen.height(), 1.6 / 0.93, 0.02);
  face.range(std::nanf(""));
  message.header(wire::header(host.now(), frames::kBaseFootprint));
  message.faces({face});
  host.publish(topics::kFaces, message);
  run(0.1, standing);
  EXPECT_EQ(host.counter("faces: rejected"), 1U);
}

TEST_F(Component, TellsMovementControlWhoIsInTheRobotsWay) {
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, room_map()));
  localize();
  run(0.5, [](double) { return Point2(5.5, 3.5); });
  const auto nobody = host.last(topics::kPersonAhead);
  ASSERT_TRUE(nobody);
  EXPECT_TRUE(nobody->clear()) << "who only stands is no person to the laser";
  run(3.0, [](double t) { return Point2(4.4 - 0.7 * t, 1.8 - 0.1 * t); });
  const auto person = host.last(topics::kPersonAhead);
  EXPECT_FALSE(person->clear());
  EXPECT_EQ(person->header().frame_id(), frames::kBaseFootprint);
  const auto known = host.last(topics::kPeople)->people().at(0);
  const Point2 place = inverse(odom_T_base) * Point2(known.x(), known.y());
  EXPECT_NEAR(person->distance(), place.norm(), 0.05);
  EXPECT_NEAR(person->bearing(), std::atan2(place.y(), place.x()), 0.1);
  EXPECT_NEAR(person->closing_speed(), 0.7, 0.2);
}

std::vector<geometry_msgs::msg::TransformStamped> told_frames(runtime::TestHost& host) {
  std::vector<geometry_msgs::msg::TransformStamped> frames;
  for (const auto& message : host.written(topics::kTf))
    for (const auto& transform : message.transforms()) frames.push_back(transform);
  return frames;
}

TEST_F(Component, TellsWhoIsSeenAsATransformUntilTheyAreNot) {
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, room_map()));
  localize();
  run(3.0, crossing);
  const auto frames = told_frames(host);
  ASSERT_GT(frames.size(), 5U);
  EXPECT_LT(frames.size(), 16U) << "5 a second";
  const auto person = host.last(topics::kPeople)->people().at(0);
  const auto& frame = frames.back();
  EXPECT_EQ(frame.header().frame_id(), frames::kOdom);
  EXPECT_EQ(frame.child_frame_id(), "person_" + std::to_string(person.id()));
  EXPECT_NEAR(frame.transform().translation().x(), person.x(), 0.2);
  EXPECT_NEAR(frame.transform().translation().y(), person.y(), 0.2);
  bool of_that_time = false;
  for (const auto& message : host.written(topics::kPeople))
    of_that_time = of_that_time || message.header().stamp() == frame.header().stamp();
  EXPECT_TRUE(of_that_time);
  run(1.5, [](double) { return Point2(40.0, 40.0); });
  host.clear();
  run(1.0, [](double) { return Point2(40.0, 40.0); });
  EXPECT_EQ(host.last(topics::kPeople)->people().size(), 1U) << "remembered";
  EXPECT_TRUE(told_frames(host).empty());
}

/// The stand-in without pixels: whom the world's model finds.
class SimComponent : public testing::Test {
 protected:
  void localize() {
    tf2_msgs::msg::TFMessage message;
    message.transforms({wire::transform(host.now(), frames::kMap, frames::kOdom, {})});
    host.publish(topics::kTf, message);
  }
  void run(int ms, bool people, const char* frame = "kinect_level",
           milliseconds late = milliseconds(0)) {
    for (int at = 0; at < ms; at += 33) {
      tf2_msgs::msg::TFMessage places;
      places.transforms().push_back(wire::transform(
          host.now(), frames::kOdom, frames::kBaseFootprint, geometry::to_space({1.0, 2.0, 0.5})));
      places.transforms().push_back(wire::transform(
          host.now(), frames::kBaseFootprint, "kinect_level", geometry::to_space({0.2, 0.0, 0.0})));
      host.publish(topics::kTf, places);
      usher_sim_msgs::msg::Sightings seen;
      seen.header(wire::header(host.now() - late, frame));
      seen.sightings().resize(2);
      seen.sightings()[0].forward(2.5);
      seen.sightings()[0].height(1.7);
      seen.sightings()[0].appearance(wire::to_message(clothes));
      seen.sightings()[1].forward(std::nan(""));
      if (people) host.publish(topics::kSimKinectPeople, seen);
      host.run_for(milliseconds(33));
    }
  }
  imaging::Appearance clothes;
  runtime::TestHost host{
      runtime::component_factory<PeopleDetectorSimComponent>("people_detector_sim"),
      "robot.footprint: [0.3, 0.33, -0.3, 0.33, -0.3, -0.33, 0.3, -0.33]"};
};

TEST_F(SimComponent, FollowsWhomTheModelFinds) {
  run(1000, true);
  const auto people = host.last(topics::kPeople);
  ASSERT_TRUE(people && people->people().size() == 1U);
  const auto& person = people->people()[0];
  EXPECT_TRUE(person.by_kinect() && !person.by_laser());
  EXPECT_NEAR(person.height(), 1.7, 1e-3);
  const Point2 place = Pose2{1.0, 2.0, 0.5} * Point2(2.7, 0.0);
  EXPECT_LT((place - Point2(person.x(), person.y())).norm(), 0.01);
  EXPECT_EQ(host.heartbeat().reason(), "no scan");
}

TEST_F(SimComponent, TellsHowThoseWhomTheModelFindsAreDressed) {
  run(1000, true);
  EXPECT_FALSE(
      wire::from_message(host.last(topics::kPeople)->people()[0].kinect_appearance()).known());
  clothes = {{{40.0, 50.0, 25.0}, 1}, {}};
  run(1000, true);
  const auto person = host.last(topics::kPeople)->people()[0];
  EXPECT_NEAR(person.kinect_appearance().upper().a(), 50.0, 1e-3);
  EXPECT_GE(person.kinect_appearance().upper().images(), 5);
  EXPECT_EQ(person.kinect_appearance().legs().images(), 0);
  EXPECT_EQ(person.rear_appearance().upper().images(), 0) << "it did not look";
}

/// A wall on the map where the person of run() is, in odom.
grid::OccupancyGrid wall_there() {
  grid::OccupancyGrid map({100, 100, 0.1, -5.0, -5.0}, grid::kFree);
  const Point2 place = Pose2{1.0, 2.0, 0.5} * Point2(2.7, 0.0);
  map.at(map.geometry().cell_at(place)) = grid::kOccupied;
  return map;
}

TEST_F(SimComponent, WhomItSeesInAWallIsAPartOfItWhileThePoseIsNew) {
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, wall_there()));
  localize();
  run(800, true);
  ASSERT_TRUE(host.last(topics::kPeople));
  EXPECT_TRUE(host.last(topics::kPeople)->people().empty());
  run(1500, true);
  EXPECT_EQ(host.last(topics::kPeople)->people().size(), 1U) << "nobody knows where the wall is";
}

TEST_F(SimComponent, WhoIsFollowedMayLeanOnAWall) {
  run(1000, true);
  ASSERT_EQ(host.last(topics::kPeople)->people().size(), 1U);
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, wall_there()));
  for (int i = 0; i < 10; ++i) {
    localize();
    run(800, true);
  }
  ASSERT_EQ(host.last(topics::kPeople)->people().size(), 1U);
  EXPECT_TRUE(host.last(topics::kPeople)->people()[0].by_kinect());
  EXPECT_EQ(host.last(topics::kPeople)->people()[0].id(), 1U);
}

TEST_F(SimComponent, ACameraWhoseImagesAreAllLeftOutDoesNotLook) {
  const auto see_with_a_scan = [this](milliseconds late) {
    for (int i = 0; i < 20; ++i) {
      run(33, true, "kinect_level", late);
      sensor_msgs::msg::LaserScan scan;  // without a map the laser looks for nobody
      scan.header(wire::header(host.now(), "kinect_level"));
      scan.angle_min(-0.1F);
      scan.angle_max(0.1F);
      scan.angle_increment(0.1F);
      scan.range_min(0.01F);
      scan.range_max(20.0F);
      scan.ranges({5.0F, 5.0F, 5.0F});
      host.publish(topics::kScanFiltered, scan);
      host.run_for(milliseconds(2));
    }
  };
  see_with_a_scan(milliseconds(0));
  EXPECT_TRUE(host.last(topics::kPeople)->kinect_looks());
  see_with_a_scan(milliseconds(400));
  EXPECT_GT(host.counter(std::string(topics::kSimKinectPeople.name) + ": late"), 5U);
  EXPECT_FALSE(host.last(topics::kPeople)->kinect_looks());
  EXPECT_FALSE(host.last(topics::kPersonAhead)->clear());
}

TEST_F(SimComponent, SightingsOfAnUnknownFrameAreDroppedAndCounted) {
  run(1000, true, "nowhere");
  EXPECT_FALSE(host.last(topics::kPeople));
  EXPECT_GT(host.counter("tf: dropped"), 5U);
}

}  // namespace
}  // namespace usher::people_detector
