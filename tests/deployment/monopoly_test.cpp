// Foreign writers in the domain of the running robot.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>

#include "deployment/running_robot.hpp"
#include "support/folder.hpp"
#include "wire/conversions.hpp"

namespace usher::test {
namespace {

using namespace usher_msgs::msg;

constexpr double kIntruderSpeed = 0.4;  // [m/s]
constexpr double kNamed = 1.0;          // [s] on a busy machine; the experiment judges it

/// The fault that names the intruder, if there is one now.
std::optional<Fault> fault_of(const RunningRobot& robot, const std::string& name) {
  const auto status = robot.status();
  if (!status) return std::nullopt;
  for (const auto& fault : status->faults()) {
    if (fault.active() &&
        (fault.component_name() + " " + fault.cause()).find(name) != std::string::npos)
      return fault;
  }
  return std::nullopt;
}

TEST(Monopoly, AForeignWriterStopsTheRobotUntilItLeavesAndAnOperatorClears) {
  RunningRobot robot;
  ASSERT_TRUE(robot.wait_for([&] { return robot.may_drive(); }, Seconds(60))) << robot.complaints();

  std::atomic<std::uint64_t> commands{0};
  std::atomic<std::uint64_t> executed{0};
  const auto base =
      robot.observer().reader(topics::kSimBaseCommand, [&](const auto& message, const auto&) {
        ++commands;
        if (message.v() != 0.0 || message.w() != 0.0) ++executed;
      });
  ASSERT_TRUE(base);
  std::atomic<double> top_speed{0.0};
  const auto truth =
      robot.observer().reader(topics::kSimGroundTruth, [&](const auto& message, const auto&) {
        top_speed = std::max(top_speed.load(), std::abs(message.v()));
      });
  ASSERT_TRUE(truth);
  ASSERT_TRUE(robot.wait_for([&] { return commands > 10; }, Seconds(10)));

  const auto epoch = robot.status()->epoch();
  {
    auto intruder =
        runtime::Observer::create({.name = "intruder", .host = "nuc", .domain = robot.domain()});
    ASSERT_TRUE(intruder) << intruder.error();
    auto writer = (*intruder)->writer(topics::kDriveCommand);
    ASSERT_TRUE(writer) << writer.error();
    ASSERT_TRUE(writer->wait_for_readers(1, std::chrono::seconds(10)));
    const auto started = std::chrono::steady_clock::now();
    std::uint64_t number = 1'000'000;
    const auto drive = [&] {
      DriveCommand command;
      command.stamp(wire::to_message(robot.observer().now()));
      command.epoch(robot.status()->epoch());
      command.number(++number);
      command.v(kIntruderSpeed);
      command.w(kIntruderSpeed);
      writer->write(command);
    };
    ASSERT_TRUE(robot.wait_for(
        [&] {
          drive();
          return fault_of(robot, "intruder").has_value() && !robot.status()->granted();
        },
        Seconds(10)))
        << robot.complaints();
    const Seconds noticed = std::chrono::steady_clock::now() - started;
    const auto fault = *fault_of(robot, "intruder");
    std::printf("noticed %.0f ms after the first command: %s: %s\n", noticed.count() * 1e3,
                fault.component_name().c_str(), fault.cause().c_str());
    EXPECT_TRUE(fault.latched());
    EXPECT_EQ(robot.status()->state(), SupervisorStatus_Constants::STATE_FAULT);

    // It goes on, and an operator who clears while it is there changes nothing.
    const auto clear = robot.command({"clear"});
    const auto until = commands + 100;
    EXPECT_TRUE(robot.wait_for(
        [&] {
          drive();
          return commands > until;
        },
        Seconds(20)));
    EXPECT_NE(clear->wait(), 0) << clear->output();
    EXPECT_NE(clear->errors().find("refused: "), std::string::npos) << clear->errors();
    EXPECT_FALSE(robot.status()->granted());
    EXPECT_TRUE(fault_of(robot, "intruder"));
  }
  EXPECT_EQ(executed, 0U) << "of " << commands;
  EXPECT_LT(top_speed, 0.05);

  // Gone, but the fault stays until it is cleared.
  const auto gone = [&] {
    const auto endpoints = robot.observer().endpoints();
    return std::none_of(endpoints.begin(), endpoints.end(),
                        [](const auto& endpoint) { return endpoint.participant == "intruder"; });
  };
  ASSERT_TRUE(robot.wait_for(gone, Seconds(10)));
  EXPECT_TRUE(fault_of(robot, "intruder"));
  EXPECT_FALSE(robot.status()->granted());
  const auto clear = robot.command({"clear"});
  EXPECT_EQ(clear->wait(), 0) << clear->errors();
  EXPECT_TRUE(robot.wait_for([&] { return robot.may_drive(); }, Seconds(10))) << robot.complaints();
  EXPECT_FALSE(fault_of(robot, "intruder"));
  EXPECT_GT(robot.status()->epoch(), epoch) << "commands of the old grant are worth nothing";
  EXPECT_EQ(executed, 0U);
}

// Each topic that moves the robot, in each way: the experiment, with few samples.
TEST(Monopoly, NoSampleOfAForeignWriterReachesTheWheels) {
  const Folder folder;
  ::setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1);
  ::setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
  Process attacks({usher_program(), "experiment", "monopoly", "--seeds", "82", "--domain",
                   std::to_string(test_domain()), "--out", folder.path()});
  attacks.wait(std::chrono::minutes(12));
  ASSERT_EQ(attacks.pid(), -1) << attacks.output();
  const auto result = YAML::Load(content_of(folder.path() + "/result.json"));
  ASSERT_TRUE(result["metrics"]) << attacks.output() << attacks.errors();
  const auto metric = [&](const char* name) { return result["metrics"][name].as<double>(); };
  std::printf("%s", attacks.output().c_str());
  EXPECT_EQ(metric("executed"), 0.0) << attacks.output();
  EXPECT_EQ(metric("samples"), 82'000.0);
  EXPECT_GE(metric("samples_with_the_right_least"), 1.0) << attacks.output();
  EXPECT_LT(metric("named_ms_max"), kNamed * slowdown() * 1e3) << attacks.output();
}

}  // namespace
}  // namespace usher::test
