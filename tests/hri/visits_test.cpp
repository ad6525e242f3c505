// A thousand seeded visits in lock-step: guide and simulated visitor as they are, between a robot
// that drives along a line, is blocked, forgets and fails. Each visit ends in a success, politely,
// or in a safe wait; nobody is left behind.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>

#include "foundation/random/random.hpp"
#include "runtime/lockstep/lockstep_world.hpp"
#include "runtime/testing/test_host.hpp"
#include "simulation/visitor/shell/component.hpp"
#include "tasks/guide/shell/component.hpp"

namespace usher {
namespace {

using runtime::LockstepWorld;
using std::chrono::milliseconds;
using std::chrono::seconds;
namespace goal_state = usher_msgs::msg::GoalStatus_Constants;
namespace command = usher_msgs::msg::SupervisorRequest_Constants;
namespace state = usher_msgs::msg::SupervisorStatus_Constants;
namespace presence = usher_msgs::msg::Visitor_Constants;

constexpr double kStep = 0.1;  ///< [s]

struct Trouble {
  double blocked_at = 1e9, blocked_for = 0.0;  ///< [s] after a goal
  double fails_at = 1e9;
  double forgets_at = 1e9;  ///< the navigator is restarted
  double fault_at = 1e9;
  bool sees_people = true;
};

/// Supervisor, navigator, people detector and the bodies of robot and visitor, on one line.
class Robot final : public runtime::Component {
 public:
  struct Truth {
    double robot = 0.0, speed = 0.0, visitor = 1.4;  ///< [m], [m/s]; the robot faces the visitor
    double largest_gap = 0.0;  ///< [m] behind a moving robot that does not wait
    bool stopped = false;
  };

  Robot(runtime::Host& host, const Trouble& trouble, Truth& truth)
      : host_(host), trouble_(trouble), truth_(truth) {
    request_ = host.input(topics::kSupervisorRequest, {.optional = true},
                          [this](const auto& request, const auto&) { take(request); });
    goal_ = host.input(topics::kNavigateGoal, {.optional = true},
                       [this](const auto& goal, const auto&) {
                         if (goal.id() == goal_id_) return;
                         goal_id_ = goal.id();
                         result_ = goal_state::STATE_ACTIVE;
                         end_ = truth_.robot + 25.0;
                         since_goal_ = 0.0;
                         pace_ = goal.max_speed();
                       });
    cancel_ = host.input(topics::kNavigateCancel, {.optional = true},
                         [this](const auto& cancel, const auto&) {
                           if (cancel.id() == goal_id_) result_ = goal_state::STATE_CANCELLED;
                         });
    pace_input_ = host.input(topics::kNavigatePace, {.optional = true},
                             [this](const auto& pace, const auto&) {
                               if (pace.id() == goal_id_) pace_ = pace.max_speed();
                             });
    walk_ = host.input(topics::kSimPersonGoal, {.optional = true},
                       [this](const auto& walk, const auto&) {
                         follows_ = walk.follow();
                         walks_ = walk.speed();
                       });
    supervisor_ = host.output(topics::kSupervisorStatus);
    navigation_ = host.output(topics::kNavigateStatus);
    follow_ = host.output(topics::kFollowStatus);
    visitor_ = host.output(topics::kVisitor);
    locations_ = host.output(topics::kLocations);
    timer_ = host.timer("step", milliseconds(100), [this](auto) { step(); });
    usher_msgs::msg::Locations places;
    for (const char* name : {"foyer", "kitchen", "lounge"}) {
      auto& place = places.locations().emplace_back();
      place.name(name);
      place.title(name);
    }
    locations_.publish(places);
    host.health().set(runtime::HealthState::kOk);
  }

 private:
  void take(const usher_msgs::msg::SupervisorRequest& request) {
    if (request.id() == last_request_) return;
    last_request_ = request.id();
    switch (request.command()) {
      case command::COMMAND_STOP:
        truth_.stopped = true;
        break;
      case command::COMMAND_MOVEMENT_ON:
        truth_.stopped = false;
        break;
      case command::COMMAND_NAVIGATION_START:
        state_ = state::STATE_NAVIGATION_START;
        break;
      case command::COMMAND_NAVIGATION_GO:
        state_ = state::STATE_NAVIGATION_ACTIVE;
        break;
      default:
        state_ = state::STATE_INTERACTION;
    }
  }

  void step() {
    time_ += kStep;
    const bool active = result_ == goal_state::STATE_ACTIVE;
    if (active) since_goal_ += kStep;
    if (active && since_goal_ > trouble_.fails_at) result_ = goal_state::STATE_FAILED;
    if (active && since_goal_ > trouble_.forgets_at) {
      trouble_.forgets_at = 1e9;
      goal_id_ = 0;
      result_ = goal_state::STATE_IDLE;
    }
    const bool blocked = active && since_goal_ > trouble_.blocked_at &&
                         since_goal_ < trouble_.blocked_at + trouble_.blocked_for;
    if (active && since_goal_ > trouble_.fault_at) state_ = state::STATE_FAULT;
    const bool drives =
        active && !truth_.stopped && !blocked && state_ == state::STATE_NAVIGATION_ACTIVE;
    truth_.speed += std::clamp((drives ? pace_ : 0.0) - truth_.speed, -0.1, 0.07);
    truth_.robot += truth_.speed * kStep;
    if (active && truth_.robot >= end_) {
      result_ = goal_state::STATE_SUCCEEDED;
      truth_.speed = 0.0;
    }
    move_visitor();
    say(active, blocked);
  }

  void move_visitor() {
    const double behind = truth_.robot - truth_.visitor;
    if (follows_) {
      if (behind > 1.2) truth_.visitor += std::min(walks_ * kStep, behind - 1.2);
    } else if (walks_ > 0.0) {
      truth_.visitor -= walks_ * kStep;
    }
    if (truth_.speed > 0.05 && !truth_.stopped && trouble_.sees_people) {
      truth_.largest_gap = std::max(truth_.largest_gap, behind);
    }
  }

  void say(bool active, bool blocked) {
    usher_msgs::msg::SupervisorStatus status;
    status.state(state_);
    status.last_request(last_request_);
    status.last_request_done(true);
    status.enable_movement(!truth_.stopped);
    supervisor_.publish(status);
    usher_msgs::msg::NavigateStatus navigation;
    navigation.id(goal_id_);
    navigation.state(result_);
    navigation.remaining(static_cast<float>(std::max(0.0, end_ - truth_.robot)));
    navigation.eta(navigation.remaining() / 0.8F);
    navigation.progress(active ? 0.5F : 1.0F);
    navigation_.publish(navigation);
    usher_msgs::msg::FollowStatus follow;
    follow.state(blocked ? goal_state::STATE_WAITING : goal_state::STATE_ACTIVE);
    follow.blocked_for(blocked ? 1.0F : 0.0F);
    follow_.publish(follow);
    if (!trouble_.sees_people) return;
    usher_msgs::msg::Visitor seen;
    const double x = truth_.visitor - truth_.robot;
    seen.presence(std::abs(x) < 8.0 ? presence::PRESENCE_SEEN : presence::PRESENCE_NOBODY);
    seen.x(x);
    visitor_.publish(seen);
  }

  runtime::Host& host_;
  Trouble trouble_;
  Truth& truth_;
  double time_ = 0.0, since_goal_ = 0.0, end_ = 0.0, pace_ = 0.0, walks_ = 0.0;
  bool follows_ = false;
  std::uint8_t state_ = state::STATE_INTERACTION, result_ = goal_state::STATE_IDLE;
  std::uint64_t goal_id_ = 0, last_request_ = 0;
  runtime::Input<usher_msgs::msg::SupervisorRequest> request_;
  runtime::Input<usher_msgs::msg::NavigateGoal> goal_;
  runtime::Input<usher_msgs::msg::GoalCancel> cancel_;
  runtime::Input<usher_msgs::msg::NavigatePace> pace_input_;
  runtime::Input<usher_sim_msgs::msg::PersonGoal> walk_;
  runtime::Output<usher_msgs::msg::SupervisorStatus> supervisor_;
  runtime::Output<usher_msgs::msg::NavigateStatus> navigation_;
  runtime::Output<usher_msgs::msg::FollowStatus> follow_;
  runtime::Output<usher_msgs::msg::Visitor> visitor_;
  runtime::Output<usher_msgs::msg::Locations> locations_;
  runtime::Timer timer_;
};

struct Result {
  std::string behavior, last_state;
  std::vector<usher_msgs::msg::GuideVisit> visits;
  Robot::Truth truth;
};

const std::vector<std::pair<std::string, std::string>>& behaviors() {
  static const std::vector<std::pair<std::string, std::string>> kAll{
      {"plain", ""},
      {"looks at the map", "looks_at_map: true"},
      {"asks where it is", "looks_at_map: true\nasks_where: true"},
      {"types", "types: true"},
      {"speaks", "speaks: true"},
      {"German", "language: de"},
      {"reads slowly", "reading_time: 45 s"},
      {"returns", "returns_to: foyer"},
      {"stops", "stops_at: 8 s"},
      {"stops for ever", "stops_at: 8 s\nstops_for: 3000 s"},
      {"cancels", "cancels_at: 9 s"},
      {"dawdles", "dawdles_at: 6 s"},
      {"ties a lace", "ties_lace_at: 10 s\nties_lace_for: 15 s"},
      {"walks away", "walks_away_at: 12 s"},
      {"leaves at once", "gives_up_in: location_ask"},
      {"leaves while choosing", "gives_up_in: guide_options"},
      {"leaves before the start", "gives_up_in: guide_start"},
      {"does not thank", "gives_up_in: end_ask"},
  };
  return kAll;
}

runtime::ParameterFile parameters(const std::string& component, const std::string& lines,
                                  const std::string& host) {
  auto file = runtime::test_parameters(component, lines);
  EXPECT_TRUE(file.ok()) << (file.ok() ? "" : file.error());
  file->host = host;
  return std::move(*file);
}

Result run(std::uint64_t seed) {
  Random random(seed);
  const auto& behavior = behaviors()[seed % behaviors().size()];
  Trouble trouble;
  switch (random.below(8)) {
    case 0:
      trouble.blocked_at = random.uniform(2.0, 15.0);
      trouble.blocked_for = random.uniform(3.0, 30.0);
      break;
    case 1:
      trouble.fails_at = random.uniform(0.5, 20.0);
      break;
    case 2:
      trouble.forgets_at = random.uniform(1.0, 20.0);
      break;
    case 3:
      trouble.fault_at = random.uniform(1.0, 30.0);
      break;
    default:
      break;
  }
  trouble.sees_people = random.below(4) > 0;
  Result result;
  result.behavior = behavior.first;
  LockstepWorld world({.network = {.seed = seed}});
  const runtime::ComponentFactory robot{"robot", [&](runtime::Host& host) {
                                          return std::unique_ptr<runtime::Component>(
                                              std::make_unique<Robot>(host, trouble, result.truth));
                                        }};
  EXPECT_TRUE(world.add(robot, parameters("robot", "", "nuc")).ok());
  EXPECT_TRUE(
      world
          .add(runtime::component_factory<guide::GuideComponent>("guide"),
               parameters("guide",
                          "texts: " USHER_SOURCE_DIR "/config/dialogue/en.yaml\nlanguages: en de",
                          "nuc"),
               {.restart_after = milliseconds(300)})
          .ok());
  EXPECT_TRUE(world
                  .add(runtime::component_factory<visitor::VisitorComponent>("visitor"),
                       parameters("visitor", "destination: kitchen\n" + behavior.second, "tablet"))
                  .ok());
  if (random.below(3) == 0) {  // a radio link that loses what is lost
    world.set_link("nuc", "tablet", {.latency = milliseconds(20), .loss = 0.2});
  }
  if (random.below(4) == 0) {
    world.at(world.now() + milliseconds(random.below(60000)), [&] { world.kill("guide"); });
  }
  world.observe(topics::kDialogueScreen,
                [&](const auto& screen, const auto&) { result.last_state = screen.state(); });
  world.observe(topics::kGuideVisit,
                [&](const auto& visit, const auto&) { result.visits.push_back(visit); });
  while (world.elapsed() < seconds(500) &&
         (result.visits.empty() || world.elapsed() < seconds(20) || result.truth.speed > 0.0)) {
    world.run_for(seconds(1));
  }
  world.run_for(seconds(3));
  return result;
}

TEST(Visits, ThousandEndInSuccessPolitelyOrInASafeWait) {
  const char* const outcomes[] = {"open", "left", "ended", "arrived", "given up"};
  std::map<std::string, std::map<std::string, int>> table;
  int waits = 0;
  double largest_gap = 0.0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    const Result result = run(seed);
    const bool rests = result.last_state == "end" || result.last_state == "inactive" ||
                       result.last_state == "initialise";
    const bool asks = result.last_state == "guide_error" || result.last_state == "guide_paused";
    EXPECT_TRUE(!result.visits.empty() || rests || asks)
        << "seed " << seed << " (" << result.behavior << ") is stuck in " << result.last_state;
    EXPECT_EQ(result.truth.speed, 0.0) << "seed " << seed << " still drives";
    EXPECT_LE(result.truth.largest_gap, 6.0) << "seed " << seed << " (" << result.behavior << ")";
    largest_gap = std::max(largest_gap, result.truth.largest_gap);
    const std::string outcome =
        result.visits.empty() ? "safe wait" : outcomes[result.visits.front().outcome()];
    ++table[result.behavior][outcome];
    for (const auto& visit : result.visits) waits += static_cast<int>(visit.waits());
    if (::testing::Test::HasFailure()) break;
  }
  for (const auto& [behavior, counts] : table) {
    std::printf("%-24s", behavior.c_str());
    for (const auto& [outcome, count] : counts) std::printf("  %s %d", outcome.c_str(), count);
    std::printf("\n");
  }
  std::printf("waited for visitors %d times; largest gap behind a moving robot %.1f m\n", waits,
              largest_gap);
  EXPECT_GT(table["plain"]["arrived"], 30);
  EXPECT_GT(table["walks away"]["given up"], 10);
  EXPECT_GT(waits, 50);
}

}  // namespace
}  // namespace usher
