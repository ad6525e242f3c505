#include "tasks/guide/shell/component.hpp"

#include <sstream>

#include "interaction/phrases/shell/read_phrases.hpp"
#include "tasks/service/shell/messages.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"
#include "wire/own_stop.hpp"

namespace usher::guide {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kSupervisorAge = milliseconds(1000);
constexpr auto kNavigationAge = milliseconds(2000);
constexpr auto kFollowAge = milliseconds(1000);
constexpr auto kLocalizationAge = milliseconds(2000);
constexpr auto kVisitorAge = milliseconds(500);
constexpr auto kSpeechAge = milliseconds(2000);
constexpr auto kTorsoAge = milliseconds(1000);
constexpr auto kPoseAge = milliseconds(1000);
constexpr const char* kMemory = "session.dialogue";  // after a boot nobody waits to be guided on
constexpr const char* kLog = "visits.csv";

}  // namespace

Parameters GuideComponent::read_parameters(runtime::Parameters& parameters) {
  Parameters p;
  const auto time = [&](const char* name, runtime::Range range, Time& value, const char* text) {
    value =
        runtime::from_seconds(parameters.number(name, "s", range, runtime::seconds(value), text));
  };
  const auto number = [&](const char* name, const char* unit, runtime::Range range, double& value,
                          const char* text) {
    value = parameters.number(name, unit, range, value, text);
  };
  time("introduction_time", {1, 60}, p.introduction, "How long the greeting is shown.");
  time("answer_timeout", {30, 3600}, p.answer,
       "How long a question waits for an answer; above warning_time.");
  time("warning_time", {20, 600}, p.warning,
       "So long before a time-out it is announced, with a button for more time; at least 20 s by "
       "WCAG 2.2.1.");
  time("pause_timeout", {30, 3600}, p.pause,
       "How long a stop on the way waits; above warning_time.");
  time("arrived_time", {1, 60}, p.arrived, "How long the arrival is shown.");
  time("goodbye_time", {1, 60}, p.goodbye, "How long the goodbye is shown.");
  time("left_time", {2, 600}, p.left, "Nobody there for so long: the visitor has gone.");
  time("greet_after", {0.2, 30}, p.greet_after,
       "How long somebody must be near before being greeted.");
  number("greet_within", "m", {0.5, 5}, p.greet_within, "How near somebody is greeted.");
  number("greet_below", "m/s", {0.1, 3}, p.greet_below, "Who walks faster passes by.");
  time("tone_time", {0.5, 5}, p.tone,
       "From the tone to the first motion; ISO 13482 asks for a warning.");
  time("acknowledge_timeout", {1, 60}, p.acknowledge, "The navigator must take a goal by then.");
  time("recovery_timeout", {5, 3600}, p.recovery,
       "How long a robot that may not move is waited for.");
  time("finish_time", {1, 60}, p.finish,
       "Greeting, arrival and goodbye stay so much longer at most, until they are said to their "
       "end.");
  time("please_after", {1, 60}, p.please, "Blocked for so long it asks to make way.");
  number("guide_speed", "m/s", {0.2, 1.4}, p.speed,
         "Pace of guiding; the limits of the place still hold.");
  number("follow_near", "m", {0.5, 6}, p.follow.near, "Up to this gap at the full pace.");
  number("follow_far", "m", {1, 6}, p.follow.far, "At this gap the robot waits.");
  number("follow_resume", "m", {0.5, 6}, p.follow.resume, "At this gap it goes on.");
  time("follow_unseen", {0.5, 10}, p.follow.unseen, "Nobody behind for so long: it waits.");
  time("follow_grace", {0.1, 60}, p.follow.grace,
       "After a departure the visitor steps behind: for so long at most, and until he was seen "
       "there.");
  number("follow_grace_way", "m", {0, 10}, p.follow.grace_way,
         "The same: until the robot has gone so far.");
  time("follow_call", {1, 60}, p.follow.call, "Waiting for so long it calls, and again.");
  time("follow_give_up", {5, 3600}, p.follow.give_up, "Waiting for so long it gives up.");
  number("follow_behind", "m", {0.8, 4}, p.behind,
         "So far behind a visitor whom the robot follows.");
  p.questionnaire =
      parameters.flag("questionnaire", p.questionnaire,
                      "At the end of a visit that arrived: the thesis' questionnaire, 13 "
                      "statements where there are voice and torso.");
  return p;
}

Guide GuideComponent::make(runtime::Host& host, const std::string& kept) {
  auto& parameters = host.parameters();
  const Parameters p = read_parameters(parameters);
  auto phrases = phrases::read_phrases(host, "guide", kTextKeys);
  if (p.warning >= p.answer || p.warning >= p.pause) {
    std::ostringstream wrong;
    wrong << "warning_time must be below answer_timeout and pause_timeout, got "
          << runtime::seconds(p.warning) << " s, " << runtime::seconds(p.answer) << " s and "
          << runtime::seconds(p.pause) << " s";
    host.fault(wrong.str());
  }
  if (!(p.follow.resume < p.follow.far) || !(p.follow.near < p.follow.far))
    host.fault("follow_near and follow_resume must be below follow_far");
  Memory memory;
  auto& unreadable = host.health().counter("memory: unreadable");
  if (auto read = memory_from_text(kept)) {
    memory = std::move(read).value();
  } else if (!kept.empty()) {
    ++unreadable;
  }
  // Ids above all that were used before a restart.
  const auto first_id = static_cast<std::uint64_t>(host.now().time_since_epoch().count() / 1000);
  return Guide(p, std::move(phrases), first_id, memory, host.now().time_since_epoch());
}

GuideComponent::GuideComponent(runtime::Host& host)
    : host_(host),
      memory_(host, kMemory),
      visits_kept_(host, kLog),
      core_(make(host, memory_.found())),
      log_(visits_kept_.found()),
      max_speed_(static_cast<float>(core_.parameters().speed)),
      ignored_answers_(host.health().counter("answers: ignored")),
      rejected_locations_(host.health().counter("locations: rejected")),
      titles_(phrases::read_place_titles(host)),
      transforms_(host),
      requests_(host, topics::kSupervisorRequest),
      goals_(host, topics::kNavigateGoal) {
  supervisor_ = host.input(
      topics::kSupervisorStatus,
      {.max_age = kSupervisorAge, .on_loss = "says that it is not ready; a guidance waits"},
      [this](const auto& status, const auto&) { take_supervisor(status); }, [this] { step(); });
  navigation_ = host.input(
      topics::kNavigateStatus,
      {.max_age = kNavigationAge,
       .on_loss = "a guidance fails after a while and offers another try"},
      [this](const auto& status, const auto&) {
        goals_.answered(status.id(), status.client());
        step();
      },
      [this] { step(); });
  follow_ =
      host.input(topics::kFollowStatus,
                 {.max_age = kFollowAge, .on_loss = "asks nobody to make way", .optional = true});
  locations_ = host.input(topics::kLocations, {},
                          [this](const auto& message, const auto&) { take_locations(message); });
  localization_ =
      host.input(topics::kLocalizationStatus, {.max_age = kLocalizationAge,
                                               .on_loss = "says that it does not know where it is",
                                               .optional = true});
  visitor_ = host.input(topics::kVisitor,
                        {.max_age = kVisitorAge,
                         .on_loss = "greets nobody, waits for nobody: the visitor is unknown",
                         .optional = true},
                        [this](const auto& visitor, const auto&) { place(visitor); });
  speech_ =
      host.input(topics::kSpeechStatus, {.max_age = kSpeechAge,
                                         .on_loss = "its screens do not wait for what is said",
                                         .optional = true});
  torso_ =
      host.input(topics::kTorsoStatus, {.max_age = kTorsoAge,
                                        .on_loss = "its questionnaire asks nothing about the body",
                                        .optional = true});
  answers_ = host.input(topics::kDialogueAnswer, {.optional = true},
                        [this](const auto& answer, const auto&) { take_answer(answer); });
  screen_ = host.output(topics::kDialogueScreen);
  status_ = host.output(topics::kGuideStatus);
  visits_ = host.output(topics::kGuideVisit);
  pace_ = host.output(topics::kNavigatePace);
  cancel_ = host.output(topics::kNavigateCancel);
  target_ = host.output(topics::kInteractionTarget);
  timer_ = host.timer("step", milliseconds(100), [this](auto) { tick(); });
  publish_screen();
  publish_status();
}

void GuideComponent::tick() {
  step();
  if (const auto bearing = core_.turns_to()) {
    usher_msgs::msg::FaceTarget target;
    target.header(wire::header(host_.now(), frames::kBaseFootprint));
    target.mode(usher_msgs::msg::FaceTarget_Constants::MODE_FACE);
    target.bearing(*bearing);
    target_.publish(target);
  }
  if (++ticks_ % 10 == 0) publish_status();
  const bool heard = supervisor_.fresh() != nullptr && navigation_.fresh() != nullptr;
  host_.health().set(heard ? HealthState::kOk : HealthState::kDegraded,
                     heard                            ? ""
                     : supervisor_.fresh() == nullptr ? "no supervisor"
                                                      : "no navigator");
}

Surroundings GuideComponent::surroundings() const {
  Surroundings s;
  if (const auto* status = supervisor_.fresh()) {
    s.supervisor = service::supervisor_from(status->state());
    const bool stopped = std::ranges::any_of(
        status->stopped_by(), [&](const auto& client) { return client != host_.name(); });
    s.permission = stopped             ? Permission::kStopped
                   : status->granted() ? Permission::kGiven
                                       : Permission::kRefused;
    s.stop_holds = wire::own_stop(*status, host_.name(), requests_);
  }
  if (const auto* status = navigation_.fresh()) {
    const auto* follow = follow_.fresh();
    const bool blocked = follow != nullptr &&
                         follow->state() == usher_msgs::msg::GoalStatus_Constants::STATE_WAITING &&
                         follow->blocked_for() > 0.0F;
    s.navigation = Navigation{
        status->id(),        static_cast<GoalState>(std::min<std::uint8_t>(status->state(), 6)),
        status->progress(),  status->eta(),
        status->remaining(), blocked,
        status->replans(),   status->client() == host_.name()};
  }
  namespace seen = usher_msgs::msg::Visitor_Constants;
  const auto* visitor = visitor_.fresh();
  if (visitor != nullptr && visitor->presence() != seen::PRESENCE_UNKNOWN) {
    s.visitor = VisitorSighting{visitor->presence() == seen::PRESENCE_SEEN,
                                visitor->x(),
                                visitor->y(),
                                visitor->speed(),
                                visitor_in_map_,
                                visitor->person()};
  }
  if (const auto* speech = speech_.fresh(); speech != nullptr && speech->audible())
    s.speech = Speech{speech->spoken_id(), speech->finished(), speech->understands()};
  s.torso = torso_.fresh() != nullptr;
  const auto* localization = localization_.fresh();
  if (localization != nullptr &&
      localization->state() != usher_msgs::msg::LocalizationStatus_Constants::STATE_LOST) {
    s.pose = transforms_.newest_planar(frames::kMap, frames::kBaseFootprint, kPoseAge);
  }
  return s;
}

/// In map, by where the robot was when it saw him: while it turns, a moment makes half a metre.
void GuideComponent::place(const usher_msgs::msg::Visitor& visitor) {
  const std::uint64_t number = ++placed_;
  visitor_in_map_.reset();
  if (visitor.presence() != usher_msgs::msg::Visitor_Constants::PRESENCE_SEEN) return;
  transforms_.when_known(
      frames::kMap, frames::kBaseFootprint, wire::from_message(visitor.header().stamp()),
      [this, number, at = geometry::Point2(visitor.x(), visitor.y())](const auto& pose) {
        if (number == placed_) visitor_in_map_ = geometry::to_plane(pose) * at;
      });
}

void GuideComponent::take_locations(const usher_msgs::msg::Locations& message) {
  std::vector<Location> locations;
  for (const auto& location : message.locations()) {
    const auto& at = location.pose().position();
    const auto titles = titles_.find(location.name());
    locations.push_back({location.name(),
                         location.title(),
                         {at.x(), at.y()},
                         titles == titles_.end() ? decltype(Location::titles){} : titles->second});
  }
  if (!core_.set_locations(std::move(locations), now())) ++rejected_locations_;
  step();
}

void GuideComponent::take_supervisor(const usher_msgs::msg::SupervisorStatus& status) {
  const bool ours = requests_.answered(status.last_request(), status.last_request_client());
  if (ours && !status.last_request_done()) act(core_.refused(now()));
  step();
}

void GuideComponent::take_answer(const usher_msgs::msg::DialogueAnswer& answer) {
  const auto input = static_cast<Input>(std::min<std::uint8_t>(answer.input(), 2));
  act(core_.answer(
      {answer.screen_id(), answer.option_id(), answer.text(), input, answer.client(), answer.id()},
      now()));
  ignored_answers_ = core_.ignored_answers();
}

void GuideComponent::act(const Actions& actions) {
  for (const auto& request : actions.requests) {
    usher_msgs::msg::SupervisorRequest message;
    message.id(requests_.next_id());
    message.command(service::command_for(request.kind));
    message.goal(request.goal);
    if (request.kind != RequestKind::kStop) {
      requests_.ask(std::move(message));
      continue;
    }
    requests_.ask_first(std::move(message), [](const auto& waiting) {
      return waiting.command() == usher_msgs::msg::SupervisorRequest_Constants::COMMAND_MOVEMENT_ON;
    });
  }
  if (actions.goal) {
    usher_msgs::msg::NavigateGoal goal;
    goal.id(actions.goal->id);
    goal.location(actions.goal->location);
    if (const auto& pose = actions.goal->pose) {
      goal.pose().header(wire::header(host_.now(), frames::kMap));
      goal.pose().pose(wire::to_message(*pose));
    }
    goal.max_speed(max_speed_);
    goals_.give_up();
    goals_.ask(std::move(goal));
  }
  if (actions.cancel) {
    goals_.give_up();
    usher_msgs::msg::GoalCancel cancel;
    cancel.id(*actions.cancel);
    cancel.client(host_.name());
    cancel_.publish(cancel);
  }
  if (actions.pace && ticks_ % 2 == 0) {
    usher_msgs::msg::NavigatePace pace;
    pace.id(core_.memory().goal_id);
    pace.client(host_.name());
    pace.max_speed(static_cast<float>(*actions.pace));
    pace_.publish(pace);
  }
  if (actions.remember) memory_.keep(to_text(core_.memory()));
  if (actions.visit) {
    visits_.publish(to_message(*actions.visit));
    log_.add(*actions.visit, core_.screen().language,
             runtime::seconds(host_.now().time_since_epoch()));
    visits_kept_.keep(log_.text());
    publish_status();
  }
  if (actions.screen_changed) publish_screen();
  // Who turns the robot or watches the visitor must not be a second late.
  if (core_.seeks() != told_.seeks() || core_.serves() != told_.serves() ||
      core_.guides() != told_.guides() || core_.follows() != told_.follows()) {
    publish_status();
  }
}

usher_msgs::msg::GuideVisit GuideComponent::to_message(const Visit& visit) const {
  usher_msgs::msg::GuideVisit message;
  message.header(wire::header(host_.now(), ""));
  message.id(visit.id);
  message.outcome(static_cast<std::uint8_t>(visit.outcome));
  message.language(core_.screen().language);
  message.place(visit.place);
  message.greeted(visit.greeted);
  message.engaged(visit.engaged());
  message.started(visit.started);
  message.arrived(visit.arrived);
  message.touches(visit.touches);
  message.utterances(visit.utterances);
  message.ignored(visit.ignored);
  message.duration(static_cast<float>(runtime::seconds(visit.duration)));
  message.travel_time(static_cast<float>(runtime::seconds(visit.travel_time)));
  message.eta_error(static_cast<float>(visit.eta_error));
  message.waits(visit.waits);
  message.largest_gap(static_cast<float>(visit.largest_gap));
  if (!visit.ratings.empty()) {
    message.ratings(visit.ratings);
    message.ratings().resize(kStatements);  // who went before the end skipped the rest
  }
  return message;
}

void GuideComponent::publish_status() {
  usher_msgs::msg::GuideStatus message;
  message.header(wire::header(host_.now(), ""));
  message.seeks(core_.seeks());
  message.serves(core_.serves());
  message.guides(core_.guides());
  message.follows(core_.follows());
  const Funnel& funnel = core_.funnel();
  message.greeted(funnel.greeted);
  message.engaged(funnel.engaged);
  message.started(funnel.started);
  message.arrived(funnel.arrived);
  message.given_up(funnel.given_up);
  message.visit(to_message(core_.visit()));
  status_.publish(message);
  told_ = message;
}

void GuideComponent::publish_screen() {
  auto message = service::to_message(core_.screen(), host_.now());
  if (const auto* supervisor = supervisor_.fresh()) message.robot_state(supervisor->state());
  if (const auto* navigation = navigation_.fresh()) message.navigation_status(navigation->state());
  message.human_detected(static_cast<std::uint8_t>(core_.human()));
  if (const auto& pose = core_.surroundings().pose) {
    message.located(true);
    message.x(pose->x);
    message.y(pose->y);
    message.yaw(pose->yaw);
  }
  message.answer_client(core_.last_answer().client);
  message.answer_id(core_.last_answer().id);
  message.answer_result(static_cast<std::uint8_t>(core_.last_result()));
  screen_.publish(message);
}

}  // namespace usher::guide
