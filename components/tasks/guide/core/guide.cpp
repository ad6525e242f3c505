#include "tasks/guide/core/guide.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

namespace usher::guide {

namespace {

// Ids of buttons.
constexpr const char* kStart = "start";
constexpr const char* kStop = "stop";
constexpr const char* kContinue = "continue";
constexpr const char* kCancel = "cancel";
constexpr const char* kMore = "more";
constexpr const char* kYes = "yes";
constexpr const char* kNo = "no";

}  // namespace

std::string_view text(State state) {
  switch (state) {
    case State::kIdle:
      return "inactive";
    case State::kGreeting:
      return "introduction";
    case State::kOptions:
      return "guide_options";
    case State::kConfirm:
      return "guide_start";
    case State::kGuiding:
      return "guide_active";
    case State::kPaused:
      return "guide_paused";
    case State::kArrived:
      return "guide_success";
    case State::kFailed:
      return "guide_error";
    case State::kAskMore:
      return "end_ask";
    case State::kEnd:
      return "end";
  }
  return "unknown";
}

Guide::Guide(const Parameters& parameters, std::uint64_t first_goal_id)
    : parameters_(parameters), next_goal_id_(std::max<std::uint64_t>(first_goal_id, 1)) {
  assert(parameters.options_on_screen >= 3);
  show(State::kIdle);
}

Status Guide::set_locations(std::vector<Location> locations, Time now) {
  std::set<std::string_view> names;
  for (const Location& location : locations) {
    if (location.name.empty() || location.name == kCancel || location.name == kMore) {
      return Error{"a location must have a name other than 'cancel' and 'more', got '" +
                   location.name + "'"};
    }
    if (!names.insert(location.name).second) {
      return Error{"location names must differ, got '" + location.name + "' twice"};
    }
  }
  if (locations == locations_) return {};
  locations_ = std::move(locations);
  begin();
  page_ = 0;
  if (state_ == State::kIdle || state_ == State::kOptions) enter(state_, now);
  return {};
}

std::string Guide::with_place(const std::string& text) const {
  const std::size_t at = text.find("{place}");
  if (at == std::string::npos) return text;
  std::string filled = text;
  return filled.replace(at, 7, place_.title.empty() ? place_.name : place_.title);
}

bool Guide::ready() const {
  return surroundings_.supervisor == Supervisor::kAvailable && !locations_.empty();
}

void Guide::begin() {
  actions_.screen_changed = false;
  actions_.requests.clear();
  actions_.goal.reset();
  actions_.cancel.reset();
}

void Guide::enter(State state, Time now) {
  state_ = state;
  since_ = now;
  show(state);
}

void Guide::show_idle() {
  const Texts& texts = parameters_.texts;
  screen_.title = texts.hello;
  if (ready()) {
    screen_.text = texts.touch_to_start;
    screen_.options = {{kStart, texts.start, OptionKind::kYes}};
  } else if (surroundings_.supervisor == Supervisor::kManual) {
    screen_.text = texts.operator_drives;
  } else if (surroundings_.supervisor == Supervisor::kAvailable) {
    screen_.text = texts.no_places;
  } else {
    screen_.text = texts.not_ready;
  }
}

void Guide::show_options() {
  const Texts& texts = parameters_.texts;
  screen_.title = texts.where_to;
  screen_.text = texts.choose;
  const std::size_t room = parameters_.options_on_screen;
  const bool pages = locations_.size() + 1 > room;  // one button is Cancel
  const std::size_t a_page = pages ? room - 2 : room - 1;
  const std::size_t first = std::min(page_ * a_page, locations_.size());
  const std::size_t last = std::min(first + a_page, locations_.size());
  for (std::size_t i = first; i < last; ++i) {
    const Location& location = locations_[i];
    screen_.options.push_back({location.name,
                               location.title.empty() ? location.name : location.title,
                               OptionKind::kOption});
  }
  if (pages) screen_.options.push_back({kMore, texts.more, OptionKind::kOption});
  screen_.options.push_back({kCancel, texts.cancel, OptionKind::kNo});
}

void Guide::show(State state) {
  const Texts& texts = parameters_.texts;
  const Option cancel{kCancel, texts.cancel, OptionKind::kNo};
  const std::vector<Option> yes_or_no{{kYes, texts.yes, OptionKind::kYes},
                                      {kNo, texts.no, OptionKind::kNo}};
  const std::uint64_t id = screen_.id + 1;
  screen_ = Screen{};
  screen_.id = id;
  screen_.state = text(state);
  switch (state) {
    case State::kIdle:
      show_idle();
      break;
    case State::kGreeting:
      screen_.title = texts.hello;
      break;
    case State::kOptions:
      show_options();
      break;
    case State::kConfirm:
      screen_.title = with_place(texts.will_take);
      screen_.text = texts.tell_when_ready;
      screen_.options = {{kStart, texts.start, OptionKind::kYes}, cancel};
      break;
    case State::kGuiding:
      screen_.title = with_place(texts.guiding);
      screen_.text = texts.lets_go;
      screen_.options = {{kStop, texts.stop, OptionKind::kNo}, cancel};
      screen_.progress = 0.0;
      break;
    case State::kPaused:
      screen_.title = texts.stopped;
      screen_.text = texts.tell_when_to_go_on;
      screen_.options = {{kContinue, texts.go_on, OptionKind::kYes}, cancel};
      break;
    case State::kArrived:
      screen_.title = texts.arrived;
      screen_.text = with_place(texts.this_is);
      screen_.progress = 1.0;
      break;
    case State::kFailed:
      screen_.title = texts.sorry;
      screen_.text = failure_.empty() ? texts.try_again : failure_ + " " + texts.try_again;
      screen_.options = yes_or_no;
      break;
    case State::kAskMore:
      screen_.title = texts.anything_else;
      screen_.options = yes_or_no;
      break;
    case State::kEnd:
      screen_.title = texts.see_you;
      break;
  }
  actions_.screen_changed = true;
}

void Guide::give_up_goal() {
  if (goal_id_ != 0) actions_.cancel = goal_id_;
  goal_id_ = 0;
  actions_.requests.push_back({RequestKind::kNavigationEnd, {}});
  // A stop of this visitor must not hold the robot for the next one.
  if (state_ == State::kPaused) actions_.requests.push_back({RequestKind::kMovementOn, {}});
}

void Guide::fail(std::string_view reason, Time now) {
  give_up_goal();
  failure_ = reason;
  if (!failure_.empty() && failure_.back() != '.') failure_ += '.';
  enter(State::kFailed, now);
}

const Actions& Guide::answer(const Answer& answer, Time now) {
  begin();
  const bool offered =
      answer.screen_id == screen_.id &&
      std::any_of(screen_.options.begin(), screen_.options.end(),
                  [&](const Option& option) { return option.id == answer.option_id; });
  if (!offered || !choose(answer.option_id, now)) ++ignored_answers_;
  return actions_;
}

bool Guide::choose(const std::string& option, Time now) {
  switch (state_) {
    case State::kIdle:
      page_ = 0;
      enter(State::kOptions, now);
      return true;
    case State::kOptions: {
      if (option == kMore) {
        const std::size_t a_page = parameters_.options_on_screen - 2;
        page_ = (page_ + 1) * a_page < locations_.size() ? page_ + 1 : 0;
        enter(State::kOptions, now);
        return true;
      }
      if (option == kCancel) {
        enter(State::kAskMore, now);
        return true;
      }
      const auto place =
          std::find_if(locations_.begin(), locations_.end(),
                       [&](const Location& location) { return location.name == option; });
      if (place == locations_.end()) return false;
      place_ = *place;
      held_since_.reset();
      actions_.requests.push_back({RequestKind::kNavigationStart, place_.name});
      enter(State::kConfirm, now);
      return true;
    }
    case State::kConfirm:
      if (option == kCancel) {
        give_up_goal();
        enter(State::kAskMore, now);
        return true;
      }
      actions_.requests.push_back({RequestKind::kNavigationGo, {}});
      goal_id_ = next_goal_id_++;
      goal_at_ = now;
      acknowledged_ = false;
      unheard_since_.reset();
      actions_.goal = Goal{goal_id_, place_.name};
      enter(State::kGuiding, now);
      return true;
    case State::kGuiding:
    case State::kPaused:
      if (option == kCancel) {
        give_up_goal();
        enter(State::kAskMore, now);
      } else if (option == kStop) {
        actions_.requests.push_back({RequestKind::kStop, {}});
        enter(State::kPaused, now);
      } else {
        actions_.requests.push_back({RequestKind::kMovementOn, {}});
        enter(State::kGuiding, now);
      }
      return true;
    case State::kFailed:
    case State::kAskMore:
      page_ = 0;
      if (option == kYes) {
        enter(State::kOptions, now);
      } else {
        enter(state_ == State::kFailed ? State::kAskMore : State::kEnd, now);
      }
      return true;
    case State::kGreeting:
    case State::kArrived:
    case State::kEnd:
      break;
  }
  return false;
}

const Actions& Guide::refused(std::string_view reason, Time now) {
  begin();
  if (state_ == State::kConfirm || journey()) fail(reason, now);
  return actions_;
}

const Actions& Guide::step(const Surroundings& surroundings, Time now) {
  begin();
  const bool was_ready = ready();
  const Supervisor before = surroundings_.supervisor;
  surroundings_ = surroundings;
  if (surroundings.visitor_near == false) greeted_ = false;
  if (state_ == State::kIdle &&
      (was_ready != ready() || (!ready() && before != surroundings.supervisor))) {
    show(State::kIdle);
  }
  if (state_ == State::kConfirm || journey()) watch_robot(now);
  if (journey()) watch_navigation(now);
  if (state_ == State::kGuiding) refresh_journey(now);
  pass_time(now);
  return actions_;
}

void Guide::watch_robot(Time now) {
  const Supervisor supervisor = surroundings_.supervisor;
  if (supervisor == Supervisor::kFault) {
    fail("Something is wrong with me; an operator must help", now);
    return;
  }
  if (supervisor == Supervisor::kManual) {
    fail("An operator has taken over", now);
    return;
  }
  // On the way, a supervisor that does not navigate holds the robot just as one that is missing.
  const bool held =
      supervisor != Supervisor::kNavigation && (supervisor != Supervisor::kAvailable || journey());
  if (!held) {
    held_since_.reset();
  } else if (!held_since_) {
    held_since_ = now;
  } else if (now - *held_since_ >= parameters_.recovery) {
    fail("A part of me does not answer", now);
  }
}

void Guide::watch_navigation(Time now) {
  const auto& navigation = surroundings_.navigation;
  const bool ours = navigation && navigation->goal_id == goal_id_;
  if (!ours) {
    if (acknowledged_ && navigation) {
      fail("Somebody gave me another goal", now);
      return;
    }
    if (!unheard_since_) unheard_since_ = acknowledged_ ? now : goal_at_;
    if (now - *unheard_since_ >= parameters_.acknowledge) {
      fail("My navigation does not answer", now);
    }
    return;
  }
  acknowledged_ = true;
  unheard_since_.reset();
  switch (navigation->state) {
    case NavigationState::kSucceeded:
      if (state_ == State::kPaused) actions_.requests.push_back({RequestKind::kMovementOn, {}});
      actions_.requests.push_back({RequestKind::kNavigationEnd, {}});
      goal_id_ = 0;
      enter(State::kArrived, now);
      break;
    case NavigationState::kFailed:
      fail(navigation->reason, now);
      break;
    case NavigationState::kCancelled:
      fail("The way was cancelled", now);
      break;
    case NavigationState::kReplaced:
      fail("Somebody gave me another goal", now);
      break;
    case NavigationState::kIdle:
    case NavigationState::kActive:
    case NavigationState::kWaiting:
      break;
  }
}

void Guide::refresh_journey(Time now) {
  const auto& navigation = surroundings_.navigation;
  const Texts& texts = parameters_.texts;
  const bool waiting = navigation && navigation->goal_id == goal_id_ &&
                       navigation->state == NavigationState::kWaiting;
  const bool held = held_since_ && now - *held_since_ >= parameters_.refresh;
  const std::string& sentence = held      ? texts.one_moment
                                : waiting ? texts.in_the_way
                                          : texts.lets_go;
  const bool spoken = sentence != screen_.text;
  if (spoken) screen_.text = sentence;
  bool moved = false;
  if (navigation && navigation->goal_id == goal_id_ && now - refreshed_ >= parameters_.refresh) {
    const double progress =
        std::isfinite(navigation->progress) ? std::clamp(navigation->progress, 0.0, 1.0) : 0.0;
    const double eta = navigation->eta;
    const bool same_eta = eta == screen_.eta || (std::isnan(eta) && std::isnan(screen_.eta));
    moved = progress != screen_.progress || !same_eta;
    screen_.progress = progress;
    screen_.eta = eta;
    if (moved) refreshed_ = now;
  }
  if (spoken || moved) actions_.screen_changed = true;
}

void Guide::pass_time(Time now) {
  const Time passed = now - since_;
  switch (state_) {
    case State::kIdle:
      if (ready() && surroundings_.visitor_near == true && !greeted_) {
        greeted_ = true;
        enter(State::kGreeting, now);
      }
      break;
    case State::kGreeting:
      page_ = 0;
      if (passed >= parameters_.greeting) enter(State::kOptions, now);
      break;
    case State::kOptions:
    case State::kFailed:
    case State::kAskMore:
      if (passed >= parameters_.answer) enter(State::kEnd, now);
      break;
    case State::kConfirm:
      if (passed >= parameters_.answer) {
        give_up_goal();
        enter(State::kEnd, now);
      }
      break;
    case State::kPaused:
      if (passed >= parameters_.pause) {
        give_up_goal();
        enter(State::kEnd, now);
      }
      break;
    case State::kArrived:
      if (passed >= parameters_.arrived) enter(State::kAskMore, now);
      break;
    case State::kEnd:
      if (passed >= parameters_.goodbye) enter(State::kIdle, now);
      break;
    case State::kGuiding:
      break;
  }
}

}  // namespace usher::guide
