// What each state shows and says.
#include <chrono>
#include <cmath>

#include "tasks/meeting/core/meeting.hpp"

namespace usher::meeting {

using service::OptionKind;
using service::Panel;
using service::Tone;

std::string Meeting::say(Text text) const {
  return phrases::filled(phrases_.phrase(language_, static_cast<std::size_t>(text)),
                         {{"place", room_title()},
                          {"n", std::to_string(report_.brought)},
                          {"wanted", std::to_string(report_.wanted)}});
}

std::string Meeting::room_title() const {
  for (const Room& room : rooms_) {
    if (room.area.name == report_.room) return room.title.empty() ? room.area.name : room.title;
  }
  return {};
}

void Meeting::says(service::Screen& screen, const std::string& words, Tone tone) const {
  screen.spoken = words;
  screen.spoken_id = next_screen_;
  screen.tone = tone;
}

void Meeting::build_invitation(service::Screen& screen, Time now) const {
  screen.title = say(Text::kInvitation);
  screen.text = say(Text::kWouldYou);
  screen.status = say(Text::kListening);
  screen.listens = true;
  screen.options = {{"yes", say(Text::kYes), OptionKind::kYes, Panel::kPrimary},
                    {"no", say(Text::kNo), OptionKind::kNo, Panel::kPrimary}};
  const double left = std::chrono::duration<double>(parameters_.answer - (now - since_)).count();
  screen.time_left = std::max(0.0, std::ceil(left - 1e-9));
  says(screen, screen.title + " " + screen.text, Tone::kCall);
}

/// With a person behind it.
void Meeting::build_way(service::Screen& screen, Time now) const {
  screen.options = {{"leave", say(Text::kLeave), OptionKind::kNo, Panel::kSecondary}};
  if (state_ == State::kGuide) {
    screen.content = service::Content::kJourney;
    screen.title = say(Text::kFollowMe);
    return says(screen, screen.title, Tone::kMoving);
  }
  screen.title = say(calls(now)     ? Text::kWhereAreYou
                     : in_the_room_ ? Text::kComeIn
                                    : Text::kWithMe);
  if (calls(now)) says(screen, screen.title, Tone::kCall);
}

service::Screen Meeting::build(Time now) const {
  service::Screen screen;
  screen.id = next_screen_;
  screen.state = text(state_);
  screen.language = phrases_.languages()[language_].tag;
  screen.place = report_.room;
  screen.status = say(Text::kCount);
  switch (state_) {
    case State::kInitialise:
      screen.title = say(Text::kNotReady);
      screen.status = lacks();
      break;
    case State::kIdle:
      screen.title = say(Text::kReady);
      screen.place.clear();
      screen.status.clear();
      break;
    case State::kToRoom:
      screen.title = say(Text::kLooksForRoom);
      screen.place = rooms_[room_].area.name;
      break;
    case State::kScanRoom:
    case State::kCheckRoom:
      screen.title = say(Text::kLooksRound);
      screen.place = rooms_[room_].area.name;
      break;
    case State::kExplore:
      screen.title = say(Text::kLooksForPeople);
      break;
    case State::kCheckFace:
      screen.title = say(Text::kOneMoment);
      break;
    case State::kRevisit:
    case State::kApproach:
      screen.title = say(Text::kComing);
      break;
    case State::kInvite:
      build_invitation(screen, now);
      break;
    case State::kGuide:
    case State::kLookBack:
      build_way(screen, now);
      break;
    case State::kArrived:
      screen.title = say(Text::kThere);
      screen.text = say(Text::kThankYou);
      says(screen, screen.title + " " + screen.text, Tone::kNone);
      break;
    case State::kDone:
      screen.title = say(Text::kAllThere);
      says(screen, screen.title, Tone::kNone);
      break;
    case State::kEnded:
      screen.title = say(Text::kEnded);
      screen.text = report_.reason;
      says(screen, screen.title, Tone::kNone);
      break;
  }
  if (active(state_) && robot_.stopped) screen.status = say(Text::kStopped);
  return screen;
}

}  // namespace usher::meeting
