#include "simulation/visitor/shell/component.hpp"

#include "simulation/visitor/core/step_up.hpp"
#include "wire/conversions.hpp"

namespace usher::visitor {

namespace {

constexpr auto kStep = std::chrono::milliseconds(200);
constexpr auto kSpeechAge = std::chrono::milliseconds(3000);
constexpr auto kTruthAge = std::chrono::milliseconds(500);
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
  c.waits_for_greeting =
      parameters.flag("waits_for_greeting", false, "Touches nothing before the robot greets.");
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

VisitorComponent::VisitorComponent(runtime::Host& host, std::shared_ptr<Voice> voice)
    : host_(host),
      core_(read_character(host.parameters())),
      fell_back_(host.health().counter("answers: touched since nobody understood")),
      answers_(host, topics::kDialogueAnswer) {
  auto& parameters = host.parameters();
  person_ = parameters.text("person", "visitor", "Name of the person in the world.");
  speed_ = parameters.number("speed", "m/s", {0.1, 2}, 1.2, "How fast the visitor walks.");
  const std::string input = parameters.choice("input", {"touch", "voice", "mixed"}, "touch",
                                              "How it answers; mixed = by turns.");
  if (input == "voice") input_ = Input::kVoice;
  if (input == "mixed") input_ = Input::kMixed;
  const std::string finger = parameters.text(
      "finger", "",
      "Where the tablet waits for a finger, for example tcp://127.0.0.1:7431; empty = writes what "
      "it would touch itself.");
  const std::string mouth = parameters.text(
      "mouth", "",
      "Where the microphone of the robot is, for example tcp://127.0.0.1:7432; empty = writes what "
      "it would say itself.");
  if (voice != nullptr) limbs_ = std::make_unique<Limbs>(host, std::move(voice), finger, mouth);
  leaves_to_ = parameters.numbers("leaves_to", "m", {-1000, 1000}, 2, 2, {3.7, 6.0},
                                  "Where the visitor goes who leaves the robot.");
  steps_up_to_ = parameters.number("steps_up_to", "m", {0, 5}, 0.0,
                                   "So near it stands before the robot's screen unless the robot "
                                   "guides; 0 = it stays where it is.");
  comes_after_ = parameters.number("comes_after", "s", {0, 3600}, 3.0,
                                   "It comes so long after the robot began to wait for visitors.");
  screen_ = host.input(topics::kDialogueScreen, {},
                       [this](const auto& screen, const auto&) { take(screen); });
  speech_ = host.input(
      topics::kSpeechStatus,
      {.max_age = kSpeechAge, .on_loss = "touches what it wanted to say", .optional = true});
  if (steps_up_to_ > 0.0) {
    truth_ = host.input(topics::kSimGroundTruth,
                        {.max_age = kTruthAge, .on_loss = "stays where it is", .optional = true});
  }
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
  delivery_.see(seen.id, seen.options);
}

std::string VisitorComponent::label_of(const std::string& option) const {
  for (const auto& each : screen_.latest()->options()) {
    if (each.id() == option) return each.label();
  }
  return {};
}

void VisitorComponent::write(const Choice& choice, Means means) {
  usher_msgs::msg::DialogueAnswer message;
  message.id(answers_.next_id());
  message.screen_id(core_.screen_id());
  message.option_id(choice.option);
  message.text(choice.text);
  message.input(means == Means::kVoice ? input::INPUT_VOICE : input::INPUT_TOUCH);
  answers_.ask(std::move(message));
}

void VisitorComponent::give(const Choice& choice) {
  const bool voice = input_ == Input::kVoice || (input_ == Input::kMixed && turns_++ % 2 == 1);
  // Nobody spells what can be typed.
  const Means means = voice && choice.text.empty() ? Means::kVoice : Means::kTouch;
  if (!limbs_ || !(means == Means::kVoice ? limbs_->has_mouth() : limbs_->has_finger())) {
    write(choice, means);
    return;
  }
  if (!choice.text.empty()) {
    for (const char letter : choice.text)
      limbs_->tap({core_.screen_id(), true, std::string(1, letter)});
    return;
  }
  const bool urgent = choice.option == "stop" || choice.option == "cancel";
  delivery_.want({core_.screen_id(), choice.option, label_of(choice.option), means, urgent},
                 in_seconds(host_.now()));
}

void VisitorComponent::deliver(double now) {
  Ear ear;
  if (const auto* speech = speech_.fresh(); speech != nullptr && limbs_->has_mouth()) {
    ear.listens = speech->listens();
    ear.sounds = !speech->sentence().empty();
    ear.asks = speech->state() == usher_msgs::msg::SpeechStatus_Constants::STATE_ASKING;
    ear.hint = speech->hint();
  }
  const auto deed = delivery_.step(ear, now);
  fell_back_ = delivery_.fell_back();
  if (!deed) return;
  if (deed->means == Means::kVoice) {
    limbs_->say(deed->what);
  } else if (limbs_->has_finger()) {
    limbs_->tap({core_.screen_id(), false, deed->what});
  } else {
    write({deed->what, {}}, Means::kTouch);
  }
}

void VisitorComponent::step() {
  const double now = in_seconds(host_.now());
  if (const auto choice = core_.answer(now)) give(*choice);
  if (limbs_) {
    deliver(now);
    host_.health().set(
        limbs_->trouble().empty() ? runtime::HealthState::kOk : runtime::HealthState::kDegraded,
        limbs_->trouble());
  }
  walk(now);
}

void VisitorComponent::send(double x, double y, double speed, bool follow) {
  usher_sim_msgs::msg::PersonGoal goal;
  goal.name(person_);
  goal.speed(speed);
  goal.x(x);
  goal.y(y);
  goal.follow(follow);
  walk_.publish(goal);
}

/// From the first time that the robot waited for somebody for a while; not on the way.
bool VisitorComponent::at_screen(double now) {
  const auto* screen = screen_.latest();
  if (steps_up_to_ <= 0.0 || screen == nullptr) return false;
  if (!invited_at_ && screen->state() == "inactive") invited_at_ = now;
  return invited_at_ && now >= *invited_at_ + comes_after_;
}

void VisitorComponent::step_up() {
  const auto* truth = truth_.fresh();
  const auto robot = truth != nullptr ? wire::to_planar(truth->pose())
                                      : Result<geometry::Pose2>(Error{"nobody tells"});
  if (!robot) return;
  for (const auto& person : truth->people()) {
    if (person.name() != person_) continue;
    const auto place = visitor::step_up(*robot, {person.x(), person.y()}, steps_up_to_);
    if (place) {
      send(place->x(), place->y(), speed_, false);
    } else if (steps_up_) {
      send(person.x(), person.y(), 0.0, false);
    }
    steps_up_ = place.has_value();
  }
}

void VisitorComponent::walk(double now) {
  const Walk walk = core_.walk(now);
  if (walk == Walk::kStand && at_screen(now)) {
    walks_ = walk;
    step_up();
    return;
  }
  if (walk == Walk::kStand && walks_ == Walk::kStand) return;
  walks_ = walk;
  send(leaves_to_[0], leaves_to_[1],
       walk == Walk::kStand    ? 0.0
       : walk == Walk::kDawdle ? kDawdling
                               : speed_,
       walk == Walk::kFollow || walk == Walk::kDawdle);
}

}  // namespace usher::visitor
