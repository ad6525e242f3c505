#include "simulation/visitor/core/visitor.hpp"

#include <algorithm>

namespace usher::visitor {

namespace {

constexpr int kMostTries = 2;       ///< after an error
constexpr int kSome = 4;            ///< statements, then it has enough
constexpr double kCatchesUp = 6.0;  ///< [s] of a follower from the robot's farthest gap
constexpr double kComesUp = 4.0;    ///< [s] that the robot needs to where its leader stands
constexpr double kTurnsBack = 1.0;  ///< [s] after a call

bool due(double at, double since) { return at >= 0.0 && since >= at; }

}  // namespace

void Visitor::see(const Screen& screen, double now) {
  const bool another = screen.id != screen_.id;
  if (screen.calls == false || screen.state != "follow_me")
    called_at_.reset();
  else if (screen.calls == true && !called_at_)
    called_at_ = now;
  const bool more_hits = typed_ && screen.options != screen_.options;
  screen_ = screen;
  if (!offers("stay"))
    awaited_at_.reset();
  else if (!awaited_at_)
    awaited_at_ = now;
  if (more_hits) {
    answered_ = false;
    typed_ = offers(wanted());  // else once more
  }
  if (!another) return;
  seen_at_ = now;
  answered_ = typed_ = false;
  if (screen.state == character_.gives_up_in) gave_up_ = true;
  if ((screen.state == "guide_active" || screen.state == "follow_me") && !departed_at_)
    departed_at_ = now;
  if (screen.state == "guide_paused") stopped_at_ = now;
  if (screen.state == "location_show") saw_map_ = true;
  if (screen.state == "location_ask") misled_ = false;
  if (screen.state == "guide_success" && wrong_place()) misled_ = true;
  if (screen.state == "guide_success" && !wrong_place()) ++arrivals_;
  if (screen.state == "guide_error") ++errors_;
  if (screen.state == "guide_success" || screen.state == "guide_error" ||
      screen.state == "end_ask") {
    departed_at_.reset();
  }
  if (screen.state == "end" || screen.state == "inactive") ended_ = screen.state == "end";
}

const std::string& Visitor::wanted() const {
  return arrivals_ > 0 && !character_.returns_to.empty() ? character_.returns_to
                                                         : character_.destination;
}

bool Visitor::offers(std::string_view option) const {
  return std::find(screen_.options.begin(), screen_.options.end(), option) != screen_.options.end();
}

std::optional<Choice> Visitor::press(std::string_view option) const {
  if (!offers(option)) return std::nullopt;
  return Choice{std::string(option), {}};
}

std::optional<Choice> Visitor::turn_back(std::string_view option) {
  misled_ = true;
  return press(option);
}

std::optional<Choice> Visitor::answer(double now) {
  if (gave_up_) return std::nullopt;
  if (screen_.time_left >= 0.0 && offers("stay")) return press("stay");
  const bool way = screen_.state == "guide_active" || screen_.state == "guide_paused";
  if (!way && (answered_ || now < seen_at_ + character_.reading_time)) return std::nullopt;
  auto chosen = choice(now);
  if (chosen) answered_ = true;
  return chosen;
}

std::optional<Choice> Visitor::choose_place() {
  if (offers(wanted())) return press(wanted());
  if (!screen_.text_option.empty()) {
    if (typed_) return std::nullopt;
    typed_ = true;
    return Choice{screen_.text_option, wanted().substr(0, 4)};
  }
  if (character_.types && offers("search")) return press("search");
  return offers("more") ? press("more") : press("search");
}

std::optional<Choice> Visitor::on_the_way(double now) {
  const double since = departed_at_ ? now - *departed_at_ : 0.0;
  if (screen_.state == "guide_paused") {
    if (stopped_at_ && now - *stopped_at_ < character_.stops_for) return std::nullopt;
    return answered_ ? std::nullopt : press("continue");
  }
  const bool comes = walk(now) == Walk::kFollow || walk(now) == Walk::kDawdle;
  if (awaited_at_ && !comes) awaited_at_ = now;
  // The robot waits for somebody who has come up and stands where it does not look.
  if (offers("stay") && awaited_at_ && now - *awaited_at_ >= kCatchesUp) {
    awaited_at_ = now;
    return press("stay");
  }
  if (answered_) return std::nullopt;
  if (wrong_place()) return turn_back("cancel");
  if (due(character_.cancels_at, since)) {
    gave_in_ = true;
    return press("cancel");
  }
  if (!stopped_ && due(character_.stops_at, since)) {
    stopped_ = true;
    return press("stop");
  }
  return std::nullopt;
}

std::optional<Choice> Visitor::rate() {
  if (character_.rates == "none" || (character_.rates == "some" && rated_ >= kSome))
    return press("cancel");
  ++rated_;
  return press(rated_ % 6 == 0 ? "skip" : "rating:" + std::to_string(rated_ % 5 + 1));
}

std::optional<Choice> Visitor::choice(double now) {
  const std::string& state = screen_.state;
  const std::string language = "language:" + character_.language;
  if (state == "inactive") {
    return ended_ || satisfied() || character_.waits_for_greeting ? std::nullopt : press(language);
  }
  if (state == "introduction") {
    return screen_.language == character_.language ? std::nullopt : press(language);
  }
  // The greeting went by before it had said so, or it was understood wrongly.
  if (state == "location_ask" && screen_.language != character_.language &&
      languages_asked_ < kMostTries && offers("languages")) {
    ++languages_asked_;
    return press("languages");
  }
  if (state == "location_ask") {
    if (satisfied()) return press("no");
    if (character_.looks_at_map && arrivals_ == 0) return press("yes");
    return press(character_.leads ? "no" : "guide_me");
  }
  if (state == "location_show") {
    if (character_.asks_where && !asked_where_) {
      asked_where_ = true;
      return press("where_is");
    }
    return asked_where_ && offers("guide_me") ? press("guide_me") : press("done");
  }
  if (state == "location_options" || state == "guide_options")
    return satisfied() ? press("cancel") : choose_place();
  if (state == "guide_ask") {
    if (satisfied()) return press("no");
    if (misses_map()) return turn_back("no");
    return press(character_.leads && !led_at_ && offers("follow_me") ? "follow_me" : "yes");
  }
  if (state == "follow_me") {
    if (!character_.leads) return press("done");  // the robot misunderstood
    return led_at_ && now - *led_at_ >= kComesUp ? press("done") : std::nullopt;
  }
  if (state == "feedback") return rate();
  if (state == "guide_start") return wrong_place() ? turn_back("cancel") : press("start");
  if (state == "guide_active" || state == "guide_paused") return on_the_way(now);
  if (state == "guide_error") {
    gave_in_ = errors_ >= kMostTries;
    return press(gave_in_ ? "no" : "yes");
  }
  if (state == "end_ask") {
    // Where he has not been yet, and did not say no to, the robot misunderstood.
    const bool unheard = !satisfied() && !gave_in_ && !led_at_ && begun_again_ < kMostTries;
    const bool again = arrivals_ == 1 && !character_.returns_to.empty();
    if (unheard && !again) ++begun_again_;
    return press(again || misled_ || unheard ? "yes" : "no");
  }
  return std::nullopt;
}

bool Visitor::crowded(double now) const {
  if (!departed_at_ || character_.crowd_at < 0.0) return false;
  const double since = now - *departed_at_ - character_.crowd_at;
  return since >= 0.0 && since < character_.crowd_for;
}

Walk Visitor::walk(double now) const {
  if (!departed_at_) return Walk::kStand;
  if (screen_.state == "follow_me") {
    if (!character_.leads || led_at_) return Walk::kStand;
    return called_at_ && now - *called_at_ >= kTurnsBack ? Walk::kReturn : Walk::kLead;
  }
  const double since = now - *departed_at_;
  const double away = since - character_.walks_away_at;
  const bool back = character_.walks_away_for >= 0.0 && away >= character_.walks_away_for;
  if (due(character_.walks_away_at, since) && !back) return Walk::kAway;
  if (due(character_.ties_lace_at, since) &&
      since < character_.ties_lace_at + character_.ties_lace_for) {
    return Walk::kStand;
  }
  if (due(character_.blocks_at, since) && since < character_.blocks_at + character_.blocks_for)
    return Walk::kBlock;
  return due(character_.dawdles_at, since) ? Walk::kDawdle : Walk::kFollow;
}

}  // namespace usher::visitor
