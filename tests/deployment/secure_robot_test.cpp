// The whole simulated robot with DDS-Security: it drives, and goes on driving under attack.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <set>
#include <span>
#include <sstream>

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
using usher_msgs::msg::SupervisorRequest_Constants::COMMAND_NAVIGATION_GO;
using usher_msgs::msg::SupervisorRequest_Constants::COMMAND_NAVIGATION_START;
using usher_msgs::msg::SupervisorStatus_Constants::STATE_NAVIGATION_ACTIVE;
using usher_sim_msgs::msg::BaseCommand_Constants::MODE_EMERGENCY_STOP;

template <class Message>
runtime::Guid writer_of(RunningRobot& robot, const topics::Topic<Message>& topic) {
  for (const auto& endpoint : robot.observer().endpoints()) {
    if (endpoint.writer && endpoint.topic == "rt/" + std::string(topic.name)) return endpoint.guid;
  }
  return {};
}
template <class Message>
runtime::Bytes bytes_of(const Message& message) {
  runtime::Bytes bytes;
  EXPECT_TRUE(runtime::message_type<Message>().serialize(&message, bytes));
  return bytes;
}

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

/// Where a process listens for a DDS domain, on this machine.
std::vector<sockaddr_in> ports_of(pid_t process, std::uint32_t domain) {
  namespace fs = std::filesystem;
  std::set<std::string> sockets;
  std::error_code error;
  for (const auto& entry :
       fs::directory_iterator("/proc/" + std::to_string(process) + "/fd", error)) {
    const std::string target = fs::read_symlink(entry.path(), error).string();
    if (target.starts_with("socket:[")) sockets.insert(target.substr(8, target.size() - 9));
  }
  std::vector<sockaddr_in> ports;
  std::istringstream table(content_of("/proc/net/udp"));
  for (std::string line; std::getline(table, line);) {
    std::istringstream words(line);
    std::string slot, local, inode;
    words >> slot >> local;
    for (int i = 0; i < 8; ++i) words >> inode;
    const auto colon = local.find(':');
    if (colon == std::string::npos || !sockets.contains(inode)) continue;
    const auto port = static_cast<std::uint32_t>(std::stoul(local.substr(colon + 1), nullptr, 16));
    if (port < 7400 + 250 * domain || port >= 7650 + 250 * domain) continue;
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    ports.push_back(to);
  }
  return ports;
}

/// Sends what a writer did not send, as its next sample, to a process that reads it.
class Forger {
 public:
  Forger(PacketTap tap, const runtime::Guid& writer) : tap_(std::move(tap)), writer_(writer) {}

  /// Takes what the writer has sent meanwhile.
  void listen() {
    while (auto packet = tap_.next_of(writer_)) {
      const std::uint64_t number = number_of(*packet, writer_).value_or(0);
      if (number > newest_) newest_ = number, ahead_ = 0;
      heard_.resize(std::min<std::size_t>(heard_.size() + 1, 10'000));
      heard_[taken_++ % heard_.size()] = std::move(*packet);
    }
  }
  std::size_t heard() const { return heard_.size(); }
  const std::vector<Datagram>& packets() const { return heard_; }
  /// Of somebody who writes seldom: it changes packets of another writer of its participant.
  void borrow(const std::vector<Datagram>& packets) { heard_ = packets; }

  void send(Forgery forgery, const runtime::Bytes& payload, const std::vector<sockaddr_in>& to) {
    listen();
    ++ahead_;
    const Datagram& packet = heard_[++tries_ % heard_.size()];
    const auto bytes = forge(forgery, packet, writer_, payload, newest_ + ahead_);
    for (const auto& port : to) sender_.send(port, bytes);
  }

 private:
  PacketTap tap_;
  runtime::Guid writer_;
  PacketSender sender_;
  std::vector<Datagram> heard_;
  std::size_t taken_ = 0, tries_ = 0;
  std::uint64_t newest_ = 0, ahead_ = 0;
};

/// What reaches the wheels of a robot that stands, and whether its base obeys.
class Wheels {
 public:
  explicit Wheels(RunningRobot& robot)
      : robot_(robot),
        wheels_(robot.observer().reader(topics::kSimBaseCommand,
                                        [this](const auto& message, const auto&) {
                                          ++commands;
                                          if (message.v() != 0.0) ++driven;
                                          if (message.mode() == MODE_EMERGENCY_STOP) ++off;
                                        })),
        base_(
            robot.observer().reader(topics::kBaseStatus, [this](const auto& message, const auto&) {
              if (message.obedience() != 0) ++disobeyed;
            })) {
    EXPECT_TRUE(wheels_ && base_);
    EXPECT_TRUE(hears(50)) << robot.complaints();
    EXPECT_EQ(driven, 0U) << "it stands before the attack";
    disobeyed = 0;
  }
  /// At the base's own pace, so that nothing is just dropped.
  bool hears(std::uint64_t more) {
    const std::uint64_t until = commands + more;
    return robot_.wait_for([&] { return commands >= until; }, Seconds(20));
  }

  std::atomic<std::uint64_t> commands{0}, driven{0}, off{0}, disobeyed{0};

 private:
  RunningRobot& robot_;
  Result<runtime::Observer::Reader<usher_sim_msgs::msg::BaseCommand>> wheels_;
  Result<runtime::Observer::Reader<usher_msgs::msg::BaseStatus>> base_;
};

/// The sample that moves the robot, or takes its right to drive, or switches it off.
struct Wanted {
  const char* name;
  const char* reader;  ///< the component that would obey
  runtime::Guid writer;
  std::function<runtime::Bytes(std::uint64_t number)> sample;
};

std::vector<Wanted> wanted_of(RunningRobot& robot) {
  return {
      {"drive/command", "segway_rmp", writer_of(robot, topics::kDriveCommand),
       [&robot](std::uint64_t number) {
         DriveCommand command;
         command.stamp(wire::to_message(robot.observer().now()));
         command.epoch(robot.status()->epoch());
         command.number(1'000'000'000 + number);
         command.v(0.4);
         return bytes_of(command);
       }},
      {"cmd_vel/navigation", "movement_control", writer_of(robot, topics::kCmdVelNavigation),
       [&robot](std::uint64_t) {
         geometry_msgs::msg::TwistStamped speed;
         speed.header(wire::header(robot.observer().now(), "base_link"));
         speed.twist().linear().x(0.4);
         return bytes_of(speed);
       }},
      {"drive/grant", "segway_rmp", writer_of(robot, topics::kDriveGrant),
       [&robot](std::uint64_t) {
         usher_msgs::msg::DriveGrant right;
         right.stamp(wire::to_message(robot.observer().now()));
         right.epoch(robot.status()->epoch() + 1);
         return bytes_of(right);
       }},
      {"base/request", "segway_rmp", writer_of(robot, topics::kBaseRequest),
       [](std::uint64_t number) {
         usher_msgs::msg::BaseRequest request;
         request.id(1'000'000'000 + number);
         request.client("supervisor");
         request.command(usher_msgs::msg::BaseRequest_Constants::COMMAND_EMERGENCY_STOP);
         return bytes_of(request);
       }},
  };
}

/// Lets it drive where the navigation wants to, which has no goal: it stands, and a speed that it
/// took would move it.
bool navigation_may_drive(const RunningRobot& robot, runtime::Observer& observer) {
  auto requests = observer.writer(topics::kSupervisorRequest);
  EXPECT_TRUE(requests) << requests.error();
  usher_msgs::msg::SupervisorRequest request;
  request.client("operator");
  request.goal("nowhere");
  for (int i = 0; i < 10; ++i) {
    for (const std::uint8_t command : {COMMAND_NAVIGATION_START, COMMAND_NAVIGATION_GO}) {
      request.id(
          static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count()));
      request.command(command);
      requests->write(request);
      if (robot.wait_for([&] { return robot.status()->state() == STATE_NAVIGATION_ACTIVE; },
                         Seconds(1)))
        return true;
    }
  }
  return false;
}

/// Forgeries of one topic, so many of each kind; the robot goes on for a moment after `pace`
/// rounds.
std::uint64_t attack(RunningRobot& robot, const Wanted& wanted, std::uint64_t rounds,
                     Wheels& wheels, std::span<const Forgery> forgeries = kForgeries,
                     std::uint64_t pace = 20) {
  auto tap = PacketTap::open(robot.domain());
  EXPECT_TRUE(tap);
  EXPECT_NE(wanted.writer, runtime::Guid{});
  Forger forger(std::move(tap).value(), wanted.writer);
  if (std::string(wanted.name) == "base/request") {
    auto beside = PacketTap::open(robot.domain());
    Forger grants(std::move(beside).value(), writer_of(robot, topics::kDriveGrant));
    EXPECT_TRUE(robot.wait_for([&] { return grants.listen(), grants.heard() > 100; }, Seconds(20)));
    forger.borrow(grants.packets());
  } else {
    EXPECT_TRUE(robot.wait_for([&] { return forger.listen(), forger.heard() > 100; }, Seconds(20)));
  }
  const auto to = ports_of(robot.components().at(wanted.reader), robot.domain());
  EXPECT_FALSE(to.empty()) << wanted.reader;
  if (testing::Test::HasFailure()) return 0;
  std::uint64_t tries = 0;
  for (std::uint64_t round = 0; round < rounds; ++round) {
    for (const auto forgery : forgeries) forger.send(forgery, wanted.sample(++tries), to);
    if (round % pace == 0) wheels.hears(2);
  }
  wheels.hears(10);
  return tries;
}

TEST_F(SecureRobot, ExecutesNoPacketThatItsOwnDidNotSend) {
  if (auto tap = PacketTap::open(robot_->domain()); !tap) GTEST_SKIP() << tap.error();
  // USHER_FORGERIES: so many of commands instead; a million take minutes on a machine of its own.
  const char* const asked = std::getenv("USHER_FORGERIES");
  const std::uint64_t commands =
      (asked != nullptr ? std::strtoull(asked, nullptr, 10) : 3200) / std::size(kForgeries);
  drive({"4.5", "5.3", "1.5708"});
  ASSERT_TRUE(navigation_may_drive(*robot_, robot_->observer()));
  Wheels wheels(*robot_);
  for (const auto& wanted : wanted_of(*robot_)) {
    SCOPED_TRACE(wanted.name);
    const bool command = std::string(wanted.name) == "drive/command";
    const auto tries = attack(*robot_, wanted, command ? commands : 100, wheels);
    std::printf("%s: %lu forged or replayed packets, %lu executed\n", wanted.name, tries,
                wheels.driven + wheels.off + wheels.disobeyed);
    EXPECT_EQ(wheels.driven, 0U);
    EXPECT_EQ(wheels.off, 0U);
    EXPECT_EQ(wheels.disobeyed, 0U);
  }
  EXPECT_EQ(robot_->status()->state(), STATE_NAVIGATION_ACTIVE);
  EXPECT_TRUE(robot_->wait_for([] { return robot_->may_drive(); }, Seconds(10)))
      << robot_->complaints();
  // The launcher tells of what came to it; here is its share.
  const Wanted command = wanted_of(*robot_).front();
  const auto launcher = ports_of(robot_->launcher().pid(), robot_->domain());
  const PacketSender sender;
  for (std::uint64_t number = 1; number <= 200; ++number) {
    const auto bytes =
        forge(Forgery::kUnsigned, {}, command.writer, command.sample(number), 2'000'000 + number);
    for (const auto& port : launcher) sender.send(port, bytes);
  }
  EXPECT_TRUE(robot_->wait_for(
      [] {
        return robot_->launcher().output().find(" messages from 127.0.0.1 that are malformed") !=
               std::string::npos;
      },
      Seconds(15)))
      << robot_->launcher().output();
}

// The control: what is unsigned moves, stops and switches off a robot that asks for no signature. A
// robot for each, since it takes the numbers of those who may.
class WithoutKeys : public testing::TestWithParam<std::size_t> {};

TEST_P(WithoutKeys, TheSamePacketsAreExecuted) {
  RunningRobot robot;
  if (auto tap = PacketTap::open(robot.domain()); !tap) GTEST_SKIP() << tap.error();
  ASSERT_TRUE(robot.wait_for([&] { return robot.may_drive(); }, Seconds(60))) << robot.complaints();
  ASSERT_TRUE(navigation_may_drive(robot, robot.observer()));
  constexpr std::array kPlain{Forgery::kUnsigned};
  Wheels wheels(robot);
  const Wanted wanted = wanted_of(robot).at(GetParam());
  attack(robot, wanted, 50, wheels, kPlain, 1);
  const bool stops = std::string(wanted.name) == "drive/grant";
  const bool off = std::string(wanted.name) == "base/request";
  EXPECT_GT(stops ? wheels.disobeyed : off ? wheels.off : wheels.driven, 0U) << wanted.name;
}

INSTANTIATE_TEST_SUITE_P(Each, WithoutKeys, testing::Range<std::size_t>(0, 4));

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
