#include "tasks/guide/core/guide.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

#include "tasks/guide/core/buttons.hpp"

namespace usher::guide {

namespace {

constexpr std::size_t kMostClients = 32;
constexpr std::size_t kMostTyped = 80;  ///< [byte]
constexpr std::size_t kMostGreeted = 32;
constexpr double kFaced = 0.26;  ///< [rad] so far to the side somebody is faced

/// Where a guide goes on that was restarted in `state`.
State resumed(std::optional<State> state) {
  if (!state) return State::kInitialise;
  switch (*state) {
    case State::kInitialise:
    case State::kInactive:
    case State::kIntroduction:
    case State::kEnd:
      return State::kInitialise;
    case State::kGuideSuccess:
      return State::kEndAsk;
    default:
      return *state;
  }
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool same(const Screen& a, const Screen& b) {
  return a.id == b.id && a.state == b.state && a.language == b.language && a.content == b.content &&
         a.title == b.title && a.text == b.text && a.status == b.status &&
         a.spoken_id == b.spoken_id && a.listens == b.listens && a.options == b.options &&
         a.place == b.place && same(a.progress, b.progress) && same(a.eta, b.eta) &&
         same(a.remaining, b.remaining) && same(a.time_left, b.time_left) &&
         a.follower == b.follower;
}

}  // namespace

Guide::Guide(const Parameters& parameters, phrases::PhraseBook phrases, std::uint64_t first_id,
             const Memory& memory, Time now)
    : parameters_(parameters),
      phrases_(std::move(phrases)),
      next_id_(std::max<std::uint64_t>(first_id, 1)),
      since_(now),
      visit_since_(now),
      funnel_(memory.funnel),
      recent_(memory.recent),
      follow_(parameters.follow) {
  assert(parameters.options_on_screen >= 4);
  state_ = resumed(state_of(memory.state));
  stopped_ = memory.stopped;
  stays_ = memory.stays;
  if (state_ != State::kInitialise) {
    language_ = phrases_.find(memory.language);
    visit_ = memory.visit;
    greeted_ = true;
    place_.name = memory.place;
    if (journey()) {
      goal_id_ = memory.goal_id;
      departed_ = now;
      acknowledged_ = goal_id_ != 0;
      follow_.depart(now);
      sentence_ = say(Text::kOneMoment);
      sentence_at_ = now;
      if (state_ == State::kGuideActive && stopped_ && goal_id_ != 0) {  // it waited for him
        follow_.await(now);
        sentence_ = say(Text::kWaitingForYou);
      } else if (state_ == State::kGuideActive && goal_id_ == 0) {
        move_at_ = now + parameters_.tone;
      }
    }
    if (follows()) {
      first_goal_ = goal_id_ = memory.goal_id;
      departed_ = moved_at_ = drove_at_ = now;
      move_at_ = now + parameters_.tone;
      sentence_ = say(Text::kWalkAhead);
    }
  }
  screen_.id = next_id_++;
  screen_ = build(now);
  if (state_ == State::kInitialise)
    speak({});
  else
    speak_screen();
  if (move_at_) screen_.tone = Tone::kMoving;
  finish(now);
}

Status Guide::set_locations(std::vector<Location> locations, Time now) {
  std::set<std::string_view> names;
  for (const Location& location : locations) {
    if (location.name.empty() || is_button(location.name)) {
      return Error{"a location must have a name that is no button's, got '" + location.name + "'"};
    }
    if (!names.insert(location.name).second) {
      return Error{"location names must differ, got '" + location.name + "' twice"};
    }
  }
  begin();
  if (locations == locations_) return {};
  locations_ = std::move(locations);
  page_ = 0;
  if (const Location* place = find(locations_, place_.name)) place_ = *place;
  finish(now);
  return {};
}

Human Guide::human() const {
  if (!surroundings_.visitor) return Human::kUnknown;
  return there(*surroundings_.visitor) ? Human::kYes : Human::kNo;
}

/// Near enough to be served; farther away than those who are greeted, so that a step back is no
/// goodbye.
bool Guide::there(const VisitorSighting& visitor) const {
  return visitor.seen && std::hypot(visitor.x, visitor.y) <= 2.0 * parameters_.greet_within;
}

std::optional<double> Guide::turns_to() const {
  const auto& visitor = surroundings_.visitor;
  if (!turns_ || !turns_now_ || !visitor || !visitor->seen) return std::nullopt;
  return std::atan2(visitor->y, visitor->x);
}

bool Guide::question() const {
  switch (state_) {
    case State::kLocationAsk:
    case State::kLocationOptions:
    case State::kLocationShow:
    case State::kGuideAsk:
    case State::kGuideOptions:
    case State::kGuideStart:
    case State::kGuidePaused:
    case State::kGuideError:
    case State::kEndAsk:
    case State::kFeedback:
      return true;
    default:
      return false;
  }
}

Memory Guide::memory() const {
  Memory memory{std::string(text(state_)),
                phrases_.languages()[language_].tag,
                place_.name,
                goal_id_,
                stopped_,
                stays_,
                visit_,
                funnel_,
                recent_};
  return memory;
}

void Guide::begin() { actions_ = {}; }

const Actions& Guide::finish(Time now) {
  screen_ = build(now);
  if (!same(screen_, published_)) actions_.screen_changed = true;
  if (actions_.screen_changed) published_ = screen_;
  return actions_;
}

void Guide::enter(State state, Cause cause, Time now) {
  // Whose stop was just to be obeyed does not find the robot turning.
  const bool arrives = state == State::kGuideSuccess && state_ == State::kGuideActive;
  const auto edge = std::find_if(kEdges.begin(), kEdges.end(), [&](const Edge& each) {
    return each.from == state_ && each.to == state && each.cause == cause;
  });
  assert(edge != kEdges.end());
  ++edges_taken_[static_cast<std::size_t>(edge - kEdges.begin())];
  state_ = state;
  since_ = now;
  warned_ = false;
  turns_ = arrives || (state == State::kEndAsk && turns_);
  if (state == State::kEnd) end_visit(cause, now);
  if (!journey()) {
    screen_.progress = state == State::kGuideSuccess ? 1.0 : -1.0;
    screen_.eta = screen_.remaining = kNothing;
  }
  offers_following_ = human() == Human::kYes;
  screen_.id = next_id_++;
  screen_ = build(now);
  if (state != State::kInitialise && state != State::kInactive) speak_screen();
  actions_.remember = true;
}

void Guide::begin_visit(bool greeted, Time now) {
  visit_ = {};
  visit_.id = next_id_++;
  visit_.greeted = greeted;
  visit_since_ = now;
  lost_visitor_ = false;
  place_ = {};
  if (greeted) ++funnel_.greeted;
}

void Guide::end_visit(Cause cause, Time now) {
  // Who stopped it and says nothing any more may lie before it. The next visitor finds a robot that
  // can go; by itself it does not turn.
  const bool answered = cause == Cause::kNo || cause == Cause::kYes;
  stays_ = !answered && (stopped_ || surroundings_.permission == Permission::kStopped);
  lift_stop();
  visit_.duration = now - visit_since_;
  visit_.outcome = visit_.arrived > 0    ? Outcome::kArrived
                   : visit_.started > 0  ? Outcome::kGivenUp
                   : cause == Cause::kNo ? Outcome::kEnded
                                         : Outcome::kLeft;
  if (visit_.outcome == Outcome::kGivenUp) ++funnel_.given_up;
  actions_.visit = visit_;
}

// --- Answers

const Actions& Guide::answer(const Answer& answer, Time now) {
  begin();
  const bool numbered = !answer.client.empty() && answer.id != 0;
  if (numbered) {
    if (handled_.size() >= kMostClients && handled_.count(answer.client) == 0) handled_.clear();
    Handled& newest = handled_[answer.client];
    if (answer.id <= newest.id) {
      // Its client did not hear the reply; another one's may have taken its place.
      last_answer_ = answer;
      last_result_ = newest.result;
      actions_.screen_changed = true;
      return finish(now);
    }
    newest.id = answer.id;
  }
  last_result_ = judge(answer, now);
  last_answer_ = answer;
  if (numbered) handled_[answer.client].result = last_result_;
  actions_.screen_changed = true;
  if (last_result_ != AnswerResult::kDone) {
    ++ignored_answers_;
    ++visit_.ignored;
    return finish(now);
  }
  if (!visit_.engaged()) ++funnel_.engaged;  // the answer may have begun the visit
  ++(answer.input == Input::kTouch   ? visit_.touches
     : answer.input == Input::kVoice ? visit_.utterances
                                     : visit_.others);
  if (actions_.visit && actions_.visit->id == visit_.id) actions_.visit = visit_;  // it ended it
  return finish(now);
}

AnswerResult Guide::judge(const Answer& answer, Time now) {
  // A stop is never late.
  const bool stop =
      answer.option_id == button::kStop && (state_ == State::kGuideActive || follows());
  if (answer.screen_id != screen_.id && !stop) return AnswerResult::kLate;
  const auto option = std::find_if(screen_.options.begin(), screen_.options.end(),
                                   [&](const Option& each) { return each.id == answer.option_id; });
  if (option == screen_.options.end()) return AnswerResult::kNotOffered;
  if (option->takes_text) {
    query_ = answer.text.substr(0, kMostTyped);
    since_ = now;
    warned_ = false;
    return AnswerResult::kDone;
  }
  const std::string id = option->id;  // the screen may change below
  return choose_service(id, now) || choose(id, now) ? AnswerResult::kDone
                                                    : AnswerResult::kNotOffered;
}

void Guide::choose_language(std::size_t language) { language_ = language; }

bool Guide::choose_service(const std::string& option, Time now) {
  if (option == button::kRepeat) {
    if (question()) {
      since_ = now;
      warned_ = false;
      screen_ = build(now);  // not the warning again, but the question
    }
    speak_screen();
    return true;
  }
  if (option == button::kStay) {
    since_ = now;
    warned_ = false;
    if (state_ == State::kGuideActive) go_on(now);
    return true;
  }
  if (option == button::kLanguages) {
    enter(State::kIntroduction, Cause::kChoice, now);
    return true;
  }
  for (std::size_t i = 0; i < phrases_.languages().size(); ++i) {
    if (option != button::language(phrases_.languages()[i].tag)) continue;
    if (state_ == State::kInactive) begin_visit(false, now);
    greeted_ = true;
    choose_language(i);
    enter(State::kIntroduction, Cause::kChoice, now);
    return true;
  }
  return false;
}

bool Guide::choose(const std::string& option, Time now) {
  const bool yes = option == button::kYes;
  const auto to = [&](State state, Cause cause) {
    page_ = 0;
    searching_ = false;
    query_.clear();
    enter(state, cause, now);
    return true;
  };
  switch (state_) {
    case State::kLocationAsk:
      if (option == button::kGuideMe) return to(State::kGuideOptions, Cause::kChoice);
      place_ = {};
      return yes ? to(State::kLocationShow, Cause::kYes) : to(State::kGuideAsk, Cause::kNo);
    case State::kLocationShow:
      if (option == button::kWhereIs) return to(State::kLocationOptions, Cause::kChoice);
      if (option == button::kGuideMe) return choose_place(place_.name, now);
      return to(State::kGuideAsk, Cause::kYes);
    case State::kLocationOptions:
      if (option == button::kCancel) return to(State::kGuideAsk, Cause::kNo);
      return choose_place(option, now);
    case State::kGuideAsk:
      if (option == button::kWhereIs) return to(State::kLocationOptions, Cause::kChoice);
      if (option == button::kFollowMe) return choose_following(option, now);
      return yes ? to(State::kGuideOptions, Cause::kYes) : to(State::kEndAsk, Cause::kNo);
    case State::kGuideOptions:
      if (option == button::kCancel) return to(State::kEndAsk, Cause::kNo);
      return choose_place(option, now);
    case State::kGuideError:
      if (yes) return to(failed_to_follow() ? State::kGuideAsk : State::kGuideOptions, Cause::kYes);
      return to(State::kEndAsk, Cause::kNo);
    case State::kEndAsk:
      if (yes) return to(State::kLocationAsk, Cause::kYes);
      if (!parameters_.questionnaire || visit_.arrived == 0) return to(State::kEnd, Cause::kNo);
      skip_what_is_not_there();
      return to(State::kFeedback, Cause::kNo);
    case State::kFeedback:
      return rate(option, now);
    case State::kFollowMe:
      return choose_following(option, now);
    case State::kEnd:
      begin_visit(false, now);
      return to(State::kLocationAsk, Cause::kChoice);
    case State::kGuideStart:
    case State::kGuideActive:
    case State::kGuidePaused:
      return choose_on_the_way(option, now);
    case State::kInitialise:
    case State::kInactive:
    case State::kIntroduction:
    case State::kGuideSuccess:
      break;
  }
  return false;
}

bool Guide::choose_place(const std::string& option, Time now) {
  if (option == button::kMore || option == button::kSearch || option == button::kBack) {
    page_ = option == button::kMore ? page_ + 1 : 0;
    searching_ = option == button::kSearch;
    query_.clear();
    enter(state_, Cause::kChoice, now);
    return true;
  }
  const Location* place = find(locations_, option);
  if (place == nullptr) return false;
  place_ = *place;
  page_ = 0;
  searching_ = false;
  if (state_ == State::kLocationOptions) {
    enter(State::kLocationShow, Cause::kChoice, now);
    return true;
  }
  visit_.place = place_.name;
  not_allowed_since_.reset();
  goal_id_ = 0;
  actions_.requests.push_back({RequestKind::kNavigationStart, place_.name});
  enter(State::kGuideStart, Cause::kChoice, now);
  return true;
}

bool Guide::choose_on_the_way(const std::string& option, Time now) {
  if (option == button::kCancel) {
    leave_journey();
    enter(State::kEndAsk, Cause::kNo, now);
  } else if (option == button::kStop) {
    stop_robot();
    enter(State::kGuidePaused, Cause::kNo, now);
  } else if (state_ == State::kGuideStart) {
    actions_.requests.push_back({RequestKind::kNavigationGo, {}});
    depart(now);
  } else {
    go_on(now);
    enter(State::kGuideActive, Cause::kYes, now);
    screen_.tone = Tone::kMoving;
  }
  return true;
}

/// Of the voice, of being understood and of the body only where they are.
bool Guide::asks(std::size_t statement) const {
  const auto& speech = surroundings_.speech;
  switch (statement + 1) {
    case 1:
    case 2:
      return speech.has_value();
    case 6:
    case 7:
      return speech && speech->understands;
    case kStatements:
      return surroundings_.torso;
    default:
      return true;
  }
}

void Guide::skip_what_is_not_there() {
  while (visit_.ratings.size() < kStatements && !asks(visit_.ratings.size()))
    visit_.ratings.push_back(0);
}

/// One statement after the other; whoever has enough goes.
bool Guide::rate(const std::string& option, Time now) {
  if (option == button::kCancel) {
    enter(State::kEnd, Cause::kNo, now);
    return true;
  }
  visit_.ratings.push_back(
      option == button::kSkip ? std::uint8_t{0} : static_cast<std::uint8_t>(option.back() - '0'));
  skip_what_is_not_there();
  const bool last = visit_.ratings.size() == kStatements;
  enter(last ? State::kEnd : State::kFeedback, last ? Cause::kYes : Cause::kChoice, now);
  return true;
}

// --- Time

const Actions& Guide::step(const Surroundings& surroundings, Time now) {
  begin();
  surroundings_ = surroundings;
  end_forgotten_journey();
  keep_own_stop();
  watch_encounter(now);
  if (state_ == State::kGuideStart || on_the_way()) watch_robot(now);
  if (state_ == State::kGuideActive || follows()) tell_why_it_stands(now);
  if (follows()) watch_following(now);
  if (follows()) follow_visitor(now);
  if (journey()) move_when_due(now);
  if (journey() && goal_id_ != 0) watch_navigation(now);
  if (state_ == State::kGuideActive && goal_id_ != 0) watch_follower(now);
  if ((state_ == State::kGuideActive || follows()) && goal_id_ != 0) watch_obstacle(now);
  if (state_ == State::kGuideActive) watch_progress(now);
  if (state_ == State::kGuideActive) refresh_journey(now);
  pass_time(now);
  watch_turns(now);
  return finish(now);
}

/// A robot that stands turns to nobody, and looks for nobody, before a tone has told of it.
void Guide::watch_turns(Time now) {
  const auto& visitor = surroundings_.visitor;
  const bool seen = turns_ && visitor && visitor->seen;
  const bool faced = seen && std::abs(std::atan2(visitor->y, visitor->x)) <= kFaced;
  if (faced) turns_ = false;
  if (!may_seek() && (!seen || faced)) {
    turn_at_.reset();
  } else if (!turn_at_) {
    turn_at_ = now + parameters_.tone;
    sound(Tone::kMoving);
  }
  turns_now_ = turn_at_ && now >= *turn_at_;
}

void Guide::watch_encounter(Time now) {
  if (!surroundings_.visitor) {
    near_since_.reset();
    nobody_since_.reset();
    return;
  }
  const VisitorSighting& visitor = *surroundings_.visitor;
  const bool near = visitor.seen && visitor.x > 0.0 &&
                    std::hypot(visitor.x, visitor.y) <= parameters_.greet_within &&
                    !(visitor.speed > parameters_.greet_below);
  if (!near || visitor.person != near_person_) near_since_.reset();
  if (near && !near_since_) {
    near_since_ = now;
    near_person_ = visitor.person;
  }
  // Who was lost on the way, or on arrival, comes back by another identity.
  const bool lost = nobody_since_ && visit_.started > 0;
  if (lost && there(visitor) && another(visitor)) remember(visitor.person);
  if (there(visitor)) nobody_since_.reset();
  if (!there(visitor) && !nobody_since_) nobody_since_ = now;
  // Who walks away on the way and comes back is not greeted for it.
  if (nobody_since_ && now - *nobody_since_ >= parameters_.left && !serves()) {
    greeted_ = false;
    greeted_persons_.clear();
  }
  if (state_ == State::kInactive && ready() && (!greeted_ || another(visitor)) && near_since_ &&
      now - *near_since_ >= parameters_.greet_after) {
    greeted_ = true;
    begin_visit(true, now);
    enter(State::kIntroduction, Cause::kVisitor, now);
  }
  // On the way he may come by one, too.
  if (serves() && there(visitor) && (another(visitor) || greeted_persons_.empty()))
    remember(visitor.person);
}

void Guide::remember(std::uint64_t person) {
  if (person == 0) return;
  if (greeted_persons_.size() == kMostGreeted) greeted_persons_.erase(greeted_persons_.begin());
  greeted_persons_.push_back(person);
}

/// Somebody who was not greeted yet, beside one who was.
bool Guide::another(const VisitorSighting& visitor) const {
  return visitor.person != 0 && !greeted_persons_.empty() &&
         std::ranges::find(greeted_persons_, visitor.person) == greeted_persons_.end();
}

/// Whether what the screen says is being said, or about to be.
bool Guide::speaks() const {
  const auto& speech = surroundings_.speech;
  return speech && !screen_.spoken.empty() &&
         !(speech->finished && speech->spoken_id >= screen_.spoken_id);
}

void Guide::pass_time(Time now) {
  const Time passed = now - since_;
  const auto shown = [&](Time least) {
    return passed >= least && (!speaks() || passed >= least + parameters_.finish);
  };
  const bool gone = nobody_since_ && now - *nobody_since_ >= parameters_.left &&
                    passed >= parameters_.left && !journey();
  if (question()) {
    if (gone || passed >= patience()) {
      if (state_ == State::kGuideStart || journey()) leave_journey();
      enter(State::kEnd, gone ? Cause::kLeft : Cause::kTimeout, now);
    } else if (!warned_ && passed >= patience() - parameters_.warning) {
      warned_ = true;
      speak(say(Text::kStillThere));
    }
    return;
  }
  switch (state_) {
    case State::kInitialise:
      if (ready()) {
        stays_ = stays_ || stopped_;
        lift_stop();  // of a visit that a restart has ended
        language_ = 0;
        enter(State::kInactive, Cause::kReady, now);
      }
      break;
    case State::kInactive:
      if (!ready()) enter(State::kInitialise, Cause::kNotReady, now);
      break;
    case State::kIntroduction:
      if (gone) {
        enter(State::kEnd, Cause::kLeft, now);
      } else if (shown(parameters_.introduction)) {
        enter(State::kLocationAsk, Cause::kDelay, now);
      }
      break;
    case State::kFollowMe:
      if (now - moved_at_ >= parameters_.pause) {  // he stays where he is
        leave_journey();
        enter(State::kEndAsk, Cause::kTimeout, now);
      }
      break;
    case State::kGuideSuccess:
      if (shown(parameters_.arrived)) enter(State::kEndAsk, Cause::kDelay, now);
      break;
    case State::kEnd:
      // Who stays may start again; after a while, or when another comes, the robot is free.
      if (shown(human() == Human::kYes && !another(*surroundings_.visitor) ? parameters_.answer
                                                                           : parameters_.goodbye)) {
        language_ = 0;
        enter(State::kInactive, Cause::kDelay, now);
      }
      break;
    default:
      break;
  }
}

const Actions& Guide::refused(Time now) {
  begin();
  const bool before = on_the_way() && !acknowledged_;
  if (state_ == State::kGuideStart || before) fail(Text::kPartSilent, Cause::kFailure, now);
  return finish(now);
}

}  // namespace usher::guide
