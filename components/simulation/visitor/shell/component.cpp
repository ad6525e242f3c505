#include "simulation/visitor/shell/component.hpp"

#include <cmath>
#include <numbers>

#include "simulation/visitor/core/step_up.hpp"
#include "wire/conversions.hpp"

namespace usher::visitor {

namespace {

constexpr auto kStep = std::chrono::milliseconds(200);
constexpr auto kSpeechAge = std::chrono::milliseconds(3000);
constexpr auto kTruthAge = std::chrono::milliseconds(500);
constexpr double kDawdling = 0.5;   ///< [m/s]
constexpr double kBlocksAt = 1.2;   ///< [m] before the robot's middle
constexpr double kThere = 0.5;      ///< [m] from a point it has come by
constexpr double kLeadsBy = 3.5;    ///< [m] farther ahead of the robot it waits
constexpr double kReturnsTo = 1.5;  ///< [m] before a robot that has called
constexpr double kRound = 1.1;      ///< [m] from the robot's middle others stand
namespace input = usher_msgs::msg::DialogueAnswer_Constants;
namespace tone = usher_msgs::msg::DialogueScreen_Constants;

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
  time("blocks_at", c.blocks_at, "Steps before the robot; -1 = never.");
  time("blocks_for", c.blocks_for, "How long.");
  time("crowd_at", c.crowd_at, "The world's bystanders gather round the robot; -1 = never.");
  time("crowd_for", c.crowd_for, "How long.");
  c.leads = parameters.flag("leads", false, "Wants the robot to follow, along leads_along.");
  c.rates = parameters.choice("rates", {"none", "some", "all"}, "none",
                              "Statements of the questionnaire that it answers.");
  time("walks_away_at", c.walks_away_at, "Leaves the robot; -1 = never.");
  time("walks_away_for", c.walks_away_for, "And comes back after so long; -1 = never.");
  return c;
}

HearingRates VisitorComponent::read_hearing(runtime::Host& host) {
  HearingRates rates;
  const auto share = [&](const char* name, double& value, const char* text) {
    value = host.parameters().number(name, "-", {0, 1}, value, text);
  };
  share("voice_understood", rates.understood,
        "Share of what it says that is understood at once, where it has no mouth.");
  share("voice_asked_back", rates.asked_back, "That the robot asks back for.");
  share("voice_mistaken", rates.mistaken,
        "That is taken for another button; what remains is not heard.");
  share("voice_confirmed", rates.confirmed,
        "Share of its answers to a question back that are heard.");
  if (rates.understood + rates.asked_back + rates.mistaken > 1.0 + 1e-9)
    host.fault("voice_understood, voice_asked_back and voice_mistaken must not exceed 1 together");
  return rates;
}

VisitorComponent::VisitorComponent(runtime::Host& host, std::shared_ptr<Voice> voice)
    : host_(host),
      core_(read_character(host.parameters())),
      hearing_(read_hearing(host), host.random("hearing")),
      fell_back_(host.health().counter("answers: touched since nobody understood")),
      said_(host.health().counter("voice: said")),
      asked_back_(host.health().counter("voice: asked back")),
      mistaken_(host.health().counter("voice: taken for another")),
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
  leads_along_ = parameters.numbers("leads_along", "m", {-1000, 1000}, 2, 40,
                                    {5.0, 8.0, 5.0, 10.0, 14.0, 10.0},
                                    "x, y of the points that it leads the robot by.");
  if (leads_along_.size() % 2 != 0) host.fault("leads_along must have pairs of x, y");
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
  const Character& c = core_.character();
  if (steps_up_to_ > 0.0 || c.leads || c.blocks_at >= 0.0 || c.crowd_at >= 0.0) {
    truth_ = host.input(topics::kSimGroundTruth,
                        {.max_age = kTruthAge, .on_loss = "stays where it is", .optional = true});
  }
  walk_ = host.output(topics::kSimPersonGoal);
  timer_ = host.timer("step", kStep, [this](auto) { step(); });
  host.health().set(runtime::HealthState::kOk);
}

void VisitorComponent::take(const usher_msgs::msg::DialogueScreen& screen) {
  answers_.answered(screen.answer_id(), screen.answer_client());
  Screen seen{.id = screen.id(),
              .state = screen.state(),
              .language = screen.language(),
              .place = screen.place()};
  std::vector<std::string> sayable;  // what is typed into has no name
  for (const auto& option : screen.options()) {
    seen.options.push_back(option.id());
    if (option.takes_text())
      seen.text_option = option.id();
    else
      sayable.push_back(option.id());
  }
  if (screen.time_left() >= 0.0F) seen.time_left = screen.time_left();
  if (screen.tone() == tone::TONE_CALL || screen.tone() == tone::TONE_NONE)
    seen.calls = screen.tone() == tone::TONE_CALL;
  core_.see(seen, in_seconds(host_.now()));
  delivery_.see(seen.id, seen.options);
  hearing_.see(seen.id, std::move(sayable), screen.listens());
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
  // Nobody spells what can be typed, and the robot understands English only.
  const bool heard = choice.text.empty() && screen_.latest()->language() == "en";
  const Means means = voice && heard ? Means::kVoice : Means::kTouch;
  if (means == Means::kVoice && !(limbs_ && limbs_->has_mouth())) {
    hearing_.want(core_.screen_id(), choice.option, in_seconds(host_.now()));
    return;
  }
  if (means == Means::kTouch && !(limbs_ && limbs_->has_finger())) {
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
  fell_back_ = delivery_.fell_back() + hearing_.fell_back();
  if (!deed) return;
  if (deed->means == Means::kVoice) {
    limbs_->say(deed->what);
  } else if (limbs_->has_finger()) {
    limbs_->tap({core_.screen_id(), false, deed->what});
  } else {
    write({deed->what, {}}, Means::kTouch);
  }
}

void VisitorComponent::speak(double now) {
  if (const auto answer = hearing_.step(now)) write({answer->option, {}}, answer->means);
  said_ = hearing_.said();
  asked_back_ = hearing_.asked_back();
  mistaken_ = hearing_.mistaken();
}

void VisitorComponent::step() {
  const double now = in_seconds(host_.now());
  if (const auto choice = core_.answer(now)) give(*choice);
  speak(now);
  if (limbs_) {
    deliver(now);
    host_.health().set(
        limbs_->trouble().empty() ? runtime::HealthState::kOk : runtime::HealthState::kDegraded,
        limbs_->trouble());
  }
  walk(now);
}

void VisitorComponent::send(const std::string& whom, const geometry::Point2& place, double speed,
                            bool follow) {
  usher_sim_msgs::msg::PersonGoal goal;
  goal.name(whom);
  goal.speed(speed);
  goal.x(place.x());
  goal.y(place.y());
  goal.follow(follow);
  walk_.publish(goal);
}

std::optional<geometry::Pose2> VisitorComponent::robot() const {
  const auto* truth = truth_.fresh();
  if (truth == nullptr) return std::nullopt;
  const auto pose = wire::to_planar(truth->pose());
  if (!pose) return std::nullopt;
  return *pose;
}

std::optional<geometry::Point2> VisitorComponent::place_of(const std::string& whom) const {
  const auto* truth = truth_.fresh();
  if (truth == nullptr) return std::nullopt;
  for (const auto& person : truth->people()) {
    if (person.name() == whom) return geometry::Point2(person.x(), person.y());
  }
  return std::nullopt;
}

/// From the first time that the robot waited for somebody for a while; not on the way.
bool VisitorComponent::at_screen(double now) {
  const auto* screen = screen_.latest();
  if (steps_up_to_ <= 0.0 || screen == nullptr) return false;
  if (!invited_at_ && screen->state() == "inactive") invited_at_ = now;
  return invited_at_ && now >= *invited_at_ + comes_after_;
}

void VisitorComponent::step_up(double range) {
  const auto before = robot();
  const auto here = place_of(person_);
  if (!before || !here) return;
  const auto place = visitor::step_up(*before, *here, range);
  if (place) {
    send(person_, *place, speed_);
  } else if (steps_up_) {
    send(person_, *here, 0.0);
  }
  steps_up_ = place.has_value();
}

/// Walks ahead, and waits for a robot that stays behind.
void VisitorComponent::lead(double now) {
  const auto behind = robot();
  const auto here = place_of(person_);
  if (!behind || !here) return;
  if (2 * led_past_ < leads_along_.size() && (*here - led_along(led_past_)).norm() < kThere)
    ++led_past_;
  if (2 * led_past_ >= leads_along_.size()) {
    core_.led(now);
    send(person_, *here, 0.0);
  } else {
    const bool waits = (*here - behind->position()).norm() > kLeadsBy;
    send(person_, led_along(led_past_), waits ? 0.0 : speed_);
  }
}

/// Back to a robot that has called, round the corners that it has come by.
void VisitorComponent::come_back() {
  const auto behind = robot();
  const auto here = place_of(person_);
  if (!behind || !here) return;
  const double range = (*here - behind->position()).norm();
  if (led_past_ > 0 && (*here - led_along(led_past_ - 1)).norm() < kThere) --led_past_;
  const bool corner = led_past_ > 0 && (*here - led_along(led_past_ - 1)).norm() < range;
  send(person_, corner ? led_along(led_past_ - 1) : behind->position(),
       range > kReturnsTo ? speed_ : 0.0);
}

/// The bystanders come and stand round the robot; later they go back.
void VisitorComponent::gather(bool crowded) {
  const auto in_the_middle = robot();
  if (crowded == gathered_ && !crowded) return;
  if (crowded && !gathered_) {
    for (const auto& person : truth_.latest()->people()) {
      if (person.name().starts_with("bystander_"))
        bystanders_[person.name()] = {person.x(), person.y()};
    }
  }
  gathered_ = crowded;
  double angle = 0.0;
  for (const auto& [name, home] : bystanders_) {
    const geometry::Point2 round(kRound * std::cos(angle), kRound * std::sin(angle));
    angle += 2.0 * std::numbers::pi / static_cast<double>(bystanders_.size());
    if (!crowded) {
      send(name, home, speed_);
    } else if (in_the_middle) {
      send(name, *in_the_middle * round, speed_);
    }
  }
}

void VisitorComponent::walk(double now) {
  if (core_.character().crowd_at >= 0.0 && truth_.fresh() != nullptr) gather(core_.crowded(now));
  const Walk walk = core_.walk(now);
  const bool stood = walk == Walk::kStand && walks_ == Walk::kStand;
  walks_ = walk;
  switch (walk) {
    case Walk::kStand:
      if (at_screen(now)) return step_up(steps_up_to_);
      if (!stood) send(person_, {leaves_to_[0], leaves_to_[1]}, 0.0);
      return;
    case Walk::kBlock:
      return step_up(kBlocksAt);
    case Walk::kLead:
      return lead(now);
    case Walk::kReturn:
      return come_back();
    case Walk::kFollow:
    case Walk::kDawdle:
    case Walk::kAway:
      return send(person_, {leaves_to_[0], leaves_to_[1]},
                  walk == Walk::kDawdle ? kDawdling : speed_, walk != Walk::kAway);
  }
}

}  // namespace usher::visitor
