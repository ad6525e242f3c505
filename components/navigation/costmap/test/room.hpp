#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "navigation/costmap/core/costs.hpp"
#include "navigation/costmap/shell/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::costmap {

using std::chrono::milliseconds;

inline constexpr int kPassing = 252;  ///< of what bars the way on the map's free ground
inline constexpr const char* kFootprint =
    "robot.footprint: [0.3, 0.3, -0.3, 0.3, -0.3, -0.3, 0.3, -0.3]";

/// A robot in the middle of a room of 8 m with a wall 2 m ahead that only the laser knows; each of
/// its senses can be left out.
class Component : public testing::Test {
 protected:
  Component() {
    tf2_msgs::msg::TFMessage fixed;
    fixed.transforms().push_back(
        wire::transform(host.now(), frames::kBaseFootprint, "laser", geometry::Pose3{}));
    fixed.transforms().push_back(
        wire::transform(host.now(), frames::kBaseFootprint, "ultrasonic", geometry::Pose3{}));
    host.publish(topics::kTfStatic, fixed);
  }
  void give_map() {
    map_stamp = host.now();
    host.publish(topics::kMap, wire::to_message(map_stamp, frames::kMap, map));
    host.run_for(milliseconds(5));
  }
  sensor_msgs::msg::LaserScan scan(const char* frame = "laser", float range = 2.0F) const {
    sensor_msgs::msg::LaserScan message;
    message.header(wire::header(host.now(), frame));
    message.angle_min(-0.2F);
    message.angle_increment(0.005F);
    message.angle_max(0.2F);
    message.range_min(0.1F);
    message.range_max(20.0F);
    message.ranges().assign(81, range);
    return message;
  }
  /// The laser sees something ahead, 3.5 m away beside it.
  void look(float middle, int ms) {
    for (int at = 0; at < ms; at += 20) {
      auto message = scan("laser", 3.5F);
      std::fill_n(message.ranges().begin() + 20, 40, middle);
      host.publish(topics::kScanFiltered, message);
      run(20, false);
    }
  }
  void run(int ms, bool scans = true, bool localized = true) {
    for (int at = 0; at < ms; at += 20) {
      tf2_msgs::msg::TFMessage moving;
      moving.transforms().push_back(wire::transform(
          host.now(), frames::kOdom, frames::kBaseFootprint, geometry::to_space(base)));
      if (localized)
        moving.transforms().push_back(
            wire::transform(host.now(), frames::kMap, frames::kOdom, geometry::to_space(odom)));
      host.publish(topics::kTf, moving);
      if (scans) {
        host.publish(topics::kScanFiltered, scan("laser", laser_range));
        last_scan = host.now();
      }
      host.run_for(milliseconds(20));
    }
  }
  /// The Kinect is sure of it in five scans.
  void surely_see(float range) {
    for (int i = 0; i < 5; ++i) {
      auto message = scan("laser", range);
      message.intensities().assign(message.ranges().size(), 0.9F);
      host.publish(topics::kKinectScan, message);
      run(40);
    }
  }
  /// The front whiskers say so, then time passes.
  void feel(bool left, bool right = false, int ms = 1500) {
    usher_msgs::msg::Whiskers whiskers;
    whiskers.header(wire::header(last_scan, frames::kBaseLink));
    whiskers.front_left(left);
    whiskers.front_right(right);
    host.publish(topics::kWhiskers, whiskers);
    run(ms);
  }
  /// Somebody is there, or was as many seconds ago.
  void tell_of(double x, double y, float unseen = 0.0F) {
    usher_msgs::msg::People people;
    people.header(wire::header(host.now(), frames::kOdom));
    auto& somebody = people.people().emplace_back();
    somebody.x(x);
    somebody.y(y);
    somebody.unseen(unseen);
    host.publish(topics::kPeople, people);
  }
  std::string reason() const { return host.heartbeat().reason(); }
  /// The highest cost within a cell's width: points lie on the borders of cells.
  int local_cost(double x, double y) const {
    const auto costs = wire::from_message(host.last(topics::kLocalCosts).value());
    int highest = 0;
    for (const double dx : {-0.04, 0.0, 0.04}) {
      for (const double dy : {-0.04, 0.0, 0.04})
        highest = std::max(highest, int{costs->at(costs->geometry().cell_at(x + dx, y + dy))});
    }
    return highest;
  }

  int global_cost(double x, double y) const {
    const auto costs = wire::from_message(host.last(topics::kGlobalCosts).value());
    return costs->at(costs->geometry().cell_at(x, y));
  }

  grid::OccupancyGrid map{{160, 160, 0.05, -4.0, -4.0}, grid::kFree};
  runtime::TestHost host{runtime::component_factory<CostmapComponent>("costmap"), kFootprint};
  runtime::Time map_stamp{}, last_scan{};
  geometry::Pose2 base;  // in odom
  geometry::Pose2 odom;  // in map
  float laser_range = 2.0F;
  static constexpr float kNothing = std::numeric_limits<float>::infinity();
};

}  // namespace usher::costmap
