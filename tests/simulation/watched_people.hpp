#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "operations/experiments/lockstep_run.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::operations {

/// Whom a robot in lock-step tells of, against those who are there.
class WatchedPeople {
 public:
  /// Somebody whom the robot has just seen, and who that is; null: nobody is there.
  using Judge =
      std::function<void(const usher_msgs::msg::Person&, const usher_sim_msgs::msg::Person*)>;

  /// Lives as long as the run.
  WatchedPeople(LockstepRun& run, Judge judge) : judge_(std::move(judge)) {
    auto& world = run.world();
    world.observe(topics::kSimGroundTruth,
                  [this](const auto& truth, const auto&) { truth_ = truth; });
    world.observe(topics::kAmclPose, [this](const auto& pose, const auto&) {
      if (const auto planar = wire::to_planar(pose.pose().pose())) map_T_base_ = *planar;
    });
    world.observe(topics::kOdom, [this](const auto& odom, const auto&) {
      if (const auto planar = wire::to_planar(odom.pose().pose())) odom_T_base_ = *planar;
    });
    world.observe(topics::kPeople, [this](const auto& people, const auto&) {
      for (const auto& person : people.people())
        if (truth_ && person.unseen() < kJustSeen) judge_(person, who_is(person));
    });
  }
  WatchedPeople(const WatchedPeople&) = delete;
  WatchedPeople& operator=(const WatchedPeople&) = delete;

 private:
  static constexpr double kSame = 0.6;      // [m]
  static constexpr float kJustSeen = 0.2F;  // [s]

  const usher_sim_msgs::msg::Person* who_is(const usher_msgs::msg::Person& person) const {
    const geometry::Pose2 map_T_odom = map_T_base_ * inverse(odom_T_base_);
    const geometry::Point2 place = map_T_odom * geometry::Point2(person.x(), person.y());
    const usher_sim_msgs::msg::Person* who = nullptr;
    double least = kSame;
    for (const auto& other : truth_->people()) {
      const double away = (geometry::Point2(other.x(), other.y()) - place).norm();
      if (away < least) least = away, who = &other;
    }
    return who;
  }

  Judge judge_;
  std::optional<usher_sim_msgs::msg::GroundTruth> truth_;
  geometry::Pose2 map_T_base_, odom_T_base_;
};

}  // namespace usher::operations
