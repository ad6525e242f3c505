#include "simulation/visitor/shell/component.hpp"

namespace usher::visitor {

namespace {

constexpr auto kStep = std::chrono::milliseconds(200);

double in_seconds(runtime::Time time) { return runtime::seconds(time.time_since_epoch()); }

Visitor make(runtime::Parameters& parameters) {
  return Visitor(
      parameters.text("destination", "lounge", "Name of the location that the visitor asks for."),
      parameters.number("reading_time", "s", {0, 60}, 1.5,
                        "How long a screen is read before it is answered."));
}

}  // namespace

VisitorComponent::VisitorComponent(runtime::Host& host)
    : host_(host), core_(make(host.parameters())) {
  person_ = host.parameters().text("person", "visitor", "Name of the person in the world.");
  speed_ = host.parameters().number("speed", "m/s", {0.1, 2}, 1.2, "How fast the visitor walks.");
  screen_ = host.input(topics::kDialogueScreen, {}, [this](const auto& screen, const auto&) {
    Screen seen{screen.id(), screen.state(), {}};
    for (const auto& option : screen.options()) seen.options.push_back(option.id());
    core_.see(seen, in_seconds(host_.now()));
  });
  answer_ = host.output(topics::kDialogueAnswer);
  walk_ = host.output(topics::kSimPersonGoal);
  timer_ = host.timer("step", kStep, [this](auto) { step(); });
  host.health().set(runtime::HealthState::kOk);
}

void VisitorComponent::step() {
  if (const auto option = core_.answer(in_seconds(host_.now()))) {
    usher_msgs::msg::DialogueAnswer message;
    message.id(++answers_);
    message.client(host_.name());
    message.screen_id(core_.screen_id());
    message.option_id(*option);
    answer_.publish(message);
  }
  if (core_.follows()) {
    usher_sim_msgs::msg::PersonGoal goal;
    goal.name(person_);
    goal.speed(speed_);
    goal.follow(true);
    walk_.publish(goal);
  }
}

}  // namespace usher::visitor
