#include "control/supervisor/shell/component.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <sstream>
#include <string>
#include <tuple>

#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::supervisor {
namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg::SupervisorRequest_Constants;

constexpr const char* kManifest = R"(
manifest.components:
  - {name: supervisor, type: supervisor, host: nuc, criticality: stop, timeout: 0.12 s}
  - {name: movement_control, type: movement_control, host: nuc, criticality: stop, timeout: 0.12 s}
)";

class Component : public testing::Test {
 protected:
  usher_msgs::msg::SupervisorStatus ask(const std::string& client, std::uint8_t command,
                                        const std::string& participant = {}) {
    usher_msgs::msg::SupervisorRequest request;
    request.id(++id);
    request.client(client);
    request.command(command);
    host.publish(topics::kSupervisorRequest, request, participant.empty() ? client : participant);
    host.run_for(milliseconds(120));
    return host.last(topics::kSupervisorStatus).value();
  }
  usher_msgs::msg::SupervisorStatus after_a_crash() {
    host.world().kill(host.name());
    host.clear();
    host.world().start(host.name());
    host.run_for(milliseconds(120));
    return host.last(topics::kSupervisorStatus).value();
  }

  runtime::TestHost host{runtime::component_factory<SupervisorComponent>("supervisor"), kManifest};
  std::uint64_t id = 0;
};

TEST_F(Component, AStopAndAnEmergencyStopHoldOverACrash) {
  EXPECT_EQ(ask("guide", COMMAND_STOP).stopped_by(), std::vector<std::string>{"guide"});
  EXPECT_EQ(after_a_crash().stopped_by(), std::vector<std::string>{"guide"});
  EXPECT_TRUE(ask("operator", COMMAND_MOVEMENT_ON).stopped_by().empty());
  EXPECT_TRUE(after_a_crash().stopped_by().empty());
  ask("operator", COMMAND_EMERGENCY_STOP);
  const auto faults = after_a_crash().faults();
  ASSERT_FALSE(faults.empty());
  EXPECT_EQ(host.last(topics::kDriveGrant)->granted(), false);
}

TEST_F(Component, WhoseMemoryCannotBeReadGrantsNothing) {
  ask("operator", COMMAND_EMERGENCY_STOP);
  host.world().kill(host.name());
  const auto& memory = host.world().kept(host.name());
  ASSERT_EQ(memory.size(), 1U);
  host.world().unreadable(host.name()).insert(memory.begin()->first);
  host.clear();
  host.world().start(host.name());
  host.run_for(milliseconds(120));
  EXPECT_FALSE(host.running());
  EXPECT_NE(host.fault_reason().find("cannot be read"), std::string::npos) << host.fault_reason();
  EXPECT_TRUE(host.written(topics::kDriveGrant).empty());
}

TEST_F(Component, InAnothersNameOneMayStopTheRobotAndNothingElse) {
  EXPECT_TRUE(ask("operator", COMMAND_EMERGENCY_STOP, "stranger").faults().empty())
      << "which leaves the motors on: a balancing robot would fall";
  EXPECT_EQ(host.last(topics::kSupervisorStatus)->stopped_by(),
            std::vector<std::string>{"operator"});
  EXPECT_TRUE(ask("operator", COMMAND_MOVEMENT_ON).stopped_by().empty());
  ask("operator", COMMAND_EMERGENCY_STOP);
  EXPECT_EQ(ask("tablet", COMMAND_STOP, "stranger").stopped_by(),
            std::vector<std::string>{"tablet"});
  const auto untouched = ask("operator", COMMAND_CLEAR, "stranger");
  EXPECT_NE(untouched.last_request(), id) << "the operator's own request may have this id";
  EXPECT_TRUE(untouched.faults().front().active());
  EXPECT_FALSE(ask("operator", COMMAND_MOVEMENT_ON, "tablet").stopped_by().empty());
  EXPECT_TRUE(ask("operator", COMMAND_MOVEMENT_ON).stopped_by().empty());
  EXPECT_TRUE(ask("operator", COMMAND_CLEAR).last_request_done());
}

TEST_F(Component, WhoIsNotDiscoveredYetMayStopTheRobotAndIsAnsweredLater) {
  ask("operator", COMMAND_STOP);
  usher_msgs::msg::SupervisorRequest request;
  request.client("operator");
  request.command(COMMAND_MOVEMENT_ON);
  request.id(++id);
  host.publish(topics::kSupervisorRequest, request, "");
  host.run_for(milliseconds(120));
  EXPECT_NE(host.last(topics::kSupervisorStatus)->last_request(), id) << "neither done nor refused";
  host.publish(topics::kSupervisorRequest, request, "operator");
  host.run_for(milliseconds(120));
  EXPECT_EQ(host.last(topics::kSupervisorStatus)->last_request(), id);
  EXPECT_TRUE(host.last(topics::kSupervisorStatus)->stopped_by().empty());
  request.id(++id);
  request.command(COMMAND_STOP);
  host.publish(topics::kSupervisorRequest, request, "");
  host.run_for(milliseconds(120));
  EXPECT_EQ(host.last(topics::kSupervisorStatus)->stopped_by(),
            std::vector<std::string>{"operator"});
}

TEST_F(Component, WhatSomebodyAskedInAnothersNameVoidsNoRequestOfHis) {
  for (const std::uint8_t forged : {COMMAND_MOVEMENT_ON, COMMAND_CLEAR, COMMAND_STOP}) {
    ask("operator", COMMAND_MOVEMENT_ON);
    ask("operator", forged, "stranger");
    --id;
    const auto status =
        ask("operator", forged == COMMAND_STOP ? COMMAND_MOVEMENT_ON : COMMAND_STOP);
    EXPECT_EQ(status.last_request(), id);
    EXPECT_TRUE(status.last_request_done());
    EXPECT_EQ(status.stopped_by().empty(), forged == COMMAND_STOP);
  }
}

TEST_F(Component, AnOperatorIsAnsweredInAFloodOfRequests) {
  host.run_for(milliseconds(200));
  usher_msgs::msg::SupervisorRequest nothing, stop;
  nothing.client("stranger");
  stop.client("operator");
  stop.command(COMMAND_STOP);
  stop.id(7);
  const auto flood = [&](int count) {
    for (int i = 0; i < count; ++i) {
      nothing.id(1000 + ++id);
      host.publish(topics::kSupervisorRequest, nothing, "stranger");
      if (i % 4 == 0) host.run_for(milliseconds(1));
    }
  };
  flood(400);
  host.clear();
  host.publish(topics::kSupervisorRequest, stop, "operator");
  flood(800);
  const auto statuses = host.written(topics::kSupervisorStatus);
  EXPECT_TRUE(std::any_of(statuses.begin(), statuses.end(), [](const auto& status) {
    return status.last_request_client() == "operator" && status.last_request() == 7;
  }));
  EXPECT_NE(statuses.back().last_request_client(), "operator") << "others are answered later";
}

TEST_F(Component, AFloodOfRequestsIsNoFloodOfAnswers) {
  host.run_for(milliseconds(200));
  host.clear();
  usher_msgs::msg::SupervisorRequest request;
  request.client("stranger");
  for (int i = 0; i < 1000; ++i) {
    request.id(++id);
    host.publish(topics::kSupervisorRequest, request);
    host.run_for(milliseconds(1));
  }
  EXPECT_LE(host.written(topics::kSupervisorStatus).size(), 60U);
  EXPECT_LE(host.written(topics::kDriveGrant).size(), 110U);
  EXPECT_EQ(ask("guide", COMMAND_STOP).stopped_by(), std::vector<std::string>{"guide"});
}

TEST_F(Component, WithoutABaseNothingIsGrantedAndTheReasonSaysSo) {
  host.run_for(milliseconds(500));
  const auto status = host.last(topics::kSupervisorStatus).value();
  EXPECT_FALSE(host.last(topics::kDriveGrant)->granted());
  EXPECT_FALSE(status.reason().empty());
  EXPECT_GE(host.written(topics::kDriveGrant).size(), 20U) << "silence is no answer";
}

TEST(BasesEpoch, IsTakenFromItsDriverAlone) {
  runtime::TestHost host{runtime::component_factory<SupervisorComponent>("supervisor"),
                         std::string(kManifest) +
                             "  - {name: segway_rmp, type: segway_rmp, host: nuc, criticality: "
                             "stop, timeout: 0.12 s}\n"};
  const auto hear = [&](std::uint64_t epoch, const char* participant) {
    usher_msgs::msg::BaseStatus base;
    base.header(wire::header(host.now(), ""));
    base.state(usher_msgs::msg::BaseStatus_Constants::STATE_BALANCING);
    base.epoch(epoch);
    host.publish(topics::kBaseStatus, base, participant);
    host.run_for(milliseconds(120));
    return host.last(topics::kDriveGrant)->epoch();
  };
  EXPECT_EQ(hear(7, "segway_rmp"), 7U);
  EXPECT_EQ(hear(std::uint64_t{1} << 40, "stranger"), 7U);
  EXPECT_EQ(host.counter("reports: rejected"), 1U);
  EXPECT_EQ(hear(9, "segway_rmp"), 9U);
}

TEST_F(Component, TellsOfThePowerWhatTheBaseSaysOfItsBattery) {
  const auto hear = [&](float battery_percent) {
    usher_msgs::msg::BaseStatus base;
    base.state(usher_msgs::msg::BaseStatus_Constants::STATE_BALANCING);
    base.battery_percent(battery_percent);
    for (int i = 0; i < 10; ++i) {
      base.header(wire::header(host.now(), ""));
      host.publish(topics::kBaseStatus, base);
      host.run_for(milliseconds(20));
    }
    return host.last(topics::kSupervisorStatus).value();
  };
  EXPECT_TRUE(hear(80.0F).ok_power());
  EXPECT_TRUE(hear(0.0F).connected_power());
  EXPECT_FALSE(hear(0.0F).ok_power());
  host.run_for(milliseconds(400));
  EXPECT_FALSE(host.last(topics::kSupervisorStatus)->connected_power()) << "the base is silent";
}

TEST(RobotsResponse, DecidesWhenItsBaseDisobeys) {
  const auto disobeys = [](const std::string& response) {
    runtime::TestHost host{runtime::component_factory<SupervisorComponent>("supervisor"),
                           response + kManifest};
    usher_msgs::msg::BaseStatus base;
    base.state(usher_msgs::msg::BaseStatus_Constants::STATE_BALANCING);
    base.v(0.4);  // though nobody commands it
    for (int i = 0; i < 250; ++i) {
      base.header(wire::header(host.now(), ""));
      host.publish(topics::kBaseStatus, base);
      host.run_for(milliseconds(20));
    }
    const auto faults = host.last(topics::kSupervisorStatus)->faults();
    return std::any_of(faults.begin(), faults.end(), [](const auto& fault) {
      return fault.cause().find("moves other than commanded") != std::string::npos;
    });
  };
  EXPECT_TRUE(disobeys(""));
  EXPECT_FALSE(disobeys("robot.response.standing_linear_threshold: 0.5 m/s\n"));
  EXPECT_FALSE(disobeys("robot.response.linear_patience: 10 s\n"));
}

TEST(BaseDriver, IsWhoeverWritesItsStatusInTheManifest) {
  for (const auto& [name, type] :
       {std::pair{"p3dx", "p3dx"}, {"segway_rmp", "segway_rmp_sim"}, {"wheels", "p3dx_sim"}}) {
    runtime::TestHost host{runtime::component_factory<SupervisorComponent>("supervisor"),
                           std::string(kManifest) + "  - {name: " + name + ", type: " + type +
                               ", host: nuc, criticality: notify, timeout: 0.12 s}\n"};
    usher_msgs::msg::Heartbeat alive;
    alive.component_name("movement_control");
    alive.state(usher_msgs::msg::Heartbeat_Constants::STATE_OK);
    alive.idl_digest(host.heartbeat().idl_digest());
    for (int i = 0; i < 10; ++i) {
      alive.header(wire::header(host.now(), ""));
      host.publish(topics::kDriveCommand, {}, "movement_control");
      host.publish(topics::kHeartbeat, alive, "movement_control");
      host.run_for(milliseconds(20));
    }
    EXPECT_EQ(host.last(topics::kSupervisorStatus)->reason(),
              std::string(name) + ": no base/status yet");
  }
}

TEST(ForeignWriters, AreNamedWhoseNameIsTheSupervisorsAndWhoWereMetFirst) {
  const auto claim = [](const auto& topic) {
    SCOPED_TRACE(topic.name);
    runtime::TestHost host{runtime::component_factory<SupervisorComponent>("supervisor"),
                           kManifest};
    host.publish(topic, {}, "supervisor");  // and nothing more
    host.run_for(milliseconds(300));
    const auto status = host.last(topics::kSupervisorStatus).value();
    ASSERT_FALSE(status.faults().empty());
    EXPECT_EQ(status.faults().front().component_name(), "supervisor");
    EXPECT_TRUE(status.faults().front().latched());
    EXPECT_NE(status.reason().find(topic.name), std::string::npos) << status.reason();
  };
  claim(topics::kDriveGrant);
  claim(topics::kMovementEnable);
  claim(topics::kBaseRequest);
  claim(topics::kSupervisorStatus);
}

/// With a writer of every topic in it.
std::string manifest_of_everybody() {
  std::string lines = "manifest.components:\n";
  std::set<std::string> types;
  const auto add = [&](const auto& topic) {
    std::istringstream words{std::string(topic.writers)};
    for (std::string word; words >> word;) {
      if (word != "*" && word != "operator") types.insert(word);
    }
  };
  std::apply([&](const auto&... topic) { (add(topic), ...); }, topics::kAll);
  for (const auto& type : types) {
    lines += "  - {name: " + type + ", type: " + type +
             ", host: nuc, criticality: notify, timeout: 1.0 s}\n";
  }
  return lines;
}

TEST(ForeignWriters, AreNamedOnEveryTopicButThoseThatAnybodyMayWriteOrNobodyDecidesBy) {
  const std::set<std::string> free{
      // An operator, a visitor or a viewer may ask.
      "heartbeat", "supervisor/request", "navigate/goal", "navigate/cancel", "goal_pose",
      "initialpose", "explore/goal", "explore/cancel", "meeting/request", "meeting/cancel",
      "dialogue/answer", "kinect/tilt/request",
      // To be looked at.
      "diagnostics", "battery", "particle_cloud", "local_costmap/costmap", "global_costmap/costmap",
      "plan", "local_plan", "explore/coverage", "guide/visit", "meeting/report",
      "interaction/status", "speech/level"};
  const std::string manifest = manifest_of_everybody();
  int watched = 0;
  const auto intrude = [&](const auto& topic) {
    const std::string name(topic.name);
    SCOPED_TRACE(name);
    if (name.starts_with("sim/") || topic.scope == topics::Scope::kFleet) return;
    runtime::TestHost host{runtime::component_factory<SupervisorComponent>("supervisor"), manifest};
    host.run_for(milliseconds(100));
    host.publish(topic, {}, "stranger");
    host.run_for(milliseconds(100));
    bool named = false;
    for (const auto& fault : host.last(topics::kSupervisorStatus)->faults())
      named = named || (fault.component_name() == "stranger" && fault.latched());
    EXPECT_NE(named, free.contains(name));
    watched += named ? 1 : 0;
  };
  std::apply([&](const auto&... topic) { (intrude(topic), ...); }, topics::kAll);
  std::printf("%d topics are watched\n", watched);
}

}  // namespace
}  // namespace usher::supervisor
