#include "tasks/meeting/shell/component.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "tasks/meeting/core/memory.hpp"
#include "tasks/service/shell/messages.hpp"
#include "wire/conversions.hpp"
#include "wire/footprint.hpp"
#include "wire/frames.hpp"
#include "wire/meeting_rooms.hpp"

namespace usher::meeting {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kPeriod = milliseconds(100);
constexpr int kStatusEvery = 5;            // periods
constexpr std::uint64_t kAskEvery = 10;    // periods; the explorer ends when nobody asks
constexpr std::uint64_t kFoundAfter = 10;  // periods
constexpr std::uint64_t kWaitedFor = 50;   // periods
constexpr auto kSupervisorAge = milliseconds(1000);
constexpr auto kGoalAge = milliseconds(2000);
constexpr auto kLocalizationAge = milliseconds(2000);
constexpr auto kFacesAge = milliseconds(1000);
constexpr auto kScanAge = milliseconds(500);
constexpr auto kPoseAge = milliseconds(500);
constexpr auto kTeamAge = milliseconds(3000);
constexpr const char* kMemory = "mission";
/// Ids of goals must not be those of another client that counts from the same clock.
constexpr std::uint64_t kIdsApart = 500'000;

GoalState goal_state(std::uint8_t state) {
  return static_cast<GoalState>(std::min<std::uint8_t>(state, 6));
}

usher_msgs::msg::MeetingReport to_message(const Report& report, runtime::Time now) {
  usher_msgs::msg::MeetingReport message;
  message.header(wire::header(now, ""));
  message.id(report.id);
  message.client(report.client);
  message.outcome(static_cast<std::uint8_t>(report.outcome));
  message.reason(report.reason);
  message.room(report.room);
  message.wanted(report.wanted);
  message.brought(report.brought);
  message.rooms_scanned(report.rooms_scanned);
  message.rooms_occupied(report.rooms_occupied);
  message.faces_checked(report.faces_checked);
  message.faces_refused(report.faces_refused);
  message.invited(report.invited);
  message.accepted(report.accepted);
  message.declined(report.declined);
  message.unanswered(report.unanswered);
  message.lost(report.lost);
  message.room_time(report.room_time ? static_cast<float>(runtime::seconds(*report.room_time))
                                     : std::numeric_limits<float>::quiet_NaN());
  message.duration(static_cast<float>(runtime::seconds(report.duration)));
  return message;
}

/// What no reader would take in [s] is a day.
Time span_of(float seconds) {
  constexpr float kLongest = 86400.0F;
  return runtime::from_seconds(
      static_cast<double>(seconds > 0.0F ? std::min(seconds, kLongest) : 0.0F));
}

usher_msgs::msg::FleetMeeting to_message(const TeamReport& report, const std::string& robot,
                                         std::uint64_t number, runtime::Time now) {
  const auto left = [now](Time until) {
    return until == Time::max()
               ? std::numeric_limits<float>::infinity()
               : static_cast<float>(runtime::seconds(until - now.time_since_epoch()));
  };
  usher_msgs::msg::FleetMeeting message;
  message.header(wire::header(now, ""));
  message.robot(robot);
  message.number(number);
  message.state(static_cast<std::uint8_t>(report.state));
  message.outcome(static_cast<std::uint8_t>(report.outcome));
  message.id(report.id);
  message.client(report.client);
  message.wanted(report.wanted);
  message.time_left(active(report.state) ? std::max(0.0F, left(report.limit))
                                         : std::numeric_limits<float>::quiet_NaN());
  message.room(report.room);
  message.room_way(static_cast<float>(report.room_way));
  message.placed(report.place.has_value());
  if (report.place) {
    message.x(report.place->x());
    message.y(report.place->y());
  }
  message.people().reserve(report.people.size());
  for (const Encounter& each : report.people) {
    auto& person = message.people().emplace_back();
    person.kind(static_cast<std::uint8_t>(each.kind));
    person.robot(each.robot);
    person.id(each.id);
    person.x(each.at.x());
    person.y(each.at.y());
    person.valid(left(each.until));
    person.room(each.room);
  }
  return message;
}

/// States and outcomes that are none are those of a robot that is on no mission.
TeamReport from_message(const usher_msgs::msg::FleetMeeting& message, Time now) {
  TeamReport report;
  report.robot = message.robot();
  report.sequence = message.number();
  report.state =
      message.state() < kStates ? static_cast<State>(message.state()) : State::kInitialise;
  report.outcome = message.outcome() <= static_cast<std::uint8_t>(Outcome::kCancelled)
                       ? static_cast<Outcome>(message.outcome())
                       : Outcome::kOpen;
  report.id = message.id();
  report.client = message.client();
  report.wanted = message.wanted();
  report.limit = now + span_of(message.time_left());
  report.room = message.room();
  report.room_way = static_cast<double>(message.room_way());
  if (message.placed()) report.place = Point2(message.x(), message.y());
  report.people.reserve(message.people().size());
  for (const auto& person : message.people()) {
    Encounter& each = report.people.emplace_back();
    each.kind = static_cast<Met>(person.kind());
    each.robot = person.robot();
    each.id = person.id();
    each.at = {person.x(), person.y()};
    each.until = std::isinf(person.valid()) ? Time::max() : now + span_of(person.valid());
    each.room = person.room();
  }
  return report;
}

}  // namespace

Parameters MeetingComponent::read_parameters(runtime::Host& host) {
  auto& p = host.parameters();
  Parameters c;
  c.robot = host.robot_name();
  const auto time = [&](const char* name, Time& value, const char* text) {
    value = runtime::from_seconds(p.number(name, "s", {0.1, 3600}, runtime::seconds(value), text));
  };
  const auto number = [&](const char* name, const char* unit, runtime::Range range, double& value,
                          const char* text) { value = p.number(name, unit, range, value, text); };
  const auto count = [&](const char* name, int& value, const char* text) {
    value = static_cast<int>(p.integer(name, "-", {1, 100}, value, text));
  };
  time("limit", c.limit, "A mission ends by then, unless its request names another time.");
  time("answer_timeout", c.answer, "An invitation waits so long for an answer.");
  time("tone_time", c.tone, "From the tone to the first motion; ISO 13482 asks for a warning.");
  time("arrived_time", c.arrived, "How long the thanks are shown.");
  time("over_time", c.over, "How long the outcome is shown, before the next request is taken.");
  time("check_time", c.check, "A face that is not seen for so long was none.");
  time("check_most", c.check_most, "A face that is not confirmed by then was none.");
  time("nobody_time", c.nobody, "Nobody seen for so long where somebody was: has gone.");
  time("unseen_time", c.unseen, "Who is guided is looked for after so long.");
  time("look_back_time", c.look_back, "Who is not seen then for so long is lost.");
  time("call_time", c.call, "Who is not seen then for so long is called.");
  time("scan_most", c.scan_most, "A turn in a room takes at most so long, else the next room.");
  time("recovery_timeout", c.recovery, "How long a robot that may not move is waited for.");
  time("ask_again", c.ask_again, "Who did not answer, or could not be reached, is asked after it.");
  time("refused_time", c.refused, "Where a face was none, none is looked for so long.");
  count("confirmations", c.confirmations, "Messages in a row that confirm a face.");
  count("notice", c.notice, "Messages in a row for which an exploration is interrupted.");
  number("field_of_view", "rad", {0.1, 3}, c.field_of_view, "Of the camera's width.");
  number("centered", "rad", {0.02, 0.7}, c.centered, "A face is centered within that.");
  number("follows", "m", {0.5, 3}, c.follows, "Behind the robot walks who follows it.");
  number("stand_off", "m", {0.5, 3}, c.stand_off, "From a person, to talk.");
  number("near", "m", {0.5, 4}, c.near, "Nearer it asks from where it stands.");
  number("same_person", "m", {0.2, 3}, c.same_person,
         "Faces nearer to each other are one person's.");
  number("seen_again", "m", {0.2, 5}, c.seen_again,
         "Who is nearer to somebody seen on the way is the same one.");
  number("room_margin", "m", {0, 1}, c.room_margin, "A face so near to a room is one in the room.");
  count("most_failures", c.most_failures,
        "So many explorations that fail in a row end the mission.");
  const auto footprint = wire::read_footprint(host);
  c.passing_room =
      footprint.inscribed_radius() +
      p.number("clearance", "m", {0, 1}, 0.08, "Around the outline, for lengths of ways.");
  c.turning_room =
      footprint.circumscribed_radius() +
      p.number("turning_clearance", "m", {0, 1}, 0.08, "Around the outline, to turn on the way.");
  return c;
}

Meeting MeetingComponent::make(runtime::Host& host) {
  auto& p = host.parameters();
  const Parameters parameters = read_parameters(host);
  const std::filesystem::path file = p.file("texts", "", "A file of config/dialogue.");
  auto phrases = file.empty()
                     ? Result<phrases::PhraseBook>(phrases::PhraseBook::of_keys(kTextKeys))
                     : phrases::PhraseBook::load(file.parent_path(), {file.stem().string()},
                                                 "meeting", kTextKeys);
  if (!phrases) host.fault("texts: " + phrases.error());
  // Ids above all that were used before a restart.
  const auto first_id =
      static_cast<std::uint64_t>(host.now().time_since_epoch().count() / 1000) + kIdsApart;
  std::vector<RoomArea> rooms;
  for (auto& room : wire::read_meeting_rooms(host))
    rooms.push_back({std::move(room.name), room.low, room.high});
  return Meeting(parameters, std::move(rooms), std::move(phrases).value(), 0, first_id);
}

MeetingComponent::MeetingComponent(runtime::Host& host)
    : host_(host),
      core_(make(host)),
      rejected_(host.health().counter("inputs: rejected")),
      rejected_faces_(host.health().counter("faces: rejected")),
      ignored_answers_(host.health().counter("answers: ignored")),
      memory_(host, kMemory),
      transforms_(host),
      requests_(host, topics::kSupervisorRequest),
      goals_(host, topics::kNavigateGoal),
      explorations_(host, topics::kExploreGoal) {
  supervisor_ = host.input(
      topics::kSupervisorStatus,
      {.max_age = kSupervisorAge, .on_loss = "waits; a mission fails after a while"},
      [this](const auto& status, const auto&) {
        requests_.answered(status.last_request(), status.last_request_client());
        step();
      },
      [this] { step(); });
  navigation_ = host.input(
      topics::kNavigateStatus,
      {.max_age = kGoalAge, .on_loss = "a drive fails after a while; what it was for is left out"},
      [this](const auto& status, const auto&) {
        goals_.answered(status.id(), status.client());
        step();
      },
      [this] { step(); });
  exploration_ = host.input(
      topics::kExploreStatus,
      {.max_age = kGoalAge, .on_loss = "an exploration fails after a while and is begun again"},
      [this](const auto& status, const auto&) {
        explorations_.answered(status.id(), status.client());
        step();
      },
      [this] { step(); });
  localization_ = host.input(
      topics::kLocalizationStatus,
      {.max_age = kLocalizationAge, .on_loss = "sees nobody; a mission fails after a while"});
  map_ =
      host.input(topics::kMap, {}, [this](const auto& message, const auto&) { take_map(message); });
  locations_ = host.input(topics::kLocations, {},
                          [this](const auto& message, const auto&) { take_locations(message); });
  faces_ = host.input(topics::kFaces,
                      {.max_age = kFacesAge,
                       .on_loss = "takes no request; looks on, sees nobody",
                       .optional = true},
                      [this](const auto& message, const auto&) { take_faces(message); });
  scan_ = host.input(
      topics::kScanFiltered,
      {.max_age = kScanAge, .on_loss = "who follows is known by the face alone", .optional = true},
      [this](const auto&, const auto&) { take_scan(); });
  request_ = host.input(topics::kMeetingRequest, {.optional = true},
                        [this](const auto& request, const auto&) { take_request(request); });
  cancel_ = host.input(
      topics::kMeetingCancel, {.optional = true},
      [this](const auto& cancel, const auto&) { act(core_.cancel(cancel.id(), now())); });
  answers_ = host.input(topics::kDialogueAnswer, {.optional = true},
                        [this](const auto& answer, const auto&) { take_answer(answer); });
  screen_ = host.output(topics::kDialogueScreen);
  status_ = host.output(topics::kMeetingStatus);
  reports_ = host.output(topics::kMeetingReport);
  target_ = host.output(topics::kInteractionTarget);
  cancel_drive_ = host.output(topics::kNavigateCancel);
  cancel_exploration_ = host.output(topics::kExploreCancel);
  team_ = host.input(topics::kFleetMeeting,
                     {.max_age = kTeamAge,
                      .on_loss = "does the work of the robots that are silent, too",
                      .optional = true,
                      .each_writer = true},
                     [this](const auto& message, const auto&) { take_team(message); });
  places_ = host.input(topics::kFleetLook, {.max_age = kTeamAge,
                                            .on_loss = "does not know who is nearer to somebody",
                                            .optional = true,
                                            .each_writer = true});
  team_told_ = host.output(topics::kFleetMeeting);
  share_ = host.output(topics::kExploreShare);
  told_ = static_cast<std::uint64_t>(host.now().time_since_epoch().count() / 1000);
  timer_ = host.timer("step", kPeriod, [this](auto) { tick(); });
  recall();
  publish_screen();
  publish_status();
}

/// A mission does not outlive its component: what it left running ends, who asked hears it.
void MeetingComponent::recall() {
  auto report = report_from_text(memory_.found());
  if (!report) return;
  left_ = std::move(report).value();
  left_->outcome = Outcome::kFailed;
  left_->reason = "the assistant was restarted";
}

/// Whatever still works for the mission that a restart ended is told to stop until it says that it
/// has: nobody would notice who drives on. What is silent for a while is not waited for.
void MeetingComponent::end_what_was_left() {
  bool unknown = false, runs = false, anothers = false;
  const auto end = [&](const auto* status, auto& output) {
    namespace goal = usher_msgs::msg::GoalStatus_Constants;
    unknown = unknown || status == nullptr;
    if (status == nullptr ||
        (status->state() != goal::STATE_ACTIVE && status->state() != goal::STATE_WAITING))
      return;
    if (status->client() != host_.name()) {
      anothers = true;
      return;
    }
    usher_msgs::msg::GoalCancel cancel;
    cancel.client(host_.name());
    cancel.id(status->id());
    output.publish(cancel);
    runs = true;
  };
  end(exploration_.fresh(), cancel_exploration_);
  end(navigation_.fresh(), cancel_drive_);
  if (runs || (unknown && ticks_ < kWaitedFor)) return;
  if (!anothers) {  // an operator may have sent the robot somewhere meanwhile
    usher_msgs::msg::SupervisorRequest request;
    request.id(requests_.next_id());
    request.command(service::command_for(service::RequestKind::kNavigationEnd));
    requests_.ask(std::move(request));
  }
  reports_.publish(to_message(*left_, host_.now()));
  left_.reset();
  remember();
}

void MeetingComponent::take_map(const nav_msgs::msg::OccupancyGrid& message) {
  const auto map = wire::from_message(message);
  if (!map || !core_.set_map(*map)) ++rejected_;
}

void MeetingComponent::take_locations(const usher_msgs::msg::Locations& message) {
  std::vector<Place> places;
  for (const auto& location : message.locations()) {
    const auto& at = location.pose().position();
    places.push_back({location.name(), location.title(), {at.x(), at.y()}});
  }
  core_.set_places(places);
}

/// With the pose of the image's time.
void MeetingComponent::take_faces(const usher_msgs::msg::Faces& message) {
  if (!pose()) return;
  transforms_.when_known(
      frames::kMap, frames::kBaseFootprint, wire::from_message(message.header().stamp()),
      [this, message](const geometry::Pose3& pose) { see(message, geometry::to_plane(pose)); });
}

void MeetingComponent::see(const usher_msgs::msg::Faces& message, const Pose2& pose) {
  Faces faces;
  faces.image_width = message.image_width();
  faces.pose = pose;
  faces.faces.reserve(message.faces().size());
  for (const auto& face : message.faces()) {
    faces.faces.push_back({face.left(), face.top(), face.width(), face.height(), face.depth(),
                           face.range(), face.bearing()});
  }
  act(core_.see(std::move(faces), now()));
  rejected_faces_ = core_.rejected_faces();
}

void MeetingComponent::take_scan() {
  if ((core_.state() != State::kGuide && core_.state() != State::kLookBack) || !pose()) return;
  const auto scan = scan_.share();
  if (!wire::check(*scan)) {
    ++rejected_;
    return;
  }
  transforms_.when_known(
      frames::kMap, scan->header().frame_id(), wire::from_message(scan->header().stamp()),
      [this, scan](const geometry::Pose3& pose) { look(*scan, geometry::to_plane(pose)); });
}

void MeetingComponent::look(const sensor_msgs::msg::LaserScan& scan, const Pose2& map_T_scan) {
  points_.clear();
  double angle = scan.angle_min();
  for (const float range : scan.ranges()) {
    if (range >= scan.range_min() && range <= scan.range_max())
      points_.push_back(map_T_scan * Point2(range * std::cos(angle), range * std::sin(angle)));
    angle += static_cast<double>(scan.angle_increment());
  }
  act(core_.look(map_T_scan.position(), points_, now()));
}

void MeetingComponent::take_request(const usher_msgs::msg::MeetingRequest& request) {
  if (left_) return;  // the request is repeated; what a restart left is ended first
  step();
  if (!core_.request({request.id(), request.client(), request.persons(),
                      static_cast<double>(request.time_limit())},
                     now()))
    ++rejected_;
  step();
  remember();
  publish_status();
}

void MeetingComponent::take_team(const usher_msgs::msg::FleetMeeting& message) {
  if (left_) return;  // the next one comes soon
  core_.hear(from_message(message, now()));
  step();
}

/// Twice a second, and at once when something changes.
void MeetingComponent::tell_team() {
  if (host_.robot_name().empty() || left_) return;
  team_told_.publish(to_message(core_.tell(now()), host_.robot_name(), ++told_, host_.now()));
}

void MeetingComponent::take_answer(const usher_msgs::msg::DialogueAnswer& answer) {
  const auto input = static_cast<service::Input>(std::min<std::uint8_t>(answer.input(), 2));
  act(core_.answer(
      {answer.screen_id(), answer.option_id(), answer.text(), input, answer.client(), answer.id()},
      now()));
  ignored_answers_ = core_.ignored_answers();
}

/// In map, as long as localization knows it.
std::optional<Pose2> MeetingComponent::pose() const {
  const auto* localization = localization_.fresh();
  if (localization == nullptr ||
      localization->state() == usher_msgs::msg::LocalizationStatus_Constants::STATE_LOST)
    return std::nullopt;
  return transforms_.newest_planar(frames::kMap, frames::kBaseFootprint, kPoseAge);
}

Surroundings MeetingComponent::surroundings() const {
  Surroundings s;
  s.pose = pose();
  if (const auto* status = supervisor_.fresh()) {
    s.supervisor = service::supervisor_from(status->state());
    s.stopped = !status->stopped_by().empty();
  }
  const auto report = [this](const auto& status) {
    const bool ours = status.client() == host_.name();
    return GoalReport{ours ? status.id() : 0, goal_state(status.state()), status.reason()};
  };
  if (const auto* status = navigation_.fresh()) s.navigation = report(*status);
  if (const auto* status = exploration_.fresh()) s.exploration = report(*status);
  s.sees = faces_.fresh() != nullptr;
  for (const auto* told : team_.fresh_of_each()) {
    if (!left_) s.team.push_back(told->robot());
  }
  for (const auto* place : places_.fresh_of_each()) {
    if (const Point2 at(place->x(), place->y()); at.allFinite()) s.team_at[place->robot()] = at;
  }
  return s;
}

std::string MeetingComponent::lacks() const {
  if (supervisor_.fresh() == nullptr) return "no supervisor";
  if (navigation_.fresh() == nullptr) return "no navigator";
  if (exploration_.fresh() == nullptr) return "no explorer";
  if (faces_.fresh() == nullptr) return "no face detector";
  if (core_.state() == State::kInitialise) return core_.screen().status;
  return {};
}

void MeetingComponent::tick() {
  step();
  turn();
  if (++ticks_ % kStatusEvery == 0) {
    publish_status();
    tell_team();
    if (core_.state() == State::kGuide) publish_screen();  // the remaining way
  }
  if (explores_ && ticks_ % kAskEvery == 0) explorations_.ask(*explores_);
  if (left_ && ticks_ % kFoundAfter == 0) end_what_was_left();
  const std::string lacking = lacks();
  host_.health().set(lacking.empty() ? HealthState::kOk : HealthState::kDegraded, lacking);
}

/// Only while a mission goes on: others may turn the robot, too.
void MeetingComponent::turn() {
  if (!active(core_.state())) return;
  namespace mode = usher_msgs::msg::FaceTarget_Constants;
  usher_msgs::msg::FaceTarget target;
  target.header(wire::header(host_.now(), frames::kBaseFootprint));
  target.mode(core_.turn() == Turn::kFace     ? mode::MODE_FACE
              : core_.turn() == Turn::kSearch ? mode::MODE_SEARCH
                                              : mode::MODE_STAND);
  target.bearing(core_.bearing());
  target_.publish(target);
}

void MeetingComponent::act(const Actions& actions) {
  if (actions.motion.cancel || actions.motion.stop_exploring) {
    usher_msgs::msg::GoalCancel cancel;
    cancel.client(host_.name());
    cancel.id(actions.motion.cancel.value_or(0));
    goals_.give_up();
    if (actions.motion.cancel) cancel_drive_.publish(cancel);
    cancel.id(actions.motion.stop_exploring.value_or(0));
    explorations_.give_up();
    explores_.reset();
    if (actions.motion.stop_exploring) cancel_exploration_.publish(cancel);
  }
  for (const auto& request : actions.motion.requests) {
    usher_msgs::msg::SupervisorRequest message;
    message.id(requests_.next_id());
    message.command(service::command_for(request.kind));
    message.goal(request.goal);
    requests_.ask(std::move(message));
  }
  if (const auto& goal = actions.motion.goal) {
    usher_msgs::msg::NavigateGoal message;
    message.id(goal->id);
    message.location(goal->location);
    message.pose().header(wire::header(host_.now(), frames::kMap));
    message.pose().pose(wire::to_message(goal->pose));
    goals_.give_up();
    goals_.ask(std::move(message));
  }
  if (const auto& exploration = actions.motion.explore) {
    usher_msgs::msg::ExploreGoal message;
    message.id(exploration->id);
    message.anew(exploration->anew);
    explorations_.give_up();
    explores_ = message;
    explorations_.ask(std::move(message));
  }
  if (actions.report) reports_.publish(to_message(*actions.report, host_.now()));
  if (actions.share) {
    usher_msgs::msg::ExploreShare message;
    message.header(wire::header(host_.now(), frames::kMap));
    message.own(static_cast<std::uint32_t>(actions.share->own));
    for (const Point2& place : actions.share->places) {
      auto& point = message.places().emplace_back();
      point.x(place.x());
      point.y(place.y());
    }
    share_.publish(message);
  }
  if (actions.status_changed) {
    publish_status();
    tell_team();
    remember();
  }
  if (actions.screen_changed) publish_screen();
}

/// While a mission goes on; nothing once it is over.
void MeetingComponent::remember() {
  if (left_) return;  // not told yet
  memory_.keep(active(core_.state()) ? to_text(core_.report()) : std::string());
}

void MeetingComponent::publish_status() {
  usher_msgs::msg::MeetingStatus message;
  message.header(wire::header(host_.now(), ""));
  message.state(static_cast<std::uint8_t>(core_.state()));
  message.reason(core_.reason().empty() ? lacks() : core_.reason());
  message.last_request(core_.last_request());
  message.last_client(core_.last_client());
  const auto left = core_.time_left(now());
  message.time_left(left ? static_cast<float>(runtime::seconds(*left))
                         : std::numeric_limits<float>::quiet_NaN());
  message.remembered(static_cast<std::uint32_t>(core_.people().remembered().size()));
  message.mission(to_message(core_.report(), host_.now()));
  if (active(core_.state()))
    message.mission().duration(static_cast<float>(runtime::seconds(core_.elapsed(now()))));
  status_.publish(message);
}

void MeetingComponent::publish_screen() {
  auto message = service::to_message(core_.screen(), host_.now());
  if (const auto* supervisor = supervisor_.fresh()) message.robot_state(supervisor->state());
  if (const auto* navigation = navigation_.fresh()) {
    message.navigation_status(navigation->state());
    namespace goal = usher_msgs::msg::GoalStatus_Constants;
    const bool ours =
        navigation->client() == host_.name() && navigation->id() == core_.goal_id() &&
        (navigation->state() == goal::STATE_ACTIVE || navigation->state() == goal::STATE_WAITING);
    if (core_.state() == State::kGuide && ours) {
      message.progress(navigation->progress());
      message.eta(navigation->eta());
      message.remaining(navigation->remaining());
    }
  }
  if (const auto here = pose()) {
    message.located(true);
    message.x(here->x);
    message.y(here->y);
    message.yaw(here->yaw);
  }
  message.answer_client(core_.last_answer().client);
  message.answer_id(core_.last_answer().id);
  message.answer_result(static_cast<std::uint8_t>(core_.last_result()));
  screen_.publish(message);
}

}  // namespace usher::meeting
