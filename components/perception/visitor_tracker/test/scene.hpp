#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "perception/visitor_tracker/core/visitor_tracker.hpp"

namespace usher::visitor_tracker {

using geometry::Point2;
using geometry::Pose2;

inline constexpr double kStep = 1.0 / 15.0;  // [s]
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A robot and the people that its tracker knows, at 15 Hz; each person walks at a velocity.
class Scene : public testing::Test {
 protected:
  Person& add(std::uint64_t id, const Point2& at, const Point2& velocity = {0, 0}) {
    return people.emplace_back(Person{
        .id = id, .position = at, .velocity = velocity, .height = height, .appearances = worn});
  }
  Person& person(std::uint64_t id) {
    for (Person& each : people) {
      if (each.id == id) return each;
    }
    ADD_FAILURE() << "nobody is " << id;
    return people.front();
  }
  void hide(std::uint64_t id) {
    std::erase_if(people, [&](const Person& each) { return each.id == id; });
  }
  const Estimate& once() {
    return estimate = tracker.update({time, robot, service, people, ahead, behind});
  }
  const Estimate& run(double seconds) {
    for (double end = time + seconds - 1e-9; time < end;) {
      time += kStep;
      robot.x += kStep * drives * std::cos(robot.yaw);
      robot.y += kStep * drives * std::sin(robot.yaw);
      for (Person& each : people) each.position += kStep * each.velocity;
      once();
    }
    return estimate;
  }
  /// The visitor 1 stood before the robot, which has turned away and leads; 1.2 m between them.
  void guide() {
    add(1, {1.2, 0.0});
    run(1.0);
    ASSERT_EQ(estimate.person, 1U);
    service = Service::kTalks;
    run(1.0);
    service = Service::kGuides;
    robot.yaw = geometry::kPi;
    run(0.5);
    drives = 1.0;
    person(1).velocity = {-1.0, 0.0};
    run(4.0);
    ASSERT_TRUE(sees(1));
  }
  /// The visitor 1 stood before the robot, which follows him; 1.5 m between them.
  void follow() {
    add(1, {1.5, 0.0});
    run(1.0);
    ASSERT_EQ(estimate.person, 1U);
    service = Service::kTalks;
    run(1.0);
    service = Service::kFollows;
    drives = 1.0;
    person(1).velocity = {1.0, 0.0};
    run(4.0);
    ASSERT_TRUE(sees(1));
  }
  /// The visitor 1 has stayed 4 m behind and is not seen any more; the robot waits.
  void lose_far_behind() {
    guide();
    person(1).velocity = {0, 0};
    run(3.0);
    drives = 0.0;
    hide(1);
  }
  void put(std::uint64_t id, double range, double bearing) {
    person(id).position = robot.position() + range * Point2(std::cos(robot.yaw + bearing),
                                                            std::sin(robot.yaw + bearing));
  }
  bool sees(std::uint64_t id) const {
    return estimate.presence == Presence::kSeen && estimate.person == id;
  }

  VisitorTracker tracker{{}};
  std::vector<Person> people;
  Pose2 robot;
  Service service = Service::kNobody;
  bool ahead = true, behind = true;
  double time = 100.0, drives = 0.0;
  double height = kNan;       ///< of whoever is added
  imaging::Appearances worn;  ///< likewise
  Estimate estimate;
};

/// As a camera shows a shirt of that color over jeans.
inline imaging::Appearance in(const imaging::LabColor& shirt) {
  return {{shirt, 5}, {{28.0, 2.0, -21.0}, 5}};
}
inline constexpr imaging::LabColor kRed{37.0, 52.0, 30.0}, kNavy{18.0, 4.0, -20.0};

}  // namespace usher::visitor_tracker
