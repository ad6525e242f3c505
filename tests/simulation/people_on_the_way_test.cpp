// People along the way of MARVIN who do not stand upright and alone: one sits on a chair, one bends
// down, three stand together and talk.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/errand.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/site_facts.hpp"
#include "support/folder.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {
namespace {

using geometry::Point2;
using geometry::Pose2;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kSame = 0.6;  // [m]
constexpr const char* kHall = R"(name: hall
ceiling: 2.7
rooms:
  - {name: hall, title: Hall, area: [0.0, 0.0, 12.0, 6.0]}
walls:
  - {name: around, thickness: 0.2, points: [[-0.1, -0.1], [12.1, -0.1], [12.1, 6.1], [-0.1, 6.1], [-0.1, -0.1]]}
obstacles:
  - {name: chair, chair: [4.4, 4.3, -1.9]}
)";
constexpr const char* kPeople = R"(people:
  - {name: sits, at: [4.4, 4.3], yaw: -1.9, height: 1.7, posture: sitting}
  - {name: bends, at: [6.3, 1.7], yaw: 2.6, height: 1.8, posture: bending}
  - {name: talks_1, at: [9.4, 5.0], yaw: -1.57, height: 1.6}
  - {name: talks_2, at: [8.85, 4.1], yaw: 0.5, height: 1.75}
  - {name: talks_3, at: [9.95, 4.1], yaw: 2.6, height: 1.9}
)";

class PeopleOnTheWay : public testing::Test {
 protected:
  void SetUp() override {
    const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
    const Installation installation{
        .programs = {}, .contracts = share + "/contracts", .share = share};
    const std::string manifest =
        folder_.file("hall.yaml", "extends: " + share +
                                      "/deploy/marvin-depth-sim.yaml\nsite: obstacle_course\n");
    auto deployment = load_deployment(manifest, installation, {{"world", "people", "true"}});
    ASSERT_TRUE(deployment.ok()) << deployment.error();
    set_site_value(*deployment, "site.world", folder_.file("world.yaml", kHall));
    set_value(*deployment, "world", "site.people", folder_.file("people.yaml", kPeople));
    auto run = LockstepRun::create(*deployment, 1);
    ASSERT_TRUE(run.ok()) << run.error();
    run_ = std::move(run).value();
    run_->world().observe(topics::kSimGroundTruth,
                          [this](const auto& truth, const auto&) { truth_ = truth; });
    run_->world().observe(topics::kAmclPose, [this](const auto& pose, const auto&) {
      if (const auto planar = wire::to_planar(pose.pose().pose())) map_T_base_ = *planar;
    });
    run_->world().observe(topics::kOdom, [this](const auto& odom, const auto&) {
      if (const auto planar = wire::to_planar(odom.pose().pose())) odom_T_base_ = *planar;
    });
    run_->world().observe(topics::kPeople,
                          [this](const auto& people, const auto&) { judge(people); });
  }

  void judge(const usher_msgs::msg::People& people) {
    if (!truth_) return;
    const Pose2 map_T_odom = map_T_base_ * inverse(odom_T_base_);
    for (const auto& person : people.people()) {
      if (person.unseen() > 0.2F) continue;
      const Point2 place = map_T_odom * Point2(person.x(), person.y());
      const usher_sim_msgs::msg::Person* who = nullptr;
      double least = kSame;
      for (const auto& other : truth_->people()) {
        const double away = (Point2(other.x(), other.y()) - place).norm();
        if (away < least) least = away, who = &other;
      }
      if (who == nullptr) {
        ++nobody_;
      } else if (person.by_kinect()) {
        ++by_kinect_[who->name()];
      } else if (person.by_rear()) {
        ++by_rear_[who->name()];
      }
    }
  }

  /// Whether it arrives.
  bool drive(seconds limit) {
    auto& world = run_->world();
    Errand errand(
        "goal", 1000,
        {[&](const auto& request) {
           world.publish(topics::kSupervisorRequest, request, Errand::kClient);
         },
         [&](const auto& goal) { world.publish(topics::kNavigateGoal, goal, Errand::kClient); }});
    world.observe(topics::kSupervisorStatus,
                  [&](const auto& status, const auto&) { errand.take(status); });
    world.observe(topics::kNavigateStatus,
                  [&](const auto& status, const auto&) { errand.take(status); });
    while (world.elapsed() < limit && !errand.over()) {
      errand.step();
      world.run_for(milliseconds(200));
    }
    return errand.succeeded();
  }

  const test::Folder folder_;
  std::unique_ptr<LockstepRun> run_;
  std::optional<usher_sim_msgs::msg::GroundTruth> truth_;
  Pose2 map_T_base_, odom_T_base_;
  std::map<std::string, int> by_kinect_, by_rear_;
  int nobody_ = 0;
};

TEST_F(PeopleOnTheWay, AreFoundInWhateverPostureAndNotTouched) {
  EXPECT_TRUE(drive(seconds(90)));
  const auto summary = run_->record().summary();
  std::printf("%.1f s, %.2f m, clearance %.2f m, %d nobody\n", summary.seconds, summary.path,
              summary.smallest_clearance, nobody_);
  EXPECT_EQ(summary.contacts + summary.touches, 0U) << summary.contact_with;
  for (const char* name : {"sits", "bends", "talks_1", "talks_2", "talks_3"}) {
    std::printf("%s: %d by the Kinect, %d by the rear camera\n", name, by_kinect_[name],
                by_rear_[name]);
    EXPECT_GE(by_kinect_[name], 20) << name;
  }
  EXPECT_LE(nobody_, 10);
}

}  // namespace
}  // namespace usher::operations
