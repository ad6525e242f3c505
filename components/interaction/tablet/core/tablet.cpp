#include "interaction/tablet/core/tablet.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/text/shortened.hpp"
#include "interaction/phrases/core/way.hpp"

namespace usher::tablet {

namespace {

constexpr const char* kDialogueStop = "stop";
constexpr const char* kDialogueStart = "start";
constexpr const char* kDialogueContinue = "continue";
constexpr const char* kStay = "stay";

/// Whether a touch of this button lifts the tablet's stop.
bool lets_move(const std::string& id) {
  return id == Tablet::kStart || id == kDialogueStart || id == kDialogueContinue || id == kStay;
}

}  // namespace

std::string way_text(double remaining, double eta) {
  std::string text;
  if (std::isfinite(remaining) && remaining >= 0.0) {
    text = std::to_string(phrases::rounded_way(remaining)) + " m";
  }
  if (std::isfinite(eta) && eta >= 0.0) {
    const long halves = phrases::rounded_half_minutes(eta);
    if (!text.empty()) text += " · ";
    text +=
        halves == 0 ? "< 1 min" : std::to_string(halves / 2) + (halves % 2 == 1 ? "½ min" : " min");
  }
  return text;
}

std::string Tablet::say(Text text) const {
  return phrases_.phrase(phrases_.find(screen_.language), static_cast<std::size_t>(text));
}

bool Tablet::offers(std::string_view id) const {
  return std::any_of(screen_.options.begin(), screen_.options.end(),
                     [&](const Screen::Option& option) { return option.id == id; });
}

void Tablet::hear(bool robot, bool dialogue, Time now) {
  robot_heard_ = robot;
  dialogue_heard_ = dialogue;
  watch_buttons(now);
}

Touched Tablet::hear_visit(bool served, bool navigates, Time now) {
  Touched touched{.move = stop_.ends(served, navigates) && lift_hold()};
  watch_buttons(now);
  return touched;
}

Touched Tablet::take(const Screen& screen, Time now) {
  const bool another = screen.id != screen_.id;
  const bool drove = screen_.id == 0 || offers(kDialogueStop);  // the first one sets off nothing
  screen_ = screen;
  if (another) {
    pending_.reset();
    typed_.clear();
  }
  if (another || !(screen.time_left >= 0.0)) announced_ = 0.0;
  if (screen.time_left >= 0.0) announced_ = std::max(announced_, screen.time_left);
  Touched touched = follow_hold(drove, now);
  watch_buttons(now);
  return touched;
}

/// What the new screen makes of the tablet's own stop. Who offers a stop moves the robot, or means
/// to.
Touched Tablet::follow_hold(bool drove, Time now) {
  const bool drives = offers(kDialogueStop), paused = offers(kDialogueContinue);
  switch (hold_) {
    case Hold::kNone:
      break;
    case Hold::kDialogue:
    case Hold::kDialogueTookOver:
      if (paused) {
        hold_ = Hold::kDialogueTookOver;
      } else if (!drives) {
        hold_ = Hold::kOwn;  // the journey has ended, not the wish to stand
      } else if (hold_ == Hold::kDialogueTookOver) {
        return {.move = lift_hold()};
      }
      break;
    case Hold::kOwn:
      if (!drives || drove) break;
      if (!stop_.late(now)) return {.move = lift_hold()};
      hold_ = Hold::kDialogue;
      return {.answer = Answer{screen_.id, kDialogueStop, {}}};
  }
  return {};
}

bool Tablet::lift_hold() {
  const bool held = holds();
  hold_ = Hold::kNone;
  return held;
}

bool Tablet::hear_stop(bool holds, Time now) {
  if (holds == this->holds()) return false;
  hold_ = holds ? Hold::kOwn : Hold::kNone;
  watch_buttons(now);
  return true;
}

void Tablet::watch_buttons(Time now) {
  const View shown = view(now);
  std::vector<std::string> buttons{std::to_string(shown.screen_id)};
  for (const auto* panel : {&shown.primary, &shown.secondary, &shown.service}) {
    for (const Button& button : *panel) buttons.push_back(button.id);
  }
  if (shown.stop_offered) buttons.emplace_back(kStop);
  if (shown.start_offered) buttons.emplace_back(kStart);
  if (buttons == buttons_) return;
  buttons_ = std::move(buttons);
  settled_ = now + kSettles;
}

Touched Tablet::stop(Time now) {
  stop_.stop(now);
  calm_at_ = now + kCalms;
  Touched touched{.stop = true};
  hold_ = Hold::kOwn;
  if (shows_dialogue() && offers(kDialogueStop)) {
    hold_ = Hold::kDialogue;
    touched.answer = Answer{screen_.id, kDialogueStop, {}};
  }
  return touched;
}

Touched Tablet::touch(const std::string& id, Time now) {
  const bool stops = id == kStop || id == kDialogueStop;
  const bool soon = !stops && !calm(now);
  if (soon) calm_at_ = now + kCalms;
  if (!stops && (now < settled_ || (soon && lets_move(id)))) return {};
  Touched touched = stops ? stop(now) : press(id, now);  // a stop again and again, if need be
  watch_buttons(now);
  return touched;
}

Touched Tablet::press(const std::string& id, Time now) {
  if (id == kStart) {
    Touched touched{.move = lift_hold()};
    if (shows_dialogue() && offers(kDialogueContinue))
      touched.answer = Answer{screen_.id, kDialogueContinue, {}};
    return touched;
  }
  if (!shows_dialogue() || !offers(id)) return {};
  if (pending_ && now - pending_->since < kPatience) return {};
  pending_ = Pending{id, now};
  return {.answer = Answer{screen_.id, id, {}}, .move = lets_move(id) && lift_hold()};
}

Touched Tablet::type(const std::string& text) {
  const auto line = std::find_if(screen_.options.begin(), screen_.options.end(),
                                 [](const Screen::Option& option) { return option.takes_text; });
  if (!shows_dialogue() || line == screen_.options.end()) return {};
  typed_ = shortened(text, kMostTyped);
  return {.answer = Answer{screen_.id, line->id, typed_}};
}

void Tablet::add_options(View& view, Time now) const {
  const bool hurries = view.time_left >= 0.0;
  for (const auto& option : screen_.options) {
    if (option.takes_text) {
      view.query_id = option.id;
      view.query_label = option.label;
      continue;
    }
    Button button{option.id, option.label,
                  static_cast<Kind>(std::min<std::uint8_t>(option.kind, 2)),
                  calm(now) || !lets_move(option.id)};
    if (option.panel == static_cast<std::uint8_t>(Panel::kService)) {
      if (option.id != kStay) button.kind = Kind::kService;
      // A question that is about to be given up has one small button: more time.
      if (!hurries || option.id == kStay) view.service.push_back(std::move(button));
    } else if (option.panel == static_cast<std::uint8_t>(Panel::kSecondary)) {
      view.secondary.push_back(std::move(button));
    } else {
      view.primary.push_back(std::move(button));
    }
  }
}

View Tablet::view(Time now) const {
  View view;
  view.language = screen_.language.empty() ? phrases_.languages().front().tag : screen_.language;
  view.stop_label = say(Text::kStop);
  view.start_label = say(Text::kStart);
  view.here_label = say(Text::kYouAreHere);
  view.typed = typed_;
  if (pose_) {
    view.located = true;
    view.robot = *pose_;
  }
  if (!shows_dialogue()) {
    view.page = robot_heard_ ? Page::kStarting : Page::kAway;
    view.state = robot_heard_ ? "starting" : "away";
    view.title = say(robot_heard_ ? Text::kStarting : Text::kAway);
    view.text = robot_heard_ ? "" : say(holds() ? Text::kStopUnsure : Text::kAwayText);
  } else {
    constexpr std::array kPages{Page::kButtons, Page::kMap, Page::kJourney, Page::kSearch};
    view.page = kPages[std::min<std::size_t>(screen_.content, kPages.size() - 1)];
    view.screen_id = screen_.id;
    view.state = screen_.state;
    view.title = screen_.title;
    view.text = screen_.text;
    view.status = screen_.status;
    if (!hint_.empty()) (asks_ ? view.text : view.status) = hint_;
    view.place = screen_.place;
    view.progress = screen_.progress;
    view.way_text = way_text(screen_.remaining, screen_.eta);
    if (screen_.time_left >= 0.0) view.time_left = screen_.time_left;
    if (announced_ > 0.0) view.time_left_share = screen_.time_left / announced_;
    add_options(view, now);
    if (pending_ && now - pending_->since < kPatience) {
      view.pending = true;
      view.pending_id = pending_->id;
    }
  }
  const bool dialogue_goes_on = shows_dialogue() && offers(kDialogueContinue);
  const bool dialogue_starts = dialogue_goes_on || (shows_dialogue() && offers(kDialogueStart));
  const bool dialogue_stops = shows_dialogue() && offers(kDialogueStop);
  view.start_offered = holds() && !dialogue_starts;
  view.start_active = calm(now);
  view.stop_offered = !holds() && !dialogue_stops && !dialogue_goes_on;
  // Beside the question, which can be answered all the same.
  if (hold_ == Hold::kOwn && shows_dialogue() && !dialogue_goes_on) view.status = say(Text::kHeld);
  return view;
}

}  // namespace usher::tablet
