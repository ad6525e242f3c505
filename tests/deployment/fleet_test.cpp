// Two meeting assistants as processes, each with a domain of its own and one in common. Whole
// missions of a fleet are tests.simulation.fleet and `usher experiment gather --robots 2`.
#include <gtest/gtest.h>

#include <mutex>

#include "deployment/running_robot.hpp"

namespace usher::test {
namespace {

namespace meeting = usher_msgs::msg::MeetingStatus_Constants;

class FleetRobot {
 public:
  FleetRobot(std::size_t number, const std::string& name, const std::string& start)
      : robot_(test_domain(number), "meeting-fleet-" + name + ".yaml",
               "fleet: {domain: " + std::to_string(test_domain(2)) + ", robot: " + name + start +
                   "}\n"),
        status_(robot_.observer().reader(topics::kMeetingStatus,
                                         [this](const auto& message, const auto&) {
                                           const std::lock_guard lock(mutex_);
                                           last_ = message;
                                         })) {
    EXPECT_TRUE(status_);
  }

  RunningRobot& robot() { return robot_; }
  usher_msgs::msg::MeetingStatus status() const {
    const std::lock_guard lock(mutex_);
    return last_;
  }
  bool is_on_a_mission() const {
    return status().state() >= meeting::STATE_TO_ROOM && status().state() <= meeting::STATE_ARRIVED;
  }
  bool is_ready() const { return status().state() == meeting::STATE_IDLE && robot_.may_drive(); }

 private:
  RunningRobot robot_;
  mutable std::mutex mutex_;
  usher_msgs::msg::MeetingStatus last_;
  Result<runtime::Observer::Reader<usher_msgs::msg::MeetingStatus>> status_;
};

TEST(Fleet, OneIsCalledTheOtherJoinsAndGoesOnAlone) {
  FleetRobot iris(0, "iris", ""), otto(1, "otto", ", start: [2.35, 1.5, 1.5708]");
  ASSERT_TRUE(
      iris.robot().wait_for([&] { return iris.is_ready() && otto.is_ready(); }, Seconds(90)))
      << iris.robot().complaints() << otto.robot().complaints();

  const auto call = iris.robot().command({"meet", "--persons", "2"});
  ASSERT_TRUE(otto.robot().wait_for([&] { return otto.is_on_a_mission(); }, Seconds(60)))
      << call->errors() << otto.robot().complaints();
  EXPECT_TRUE(iris.is_on_a_mission());
  EXPECT_EQ(otto.status().mission().client(), iris.status().mission().client());
  EXPECT_EQ(otto.status().mission().wanted(), 2U);
  const auto does = [](const FleetRobot& one, std::uint8_t state) {
    return one.status().state() == state;
  };
  const auto divided = [&] {
    return (does(iris, meeting::STATE_TO_ROOM) && does(otto, meeting::STATE_EXPLORE)) ||
           (does(otto, meeting::STATE_TO_ROOM) && does(iris, meeting::STATE_EXPLORE));
  };
  ASSERT_TRUE(iris.robot().wait_for(divided, Seconds(30)))
      << "one looks for a room, the other one for people";
  FleetRobot& seeker = does(iris, meeting::STATE_TO_ROOM) ? iris : otto;
  FleetRobot& other = &seeker == &iris ? otto : iris;

  call->signal(SIGKILL);  // so that nobody gives the mission up when its robot ends
  seeker.robot().launcher().signal(SIGTERM);
  seeker.robot().launcher().wait(std::chrono::seconds(10));
  EXPECT_TRUE(
      other.robot().wait_for([&] { return does(other, meeting::STATE_TO_ROOM); }, Seconds(60)))
      << "looks for the room itself";
}

}  // namespace
}  // namespace usher::test
