// The meeting assistant as processes, called and sent home as an operator would do it. The whole
// mission is `deployment.demo`.
#include <gmock/gmock.h>

#include <atomic>
#include <cmath>

#include "deployment/running_robot.hpp"

namespace usher::test {
namespace {

using testing::HasSubstr;
using testing::Not;
namespace meeting = usher_msgs::msg::MeetingStatus_Constants;

TEST(Meeting, IsCalledByAnOperatorAndGivenUp) {
  RunningRobot robot(false, "meeting-demo.yaml");
  std::atomic<std::uint8_t> state{0};
  std::atomic<double> driven{0.0};
  const auto status = robot.observer().reader(
      topics::kMeetingStatus, [&](const auto& message, const auto&) { state = message.state(); });
  const auto truth =
      robot.observer().reader(topics::kSimGroundTruth, [&](const auto& message, const auto&) {
        const auto& at = message.pose().position();
        driven = std::hypot(at.x() - 1.5, at.y() - 1.5);  // from the site's initial pose
      });
  ASSERT_TRUE(status && truth);
  ASSERT_TRUE(robot.wait_for([&] { return state == meeting::STATE_IDLE && robot.may_drive(); },
                             Seconds(60)))
      << robot.complaints();

  const auto call = robot.command({"meet", "--persons", "2"});
  ASSERT_TRUE(robot.wait_for([&] { return driven > 0.5; }, Seconds(60)))
      << call->output() << call->errors() << robot.complaints();
  EXPECT_EQ(state, meeting::STATE_TO_ROOM);
  const auto second = robot.command({"meet"});
  EXPECT_EQ(second->wait(), 1);
  EXPECT_THAT(second->errors(), HasSubstr("is not over"));

  EXPECT_THAT(second->errors(), HasSubstr("'operator' called"));
  EXPECT_THAT(call->output(), Not(HasSubstr("refused"))) << "that was the other one's";

  call->signal(SIGINT);
  EXPECT_EQ(call->wait(), 1);
  EXPECT_THAT(call->errors(), HasSubstr("gave it up"));
  EXPECT_THAT(call->output(), HasSubstr("drives to a meeting room, 0 of 2 there"));
  EXPECT_TRUE(robot.wait_for([&] { return state == meeting::STATE_IDLE; }, Seconds(30)));

  EXPECT_EQ(robot.command({"meet", "--no-wait"})->wait(), 0);
  const auto cancel = robot.command({"meet", "--cancel"});
  EXPECT_EQ(cancel->wait(), 0) << cancel->errors();
  EXPECT_THAT(cancel->output(), HasSubstr("has ended"));
  const auto again = robot.command({"meet", "--cancel"});
  EXPECT_EQ(again->wait(), 0);
  EXPECT_THAT(again->output(), HasSubstr("no meeting is called"));
}

TEST(Meeting, WithoutAnAssistantIsAnError) {
  RunningRobot robot;
  ASSERT_TRUE(robot.wait_for([&] { return robot.status().has_value(); }, Seconds(60)));
  const auto call = robot.command({"meet"});
  EXPECT_EQ(call->wait(), 1);
  EXPECT_THAT(call->errors(), HasSubstr("no meeting assistant in domain"));
}

}  // namespace
}  // namespace usher::test
