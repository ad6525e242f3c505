#include "navigation/explorer/shell/component.hpp"

#include <algorithm>
#include <utility>

#include "wire/conversions.hpp"
#include "wire/footprint.hpp"
#include "wire/frames.hpp"
#include "wire/meeting_rooms.hpp"

namespace usher::explorer {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kPeriod = milliseconds(100);
constexpr int kStatusEvery = 2;     // periods
constexpr int kCoverageEvery = 10;  // periods
constexpr auto kNavigatorAge = milliseconds(2000);
constexpr auto kLocalizationAge = milliseconds(2000);
constexpr auto kPoseAge = milliseconds(500);

}  // namespace

ExplorerConfig ExplorerComponent::read_parameters(runtime::Host& host) {
  auto& p = host.parameters();
  ExplorerConfig c;
  const std::vector<std::string> kinds = {"information_gain", "frontier", "cell", "grid"};
  const std::string kind = p.choice("strategy", kinds, kinds.front(), "How viewpoints are chosen.");
  c.strategy.kind =
      static_cast<StrategyKind>(std::find(kinds.begin(), kinds.end(), kind) - kinds.begin());
  c.strategy.levels = p.numbers("levels", "m", {0.2, 50}, 1, 8, c.strategy.levels,
                                "Point distances of cell and grid, one after the other.");
  const auto number = [&](const char* name, const char* unit, runtime::Range range, double& value,
                          const char* text) { value = p.number(name, unit, range, value, text); };
  number("field_of_view", "rad", {0.1, 3}, c.camera.field_of_view,
         "Of the camera that looks for people.");
  number("nearest", "m", {0, 5}, c.camera.nearest, "People are found from this distance on.");
  number("farthest", "m", {0.5, 20}, c.camera.farthest, "People are found up to this distance.");
  c.camera.ahead =
      p.number("robot.kinect.mount_x", "m", {-1, 1}, 0.0, "Kinect ahead of the axle's middle.");
  number("least_gain", "m2", {0.01, 10}, c.strategy.least_gain,
         "Less that was not seen is worth no view.");
  number("candidate_spacing", "m", {0.2, 5}, c.strategy.candidate_spacing,
         "Squares that have a candidate of information_gain each.");
  number("usual_speed", "m/s", {0.05, 2}, c.strategy.usual_speed,
         "Kept on a way, to foresee its time.");
  number("turn_rate", "rad/s", {0.05, 3}, c.strategy.turn_rate, "Of turns in place, likewise.");
  number("stop_time", "s", {0, 10}, c.strategy.stop_time, "That a stop costs, likewise.");
  number("give_up_radius", "m", {0, 5}, c.strategy.give_up_radius,
         "Around a viewpoint that could not be reached there is none in that round.");
  c.most_recoveries =
      static_cast<int>(p.integer("most_recoveries", "-", {0, 100}, c.most_recoveries,
                                 "A viewpoint that takes the navigator more of them is given up."));
  c.most_failures = static_cast<int>(
      p.integer("most_failures", "-", {1, 100}, c.most_failures,
                "So many viewpoints in a row that cannot be reached end the exploration."));
  number("client_silence", "s", {0.5, 60}, c.client_silence,
         "An exploration ends when its goal was not repeated for so long.");
  const double clearance = p.number("clearance", "m", {0, 1}, 0.08,
                                    "Around the outline, at viewpoints and on ways to them.");
  const auto footprint = wire::read_footprint(host);
  c.passing_room = footprint.inscribed_radius() + clearance;
  c.standing_room = footprint.circumscribed_radius() + clearance;
  for (const auto& room : wire::read_meeting_rooms(host))
    c.leave_out.push_back({room.low, room.high});
  return c;
}

Explorer ExplorerComponent::make(runtime::Host& host) {
  // Ids above all that were used before a restart.
  const auto first_id = static_cast<std::uint64_t>(host.now().time_since_epoch().count() / 1000);
  auto made = Explorer::create(read_parameters(host), host.random("viewpoints").next(), first_id);
  if (!made) host.fault(made.error());
  return std::move(made).value();
}

ExplorerComponent::ExplorerComponent(runtime::Host& host)
    : host_(host),
      core_(make(host)),
      rejected_(host.health().counter("inputs: rejected")),
      transforms_(host),
      drives_(host, topics::kNavigateGoal) {
  map_ =
      host.input(topics::kMap, {}, [this](const auto& message, const auto&) { take_map(message); });
  goal_ = host.input(topics::kExploreGoal, {.on_loss = "the exploration ends", .optional = true},
                     [this](const auto& goal, const auto&) { take_goal(goal); });
  cancel_ = host.input(topics::kExploreCancel, {.optional = true},
                       [this](const auto& cancel, const auto&) {
                         core_.cancel(cancel.id());
                         step();
                       });
  navigation_ = host.input(
      topics::kNavigateStatus,
      {.max_age = kNavigatorAge, .on_loss = "waits; a navigator that is back is told anew"},
      [this](const auto& status, const auto&) { take_navigation(status); });
  localization_ = host.input(
      topics::kLocalizationStatus,
      {.max_age = kLocalizationAge, .on_loss = "takes nothing for seen and chooses no viewpoint"});
  cancel_drive_ = host.output(topics::kNavigateCancel);
  status_ = host.output(topics::kExploreStatus);
  coverage_ = host.output(topics::kExploreCoverage);
  host.input(topics::kExploreShare, {.optional = true},
             [this](const auto& share, const auto&) { take_share(share); });
  host.input(topics::kFleetLook, {.optional = true},
             [this](const auto& look, const auto&) { take_look(look); });
  looks_ = host.output(topics::kFleetLook);
  timer_ = host.timer("step", kPeriod, [this](auto) { tick(); });
  publish_status();
}

void ExplorerComponent::take_map(const nav_msgs::msg::OccupancyGrid& message) {
  const auto map = wire::from_message(message);
  const Status taken = map ? core_.set_map(*map) : Status(Error{map.error()});
  map_refused_ = taken ? "" : "map refused: " + taken.error();
  published_cells_ = 0;
  if (!taken) ++rejected_;
}

void ExplorerComponent::take_goal(const usher_msgs::msg::ExploreGoal& goal) {
  core_.request({goal.id(), goal.client(), goal.rounds(), goal.anew(),
                 static_cast<double>(goal.max_speed())});
  step();
  publish_status();
}

void ExplorerComponent::take_share(const usher_msgs::msg::ExploreShare& message) {
  Share share;
  share.own = message.own();
  for (const auto& place : message.places()) share.places.emplace_back(place.x(), place.y());
  if (!core_.set_share(share)) ++rejected_;
}

/// What another robot of the fleet sees need not be looked at again.
void ExplorerComponent::take_look(const usher_msgs::msg::FleetLook& look) {
  if (look.robot() != host_.robot_name()) core_.look({look.x(), look.y(), look.yaw()});
}

void ExplorerComponent::tell_fleet(const Pose2& robot) {
  usher_msgs::msg::FleetLook look;
  look.header(wire::header(host_.now(), frames::kMap));
  look.robot(host_.robot_name());
  look.x(robot.x);
  look.y(robot.y);
  look.yaw(robot.yaw);
  looks_.publish(look);
}

void ExplorerComponent::take_navigation(const usher_msgs::msg::NavigateStatus& status) {
  drives_.answered(status.id(), status.client());
  step();
}

/// In map, as long as localization knows it.
std::optional<Pose2> ExplorerComponent::pose() const {
  const auto* localization = localization_.fresh();
  if (localization == nullptr ||
      localization->state() == usher_msgs::msg::LocalizationStatus_Constants::STATE_LOST)
    return std::nullopt;
  return transforms_.newest_planar(frames::kMap, frames::kBaseFootprint, kPoseAge);
}

void ExplorerComponent::tick() {
  const auto robot = pose();
  if (robot) core_.look(*robot);
  if (robot && !host_.robot_name().empty()) tell_fleet(*robot);
  step();
  ++ticks_;
  if (ticks_ % kStatusEvery == 0) publish_status();
  if (ticks_ % kCoverageEvery == 0) publish_coverage();
  const std::string lacks = !map_refused_.empty()            ? map_refused_
                            : core_.seen().empty()           ? "no map"
                            : navigation_.fresh() == nullptr ? "no navigator"
                            : !robot                         ? "robot not localized"
                                                             : "";
  host_.health().set(lacks.empty() ? HealthState::kOk : HealthState::kDegraded, lacks);
}

void ExplorerComponent::step() {
  Situation situation;
  situation.time = runtime::seconds(host_.now().time_since_epoch());
  situation.pose = pose();
  situation.client = host_.name();
  if (const auto* status = navigation_.fresh()) {
    situation.navigation =
        DriveReport{status->id(), status->client(),
                    static_cast<GoalState>(std::min<std::uint8_t>(status->state(), 6)),
                    status->reason(), status->recoveries()};
  }
  const Decision decision = core_.step(situation);
  if (decision.cancel) {
    drives_.give_up();
    usher_msgs::msg::GoalCancel cancel;
    cancel.id(*decision.cancel);
    cancel.client(host_.name());
    cancel_drive_.publish(cancel);
  }
  if (decision.drive) {
    usher_msgs::msg::NavigateGoal goal;
    goal.id(decision.drive->id);
    goal.pose().header(wire::header(host_.now(), frames::kMap));
    goal.pose().pose(wire::to_message(decision.drive->view));
    goal.max_speed(static_cast<float>(decision.drive->max_speed));
    drives_.give_up();
    drives_.ask(std::move(goal));
  }
  if (core_.status().state != told_) publish_status();
}

void ExplorerComponent::publish_status() {
  const ExploreStatus& status = core_.status();
  const SeenArea& seen = core_.seen();
  told_ = status.state;
  usher_msgs::msg::ExploreStatus message;
  message.header(wire::header(host_.now(), frames::kMap));
  message.id(status.id);
  message.client(status.client);
  message.state(static_cast<std::uint8_t>(status.state));
  message.reason(status.reason);
  message.round(status.round);
  message.coverage(static_cast<float>(seen.coverage()));
  if (!seen.empty())
    message.area(static_cast<float>(static_cast<double>(seen.wanted_cells()) * seen.cell_area()));
  message.views(status.views);
  message.given_up(status.given_up);
  message.view(wire::to_message(status.view));
  status_.publish(message);
}

/// For viewers, when there are any and something changed.
void ExplorerComponent::publish_coverage() {
  const SeenArea& seen = core_.seen();
  if (seen.empty() || coverage_.reader_count() == 0 || seen.seen_cells() == published_cells_)
    return;
  published_cells_ = seen.seen_cells();
  grid::OccupancyGrid picture(seen.geometry(), grid::kUnknown);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    if (seen.wanted(i)) picture[i] = seen.unseen(i) ? grid::kOccupied : grid::kFree;
  }
  coverage_.publish(wire::to_message(host_.now(), frames::kMap, picture));
}

}  // namespace usher::explorer
