// What each state shows.
#include <algorithm>
#include <cmath>

#include "interaction/phrases/core/way.hpp"
#include "tasks/guide/core/buttons.hpp"
#include "tasks/guide/core/guide.hpp"

namespace usher::guide {

namespace {

constexpr double kAt = 2.5;  ///< [m] farther from a place we are only near it

}  // namespace

std::string Guide::say(Text text) const {
  return phrases_.phrase(language_, static_cast<std::size_t>(text));
}

std::string Guide::say_place(Text text) const {
  return phrases::filled(say(text), {{"place", place_.label(tag())}});
}

std::string Guide::way_words(double meters) const {
  const long rounded = phrases::rounded_way(meters);
  if (rounded == 1) return say(Text::kOneMeter);
  return phrases::filled(say(Text::kMeters), {{"n", std::to_string(rounded)}});
}

std::string Guide::time_words(double seconds) const {
  const long halves = phrases::rounded_half_minutes(seconds);
  if (halves == 0) return say(Text::kLessThanAMinute);
  if (halves == 2) return say(Text::kOneMinute);
  if (halves % 2 == 1) {
    return phrases_.phrase(language_, static_cast<std::size_t>(Text::kAndAHalf) +
                                          static_cast<std::size_t>(halves / 2) - 1);
  }
  return phrases::filled(say(Text::kMinutes), {{"n", std::to_string(halves / 2)}});
}

void Guide::speak(const std::string& sentence, Tone tone) {
  screen_.spoken = sentence;
  screen_.tone = tone;
  screen_.spoken_id = next_id_++;
}

void Guide::speak_screen() {
  const bool announces = state_ == State::kGuideActive && !screen_.text.empty();
  std::string sentence = announces ? screen_.text : screen_.title;
  if (!announces && !screen_.text.empty()) sentence += " " + screen_.text;
  speak(sentence);
}

/// With what is about to be said, or alone.
void Guide::sound(Tone tone) {
  if (screen_.spoken_id == published_.spoken_id) {
    speak({}, tone);
  } else {
    screen_.tone = tone;
  }
}

Text Guide::idle_text() const {
  if (surroundings_.supervisor == Supervisor::kManual) return Text::kOperatorDrives;
  if (surroundings_.supervisor == Supervisor::kAvailable) return Text::kNoPlaces;
  return Text::kNotReady;
}

/// Whether the robot stands though it is on the way.
bool Guide::stands() const {
  const auto& navigation = surroundings_.navigation;
  const bool waits = navigation && goal_id_ != 0 && navigation->goal_id == goal_id_ &&
                     navigation->state == GoalState::kWaiting;
  return stopped_ || move_at_ || not_allowed_since_ || waits;
}

std::string Guide::status() const {
  switch (state_) {
    case State::kInitialise:
      return say(Text::kConnecting);
    case State::kInactive:
    case State::kEnd:
      return say(Text::kWaitingForHuman);
    case State::kGuideActive:
      return say(blocked_since_ ? Text::kInTheWay : stands() ? Text::kStanding : Text::kDriving);
    case State::kFollowMe:
      return say(blocked_since_              ? Text::kInTheWay
                 : stands() || goal_id_ == 0 ? Text::kStanding
                                             : Text::kDriving);
    case State::kGuidePaused:
      return say(Text::kStanding);
    case State::kIntroduction:
    case State::kGuideSuccess:
      return {};
    default:
      return say(Text::kListening);
  }
}

void Guide::add(Screen& screen, const char* id, Text label, OptionKind kind, Panel panel) const {
  screen.options.push_back({id, say(label), kind, panel, false});
}

void Guide::build_languages(Screen& screen) const {
  for (const auto& language : phrases_.languages()) {
    screen.options.push_back({button::language(language.tag), language.name, OptionKind::kOption,
                              Panel::kPrimary, false});
  }
}

std::vector<const Location*> Guide::offered() const {
  std::vector<const Location*> list;
  for (const std::string& name : recent_) {
    if (list.size() == parameters_.recent) break;
    if (const Location* location = find(locations_, name)) list.push_back(location);
  }
  for (const Location& location : locations_) {
    if (std::find(list.begin(), list.end(), &location) == list.end()) list.push_back(&location);
  }
  return list;
}

void Guide::build_places(Screen& screen) const {
  const bool guides = state_ == State::kGuideOptions;
  screen.title = say(guides ? Text::kWhereTo : Text::kWhichPlace);
  const std::size_t room = parameters_.options_on_screen;
  const auto offer = [&](const Location& location) {
    screen.options.push_back(
        {location.name, location.label(tag()), OptionKind::kOption, Panel::kPrimary, false});
  };
  if (searching_) {
    screen.content = Content::kSearch;
    screen.options.push_back(
        {button::kQuery, say(Text::kTypeName), OptionKind::kOption, Panel::kPrimary, true});
    const auto hits = search(locations_, query_, tag(), std::min<std::size_t>(room, 3));
    for (const Location* hit : hits) offer(*hit);
    screen.text = say(hits.empty() ? Text::kNoHits : Text::kTypeName);
    add(screen, button::kBack, Text::kBack, OptionKind::kOption, Panel::kSecondary);
  } else {
    const auto list = offered();
    const bool pages = list.size() > room;
    const std::size_t a_page = pages ? room - 1 : room;  // one button is "more"
    const std::size_t count = std::max<std::size_t>(1, (list.size() + a_page - 1) / a_page);
    const std::size_t first = (page_ % count) * a_page;
    for (std::size_t i = first; i < std::min(first + a_page, list.size()); ++i) offer(*list[i]);
    const bool last = first + a_page >= list.size();  // from there back to the first page
    if (pages)
      add(screen, button::kMore, last ? Text::kFirstPage : Text::kMore, OptionKind::kOption,
          Panel::kPrimary);
    add(screen, button::kSearch, Text::kSearch, OptionKind::kOption, Panel::kSecondary);
  }
  add(screen, button::kCancel, Text::kCancel, OptionKind::kNo, Panel::kSecondary);
}

void Guide::build_map(Screen& screen) const {
  screen.content = Content::kMap;
  screen.place = place_.name;
  screen.title = place_.name.empty() ? say(Text::kLocationShow) : say_place(Text::kPlaceShow);
  const Location* here =
      surroundings_.pose ? nearest(locations_, surroundings_.pose->position()) : nullptr;
  if (here == nullptr) {
    screen.text = say(Text::kNotLocated);
  } else {
    const bool at = (here->at - surroundings_.pose->position()).norm() <= kAt;
    screen.text =
        phrases::filled(say(at ? Text::kNear : Text::kNearby), {{"place", here->label(tag())}});
  }
  add(screen, button::kWhereIs, Text::kWhereIs, OptionKind::kOption, Panel::kSecondary);
  if (!place_.name.empty()) {
    add(screen, button::kGuideMe, Text::kGuideMe, OptionKind::kOption, Panel::kSecondary);
  }
  add(screen, button::kDone, Text::kDone, OptionKind::kYes, Panel::kSecondary);
}

void Guide::build_statement(Screen& screen) const {
  const std::size_t number = visit_.ratings.size();
  screen.title = phrases_.phrase(language_, static_cast<std::size_t>(Text::kStatement) + number);
  std::size_t before = 0, after = 0;
  for (std::size_t other = 0; other < kStatements; ++other) {
    if (other != number && asks(other)) ++(other < number ? before : after);
  }
  screen.text = phrases::filled(
      say(Text::kDoYouAgree),
      {{"n", std::to_string(before + 1)}, {"all", std::to_string(before + 1 + after)}});
  for (int agreement = 5; agreement >= 1; --agreement) {
    const auto label =
        static_cast<std::size_t>(Text::kAgree) + static_cast<std::size_t>(agreement) - 1;
    screen.options.push_back({button::rating(agreement), phrases_.phrase(language_, label),
                              OptionKind::kOption, Panel::kPrimary, false});
  }
  add(screen, button::kSkip, Text::kSkip, OptionKind::kOption, Panel::kPrimary);
  add(screen, button::kCancel, Text::kNoThanks, OptionKind::kNo, Panel::kSecondary);
}

void Guide::build_journey(Screen& screen) const {
  screen.content = Content::kJourney;
  screen.place = place_.name;
  screen.progress = screen_.progress;
  screen.eta = screen_.eta;
  screen.remaining = screen_.remaining;
  screen.follower = follow_.state();
  const bool paused = state_ == State::kGuidePaused;
  screen.title = paused ? say(Text::kStopped) : say_place(Text::kGuiding);
  screen.text = paused ? say(Text::kTellWhenToGoOn) : sentence_;
  if (paused) {
    add(screen, button::kContinue, Text::kGoOn, OptionKind::kYes, Panel::kPrimary);
  } else {
    add(screen, button::kStop, Text::kStop, OptionKind::kNo, Panel::kPrimary);
  }
  if (!paused && follow_.waits()) {  // he may stand where nothing looks
    add(screen, button::kStay, Text::kStay, OptionKind::kYes, Panel::kService);
  }
  add(screen, button::kCancel, Text::kCancel, OptionKind::kNo, Panel::kSecondary);
}

void Guide::add_yes_and_no(Screen& screen) const {
  add(screen, button::kYes, Text::kYes, OptionKind::kYes, Panel::kPrimary);
  add(screen, button::kNo, Text::kNo, OptionKind::kNo, Panel::kPrimary);
}

void Guide::add_secondary(Screen& screen, const char* id, Text label) const {
  add(screen, id, label, OptionKind::kOption, Panel::kSecondary);
}

void Guide::build_offer(Screen& screen) const {
  screen.title = say(Text::kGuideAsk);
  add_yes_and_no(screen);
  add_secondary(screen, button::kWhereIs, Text::kWhereIs);
  if (offers_following_)
    add(screen, button::kFollowMe, Text::kFollowMe, OptionKind::kOption, Panel::kPrimary);
}

void Guide::build_start(Screen& screen) const {
  screen.place = place_.name;
  screen.title = say_place(Text::kWillTake);
  screen.text = say(Text::kTellWhenReady);
  add(screen, button::kStart, Text::kStart, OptionKind::kYes, Panel::kPrimary);
  add(screen, button::kCancel, Text::kCancel, OptionKind::kNo, Panel::kSecondary);
}

void Guide::build_following(Screen& screen) const {
  screen.title = say(Text::kFollowing);
  screen.text = sentence_;
  add(screen, button::kDone, Text::kDone, OptionKind::kYes, Panel::kPrimary);
  add(screen, button::kStop, Text::kStop, OptionKind::kNo, Panel::kPrimary);
}

void Guide::build_failure(Screen& screen) const {
  screen.place = place_.name;
  screen.title = say(failed_to_follow() ? Text::kNotFollowed : Text::kSorry);
  screen.text = say(failure_) + " " + say(Text::kTryAgain);
  add_yes_and_no(screen);
}

void Guide::build_goodbye(Screen& screen) const {
  screen.title = say(lost_visitor_ ? Text::kLostYou : Text::kSeeYou);
  if (visit_.ratings.size() == kStatements) screen.text = say(Text::kThanksForAnswers);
  add_secondary(screen, button::kAgain, Text::kAgain);
}

void Guide::build_state(Screen& screen) const {
  switch (state_) {
    case State::kInitialise:
      screen.title = say(Text::kHello);
      screen.text = say(idle_text());
      break;
    case State::kInactive:
    case State::kIntroduction:
      screen.title = say(Text::kHello);
      screen.text = say(Text::kChooseLanguage);
      build_languages(screen);
      break;
    case State::kLocationAsk:
      screen.title = say(Text::kLocationAsk);
      add_yes_and_no(screen);
      add_secondary(screen, button::kGuideMe, Text::kGuideMe);
      break;
    case State::kLocationShow:
      return build_map(screen);
    case State::kLocationOptions:
    case State::kGuideOptions:
      return build_places(screen);
    case State::kGuideAsk:
      return build_offer(screen);
    case State::kFollowMe:
      return build_following(screen);
    case State::kGuideStart:
      return build_start(screen);
    case State::kGuideActive:
    case State::kGuidePaused:
      return build_journey(screen);
    case State::kGuideError:
      return build_failure(screen);
    case State::kGuideSuccess:
      screen.place = place_.name;
      screen.title = say(Text::kArrived);
      screen.text = say_place(Text::kThisIs);
      screen.progress = 1.0;
      break;
    case State::kEndAsk:
      screen.title = say(Text::kAnythingElse);
      add_yes_and_no(screen);
      break;
    case State::kFeedback:
      return build_statement(screen);
    case State::kEnd:
      return build_goodbye(screen);
  }
}

/// What several states offer beside their own: languages, the sentence again, more time.
void Guide::add_services(Screen& screen, Time now) const {
  const bool first = state_ == State::kLocationAsk || state_ == State::kGuideAsk;
  if (first && phrases_.languages().size() > 1)
    add(screen, button::kLanguages, Text::kLanguages, OptionKind::kOption, Panel::kService);
  if (question() || state_ == State::kGuideActive || follows())
    add(screen, button::kRepeat, Text::kRepeat, OptionKind::kOption, Panel::kService);
  if (!question() || !warned_) return;
  const double left = std::chrono::duration<double>(patience() - (now - since_)).count();
  screen.time_left = std::max(0.0, std::ceil(left));
  screen.text = say(Text::kStillThere);
  add(screen, button::kStay, Text::kStay, OptionKind::kYes, Panel::kService);
}

Screen Guide::build(Time now) const {
  Screen screen;
  screen.id = screen_.id;
  screen.spoken = screen_.spoken;
  screen.spoken_id = screen_.spoken_id;
  screen.tone = screen_.tone;
  screen.state = text(state_);
  screen.language = phrases_.languages()[language_].tag;
  screen.status = status();
  screen.listens = question() || state_ == State::kIntroduction;
  build_state(screen);
  add_services(screen, now);
  return screen;
}

}  // namespace usher::guide
