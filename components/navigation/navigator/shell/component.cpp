#include "navigation/navigator/shell/component.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"
#include "wire/site_locations.hpp"

namespace usher::navigator {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;
namespace supervisor_state = usher_msgs::msg::SupervisorStatus_Constants;

constexpr auto kPeriod = milliseconds(100);
constexpr int kStatusEvery = 2;                 // of those periods: 5 Hz
constexpr auto kWordStands = milliseconds(80);  // less than a period
constexpr std::size_t kMostWords = 8;
constexpr auto kFollowAge = milliseconds(500);
constexpr auto kPaceAge = milliseconds(1000);
constexpr auto kOdomAge = milliseconds(200);
constexpr auto kLocalizationAge = milliseconds(1000);
constexpr auto kSupervisorAge = milliseconds(1000);
constexpr double kTrail = 1.2;  // [m] of its own way that is taken for free
constexpr auto kPoseAge = milliseconds(300);
constexpr auto kPeopleAge = milliseconds(400);
constexpr double kSeenLately = 1.0;            // [s]
constexpr const char* kOperator = "operator";  // `usher goto`
constexpr auto kOver = milliseconds(3000);     // longer than he needs to start it anew
constexpr const char* kViewer = "goal_pose";
constexpr auto kViewerPatience = milliseconds(3000);  // with the supervisor's answers

}  // namespace

NavigatorConfig NavigatorComponent::read_parameters(runtime::Parameters& parameters) {
  NavigatorConfig c;
  const auto number = [&](const char* name, const char* unit, double low, double high,
                          double& value, const char* text) {
    value = parameters.number(name, unit, {low, high}, value, text);
  };
  number("position_tolerance", "m", 0.05, 2, c.position_tolerance,
         "The goal is reached within this; at least the local planner's.");
  number("yaw_tolerance", "rad", 0.02, 3.2, c.yaw_tolerance, "The same for its yaw.");
  number("settle_time", "s", 0, 10, c.settle_time, "Time to stand at the goal before it counts.");
  number("replan_period", "s", 0, 600, c.replan_period,
         "A better path may have appeared; 0 = never.");
  number("wait_object", "s", 0, 120, c.wait_object,
         "Blocked by a thing: wait before planning round it.");
  number("wait_person", "s", 0, 120, c.wait_person, "Blocked by somebody, who probably moves.");
  number("recovery_patience", "s", 0.1, 120, c.recovery_patience,
         "Still blocked after the new path: recover.");
  number("stall_time", "s", 1, 120, c.stall_time, "Without getting nearer it counts as blocked.");
  number("recovery_timeout", "s", 0.5, 120, c.recovery_timeout, "For one motion that recovers.");
  number("hold_timeout", "s", 1, 3600, c.hold_timeout,
         "How long a robot that may not drive is waited for.");
  number("pause_timeout", "s", 1, 600, c.pause_timeout,
         "Without localization or inputs before giving up.");
  number("plan_timeout", "s", 0.5, 60, c.plan_timeout, "Without an answer is a failed plan.");
  number("time_base", "s", 1, 36000, c.time_base, "A goal may take this long, and the following.");
  number("time_factor", "-", 1, 100, c.time_factor, "This many times its path at the usual speed.");
  number("usual_speed", "m/s", 0.05, 2, c.usual_speed,
         "Kept on average along the way, stops for people included.");
  number("turn_time", "s", 0, 60, c.turn_time, "That a turn of one radian takes besides.");
  number("start_time", "s", 0, 60, c.start_time, "From standing to driving.");
  number("approach_time", "s", 0, 60, c.approach_time, "That the last metre takes besides.");
  number("near_enough", "m", 0, 2, c.near_enough,
         "Blocked so near the goal that no recovery helps, it has arrived.");
  c.most_recoveries =
      static_cast<int>(parameters.integer("most_recoveries", "-", {0, 100}, c.most_recoveries,
                                          "Recoveries in a row without progress."));
  return c;
}

Locations NavigatorComponent::read_locations(runtime::Host& host) {
  std::vector<Location> locations;
  for (auto& each : wire::read_locations(host.parameters()))
    locations.push_back({std::move(each.name), std::move(each.title), each.pose});
  auto made = Locations::create(std::move(locations));
  if (!made) host.fault("site.locations: " + made.error());
  return std::move(made).value();
}

Navigator NavigatorComponent::make(runtime::Host& host) {
  // Ids above all that were used before a restart.
  const auto first_id = static_cast<std::uint64_t>(host.now().time_since_epoch().count() / 1000);
  auto made = Navigator::create(read_parameters(host.parameters()), read_locations(host), first_id);
  if (!made) host.fault(made.error());
  return std::move(made).value();
}

NavigatorComponent::NavigatorComponent(runtime::Host& host)
    : host_(host),
      transforms_(host),
      core_(make(host)),
      rejected_(host.health().counter("inputs: rejected")),
      unfelt_trail_(host.parameters().number(
          "unfelt_trail", "m", {0, 1}, 0.0,
          "Way behind the robot that is taken for free where no rear whisker feels.")),
      requests_(host, topics::kSupervisorRequest) {
  goal_ = host.input(topics::kNavigateGoal, {.optional = true},
                     [this](const auto& goal, const auto&) { take_goal(goal); });
  goal_pose_ = host.input(topics::kGoalPose, {.optional = true},
                          [this](const auto& goal, const auto&) { take_goal_pose(goal); });
  cancel_ = host.input(topics::kNavigateCancel, {.optional = true},
                       [this](const auto& cancel, const auto&) {
                         core_.cancel(cancel.id());
                         step();
                       });
  pace_ = host.input(
      topics::kNavigatePace,
      {.max_age = kPaceAge, .on_loss = "drives at the goal's own pace", .optional = true},
      [this](const auto& pace, const auto&) {
        core_.pace(pace.id(), pace.client(), pace.max_speed());
      },
      [this] { core_.forget_pace(); });
  reply_ = host.input(topics::kPlanReply, {},
                      [this](const auto& reply, const auto&) { take_reply(reply); });
  follow_ = host.input(topics::kFollowStatus,
                       {.max_age = kFollowAge, .on_loss = "pauses, fails after a while"},
                       [this](const auto&, const auto&) { step(); });
  localization_ =
      host.input(topics::kLocalizationStatus,
                 {.max_age = kLocalizationAge, .on_loss = "pauses, fails after a while"});
  odom_ =
      host.input(topics::kOdom, {.max_age = kOdomAge, .on_loss = "pauses, fails after a while"});
  supervisor_ = host.input(topics::kSupervisorStatus,
                           {.max_age = kSupervisorAge, .on_loss = "pauses, fails after a while"},
                           [this](const auto& status, const auto&) { take_supervisor(status); });
  whiskers_ =
      host.input(topics::kWhiskers,
                 {.max_age = milliseconds(300), .on_loss = "does not back off", .optional = true});
  people_ = host.input(topics::kPeople, {.max_age = kPeopleAge,
                                         .on_loss = "takes whoever blocks the way for a thing",
                                         .optional = true});
  plan_ = host.output(topics::kPlanRequest);
  motion_ = host.output(topics::kFollowGoal);
  clear_ = host.output(topics::kCostmapRequest);
  status_ = host.output(topics::kNavigateStatus);
  locations_ = host.output(topics::kLocations);
  timer_ = host.timer("step", kPeriod, [this](auto) {
    step();
    speak(++status_share_ % kStatusEvery == 0);
  });
  publish_locations();
  publish(core_.status());
}

void NavigatorComponent::take_goal(const usher_msgs::msg::NavigateGoal& goal) {
  const auto pose = wire::to_planar(goal.pose().pose());
  const bool usable = pose && goal.pose().header().frame_id() == frames::kMap;
  if (goal.location().empty() && !usable) ++rejected_;
  // The core answers what is not finite, so that nobody asks for ever.
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  core_.request({goal.id(), goal.client(), goal.location(),
                 usable ? *pose : geometry::Pose2{kNaN, kNaN, kNaN}, goal.max_speed()});
  step();
  speak(true);
}

/// rviz's goal: a pose without an id, and nobody who asks the supervisor to let the navigation
/// drive. It is given only when that is granted: one that waited would drive off when somebody else
/// starts a navigation for a goal of his own.
void NavigatorComponent::take_goal_pose(const geometry_msgs::msg::PoseStamped& goal) {
  const auto pose = wire::to_planar(goal.pose());
  if (!pose || goal.header().frame_id() != frames::kMap) {
    ++rejected_;
    return;
  }
  if (viewer_goal_) refuse_viewer("replaced by a newer goal");
  viewer_goal_ = {requests_.next_id(), *pose, host_.now()};
  requests_.give_up();
  using namespace usher_msgs::msg::SupervisorRequest_Constants;
  for (const auto command : {COMMAND_NAVIGATION_START, COMMAND_NAVIGATION_GO}) {
    usher_msgs::msg::SupervisorRequest request;
    request.id(requests_.next_id());
    request.command(command);
    request.goal(kViewer);
    requests_.ask(std::move(request));
  }
}

void NavigatorComponent::take_supervisor(const usher_msgs::msg::SupervisorStatus& status) {
  const bool ours = requests_.answered(status.last_request(), status.last_request_client());
  if (!ours || !viewer_goal_) return;
  if (!status.last_request_done()) return refuse_viewer(status.last_request_reason());
  if (requests_.waits()) return;
  core_.request({viewer_goal_->id, kViewer, "", viewer_goal_->pose, 0.0});
  viewer_goal_.reset();
  step();
}

void NavigatorComponent::refuse_viewer(const std::string& reason) {
  NavigationStatus refused;
  refused.id = viewer_goal_->id;
  refused.client = kViewer;
  refused.state = GoalState::kFailed;
  refused.reason = reason;
  refused.goal = viewer_goal_->pose;
  remember_last_word(refused);
  viewer_goal_.reset();
  requests_.give_up();
}

/// Nobody else gives a viewer's goal up when the supervisor navigates for it no more.
void NavigatorComponent::watch_viewer() {
  if (viewer_goal_ && host_.now() - viewer_goal_->asked > kViewerPatience)
    refuse_viewer("the supervisor did not answer within 3 s");
  const auto* supervisor = supervisor_.fresh();
  if (supervisor == nullptr || supervisor->current_goal() == kViewer || !core_.pursues() ||
      core_.status().client != kViewer)
    return;
  core_.cancel(core_.status().id, supervisor->current_goal().empty()
                                      ? "the supervisor ended the navigation"
                                      : "another goal took its place");
}

/// Guide and meeting see to their goals themselves; an operator's command may have gone when the
/// supervisor ends its navigation, and the goal would wait for a start that is somebody else's.
void NavigatorComponent::watch_operator() {
  const auto* supervisor = supervisor_.fresh();
  const bool watched =
      supervisor != nullptr && core_.pursues() && core_.status().client == kOperator;
  if (!watched || supervisor->state() != supervisor_state::STATE_INTERACTION) {
    not_navigating_since_.reset();
  } else if (!not_navigating_since_) {
    not_navigating_since_ = host_.now();
  }
  if (!watched) return;
  const std::string ended = "the supervisor ended the navigation";
  const std::uint64_t id = core_.status().id;
  if (supervisor->state() == supervisor_state::STATE_FAULT) {
    core_.cancel(id, ended + ": " + supervisor->reason());
  } else if (supervisor->state() == supervisor_state::STATE_MANUAL) {
    core_.cancel(id, ended + ": driven by hand");
  } else if (not_navigating_since_ && host_.now() - *not_navigating_since_ > kOver) {
    core_.cancel(id, ended);
  }
}

void NavigatorComponent::take_reply(const usher_msgs::msg::PlanReply& reply) {
  PlanReply plan{reply.id(), reply.reason(), {}};
  if (reply.state() == usher_msgs::msg::GoalStatus_Constants::STATE_SUCCEEDED) {
    auto path = wire::from_message(reply.path());
    if (!path) {
      ++rejected_;
      plan.reason = path.error();
    } else {
      plan.path = std::move(path).value();
    }
  }
  core_.plan_reply(std::move(plan));
  step();
}

/// In words, why nothing may drive now; the supervisor enables the navigation in one state only.
std::string NavigatorComponent::not_allowed_because() const {
  const auto* supervisor = supervisor_.fresh();
  if (supervisor == nullptr) return "no supervisor";
  if (!supervisor->granted())
    return supervisor->reason().empty() ? "nobody may drive" : supervisor->reason();
  if (supervisor->state() != supervisor_state::STATE_NAVIGATION_ACTIVE)
    return "the supervisor has not started the navigation";
  if (!supervisor->enable_movement()) {
    return supervisor->stopped_by().empty() ? "the robot has been stopped"
                                            : "stopped by " + supervisor->stopped_by().front();
  }
  return {};
}

bool NavigatorComponent::somebody_ahead() const {
  const auto* people = people_.fresh();
  const auto newest = transforms_.buffer().newest(frames::kMap, frames::kOdom);
  if (people == nullptr || people->header().frame_id() != frames::kOdom || !newest) return false;
  const auto map_T_odom =
      transforms_.lookup_planar(frames::kMap, frames::kOdom, runtime::Time(*newest));
  return map_T_odom && std::ranges::any_of(people->people(), [&](const auto& person) {
           return static_cast<double>(person.unseen()) <= kSeenLately &&
                  core_.on_the_way(*map_T_odom * geometry::Point2{person.x(), person.y()});
         });
}

Situation NavigatorComponent::situation() {
  Situation s;
  s.time = now();
  if (reply_.writers().empty()) {
    s.missing = "the global planner";
  } else if (follow_.latest() == nullptr) {
    s.missing = "the local planner";
  }
  if (const auto* status = follow_.fresh()) {
    s.follow = {status->id(), static_cast<GoalState>(std::min<std::uint8_t>(status->state(), 6)),
                status->reason(), status->obstacle_distance()};
  } else {
    s.stale = "the local planner";
  }
  if (const auto* status = localization_.fresh()) {
    const auto state = static_cast<Localization>(status->state());
    s.localization = state > Localization::kGood ? Localization::kLost : state;
  }
  if (const auto* odom = odom_.fresh()) {
    if (const auto velocity = wire::from_message(odom->twist().twist())) {
      s.velocity = *velocity;
    } else {
      ++rejected_;
    }
  } else {
    s.stale = "the odometry";
  }
  if (const auto newest = transforms_.buffer().newest(frames::kMap, frames::kBaseFootprint)) {
    const runtime::Time stamp(*newest);
    const auto pose = transforms_.lookup_planar(frames::kMap, frames::kBaseFootprint, stamp);
    if (pose && host_.now() - stamp < kPoseAge) s.pose = *pose;
  }
  // Nobody sees behind, but the robot has just come from there, and its rear whiskers feel. From
  // what one of them touches the local planner turns away; what touches all four stands beside it.
  s.rear_clearance = unfelt_trail_;
  const auto* t = whiskers_.fresh();
  if (t != nullptr &&
      (!(t->back_left() && t->back_right()) || (t->front_left() && t->front_right())))
    s.rear_clearance = kTrail;
  s.person_ahead = somebody_ahead();
  s.not_allowed_because = not_allowed_because();
  return s;
}

void NavigatorComponent::step() {
  watch_viewer();
  watch_operator();
  const Decision decision = core_.step(situation());
  for (const auto& aside : decision.asides) remember_last_word(aside);
  if (decision.plan) send_plan(*decision.plan);
  if (decision.motion) send_motion(*decision.motion);
  if (decision.clear_costmap) {
    usher_msgs::msg::CostmapRequest request;
    request.id(static_cast<std::uint64_t>(host_.now().time_since_epoch().count()) +
               ++clear_requests_);
    request.client(host_.name());
    clear_.publish(request);
  }
  const auto& status = core_.status();
  if (status.id != last_id_ || status.state != last_state_) {
    last_id_ = status.id;
    last_state_ = status.state;
    if (status.state >= GoalState::kSucceeded) {
      remember_last_word(status);
    } else {
      unsaid_ = true;
    }
  }
  speak(false);
  const bool ready = core_.state() != State::kInitialise;
  host_.health().set(ready ? HealthState::kOk : HealthState::kDegraded,
                     ready ? "" : "waits for the planners");
}

void NavigatorComponent::send_plan(const PlanRequest& request) {
  usher_msgs::msg::PlanRequest message;
  message.id(request.id);
  message.client(host_.name());
  message.start().header(wire::header(host_.now(), frames::kMap));
  message.start().pose(wire::to_message(request.start));
  message.goal().header(message.start().header());
  message.goal().pose(wire::to_message(request.goal));
  plan_.publish(message);
}

void NavigatorComponent::send_motion(const Motion& motion) {
  using namespace usher_msgs::msg::FollowGoal_Constants;
  constexpr std::uint8_t kModes[] = {MODE_STOP, MODE_PATH, MODE_ROTATE, MODE_BACK_OFF};
  usher_msgs::msg::FollowGoal message;
  message.id(motion.id);
  message.client(host_.name());
  message.mode(kModes[static_cast<std::size_t>(motion.mode)]);
  message.max_speed(static_cast<float>(motion.max_speed));
  message.amount(static_cast<float>(motion.amount));
  const std::span<const geometry::Pose2> path = motion.mode == MotionMode::kFollow
                                                    ? std::span(core_.path())
                                                    : std::span<const geometry::Pose2>();
  message.path(wire::to_message(host_.now(), frames::kMap, path));
  motion_.publish(message);
}

void NavigatorComponent::publish_locations() {
  usher_msgs::msg::Locations message;
  for (const auto& location : core_.locations().all()) {
    auto& entry = message.locations().emplace_back();
    entry.name(location.name);
    entry.title(location.title);
    entry.pose(wire::to_message(location.pose));
  }
  locations_.publish(message);
}

/// Who asks repeats a goal that is not answered, so no more than these need to wait.
void NavigatorComponent::remember_last_word(const NavigationStatus& status) {
  const bool waits = std::ranges::any_of(last_words_, [&](const NavigationStatus& word) {
    return word.id == status.id && word.client == status.client;
  });
  if (!waits && last_words_.size() < kMostWords) last_words_.push_back(status);
}

/// A reader may keep the newest status only. So the last word of a goal stands alone for a moment,
/// and after each the present goal has its turn: whoever asked learns what became of it.
void NavigatorComponent::speak(bool due) {
  if (host_.now() - last_word_at_ < kWordStands) return;
  if (!last_words_.empty() && turn_of_words_) {
    publish(last_words_.front());
    last_words_.pop_front();
    last_word_at_ = host_.now();
    turn_of_words_ = false;
    unsaid_ = true;
  } else if (unsaid_ || due) {
    publish(core_.status());
    turn_of_words_ = true;
    unsaid_ = false;
  }
}

void NavigatorComponent::publish(const NavigationStatus& status) {
  usher_msgs::msg::NavigateStatus message;
  message.header(wire::header(host_.now(), frames::kMap));
  message.id(status.id);
  message.client(status.client);
  message.state(static_cast<std::uint8_t>(status.state));
  message.reason(status.reason);
  message.location(status.location);
  message.goal().header(message.header());
  message.goal().pose(wire::to_message(status.goal));
  message.progress(static_cast<float>(status.progress));
  message.remaining(static_cast<float>(status.remaining));
  message.eta(static_cast<float>(status.eta));
  message.recoveries(status.recoveries);
  message.replans(status.replans);
  status_.publish(message);
}

}  // namespace usher::navigator
