// The whole simulated robot with DDS-Security: it drives, and goes on driving under attack.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>

#include "deployment/running_robot.hpp"
#include "operations/security/packet_attack.hpp"
#include "support/sanitizer.hpp"
#include "wire/conversions.hpp"

namespace usher::test {
namespace {

using namespace operations;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using usher_msgs::msg::DriveCommand;
using usher_msgs::msg::Heartbeat_Constants::STATE_OK;

class SecureRobot : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!signing_robot_starves()) robot_ = new RunningRobot(true);
  }
  static void TearDownTestSuite() {
    delete robot_;
    robot_ = nullptr;
  }
  void SetUp() override {
    if (signing_robot_starves()) GTEST_SKIP() << kSigningRobotStarves;
    ASSERT_TRUE(robot_->wait_for([] { return robot_->may_drive(); }, Seconds(60)))
        << robot_->complaints();
  }
  /// A command that nobody answered, since it was not authenticated in time, is typed again.
  static constexpr int kTries = 6;

  /// Drives there while `meanwhile` is called again and again.
  static void drive(
      const std::vector<std::string>& pose, const std::function<void()>& meanwhile = [] {}) {
    std::string story;
    for (int i = 0; i < kTries; ++i) {
      const auto command = robot_->command({"goto", "--pose", pose[0], pose[1], pose[2]});
      robot_->wait_for(
          [&] {
            meanwhile();
            return command->output().find("arrived") != std::string::npos ||
                   !command->errors().empty();
          },
          Seconds(120));
      const int code = command->wait();
      if (code == 0) return;
      story += command->output() + command->errors();
    }
    ADD_FAILURE() << story;
  }
  /// What `usher status` prints when it says so; else what it printed last. Its exit code also
  /// tells of a simulation that was once too slow.
  static std::string status_with(const std::string& wanted) {
    std::string printed;
    // Who comes new authenticates with all others: on a slow machine that outlasts one command, or
    // starves a component, and the robot stops, for a moment.
    const auto until = std::chrono::steady_clock::now() + Seconds(60);
    while (std::chrono::steady_clock::now() < until) {
      const auto command = robot_->command({"status"});
      EXPECT_GE(command->wait(), 0);
      printed = command->output() + command->errors();
      if (printed.find(wanted) != std::string::npos) break;
    }
    return printed;
  }
  template <class Message>
  static runtime::Guid writer_of(const topics::Topic<Message>& topic) {
    for (const auto& endpoint : robot_->observer().endpoints()) {
      if (endpoint.writer && endpoint.topic == "rt/" + std::string(topic.name))
        return endpoint.guid;
    }
    return {};
  }
  template <class Message>
  static runtime::Bytes bytes_of(const Message& message) {
    runtime::Bytes bytes;
    EXPECT_TRUE(runtime::message_type<Message>().serialize(&message, bytes));
    return bytes;
  }

  static RunningRobot* robot_;
};
RunningRobot* SecureRobot::robot_ = nullptr;

TEST_F(SecureRobot, DrivesAndAnswersItsOperator) {
  drive({"4.5", "5.3", "1.5708"});
  EXPECT_THAT(status_with(", may drive\n"), HasSubstr(", may drive\n"));
  Process checked({usher_program(), "check", robot_->manifest()});
  EXPECT_EQ(checked.wait(), 0) << checked.output();
}

TEST_F(SecureRobot, AStopIsAskedForUntilItIsAnswered) {
  const auto stop = robot_->command({"stop"});
  EXPECT_EQ(stop->wait(), 0) << stop->errors();
  EXPECT_THAT(robot_->status()->stopped_by(), Not(testing::IsEmpty()));
  ASSERT_TRUE(robot_->wait_for([] { return robot_->command({"move"})->wait() == 0; }, Seconds(60)));
}

TEST_F(SecureRobot, DrivesOnBesideAForeignParticipantAndReportsIt) {
  auto intruder =
      runtime::Observer::create({.name = "intruder", .host = "nuc", .domain = robot_->domain()});
  ASSERT_TRUE(intruder) << intruder.error();
  auto writer = (*intruder)->writer(topics::kDriveCommand);
  ASSERT_TRUE(writer) << writer.error();
  std::string reasons;  // a busy machine may have others
  drive({"4.5", "3.6", "0.0"}, [&] {
    writer->write(DriveCommand{});
    if (const auto now = robot_->status(); now && !now->granted()) reasons += now->reason() + "\n";
  });
  EXPECT_THAT(reasons, Not(AnyOf(HasSubstr("foreign"), HasSubstr("intruder"))));
  EXPECT_EQ(writer->reader_count(), 0U);
  EXPECT_THAT(robot_->launcher().output(), HasSubstr("refused: participant 'intruder' from "));
  // It listens for two seconds only.
  EXPECT_THAT(status_with("'intruder'"), HasSubstr("'intruder'"));
}

TEST_F(SecureRobot, ExecutesNoPacketThatItsMovementControlDidNotSend) {
  auto tap = PacketTap::open(robot_->domain());
  if (!tap) GTEST_SKIP() << tap.error();
  const auto writer = writer_of(topics::kDriveCommand);
  std::vector<Datagram> heard;  // commands of a moving robot, as they went to the base and others
  drive({"4.5", "5.3", "1.5708"}, [&] {
    while (auto packet = tap->next_of(writer)) {
      if (heard.size() < 20'000) heard.push_back(std::move(*packet));
    }
  });
  ASSERT_GT(heard.size(), 100U);
  std::atomic<std::uint64_t> executed{0};
  std::atomic<std::uint64_t> commands{0};
  const auto base =
      robot_->observer().reader(topics::kSimBaseCommand, [&](const auto& message, const auto&) {
        ++commands;
        if (message.v() != 0.0 || message.w() != 0.0) ++executed;
      });
  ASSERT_TRUE(base) << base.error();
  ASSERT_TRUE(robot_->wait_for([&] { return commands > 50; }, Seconds(20)));
  ASSERT_EQ(executed, 0U) << "it stands before the attack";

  DriveCommand wanted;
  wanted.epoch(robot_->status()->epoch());
  wanted.v(0.4);
  const PacketSender sender;
  std::uint64_t tries = 0;
  // USHER_FORGERIES: so many instead; a million take two minutes on a machine of its own.
  const char* const wanted_tries = std::getenv("USHER_FORGERIES");
  const std::uint64_t rounds =
      (wanted_tries != nullptr ? std::strtoull(wanted_tries, nullptr, 10) : 3200) /
      std::size(kForgeries);
  for (std::uint64_t round = 0; round < rounds; ++round) {
    for (const auto forgery : kForgeries) {
      wanted.stamp(wire::to_message(robot_->observer().now()));
      wanted.number(1'000'000'000 + ++tries);
      const runtime::Bytes payload = bytes_of(wanted);
      const Datagram& packet = heard[tries % heard.size()];
      sender.send(packet.to, forge(forgery, packet, writer, payload, 1'000'000 + tries));
    }
    if (round % 20 == 0) {
      const auto until = commands + 2;  // at the base's own pace, so that nothing is just dropped
      robot_->wait_for([&] { return commands >= until; }, Seconds(1));
    }
  }
  std::printf("%lu forged or replayed packets, %lu executed\n", tries, executed.load());
  EXPECT_EQ(executed, 0U);
  EXPECT_TRUE(robot_->wait_for([] { return robot_->may_drive(); }, Seconds(10)))
      << robot_->complaints();
  // The launcher tells of what came to it; here is its share.
  const runtime::Bytes payload = bytes_of(wanted);
  sockaddr_in everybody = heard[0].to;
  for (std::uint32_t port = 10; port < 250; ++port) {
    everybody.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * robot_->domain() + port));
    sender.send(everybody, forge(Forgery::kUnsigned, heard[0], writer, payload, 2'000'000));
  }
  EXPECT_TRUE(robot_->wait_for(
      [] {
        return robot_->launcher().output().find(" messages from 127.0.0.1 that are malformed") !=
               std::string::npos;
      },
      Seconds(15)))
      << robot_->launcher().output();
}

// A planner's speeds, an end of the right to drive, an order to switch the motors off.
TEST_F(SecureRobot, ObeysNoForgedSpeedNorRightNorRequest) {
  auto speeds = PacketTap::open(robot_->domain());
  auto rights = PacketTap::open(robot_->domain());
  if (!speeds || !rights) GTEST_SKIP() << "no packets are heard";
  const auto planner = writer_of(topics::kCmdVelNavigation);
  const auto grantor = writer_of(topics::kDriveGrant);
  const auto requester = writer_of(topics::kBaseRequest);
  std::vector<Datagram> speeds_heard, rights_heard;
  drive({"4.5", "3.6", "0.0"}, [&] {
    while (auto packet = speeds->next_of(planner)) speeds_heard.push_back(std::move(*packet));
    while (auto packet = rights->next_of(grantor)) rights_heard.push_back(std::move(*packet));
  });
  ASSERT_GT(speeds_heard.size(), 50U);
  ASSERT_GT(rights_heard.size(), 50U);
  std::atomic<std::uint64_t> commands{0}, executed{0}, no_right{0};
  const auto wheels =
      robot_->observer().reader(topics::kSimBaseCommand, [&](const auto& message, const auto&) {
        ++commands;
        if (message.v() != 0.0 || message.w() != 0.0 ||
            message.mode() == usher_sim_msgs::msg::BaseCommand_Constants::MODE_EMERGENCY_STOP)
          ++executed;
      });
  const auto base =
      robot_->observer().reader(topics::kBaseStatus, [&](const auto& message, const auto&) {
        if (message.obedience() != 0) ++no_right;
      });
  ASSERT_TRUE(wheels && base);
  ASSERT_TRUE(robot_->wait_for([&] { return commands > 50; }, Seconds(20)));
  ASSERT_EQ(executed, 0U) << "it stands before the attack";
  no_right = 0;

  const PacketSender sender;
  std::uint64_t tries = 0;
  for (int round = 0; round < 100; ++round) {
    const auto now = robot_->observer().now();
    const auto epoch = robot_->status()->epoch();
    geometry_msgs::msg::TwistStamped speed;
    speed.header(wire::header(now, "base_link"));
    speed.twist().linear().x(0.4);
    usher_msgs::msg::DriveGrant right;
    right.stamp(wire::to_message(now));
    right.epoch(epoch + 1);
    usher_msgs::msg::BaseRequest request;
    request.client("supervisor");
    request.command(usher_msgs::msg::BaseRequest_Constants::COMMAND_EMERGENCY_STOP);
    for (const auto forgery : kForgeries) {
      const std::uint64_t number = 1'000'000 + ++tries;
      request.id(1'000'000'000 + number);
      const auto send = [&](const std::vector<Datagram>& heard, const runtime::Guid& writer,
                            const runtime::Bytes& payload) {
        const Datagram& packet = heard[tries % heard.size()];
        sender.send(packet.to, forge(forgery, packet, writer, payload, number));
      };
      send(speeds_heard, planner, bytes_of(speed));
      send(rights_heard, grantor, bytes_of(right));
      send(rights_heard, requester, bytes_of(request));
    }
    const auto until = commands + 2;
    robot_->wait_for([&] { return commands >= until; }, Seconds(1));
  }
  EXPECT_EQ(executed, 0U) << "of " << commands;
  EXPECT_EQ(no_right, 0U);
  EXPECT_TRUE(robot_->wait_for([] { return robot_->may_drive(); }, Seconds(10)))
      << robot_->complaints();
}

TEST_F(SecureRobot, HearsAgainWhoStoodStillForLongerThanItsLease) {
  for (const auto* victim : {"guide", "map_server"}) {
    const pid_t process = robot_->components().at(victim);
    ASSERT_EQ(::kill(process, SIGSTOP), 0);
    robot_->wait_for([] { return false; }, Seconds(1.3));
    ::kill(process, SIGCONT);
    EXPECT_TRUE(robot_->wait_for([] { return robot_->may_drive(); }, Seconds(30)))
        << victim << "\n"
        << robot_->complaints();
  }
}

TEST_F(SecureRobot, ComesBackAfterTheDeathOfAPart) {
  for (const auto* victim : {"movement_control", "segway_rmp"}) {
    const auto before = robot_->lives().at(victim).writer;
    const double slow = slowdown();
    const auto killed = std::chrono::steady_clock::now();
    ASSERT_EQ(::kill(robot_->components().at(victim), SIGKILL), 0);
    ASSERT_TRUE(robot_->wait_for([&] { return robot_->lives().at(victim).writer != before; },
                                 Seconds(30.0 * slow)));
    const Seconds heard = robot_->lives().at(victim).at - killed;
    ASSERT_TRUE(robot_->wait_for(
        [&] { return robot_->lives().at(victim).state == STATE_OK && robot_->may_drive(); },
        Seconds(30.0 * slow)))
        << robot_->complaints();
    const Seconds whole = std::chrono::steady_clock::now() - killed;
    std::printf("%-16s heard after %4.0f ms, may drive again after %4.0f ms (machine %.1fx)\n",
                victim, heard.count() * 1e3, whole.count() * 1e3, slow);
  }
}

}  // namespace
}  // namespace usher::test
