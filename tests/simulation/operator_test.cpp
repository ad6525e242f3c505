// An operator's stick in lock-step: the whole robot among walls, and nobody's good sense.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "foundation/random/random.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/site_facts.hpp"
#include "support/folder.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {
namespace {

using std::chrono::milliseconds;

constexpr const char* kMarvin = "marvin-sim.yaml";
constexpr const char* kPioneer = "meeting-sim.yaml";
constexpr const char* kFoyer = "[4.5, 7.0, 1.5708]";      // 3.7 m before a wall
constexpr const char* kBesideAWall = "[4.5, 0.34, 0.0]";  // 5 cm to the right
constexpr const char* kHall = "[4.5, 2.0, -1.5708]";      // 1.9 m before a wall

/// A robot at a place of its site, driven by hand.
class OperatedRobot {
 public:
  OperatedRobot(const std::string& manifest, const std::string& place, bool guard) {
    const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
    const Installation installation{
        .programs = {}, .contracts = share + "/contracts", .share = share};
    // The meeting assistant has no gamepad of its own.
    const test::Folder folder;
    const std::string driven =
        folder.file("driven.yaml", "extends: " + share + "/deploy/" + manifest +
                                       "\ncomponents:\n  manual_control: {host: " + host(manifest) +
                                       ", criticality: notify, heartbeat_timeout: 1.0}\n");
    auto deployment = load_deployment(driven, installation,
                                      {{"movement_control", "guard", guard ? "true" : "false"}});
    EXPECT_TRUE(deployment.ok()) << deployment.error();
    set_site_value(*deployment, "site.initial_pose", place);
    auto run = LockstepRun::create(*deployment, 1);
    EXPECT_TRUE(run.ok()) << run.error();
    run_ = std::move(run).value();
    run_->world().observe(topics::kMovementStatus, [this](const auto& status, const auto&) {
      reason_ = status.limit_reason();
    });
    run_->world().observe(topics::kSupervisorStatus, [this](const auto& status, const auto&) {
      manual_ = status.state() == usher_msgs::msg::SupervisorStatus_Constants::STATE_MANUAL;
    });
    run_->world().run_for(std::chrono::seconds(5));
    manual_on();
  }

  /// The stick is held so for a while [s].
  void hold(double forward, double turn, double duration, bool held = true) {
    for (int ms = 0; ms < std::lround(1000.0 * duration); ms += 40) {
      sensor_msgs::msg::Joy joy;
      joy.header(wire::header(run_->world().now(), ""));
      joy.axes({0.0F, static_cast<float>(forward), 0.0F, static_cast<float>(turn)});
      joy.buttons({0, 0, 0, 0, held ? 1 : 0});
      run_->world().publish(topics::kJoy, joy, "operator");
      run_->world().run_for(milliseconds(40));
    }
  }

  const RunRecord::Sample& now() const { return run_->record().samples().back(); }
  RunRecord::Summary summary() const { return run_->record().summary(); }
  /// [m] that it has driven.
  double way() const {
    const auto& samples = run_->record().samples();
    double way = 0.0;
    for (std::size_t i = 1; i < samples.size(); ++i)
      way += geometry::distance(samples[i - 1].truth, samples[i].truth);
    return way;
  }
  const std::string& reason() const { return reason_; }

 private:
  static std::string host(const std::string& manifest) {
    return manifest == kMarvin ? "nuc" : "laptop";
  }
  void manual_on() {
    usher_msgs::msg::SupervisorRequest request;
    request.client("operator");
    request.id(1);
    request.command(usher_msgs::msg::SupervisorRequest_Constants::COMMAND_MANUAL_ON);
    for (int i = 0; i < 25 && !manual_; ++i) {
      run_->world().publish(topics::kSupervisorRequest, request, "operator");
      run_->world().run_for(milliseconds(200));
    }
    EXPECT_TRUE(manual_) << run_->complaints();
    hold(0.0, 0.0, 0.2, false);  // a button counts only once it was released
  }

  std::unique_ptr<LockstepRun> run_;
  std::string reason_;
  bool manual_ = false;
};

TEST(Operator, FullAheadAtAWallComesToRestBeforeIt) {
  OperatedRobot robot(kMarvin, kFoyer, true);
  robot.hold(1.0, 0.0, 25.0);
  EXPECT_GT(robot.now().truth.y, 9.5) << "it went there";
  EXPECT_LT(std::abs(robot.now().v), 0.1);
  const auto summary = robot.summary();
  EXPECT_EQ(summary.contacts + summary.touches, 0U) << summary.contact_with;
}

TEST(Operator, WithoutTheGuardMarvinHitsTheWall) {
  OperatedRobot robot(kMarvin, kFoyer, false);
  robot.hold(1.0, 0.0, 25.0);
  EXPECT_GT(robot.summary().contacts, 0U);
}

TEST(Operator, ThePioneerComesToRestBeforeAWall) {
  OperatedRobot robot(kPioneer, kHall, true);
  robot.hold(1.0, 0.0, 15.0);
  EXPECT_LT(robot.now().truth.y, 0.6) << "it went there";
  const auto summary = robot.summary();
  EXPECT_EQ(summary.contacts + summary.touches, 0U) << summary.contact_with;
  OperatedRobot reckless(kPioneer, kHall, false);
  reckless.hold(1.0, 0.0, 15.0);
  EXPECT_GT(reckless.summary().contacts, 0U);
}

TEST(Operator, AFullTurnBesideAWallTurnsNoCornerIntoIt) {
  for (const double side : {1.0, -1.0}) {
    SCOPED_TRACE(side);
    OperatedRobot robot(kPioneer, kBesideAWall, true);
    robot.hold(0.0, side, 15.0);
    const auto summary = robot.summary();
    EXPECT_EQ(summary.contacts + summary.touches, 0U) << summary.contact_with;
    OperatedRobot reckless(kPioneer, kBesideAWall, false);
    reckless.hold(0.0, side, 15.0);
    EXPECT_GT(reckless.summary().contacts, 0U);
  }
}

// Nothing sees behind, so it never pulls the stick back.
TEST(Operator, WithoutAnySenseItTouchesNothingThatItSees) {
  const std::pair<const char*, const char*> rows[] = {{kMarvin, "[7.0, 12.6, 1.57]"},
                                                      {kMarvin, "[16.0, 7.4, -1.57]"},
                                                      {kPioneer, "[10.0, 10.4, 0.0]"},
                                                      {kPioneer, "[1.5, 1.5, 1.57]"}};
  std::uint32_t reckless_contacts = 0;
  for (const auto& [manifest, place] : rows) {
    for (const bool guard : {true, false}) {
      OperatedRobot robot(manifest, place, guard);
      Random random(7);
      for (int turn_of_mind = 0; turn_of_mind < 60; ++turn_of_mind) {
        const double forward = std::min(1.0, random.uniform(0.0, 1.4));
        const double turn = std::clamp(random.uniform(-1.5, 1.5), -1.0, 1.0);
        const bool spins = random.below(3) == 0, straight = random.below(3) == 0;
        robot.hold(spins ? 0.0 : forward, straight ? 0.0 : turn, 2.0);
      }
      const auto summary = robot.summary();
      if (guard) {
        EXPECT_EQ(summary.contacts, 0U) << manifest << " " << place << ": " << summary.contact_with;
        EXPECT_GT(robot.way(), 3.0) << "it gets about";
      } else {
        reckless_contacts += summary.contacts;
      }
    }
  }
  EXPECT_GT(reckless_contacts, 10U);
}

}  // namespace
}  // namespace usher::operations
