#include "tasks/guide/shell/component.hpp"

#include "wire/conversions.hpp"

namespace usher::guide {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;
namespace command = usher_msgs::msg::SupervisorRequest_Constants;
namespace state = usher_msgs::msg::SupervisorStatus_Constants;

constexpr auto kSupervisorAge = milliseconds(1000);
constexpr auto kNavigationAge = milliseconds(2000);

Supervisor supervisor_from(std::uint8_t value) {
  switch (value) {
    case state::STATE_INITIALISE:
      return Supervisor::kNotReady;
    case state::STATE_INACTIVE:
      return Supervisor::kInactive;
    case state::STATE_INTERACTION:
      return Supervisor::kAvailable;
    case state::STATE_NAVIGATION_START:
    case state::STATE_NAVIGATION_ACTIVE:
    case state::STATE_NAVIGATION_END:
      return Supervisor::kNavigation;
    case state::STATE_MANUAL:
      return Supervisor::kManual;
    case state::STATE_FAULT:
      return Supervisor::kFault;
    default:
      return Supervisor::kUnknown;
  }
}

std::uint8_t command_for(RequestKind kind) {
  switch (kind) {
    case RequestKind::kNavigationStart:
      return command::COMMAND_NAVIGATION_START;
    case RequestKind::kNavigationGo:
      return command::COMMAND_NAVIGATION_GO;
    case RequestKind::kNavigationEnd:
      return command::COMMAND_NAVIGATION_END;
    case RequestKind::kStop:
      return command::COMMAND_STOP;
    case RequestKind::kMovementOn:
      return command::COMMAND_MOVEMENT_ON;
  }
  return command::COMMAND_NONE;
}

}  // namespace

Parameters GuideComponent::read_parameters(runtime::Parameters& parameters) {
  Parameters p;
  const auto time = [&](const char* name, Time& value, const char* text) {
    value = runtime::from_seconds(
        parameters.number(name, "s", {0.5, 3600}, runtime::seconds(value), text));
  };
  time("answer_timeout", p.answer, "How long a question waits for an answer.");
  time("pause_timeout", p.pause, "How long a stop on the way waits.");
  time("acknowledge_timeout", p.acknowledge, "The navigator must take a goal by then.");
  time("recovery_timeout", p.recovery, "How long a robot that may not move is waited for.");
  time("arrived_time", p.arrived, "How long the arrival is shown.");
  time("goodbye_time", p.goodbye, "How long the goodbye is shown.");
  return p;
}

GuideComponent::GuideComponent(runtime::Host& host)
    : host_(host),
      core_(read_parameters(host.parameters()),
            static_cast<std::uint64_t>(host.now().time_since_epoch().count() / 1000)),
      max_speed_(static_cast<float>(
          host.parameters().number("guide_speed", "m/s", {0.2, 1.4}, 1.15,
                                   "Pace of guiding; the limits of the place still hold."))),
      ignored_answers_(host.health().counter("answers: ignored")),
      rejected_locations_(host.health().counter("locations: rejected")),
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
        goals_.answered(status.id());
        step();
      },
      [this] { step(); });
  locations_ = host.input(topics::kLocations, {},
                          [this](const auto& message, const auto&) { take_locations(message); });
  answers_ = host.input(topics::kDialogueAnswer, {.optional = true},
                        [this](const auto& answer, const auto&) {
                          act(core_.answer({answer.screen_id(), answer.option_id()}, now()));
                          ignored_answers_ = core_.ignored_answers();
                        });
  screen_ = host.output(topics::kDialogueScreen);
  cancel_ = host.output(topics::kNavigateCancel);
  timer_ = host.timer("step", milliseconds(100), [this](auto) {
    step();
    const bool heard = supervisor_.fresh() != nullptr && navigation_.fresh() != nullptr;
    host_.health().set(heard ? HealthState::kOk : HealthState::kDegraded,
                       heard                            ? ""
                       : supervisor_.fresh() == nullptr ? "no supervisor"
                                                        : "no navigator");
  });
  publish_screen();
}

Surroundings GuideComponent::surroundings() const {
  Surroundings s;
  if (const auto* status = supervisor_.fresh()) s.supervisor = supervisor_from(status->state());
  if (const auto* status = navigation_.fresh()) {
    s.navigation = Navigation{
        status->id(), static_cast<NavigationState>(std::min<std::uint8_t>(status->state(), 6)),
        status->progress(), status->eta(), status->reason()};
  }
  return s;
}

void GuideComponent::take_locations(const usher_msgs::msg::Locations& message) {
  std::vector<Location> locations;
  for (const auto& location : message.locations())
    locations.push_back({location.name(), location.title()});
  if (!core_.set_locations(std::move(locations), now())) ++rejected_locations_;
  step();
}

void GuideComponent::take_supervisor(const usher_msgs::msg::SupervisorStatus& status) {
  if (requests_.answered(status.last_request()) && !status.last_request_done()) {
    act(core_.refused(status.last_request_reason(), now()));
  }
  step();
}

void GuideComponent::act(const Actions& actions) {
  for (const auto& request : actions.requests) {
    usher_msgs::msg::SupervisorRequest message;
    message.id(requests_.next_id());
    message.command(command_for(request.kind));
    message.goal(request.goal);
    requests_.ask(std::move(message));
  }
  if (actions.goal) {
    usher_msgs::msg::NavigateGoal goal;
    goal.id(actions.goal->id);
    goal.location(actions.goal->location);
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
  if (actions.screen_changed) publish_screen();
}

void GuideComponent::publish_screen() {
  const Screen& screen = core_.screen();
  usher_msgs::msg::DialogueScreen message;
  message.header(wire::header(host_.now(), ""));
  message.id(screen.id);
  message.state(screen.state);
  message.title(screen.title);
  message.text(screen.text);
  for (const auto& option : screen.options) {
    auto& entry = message.options().emplace_back();
    entry.id(option.id);
    entry.label(option.label);
    entry.kind(static_cast<std::uint8_t>(option.kind));
  }
  message.progress(static_cast<float>(screen.progress));
  message.eta(static_cast<float>(screen.eta));
  screen_.publish(message);
}

}  // namespace usher::guide
