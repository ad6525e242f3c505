// The commands of the program against a running robot, as an operator would type them.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "deployment/running_robot.hpp"
#include "foundation/grid/map_file.hpp"
#include "support/terminal.hpp"

namespace usher::test {
namespace {

class Commands : public testing::Test {
 protected:
  static void SetUpTestSuite() { robot_ = new RunningRobot; }
  static void TearDownTestSuite() {
    delete robot_;
    robot_ = nullptr;
  }
  void SetUp() override {
    ASSERT_TRUE(robot_->wait_for([] { return robot_->status().has_value(); }, Seconds(60)))
        << robot_->complaints();
  }
  static bool well() {
    return robot_->wait_for([] { return robot_->may_drive(); }, Seconds(30));
  }

  /// Output of a command that has to end with `code`.
  static std::string output(std::vector<std::string> words, int code = 0) {
    const auto command = robot_->command(std::move(words));
    EXPECT_EQ(command->wait(std::chrono::seconds(60)), code)
        << command->output() << command->errors();
    return command->output();
  }
  static std::string errors(std::vector<std::string> words, int code = 1) {
    const auto command = robot_->command(std::move(words));
    EXPECT_EQ(command->wait(std::chrono::seconds(60)), code)
        << command->output() << command->errors();
    EXPECT_TRUE(command->errors().starts_with("usher: ")) << command->errors();
    return command->errors();
  }
  static bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }
  /// The line of a table that starts with a word.
  static std::string row(const std::string& table, const std::string& name) {
    std::istringstream lines(table);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with(name + " ")) return line;
    }
    return {};
  }

  static RunningRobot* robot_;
};
RunningRobot* Commands::robot_ = nullptr;

TEST_F(Commands, StatusShowsEveryComponent) {
  ASSERT_TRUE(well()) << robot_->complaints();
  const auto command = robot_->command({"status"});
  const int code = command->wait();
  const auto text = command->output();
  EXPECT_EQ(code, contains(row(text, "world"), " ok ") ? 0 : 1) << text;
  EXPECT_TRUE(contains(text, ", may drive\n")) << text;
  for (const auto& [name, pid] : robot_->components()) {
    if (name == "supervisor" || name == "world") continue;  // not in the table; late or not
    EXPECT_TRUE(contains(row(text, name), " ok ")) << name << "\n" << text;
  }
}

TEST_F(Commands, TopicsShowsWritersReadersAndRates) {
  const auto text = output({"topics", "--seconds", "2"});
  const auto scan = row(text, "scan");
  EXPECT_TRUE(contains(scan, "sensor_msgs::msg::dds_::LaserScan_")) << text;
  EXPECT_TRUE(contains(scan, "volatile")) << scan;
  EXPECT_TRUE(contains(scan, "lms100")) << scan;
  EXPECT_TRUE(contains(scan, "scan_filter")) << scan;
  EXPECT_TRUE(contains(row(text, "map"), "latched")) << text;
  EXPECT_TRUE(contains(row(text, "drive/command"), "movement_control")) << text;
  const auto map = row(text, "scan/filtered");
  std::istringstream words(map);
  std::string name, type, qos;
  double rate = 0.0;
  words >> name >> type >> qos >> rate;
  EXPECT_GT(rate, 50.0 / (2.0 * slowdown())) << map;
  EXPECT_LT(rate, 60.0) << map;
}

TEST_F(Commands, EchoPrintsSamples) {
  const auto text = output({"topics", "echo", "scan", "--count", "2"});
  EXPECT_TRUE(contains(text, "ranges:")) << text;
  EXPECT_TRUE(contains(text, "angle_min: ")) << text;
  EXPECT_EQ(text.substr(text.size() - 4), "---\n");
  const auto latched = output({"topics", "echo", "supervisor/status", "--count", "1"});
  EXPECT_TRUE(contains(latched, "granted: true")) << latched;
}

TEST_F(Commands, EchoSaysThatNobodyWrites) {
  EXPECT_EQ(errors({"topics", "echo", "scans", "--count", "1", "--patience", "1"}),
            "usher: nobody writes scans in domain " + std::to_string(robot_->domain()) +
                "; did you mean scan?\n");
}

TEST_F(Commands, GotoListsTheLocations) {
  const auto text = output({"goto"});
  EXPECT_TRUE(contains(row(text, "kitchen"), "Kitchen")) << text;
  EXPECT_TRUE(contains(row(text, "meeting_room"), "Meeting room")) << text;
}

TEST_F(Commands, AGotoThatCannotBeAsksNobodyAnything) {
  ASSERT_TRUE(well()) << robot_->complaints();
  const auto asked = robot_->status()->last_request();
  const auto text = errors({"goto", "kichen"});
  EXPECT_TRUE(contains(text, "unknown location \"kichen\", did you mean kitchen?")) << text;
  EXPECT_TRUE(contains(text, "\nlocations: ")) << text;
  EXPECT_TRUE(contains(text, " meeting_room")) << text;
  EXPECT_TRUE(contains(errors({"goto", "kitchen", "--max-speed=2"}),
                       "--max-speed must be at most this robot's "));
  EXPECT_TRUE(contains(errors({"goto", "kitchen", "--max-speed=-1"}, 2), "--max-speed"));
  EXPECT_TRUE(contains(errors({"goto", "--pose", "nan", "0", "0"}, 2), "--pose"));
  EXPECT_TRUE(contains(errors({"goto", "--pose", "1e9", "2", "0"}), "is outside the map of "));
  EXPECT_TRUE(contains(errors({"goto", "kitchen", "--pose", "1", "2", "3"}, 2), "not both"));
  EXPECT_EQ(robot_->status()->last_request(), asked) << "a visit that runs goes on";
}

TEST_F(Commands, LocateTellsTheRobotWhereItStands) {
  ASSERT_TRUE(well()) << robot_->complaints();
  const auto text = output({"locate", "4.6", "4.4", "1.5"});
  EXPECT_TRUE(contains(text, "by its scan it stands at 4.")) << text;
  EXPECT_TRUE(contains(errors({"locate", "-900", "2", "0"}), "(-900.00, 2.00) m is outside"));
}

TEST_F(Commands, AWordThatIsNoCommandIsNamed) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"nosuch"}, {"nosuch", "--domain", "3"}}) {
    std::vector<std::string> all{usher_program()};
    all.insert(all.end(), words.begin(), words.end());
    Process command(all);
    EXPECT_EQ(command.wait(), 2);
    EXPECT_EQ(command.errors(), "usher: unknown command 'nosuch'; see usher --help\n");
  }
}

TEST_F(Commands, GotoDrivesThere) {
  ASSERT_TRUE(well()) << robot_->complaints();
  const auto text = output({"goto", "--pose", "4.5", "5.3", "1.5708"});
  EXPECT_TRUE(contains(text, "arrived\n")) << text;
}

/// Somebody at a keyboard who drives the robot, and a judge at its wheels.
class Driver {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Driver(RunningRobot& robot) : robot_(robot) {
    auto wheels = robot.observer().reader(topics::kSimBaseCommand,
                                          [this](const auto& m, const auto&) { told_ = m.v(); });
    auto truths = robot.observer().reader(
        topics::kSimGroundTruth, [this](const auto& m, const auto&) { speed_ = std::abs(m.v()); });
    assert(wheels && truths);
    wheels_ = std::move(wheels).value();
    truths_ = std::move(truths).value();
  }

  bool sits_down() {
    teleop_ = robot_.command({"teleop"}, terminal_.path());
    return wait_for([&] {
      return terminal_.text().find("standing  pace") != std::string::npos && is_manual();
    });
  }
  /// Holds the key until the robot drives.
  bool drives(const std::string& key) {
    return wait_for([&] {
      terminal_.type(key);
      return speed_ > 0.2;
    });
  }
  /// Until the wheels are told to stand [s].
  double until_zero() {
    const auto since = Clock::now();
    EXPECT_TRUE(wait_for([&] { return told_ == 0.0; }));
    const double took = Seconds(Clock::now() - since).count();
    EXPECT_TRUE(wait_for([&] { return speed_ < 0.02; }));
    return took;
  }
  bool is_manual() const {
    const auto status = robot_.status();
    return status && status->state() == usher_msgs::msg::SupervisorStatus_Constants::STATE_MANUAL;
  }
  Terminal& terminal() { return terminal_; }
  Process& teleop() { return *teleop_; }

 private:
  bool wait_for(const std::function<bool()>& condition) {
    return robot_.wait_for(
        [&] {
          terminal_.text();
          return condition();
        },
        Seconds(20));
  }

  RunningRobot& robot_;
  Terminal terminal_;
  std::unique_ptr<Process> teleop_;
  std::atomic<double> told_{0.0}, speed_{0.0};
  std::optional<runtime::Observer::Reader<usher_sim_msgs::msg::BaseCommand>> wheels_;
  std::optional<runtime::Observer::Reader<usher_sim_msgs::msg::GroundTruth>> truths_;
};

constexpr double kKeyIsHeld = 0.5;    // [s] after its last repeat, unless --hold says otherwise
constexpr double kJoyIsHeard = 0.25;  // [s] after its last sample
constexpr double kZero = 0.2;         // [s] the promise

TEST_F(Commands, TeleopDrivesWhileAKeyIsHeld) {
  ASSERT_TRUE(well()) << robot_->complaints();
  const double slow = slowdown();
  Driver driver(*robot_);
  ASSERT_TRUE(driver.sits_down()) << driver.terminal().text() << driver.teleop().errors();
  ASSERT_TRUE(driver.drives("w")) << driver.terminal().text() << robot_->complaints();
  EXPECT_TRUE(contains(driver.terminal().text(), "driving   pace"));
  EXPECT_LT(driver.until_zero(), kKeyIsHeld + kZero * slow) << "the key was let go";
  ASSERT_TRUE(driver.drives("\033[B")) << "an arrow, and back";
  driver.terminal().type(" ");
  EXPECT_LT(driver.until_zero(), kZero * slow) << "the space bar waits for nothing";
  EXPECT_TRUE(driver.is_manual());
  driver.terminal().type("x");
  EXPECT_EQ(driver.teleop().wait(), 0) << driver.teleop().errors();
  EXPECT_TRUE(robot_->wait_for([&] { return !driver.is_manual(); }, Seconds(5)));
  EXPECT_TRUE(well()) << robot_->complaints();
}

TEST_F(Commands, TeleopWhoseWindowIsClosedLeavesTheRobotStandingAndEndsTheManualMode) {
  ASSERT_TRUE(well()) << robot_->complaints();
  const double slow = slowdown();
  Driver driver(*robot_);
  ASSERT_TRUE(driver.sits_down()) << driver.terminal().text() << driver.teleop().errors();
  ASSERT_TRUE(driver.drives("w")) << driver.terminal().text() << robot_->complaints();
  driver.terminal().close();
  EXPECT_LT(driver.until_zero(), kZero * slow);
  EXPECT_EQ(driver.teleop().wait(), 0) << driver.teleop().errors();
  EXPECT_TRUE(robot_->wait_for([&] { return !driver.is_manual(); }, Seconds(5)));
  EXPECT_TRUE(well()) << robot_->complaints();
}

TEST_F(Commands, TeleopThatIsKilledLeavesTheRobotStanding) {
  ASSERT_TRUE(well()) << robot_->complaints();
  const double slow = slowdown();
  {
    Driver driver(*robot_);
    ASSERT_TRUE(driver.sits_down()) << driver.terminal().text() << driver.teleop().errors();
    ASSERT_TRUE(driver.drives("s")) << driver.terminal().text() << robot_->complaints();
    driver.teleop().signal(SIGKILL);
    EXPECT_LT(driver.until_zero(), kJoyIsHeard + kZero * slow);
    EXPECT_TRUE(driver.is_manual()) << "nobody ended it";
  }
  Driver next(*robot_);
  ASSERT_TRUE(next.sits_down()) << next.terminal().text() << next.teleop().errors();
  next.terminal().type("x");
  EXPECT_EQ(next.teleop().wait(), 0) << next.teleop().errors();
  EXPECT_TRUE(well()) << robot_->complaints();
}

TEST_F(Commands, StopHoldsTheRobotUntilMove) {
  EXPECT_EQ(output({"stop"}), "stopped\n");
  EXPECT_TRUE(robot_->wait_for([] { return !robot_->status()->enable_movement(); }, Seconds(5)));
  const auto status = robot_->command({"status"});
  status->wait();
  EXPECT_TRUE(contains(status->output(), "stands: stopped by ")) << status->output();
  const auto drive = robot_->command({"goto", "--pose", "4.5", "4.5", "1.57", "--no-wait"});
  EXPECT_EQ(drive->wait(std::chrono::seconds(30)), 0) << drive->errors();
  EXPECT_TRUE(contains(drive->output(), "the goal is taken")) << drive->output();
  EXPECT_TRUE(contains(drive->errors(), "stopped by operator; `usher move` lifts that"))
      << drive->errors();
  output({"goto", "--cancel"});
  EXPECT_EQ(output({"move"}), "the stop is lifted\n");
  EXPECT_EQ(output({"move"}), "nobody held a stop\n");
  EXPECT_TRUE(robot_->wait_for([] { return robot_->status()->enable_movement(); }, Seconds(5)));
}

TEST_F(Commands, WithoutADomainTheOnlyRobotOfThisMachineIsMeant) {
  ASSERT_TRUE(well()) << robot_->complaints();
  Process stop({usher_program(), "stop"});
  EXPECT_EQ(stop.wait(), 0) << stop.errors();
  EXPECT_EQ(stop.errors(), "usher: in domain " + std::to_string(robot_->domain()) +
                               ", where the only robot of this machine was launched\n");
  EXPECT_TRUE(robot_->wait_for([] { return !robot_->status()->enable_movement(); }, Seconds(5)));
  Process move({usher_program(), "move"});
  EXPECT_EQ(move.wait(), 0) << move.errors();
}

/// Long before it gives up, after 25 s.
TEST_F(Commands, AStopInAnotherDomainSaysAtOnceWhereTheRobotIs) {
  const auto nowhere = std::to_string((robot_->domain() + 110) % 232);
  const Process stop({usher_program(), "stop", "--domain", nowhere});
  EXPECT_TRUE(robot_->wait_for(
      [&] {
        return contains(stop.errors(), "no robot was launched on this machine in domain " +
                                           nowhere + "; one was in domain " +
                                           std::to_string(robot_->domain()) + " (--domain ");
      },
      Seconds(10)))
      << stop.errors();
}

TEST_F(Commands, AnEmergencyStopEndsAGoto) {
  ASSERT_TRUE(well()) << robot_->complaints();
  const auto drive = robot_->command({"goto", "--pose", "4.5", "3.6", "0.0"});
  EXPECT_TRUE(robot_->wait_for(
      [] {
        return robot_->status()->state() ==
               usher_msgs::msg::SupervisorStatus_Constants::STATE_NAVIGATION_ACTIVE;
      },
      Seconds(20)));
  EXPECT_EQ(output({"stop", "--emergency"}), "emergency stop\n");
  EXPECT_EQ(drive->wait(), 1);
  EXPECT_TRUE(contains(drive->errors(), "the supervisor ended the navigation: "))
      << drive->errors();
  EXPECT_EQ(output({"clear"}), "cleared\n");
  EXPECT_TRUE(well()) << robot_->complaints();
}

TEST_F(Commands, EmergencyStopIsAFaultUntilCleared) {
  EXPECT_EQ(output({"stop", "--emergency"}), "emergency stop\n");
  EXPECT_TRUE(robot_->wait_for([] { return !robot_->status()->granted(); }, Seconds(5)));
  const auto status = robot_->command({"status"});
  EXPECT_EQ(status->wait(), 1);
  EXPECT_TRUE(contains(status->output(), "may not drive: ")) << status->output();
  EXPECT_TRUE(contains(status->output(), "latched fault: ")) << status->output();
  const auto move = robot_->command({"move"});
  EXPECT_EQ(move->wait(), 1);
  EXPECT_TRUE(contains(move->errors(), "the robot stands: emergency stop")) << move->errors();
  EXPECT_EQ(output({"clear"}), "cleared\n");
  EXPECT_TRUE(well()) << robot_->complaints();
  EXPECT_EQ(output({"clear"}), "no fault was latched\n") << "nothing to clear is fine";
}

TEST_F(Commands, GotoThatIsInterruptedIsCancelled) {
  ASSERT_TRUE(well()) << robot_->complaints();
  auto status = robot_->observer().reader(topics::kNavigateStatus);
  ASSERT_TRUE(status);
  std::uint8_t state = 0;
  const auto became = [&](std::uint8_t wanted) {
    return robot_->wait_for(
        [&] {
          while (const auto message = status->take()) state = message->state();
          return state == wanted;
        },
        Seconds(20));
  };
  const auto command = robot_->command({"goto", "kitchen"});
  ASSERT_TRUE(became(usher_msgs::msg::GoalStatus_Constants::STATE_ACTIVE)) << int{state};
  const auto told = robot_->command({"status"});
  told->wait();
  EXPECT_TRUE(contains(told->output(), "\ngoal kitchen of ")) << told->output();
  command->signal(SIGINT);
  EXPECT_EQ(command->wait(), 1);
  EXPECT_EQ(command->errors(), "usher: cancelled\n");
  EXPECT_TRUE(became(usher_msgs::msg::GoalStatus_Constants::STATE_CANCELLED)) << int{state};
}

TEST_F(Commands, AGoalThatNobodyWaitsForIsGivenUpByHand) {
  ASSERT_TRUE(well()) << robot_->complaints();
  EXPECT_EQ(errors({"goto", "--cancel"}), "usher: no goal is under way\n");
  output({"goto", "kitchen", "--no-wait"});
  EXPECT_EQ(output({"goto", "--cancel"}), "the goal kitchen is given up\n");
  EXPECT_EQ(errors({"goto", "--cancel"}), "usher: no goal is under way\n");
  EXPECT_TRUE(robot_->wait_for(
      [] {
        return robot_->status()->state() ==
               usher_msgs::msg::SupervisorStatus_Constants::STATE_INTERACTION;
      },
      Seconds(10)));
  output({"goto", "kitchen", "--no-wait"});
  output({"stop", "--emergency"});
  output({"clear"});
  EXPECT_EQ(errors({"goto", "--cancel"}), "usher: no goal is under way\n")
      << "nobody would have started it again";
  EXPECT_TRUE(well()) << robot_->complaints();
}

TEST_F(Commands, StatusSaysWhyAGoalFailedThatNobodyWaitedFor) {
  ASSERT_TRUE(well()) << robot_->complaints();
  output({"goto", "--pose", "-0.4", "5.0", "0", "--no-wait"});  // outside of the house
  std::string told;
  EXPECT_TRUE(robot_->wait_for(
      [&] {
        const auto status = robot_->command({"status"});
        status->wait();
        told = status->output();
        return contains(told, "\ngoal -0.4 5.0 of operator failed: no path ");
      },
      Seconds(20)))
      << told;
}

TEST_F(Commands, GotoEndsWhenTheLaunchDoes) {
  ASSERT_TRUE(well()) << robot_->complaints();
  const auto command = robot_->command({"goto", "kitchen"});
  ASSERT_TRUE(robot_->wait_for(
      [] {
        return robot_->status()->state() ==
               usher_msgs::msg::SupervisorStatus_Constants::STATE_NAVIGATION_ACTIVE;
      },
      Seconds(20)));
  robot_->wait_for([] { return false; }, Seconds(1));  // the goal is taken
  robot_->launcher().signal(SIGTERM);
  EXPECT_EQ(command->wait(std::chrono::seconds(40)), 1);
  EXPECT_TRUE(contains(command->errors(), "usher: ")) << command->errors();
  robot_->launcher().wait(std::chrono::seconds(30));
  robot_->launch();
  ASSERT_TRUE(robot_->wait_for([] { return robot_->status().has_value(); }, Seconds(60)));
}

TEST_F(Commands, MapSaveWritesTheMapThatTheRobotHas) {
  const auto path = robot_->folder() + "/saved.yaml";
  const auto text = output({"map", "save", path});
  const auto saved = grid::load_map(path);
  const auto original =
      grid::load_map(std::string(USHER_SOURCE_DIR) + "/config/sites/office/map.yaml");
  ASSERT_TRUE(saved) << saved.error();
  ASSERT_TRUE(original) << original.error();
  EXPECT_EQ(saved->width(), original->width());
  EXPECT_EQ(saved->height(), original->height());
  EXPECT_EQ(saved->values(), original->values());
  EXPECT_TRUE(contains(text, path)) << text;
  errors({"map", "save", robot_->folder() + "/none/map.yaml"});
}

TEST_F(Commands, SayWhenThereIsNoRobot) {
  const auto nowhere = std::to_string((robot_->domain() + 110) % 232);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"status"}, {"goto"}, {"goto", "kitchen"}, {"stop"}, {"topics"}}) {
    std::vector<std::string> all{usher_program()};
    all.insert(all.end(), words.begin(), words.end());
    all.insert(all.end(), {"--domain", nowhere});
    Process command(all);
    EXPECT_EQ(command.wait(), 1) << words.front();
    EXPECT_TRUE(contains(command.errors(), "domain")) << words.front() << ": " << command.errors();
  }
}

TEST_F(Commands, GraphIsValidDot) {
  Process graph({usher_program(), "graph", robot_->manifest()});
  ASSERT_EQ(graph.wait(), 0) << graph.errors();
  const std::string dot = graph.output();
  EXPECT_TRUE(dot.starts_with("digraph \"robot\" {\n")) << dot;
  EXPECT_TRUE(dot.ends_with("}\n"));
  EXPECT_EQ(std::count(dot.begin(), dot.end(), '{'), std::count(dot.begin(), dot.end(), '}'));
  EXPECT_EQ(std::count(dot.begin(), dot.end(), '"') % 2, 0);
  EXPECT_TRUE(contains(dot, "\"lms100\" -> \"scan_filter\" [label=\"scan\"];")) << dot;
  EXPECT_TRUE(contains(dot, "label=\"tablet\"")) << dot;
  const auto path = robot_->folder() + "/graph.dot";
  std::ofstream(path) << dot;
  if (!std::filesystem::exists("/usr/bin/dot")) GTEST_SKIP() << "no graphviz: drawn by nobody";
  Process draw({"/usr/bin/dot", "-Tsvg", "-o", robot_->folder() + "/graph.svg", path});
  EXPECT_EQ(draw.wait(), 0) << draw.errors();
}

}  // namespace
}  // namespace usher::test
