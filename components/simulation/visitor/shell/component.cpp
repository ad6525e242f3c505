#include "simulation/visitor/shell/component.hpp"

namespace usher::visitor {

namespace {

constexpr auto kStep = std::chrono::milliseconds(200);
constexpr double kDawdling = 0.5;  ///< [m/s]
namespace input = usher_msgs::msg::DialogueAnswer_Constants;

double in_seconds(runtime::Time time) { return runtime::seconds(time.time_since_epoch()); }

}  // namespace

Character VisitorComponent::read_character(runtime::Parameters& parameters) {
  Character c;
  c.destination =
      parameters.text("destination", "lounge", "Name of the location that the visitor asks for.");
  c.returns_to = parameters.text("returns_to", "", "A second location after the first.");
  c.language = parameters.text("language", "en", "Which one the visitor chooses.");
  c.reading_time = parameters.number("reading_time", "s", {0, 60}, 1.5,
                                     "How long a screen is read before it is answered.");
  c.looks_at_map = parameters.flag("looks_at_map", false, "Wants to see the map first.");
  c.asks_where = parameters.flag("asks_where", false, "Asks on the map where the place is.");
  c.types = parameters.flag("types", false, "Types the place's name.");
  c.gives_up_in =
      parameters.text("gives_up_in", "", "State of the dialogue from which on it answers nothing.");
  const auto time = [&](const char* name, double& value, const char* text) {
    value = parameters.number(name, "s", {-1, 3600}, value, text);
  };
  time("stops_at", c.stops_at, "Stops the robot so long after the departure; -1 = never.");
  time("stops_for", c.stops_for, "How long.");
  time("cancels_at", c.cancels_at, "Cancels so long after the departure; -1 = never.");
  time("dawdles_at", c.dawdles_at, "Walks slowly from then on; -1 = never.");
  time("ties_lace_at", c.ties_lace_at, "Stands to tie a lace; -1 = never.");
  time("ties_lace_for", c.ties_lace_for, "How long.");
  time("walks_away_at", c.walks_away_at, "Leaves the robot; -1 = never.");
  time("walks_away_for", c.walks_away_for, "And comes back after so long; -1 = never.");
  return c;
}

VisitorComponent::VisitorComponent(runtime::Host& host)
    : host_(host),
      core_(read_character(host.parameters())),
      answers_(host, topics::kDialogueAnswer) {
  auto& parameters = host.parameters();
  person_ = parameters.text("person", "visitor", "Name of the person in the world.");
  speed_ = parameters.number("speed", "m/s", {0.1, 2}, 1.2, "How fast the visitor walks.");
  input_ = parameters.flag("speaks", false, "Answers as if by voice instead of by touch.")
               ? input::INPUT_VOICE
               : input::INPUT_TOUCH;
  leaves_to_ = parameters.numbers("leaves_to", "m", {-1000, 1000}, 2, 2, {3.7, 6.0},
                                  "Where the visitor goes who leaves the robot.");
  screen_ = host.input(topics::kDialogueScreen, {},
                       [this](const auto& screen, const auto&) { take(screen); });
  walk_ = host.output(topics::kSimPersonGoal);
  timer_ = host.timer("step", kStep, [this](auto) { step(); });
  host.health().set(runtime::HealthState::kOk);
}

void VisitorComponent::take(const usher_msgs::msg::DialogueScreen& screen) {
  if (screen.answer_client() == host_.name()) answers_.answered(screen.answer_id());
  Screen seen{.id = screen.id(), .state = screen.state(), .language = screen.language()};
  for (const auto& option : screen.options()) {
    seen.options.push_back(option.id());
    if (option.takes_text()) seen.text_option = option.id();
  }
  if (screen.time_left() >= 0.0F) seen.time_left = screen.time_left();
  core_.see(seen, in_seconds(host_.now()));
}

void VisitorComponent::step() {
  const double now = in_seconds(host_.now());
  if (const auto choice = core_.answer(now)) {
    usher_msgs::msg::DialogueAnswer message;
    message.id(answers_.next_id());
    message.screen_id(core_.screen_id());
    message.option_id(choice->option);
    message.text(choice->text);
    message.input(input_);
    answers_.ask(std::move(message));
  }
  const Walk walk = core_.walk(now);
  if (walk == Walk::kStand && walks_ == Walk::kStand) return;
  walks_ = walk;
  usher_sim_msgs::msg::PersonGoal goal;
  goal.name(person_);
  goal.speed(walk == Walk::kStand ? 0.0 : walk == Walk::kDawdle ? kDawdling : speed_);
  goal.x(leaves_to_[0]);
  goal.y(leaves_to_[1]);
  goal.follow(walk == Walk::kFollow || walk == Walk::kDawdle);
  walk_.publish(goal);
}

}  // namespace usher::visitor
