#include "wire/plan_server.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::wire {
namespace {

using geometry::Pose2;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using namespace usher_msgs::msg::GoalStatus_Constants;

/// Goes straight to wherever; why not, in `refusal`.
class Straight final : public runtime::Component {
 public:
  explicit Straight(runtime::Host& host)
      : server_(host, [](const Pose2& start, const Pose2& goal) -> Result<PlannedPath> {
          if (!refusal.empty()) return Error{refusal};
          return PlannedPath{{start, goal}, geometry::distance(start, goal)};
        }) {}
  static std::string refusal;

 private:
  PlanServer server_;
};
std::string Straight::refusal;

class Plans : public testing::Test {
 protected:
  void SetUp() override { Straight::refusal.clear(); }
  static usher_msgs::msg::PlanRequest request(std::uint64_t id, const Pose2& goal) {
    usher_msgs::msg::PlanRequest message;
    message.id(id);
    message.client("navigator");
    message.start().header().frame_id(frames::kMap);
    message.start().pose(to_message(Pose2{1, 1, 0}));
    message.goal().header().frame_id(frames::kMap);
    message.goal().pose(to_message(goal));
    return message;
  }
  usher_msgs::msg::PlanReply ask(const usher_msgs::msg::PlanRequest& message) {
    host.publish(topics::kPlanRequest, message);
    host.run_for(std::chrono::milliseconds(5));
    return host.last(topics::kPlanReply).value();
  }
  std::uint64_t counted(const std::string& what) {
    host.run_for(std::chrono::milliseconds(110));  // for a heartbeat
    return host.counter(what);
  }

  runtime::TestHost host{runtime::component_factory<Straight>("straight")};
};

TEST_F(Plans, AreRepliedAndShown) {
  const auto reply = ask(request(7, {9, 1, 0.5}));
  EXPECT_EQ(reply.id(), 7U);
  EXPECT_EQ(reply.state(), STATE_SUCCEEDED);
  EXPECT_EQ(reply.reason(), "");
  EXPECT_FLOAT_EQ(reply.length(), 8.0F);
  EXPECT_EQ(reply.path().header().frame_id(), frames::kMap);
  EXPECT_THAT(reply.path().poses(), SizeIs(2));
  EXPECT_EQ(host.last(topics::kPlan), reply.path());
}

TEST_F(Plans, SayWhyThereIsNone) {
  ask(request(1, {9, 1, 0}));
  Straight::refusal = "a wall";
  const auto reply = ask(request(2, {9, 1, 0}));
  EXPECT_EQ(reply.state(), STATE_FAILED);
  EXPECT_EQ(reply.reason(), "a wall");
  EXPECT_EQ(reply.length(), 0.0F);
  EXPECT_THAT(reply.path().poses(), IsEmpty());
  EXPECT_THAT(host.last(topics::kPlan)->poses(), IsEmpty()) << "who looks on sees that, too";
  EXPECT_EQ(counted("plans"), 2U);
  EXPECT_EQ(counted("plans: failed"), 1U);
}

TEST_F(Plans, RefusePosesThatAreNone) {
  auto nowhere = request(1, {9, 1, 0});
  nowhere.goal().pose().position().x(std::numeric_limits<double>::infinity());
  EXPECT_THAT(ask(nowhere).reason(), HasSubstr("start or goal is no pose"));
  auto no_start = request(2, {9, 1, 0});
  no_start.start().pose().position().y(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(ask(no_start).reason(), HasSubstr("start or goal is no pose"));
  auto elsewhere = request(3, {9, 1, 0});
  elsewhere.start().header().frame_id(frames::kOdom);
  EXPECT_EQ(ask(elsewhere).reason(), "start and goal must be in the frame map");
  elsewhere = request(4, {9, 1, 0});
  elsewhere.goal().header().frame_id(frames::kOdom);
  EXPECT_EQ(ask(elsewhere).reason(), "start and goal must be in the frame map");
  EXPECT_EQ(counted("plans: failed"), 4U);
}

TEST_F(Plans, OfARepeatedRequestAreMadeOnce) {
  const auto message = request(1, {9, 1, 0});
  const auto first = ask(message);
  Straight::refusal = "something stands there now";
  EXPECT_EQ(ask(message), first);
  EXPECT_THAT(host.written(topics::kPlanReply), SizeIs(2));
  EXPECT_THAT(host.written(topics::kPlan), SizeIs(1));
  EXPECT_EQ(counted("plans"), 1U);
  EXPECT_EQ(ask(request(0, {9, 1, 0})).state(), STATE_FAILED);
  Straight::refusal.clear();
  EXPECT_EQ(ask(request(0, {9, 1, 0})).state(), STATE_SUCCEEDED) << "0 is no id";
}

TEST_F(Plans, OfTwoClientsWithOneIdAreTheirOwn) {
  auto theirs = request(1, {1, 3, 0});
  theirs.client("somebody else");
  EXPECT_FLOAT_EQ(ask(request(1, {9, 1, 0})).length(), 8.0F);
  EXPECT_FLOAT_EQ(ask(theirs).length(), 2.0F);
  EXPECT_FLOAT_EQ(ask(request(1, {9, 1, 0})).length(), 8.0F);
}

}  // namespace
}  // namespace usher::wire
