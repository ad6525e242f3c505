#include "navigation/navigator/shell/component.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <set>

#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::navigator {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using namespace usher_msgs::msg::GoalStatus_Constants;
namespace follow = usher_msgs::msg::FollowGoal_Constants;
namespace command = usher_msgs::msg::SupervisorRequest_Constants;
namespace supervisor_state = usher_msgs::msg::SupervisorStatus_Constants;

constexpr const char* kSite = R"(
site.locations:
  - {name: lab, title: Lab, x: 8 m, y: 0 m, yaw: 0 rad}
)";

/// A robot that stands in map, with planners that answer and a supervisor that lets it drive. Each
/// of its words can be left out.
class Component : public testing::Test {
 protected:
  explicit Component(const std::string& parameters = {})
      : host{runtime::component_factory<NavigatorComponent>("navigator"), kSite + parameters} {}
  bool says(const std::string& topic) const { return !silent.contains(topic); }
  void say_where_it_is() {
    tf2_msgs::msg::TFMessage moving;
    moving.transforms().push_back(
        wire::transform(host.now(), frames::kOdom, frames::kBaseFootprint, geometry::Pose3{}));
    moving.transforms().push_back(
        wire::transform(host.now(), frames::kMap, frames::kOdom, geometry::Pose3{}));
    if (says("tf")) host.publish(topics::kTf, moving);
    usher_msgs::msg::LocalizationStatus localization;
    localization.header(wire::header(host.now(), frames::kMap));
    localization.state(localization_state);
    if (says("localization")) host.publish(topics::kLocalizationStatus, localization);
    nav_msgs::msg::Odometry odom;
    odom.header(wire::header(host.now(), frames::kOdom));
    odom.pose().pose(wire::to_message(geometry::Pose2{}));
    if (says("odom")) host.publish(topics::kOdom, odom);
    usher_msgs::msg::Whiskers whiskers;
    whiskers.header(wire::header(host.now(), frames::kBaseLink));
    if (says("whiskers")) host.publish(topics::kWhiskers, whiskers);
  }
  void say_who_is_there() {
    usher_msgs::msg::SupervisorStatus supervisor;
    supervisor.header(wire::header(host.now(), ""));
    supervisor.granted(granted);
    supervisor.reason(granted ? "" : "stopped by operator");
    supervisor.enable_movement(stopped_by.empty());
    supervisor.stopped_by(stopped_by);
    supervisor.state(behavior);
    if (const auto asked = host.last(topics::kSupervisorRequest); asked && answers) {
      supervisor.last_request(asked->id());
      supervisor.last_request_client(answered_client);
      supervisor.last_request_done(refusal.empty());
      supervisor.last_request_reason(refusal);
      if (refusal.empty() && asked->id() != answered) current_goal = asked->goal();
      answered = asked->id();
    }
    supervisor.current_goal(current_goal);
    if (says("supervisor")) host.publish(topics::kSupervisorStatus, supervisor);
    usher_msgs::msg::People people;
    people.header(wire::header(host.now(), frames::kOdom));
    for (const geometry::Point2& at : persons) {
      auto& person = people.people().emplace_back();
      person.x(at.x());
      person.y(at.y());
    }
    if (says("people")) host.publish(topics::kPeople, people);
  }
  void answer() {
    const auto request = host.last(topics::kPlanRequest);
    if (says("plan/reply") && request && request->id() != planned) {
      planned = request->id();
      usher_msgs::msg::PlanReply reply;
      reply.id(planned);
      reply.state(STATE_SUCCEEDED);
      const geometry::Pose2 path[] = {{0, 0, 0}, {4, 0, 0}, {8, 0, 0}};
      reply.path(wire::to_message(host.now(), frames::kMap, path));
      host.publish(topics::kPlanReply, reply, "global_planner");
    }
    if (const auto told = host.last(topics::kFollowGoal)) task = told;
    usher_msgs::msg::FollowStatus status;
    status.header(wire::header(host.now(), frames::kOdom));
    if (task) status.id(task->id());
    const bool path = task && task->mode() == follow::MODE_PATH;
    status.state(!path ? STATE_SUCCEEDED : blocked ? STATE_WAITING : STATE_ACTIVE);
    status.obstacle_distance(std::numeric_limits<float>::infinity());
    if (says("follow/status")) host.publish(topics::kFollowStatus, status);
  }
  void run(int ms) {
    for (int at = 0; at < ms; at += 50) {
      say_where_it_is();
      say_who_is_there();
      answer();
      host.run_for(milliseconds(50));
    }
  }
  void request(std::uint64_t id, const std::string& location, const std::string& client = "guide") {
    usher_msgs::msg::NavigateGoal goal;
    goal.id(id);
    goal.client(client);
    goal.location(location);
    host.publish(topics::kNavigateGoal, goal, client);
  }
  void drive() {
    host.publish(topics::kPlanReply, {}, "global_planner");
    run(500);
    request(1, "lab");
    run(500);
    ASSERT_EQ(status().state(), STATE_ACTIVE) << status().reason();
    ASSERT_EQ(motion(), follow::MODE_PATH);
  }
  usher_msgs::msg::NavigateStatus status() const {
    return host.last(topics::kNavigateStatus).value();
  }
  std::uint8_t motion() const { return task->mode(); }
  std::size_t plans() const {
    std::set<std::uint64_t> ids;
    for (const auto& request : host.written(topics::kPlanRequest)) ids.insert(request.id());
    return ids.size();
  }
  std::set<std::uint8_t> motions() const {
    std::set<std::uint8_t> modes;
    for (const auto& goal : host.written(topics::kFollowGoal)) modes.insert(goal.mode());
    return modes;
  }
  /// How long the first status of this goal and state stood before another took its place; -1:
  /// there was none. A reader that keeps the newest only has that long to hear it.
  double stood(std::uint64_t id, std::uint8_t state) const {
    const auto all = host.written(topics::kNavigateStatus);
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
      if (all[i].id() != id || all[i].state() != state) continue;
      return runtime::seconds(wire::from_message(all[i + 1].header().stamp()) -
                              wire::from_message(all[i].header().stamp()));
    }
    return -1.0;
  }

  runtime::TestHost host;
  std::set<std::string> silent;
  std::uint8_t localization_state = usher_msgs::msg::LocalizationStatus_Constants::STATE_GOOD;
  std::vector<geometry::Point2> persons;
  bool granted = true, blocked = false, answers = true;
  std::vector<std::string> stopped_by;  ///< whose stops hold
  std::uint8_t behavior = supervisor_state::STATE_NAVIGATION_ACTIVE;
  std::string current_goal, refusal, answered_client = "navigator";
  std::uint64_t answered = 0;
  std::uint64_t planned = 0;
  std::optional<usher_msgs::msg::FollowGoal> task;  ///< that the follower was told last
};

TEST_F(Component, DrivesToALocation) {
  drive();
  EXPECT_EQ(host.last(topics::kFollowGoal)->path().poses().size(), 3U);
  EXPECT_EQ(status().location(), "lab");
  EXPECT_EQ(host.heartbeat().reason(), "");
}

/// What becomes of a robot on its way that loses this input, and gets it back.
struct Loss {
  const char* name;
  const char* topic;
  const char* reason;
};

class Losing : public Component, public testing::WithParamInterface<Loss> {};

TEST_P(Losing, ItPausesAndGoesOn) {
  drive();
  silent.insert(GetParam().topic);
  run(1500);
  EXPECT_EQ(motion(), follow::MODE_STOP);
  EXPECT_EQ(status().state(), STATE_WAITING);
  EXPECT_EQ(status().reason(), GetParam().reason);
  run(10000);
  EXPECT_EQ(status().state(), STATE_WAITING) << "it is patient";
  silent.clear();
  run(1000);
  EXPECT_EQ(motion(), follow::MODE_PATH);
  EXPECT_EQ(status().state(), STATE_ACTIVE) << status().reason();
  EXPECT_EQ(plans(), 2U) << "by a new path";
}

TEST_P(Losing, ItFailsAfterAWhileAndSaysWhy) {
  drive();
  silent.insert(GetParam().topic);
  const bool held = std::string(GetParam().topic) == "supervisor";
  const int patience = held ? 300 : 60;
  run((patience + 2) * 1000);
  EXPECT_EQ(status().state(), STATE_FAILED);
  EXPECT_EQ(status().reason(), GetParam().reason + (" for " + std::to_string(patience)) + " s");
}

INSTANTIATE_TEST_SUITE_P(
    Component, Losing,
    testing::Values(Loss{"Pose", "tf", "robot not localized"},
                    Loss{"Localization", "localization", "robot not localized"},
                    Loss{"Odometry", "odom", "no word from the odometry"},
                    Loss{"LocalPlanner", "follow/status", "no word from the local planner"},
                    Loss{"Supervisor", "supervisor", "no supervisor"}),
    [](const auto& loss) { return std::string(loss.param.name); });

TEST_F(Component, AStateOfTheLocalizationThatIsNoneCountsAsLost) {
  drive();
  localization_state = usher_msgs::msg::LocalizationStatus_Constants::STATE_GOOD + 1;
  run(300);
  EXPECT_EQ(motion(), follow::MODE_STOP);
  EXPECT_EQ(status().reason(), "robot not localized");
}

TEST_F(Component, StandsWhileItMayNotDriveAndSaysWhoHoldsIt) {
  drive();
  granted = false;
  run(300);
  EXPECT_EQ(motion(), follow::MODE_STOP);
  EXPECT_EQ(status().reason(), "stopped by operator");
  granted = true;
  run(1000);
  EXPECT_EQ(motion(), follow::MODE_PATH);
}

TEST_F(Component, GivesAnOperatorsGoalUpWithTheNavigation) {
  const std::pair<std::uint8_t, std::string> ends[] = {
      {supervisor_state::STATE_FAULT, "stopped by operator"},
      {supervisor_state::STATE_MANUAL, "driven by hand"}};
  drive();
  std::uint64_t id = 1;
  for (const auto& [end, why] : ends) {
    request(++id, "lab", "operator");
    run(500);
    ASSERT_EQ(motion(), follow::MODE_PATH) << status().reason();
    granted = false;
    behavior = end;
    run(300);
    EXPECT_EQ(status().state(), STATE_CANCELLED);
    EXPECT_EQ(status().reason(), "the supervisor ended the navigation: " + why);
    granted = true;
    behavior = supervisor_state::STATE_NAVIGATION_ACTIVE;
    host.clear();
    run(500);
    EXPECT_FALSE(motions().contains(follow::MODE_PATH)) << "it would drive at another one's start";
  }
}

TEST_F(Component, GivesAnOperatorsGoalUpWhoseNavigationNobodyStartsAgain) {
  drive();
  request(2, "lab", "operator");
  run(500);
  behavior = supervisor_state::STATE_INTERACTION;
  run(2500);
  EXPECT_EQ(status().state(), STATE_WAITING) << "he starts it again after the supervisor's restart";
  behavior = supervisor_state::STATE_NAVIGATION_ACTIVE;
  run(500);
  EXPECT_EQ(motion(), follow::MODE_PATH);
  behavior = supervisor_state::STATE_INTERACTION;
  run(3500);
  EXPECT_EQ(status().state(), STATE_CANCELLED);
  EXPECT_EQ(status().reason(), "the supervisor ended the navigation");
}

TEST_F(Component, LeavesOthersTheirGoalsInAFault) {
  drive();
  granted = false;
  behavior = supervisor_state::STATE_FAULT;
  run(300);
  EXPECT_EQ(status().state(), STATE_WAITING) << "the guide gives it up itself";
}

TEST_F(Component, StandsWhileAStopHoldsAndSaysWhose) {
  drive();
  stopped_by = {"guide"};
  run(300);
  EXPECT_EQ(motion(), follow::MODE_STOP);
  EXPECT_EQ(status().reason(), "stopped by guide");
  stopped_by.clear();
  run(1000);
  EXPECT_EQ(motion(), follow::MODE_PATH);
}

TEST_F(Component, WaitsForPlannersAndSaysForWhich) {
  request(1, "lab");
  silent = {"plan/reply", "follow/status"};
  run(500);
  EXPECT_EQ(status().state(), STATE_WAITING);
  EXPECT_EQ(status().reason(), "no word from the global planner yet");
  EXPECT_EQ(host.heartbeat().reason(), "waits for the planners");
  host.publish(topics::kPlanReply, {}, "global_planner");
  run(500);
  EXPECT_EQ(status().reason(), "no word from the local planner yet");
  run(31000);
  EXPECT_EQ(status().state(), STATE_FAILED);
  EXPECT_EQ(status().reason(), "no word from the local planner for 30 s");
}

TEST_F(Component, DrivesOnAlongItsPathWithoutTheGlobalPlanner) {
  drive();
  silent.insert("plan/reply");
  host.world().leave("global_planner");
  run(8000);
  EXPECT_EQ(motion(), follow::MODE_PATH);
  EXPECT_EQ(status().state(), STATE_ACTIVE) << status().reason();
  blocked = true;  // now it needs a new one
  run(15000);
  EXPECT_EQ(motion(), follow::MODE_STOP);
  EXPECT_EQ(status().reason(), "no word from the global planner");
}

TEST_F(Component, BacksOffOnlyWhileItsWhiskersFeel) {
  for (const bool feels : {true, false}) {
    SCOPED_TRACE(feels);
    silent.clear();
    blocked = false;
    if (!feels) silent.insert("whiskers");
    drive();
    host.clear();
    blocked = true;
    run(60000);
    EXPECT_EQ(motions().contains(follow::MODE_BACK_OFF), feels);
    EXPECT_TRUE(motions().contains(follow::MODE_ROTATE));
    usher_msgs::msg::GoalCancel cancel;
    host.publish(topics::kNavigateCancel, cancel);
    host.world().kill(host.name());
    host.clear();
    host.world().start(host.name());
  }
}

class WithoutWhiskers : public Component {
 protected:
  WithoutWhiskers() : Component("unfelt_trail: 0.5 m\n") {}
};

TEST_F(WithoutWhiskers, BacksOffAsFarAsItsTrailIsTakenForFree) {
  silent.insert("whiskers");
  drive();
  host.clear();
  blocked = true;
  run(60000);
  EXPECT_TRUE(motions().contains(follow::MODE_BACK_OFF));
}

TEST_F(Component, WaitsLongerForSomebodyThanForAThing) {
  const struct {
    const char* what;
    std::vector<geometry::Point2> persons;
    bool detector;
    double wait;  // [s] before it plans round
  } table[] = {{"a thing", {}, true, 2.0},
               {"somebody on the path", {{1.5, 0.3}}, true, 8.0},
               {"somebody beside it", {{1.5, 2.0}}, true, 2.0},
               {"somebody behind", {{-2.0, 0.0}}, true, 2.0},
               {"somebody far ahead", {{5.0, 0.0}}, true, 2.0},
               {"nobody says who", {{1.5, 0.3}}, false, 2.0}};
  std::uint64_t id = 10;
  for (const auto& row : table) {
    SCOPED_TRACE(row.what);
    blocked = false;
    silent.clear();
    if (!row.detector) silent.insert("people");
    persons = row.persons;
    host.publish(topics::kPlanReply, {}, "global_planner");
    run(500);
    request(++id, "lab");
    run(500);
    ASSERT_EQ(motion(), follow::MODE_PATH);
    host.clear();
    blocked = true;
    run(static_cast<int>(row.wait * 1000) - 300);
    EXPECT_EQ(plans(), 0U);
    run(600);
    EXPECT_EQ(plans(), 1U);
  }
}

TEST_F(Component, BelievesNobodyWhoWasLastSeenLongAgoOrIsNowhere) {
  drive();
  host.clear();
  blocked = true;
  for (int i = 0; i < 50; ++i) {
    usher_msgs::msg::People people;
    people.header(wire::header(host.now(), frames::kOdom));
    auto& gone = people.people().emplace_back();
    gone.x(1.5);
    gone.unseen(3.0F);
    auto& nowhere = people.people().emplace_back();
    nowhere.x(std::numeric_limits<double>::quiet_NaN());
    silent.insert("people");
    host.publish(topics::kPeople, people);
    run(50);
  }
  EXPECT_EQ(plans(), 1U);
}

// --- What is said to whom

TEST_F(Component, ARefusedForeignGoalIsAnsweredAndDisturbsNothing) {
  drive();
  host.clear();
  request(99, "labb", "operator");
  run(1000);
  EXPECT_GE(stood(99, STATE_FAILED), 0.08);
  EXPECT_EQ(status().id(), 1U);
  EXPECT_EQ(status().state(), STATE_ACTIVE);
  EXPECT_TRUE(host.written(topics::kFollowGoal).empty()) << "the robot drives on";
  for (const auto& said : host.written(topics::kNavigateStatus)) {
    if (said.id() != 99) continue;
    EXPECT_THAT(said.reason(), HasSubstr("lab"));
  }
}

TEST_F(Component, AFloodOfRefusedGoalsDoesNotDrownTheOneThatRuns) {
  drive();
  host.clear();
  for (std::uint64_t id = 100; id < 400; ++id) {
    request(id, "nowhere", "operator");
    run(50);
  }
  std::size_t ours = 0;
  for (const auto& said : host.written(topics::kNavigateStatus)) ours += said.id() == 1 ? 1 : 0;
  EXPECT_GE(ours, 60U) << "5 Hz or nearly so, for 15 s";
  run(3000);
  EXPECT_EQ(status().id(), 1U) << "and what waits to be said has a bound";
}

TEST_F(Component, AReplacedGoalAndItsSuccessorAreBothTold) {
  drive();
  host.clear();
  request(2, "lab", "operator");
  run(1000);
  EXPECT_GE(stood(1, STATE_REPLACED), 0.08);
  EXPECT_EQ(status().id(), 2U);
  EXPECT_EQ(status().state(), STATE_ACTIVE);
}

TEST_F(Component, AnOutcomeIsToldThoughAnotherGoalComesAtOnce) {
  drive();
  host.clear();
  usher_msgs::msg::GoalCancel cancel;
  cancel.id(1);
  cancel.client("guide");
  host.publish(topics::kNavigateCancel, cancel, "guide");
  host.run_for(milliseconds(1));
  request(2, "nowhere", "operator");
  host.run_for(milliseconds(1));
  request(3, "lab", "guide");
  run(1000);
  EXPECT_GE(stood(1, STATE_CANCELLED), 0.08);
  EXPECT_GE(stood(2, STATE_FAILED), 0.08);
  EXPECT_EQ(status().id(), 3U);
  EXPECT_EQ(status().state(), STATE_ACTIVE);
}

TEST_F(Component, IsHeardFiveTimesASecondWhateverItDoes) {
  run(1000);
  host.clear();
  run(2000);
  EXPECT_GE(host.written(topics::kNavigateStatus).size(), 9U) << "without a goal";
  drive();
  host.clear();
  run(2000);
  EXPECT_GE(host.written(topics::kNavigateStatus).size(), 9U) << "with one";
}

// --- Goals from rviz

class ViewerGoal : public Component {
 protected:
  ViewerGoal() {
    behavior = supervisor_state::STATE_INTERACTION;
    host.publish(topics::kPlanReply, {}, "global_planner");
    run(500);
  }
  void click(double x = 8) {
    geometry_msgs::msg::PoseStamped goal;
    goal.header(wire::header(host.now(), frames::kMap));
    goal.pose(wire::to_message(geometry::Pose2{x, 0, 0}));
    host.publish(topics::kGoalPose, goal, "rviz");
  }
  std::string reason_of(std::uint8_t outcome) const {
    for (const auto& each : host.written(topics::kNavigateStatus)) {
      if (each.client() == "goal_pose" && each.state() == outcome) return each.reason();
    }
    return "nothing";
  }
  /// The guide's visitor is ready: so far no goal of the guide's came.
  void guide_sets_out() {
    behavior = supervisor_state::STATE_NAVIGATION_START;
    current_goal = "lab";
    run(200);
    behavior = supervisor_state::STATE_NAVIGATION_ACTIVE;
    host.clear();
    run(1000);
  }
};

TEST_F(ViewerGoal, IsDrivenToOnceTheSupervisorNavigatesForIt) {
  click();
  host.run_for(milliseconds(50));
  const auto first = host.last(topics::kSupervisorRequest);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->command(), command::COMMAND_NAVIGATION_START);
  EXPECT_EQ(first->goal(), "goal_pose");
  EXPECT_EQ(plans(), 0U) << "nobody has answered";
  run(50);
  EXPECT_EQ(host.last(topics::kSupervisorRequest)->command(), command::COMMAND_NAVIGATION_GO);
  EXPECT_EQ(plans(), 0U);
  behavior = supervisor_state::STATE_NAVIGATION_ACTIVE;
  run(500);
  EXPECT_EQ(status().client(), "goal_pose");
  EXPECT_EQ(status().state(), STATE_ACTIVE) << status().reason();
  EXPECT_EQ(motion(), follow::MODE_PATH);
}

TEST_F(ViewerGoal, DoesNotWaitForANavigationOfSomebodyElse) {
  refusal = "an operator drives";
  click();
  run(500);
  EXPECT_EQ(reason_of(STATE_FAILED), "an operator drives");
  guide_sets_out();
  EXPECT_FALSE(motions().contains(follow::MODE_PATH));
  EXPECT_EQ(plans(), 0U);
}

TEST_F(ViewerGoal, AnAnswerToAnotherClientIsNone) {
  answered_client = "guide";
  click();
  run(500);
  EXPECT_EQ(host.last(topics::kSupervisorRequest)->command(), command::COMMAND_NAVIGATION_START);
  EXPECT_EQ(plans(), 0U);
}

TEST_F(ViewerGoal, IsReplacedByANewerOneWithALastWord) {
  answers = false;
  click();
  run(500);
  EXPECT_EQ(reason_of(STATE_FAILED), "nothing");
  const auto first = host.last(topics::kSupervisorRequest)->id();
  click(4);
  run(200);
  EXPECT_EQ(reason_of(STATE_FAILED), "replaced by a newer goal");
  answers = true;
  behavior = supervisor_state::STATE_NAVIGATION_ACTIVE;
  run(700);
  EXPECT_GT(host.last(topics::kSupervisorRequest)->id(), first);
  EXPECT_EQ(status().state(), STATE_ACTIVE) << status().reason();
  EXPECT_EQ(status().goal().pose().position().x(), 4.0);
}

TEST_F(ViewerGoal, EndsWhenTheSupervisorNavigatesForAnother) {
  click();
  run(200);
  behavior = supervisor_state::STATE_NAVIGATION_ACTIVE;
  run(500);
  ASSERT_EQ(motion(), follow::MODE_PATH);
  guide_sets_out();
  EXPECT_FALSE(motions().contains(follow::MODE_PATH));
  EXPECT_EQ(reason_of(STATE_CANCELLED), "another goal took its place");
}

TEST_F(ViewerGoal, EndsWithTheNavigation) {
  click();
  run(200);
  behavior = supervisor_state::STATE_NAVIGATION_ACTIVE;
  run(500);
  ASSERT_EQ(motion(), follow::MODE_PATH);
  behavior = supervisor_state::STATE_MANUAL;
  current_goal.clear();
  run(500);
  EXPECT_EQ(reason_of(STATE_CANCELLED), "the supervisor ended the navigation");
  guide_sets_out();
  EXPECT_FALSE(motions().contains(follow::MODE_PATH));
}

TEST_F(ViewerGoal, IsGivenUpWhenTheSupervisorDoesNotAnswer) {
  answers = false;
  click();
  run(2900);
  EXPECT_EQ(reason_of(STATE_FAILED), "nothing");
  run(500);
  EXPECT_EQ(reason_of(STATE_FAILED), "the supervisor did not answer within 3 s");
  host.clear();
  run(1000);
  EXPECT_TRUE(host.written(topics::kSupervisorRequest).empty());
}

TEST_F(Component, RejectsAndCountsNonsense) {
  drive();
  host.clear();
  geometry_msgs::msg::PoseStamped nowhere;
  nowhere.header(wire::header(host.now(), frames::kOdom));
  nowhere.pose(wire::to_message(geometry::Pose2{}));
  host.publish(topics::kGoalPose, nowhere);
  usher_msgs::msg::NavigateGoal goal;
  goal.id(7);
  goal.client("operator");
  goal.pose().header().frame_id(frames::kMap);
  goal.pose().pose().position().x(std::numeric_limits<double>::quiet_NaN());
  host.publish(topics::kNavigateGoal, goal);
  nav_msgs::msg::Odometry odom;
  odom.header(wire::header(host.now(), frames::kOdom));
  odom.twist().twist().linear().x(std::numeric_limits<double>::quiet_NaN());
  host.publish(topics::kOdom, odom);
  host.run_for(milliseconds(1));
  run(1500);
  EXPECT_GE(host.counter("inputs: rejected"), 2U);
  EXPECT_GE(stood(7, STATE_FAILED), 0.08);
  EXPECT_EQ(status().id(), 1U);
  EXPECT_TRUE(host.written(topics::kFollowGoal).empty()) << "the robot drives on";
}

TEST_F(Component, ForgetsAPaceThatNobodySaysAnyMore) {
  drive();
  const auto own = task->max_speed();
  usher_msgs::msg::NavigatePace pace;
  pace.id(1);
  pace.client("guide");
  pace.max_speed(0.4F);
  for (int i = 0; i < 15; ++i) {
    host.publish(topics::kNavigatePace, pace, "guide");
    run(200);
    ASSERT_EQ(task->max_speed(), 0.4F);
  }
  run(700);
  EXPECT_EQ(task->max_speed(), 0.4F);
  run(400);
  EXPECT_EQ(task->max_speed(), own);
}

}  // namespace
}  // namespace usher::navigator
