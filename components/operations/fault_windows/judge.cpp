#include "operations/fault_windows/judge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace usher::operations {

namespace {

constexpr double kStanding = 0.05;    // [m/s], as in the definition of a contact
constexpr double kTurning = 0.1;      // [rad/s]
constexpr double kRolling = 0.03;     // [m/s]
constexpr double kCreep = 0.25;       // [m] more than a balancing base sways in a window
constexpr double kSway = 0.3;         // [rad]
constexpr double kSettled = 3.0;      // [s] every stop is over: d(v) / v and the overshoot
constexpr double kWaySlack = 0.15;    // [m]
constexpr double kWayShare = 1.1;     // of the stopping distance: the spread of table 8.1
constexpr double kUnheard = 1.0;      // [s] after which an operator sees that nobody speaks
constexpr double kLastSeconds = 8.0;  // [s] of the end: by then the navigator says that it is stuck
constexpr double kLeansBack = 0.4;    // [s]
constexpr double kRollsUnmeasured = 0.6;  // [s] who does not hear the base knows not when it stands
// More than a balancing base sways meanwhile, one or the other, or less of both.
constexpr double kMoved = 0.15;          // [m]
constexpr double kTurned = 0.15;         // [rad]
constexpr double kMoment = 1e-6;         // [s] what comes as the fault ends comes through
constexpr double kHullSlack = 0.03;      // [m/s]
constexpr double kTurnHullSlack = 0.07;  // [rad/s]
constexpr double kLimitSlack = 0.02;     // [m/s]
/// [s] The limit is told ten times a second: one between two words is not heard.
constexpr double kBeyondLimit = 0.25;
constexpr std::uint8_t kActive = 1, kWaiting = 2, kSucceeded = 3, kReplaced = 6;  // GoalStatus

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f", value);
  return text;
}

bool zero(const geometry::Twist2& twist) { return twist.v == 0.0 && twist.w == 0.0; }

template <class Queue>
void drop_older(Queue& queue, double than) {
  while (!queue.empty() && queue.front().t < than) queue.pop_front();
}

}  // namespace

std::string_view text(WindowEnd end) {
  constexpr std::array kTexts = {"drives", "arrived", "waits", "stands", "gave up", "unexplained"};
  return kTexts[static_cast<std::size_t>(end)];
}

void WindowJudge::violate(double t, const std::string& what) {
  if (!violation_.empty()) return;
  violation_ = what + (hit_ ? ", " + number(t - *hit_) + " s after the hit" : ", before the hit");
}

/// A base that is to stand may be told to turn as it did, or was told to, so that it stays on its
/// arc.
bool WindowJudge::rolls_out(double t, const geometry::Twist2& twist) const {
  double right = 0.0, left = 0.0;
  for (const auto* turns : {&speeds_, &obeyed_}) {
    for (const At& each : *turns) {
      right = std::min(right, each.twist.w);
      left = std::max(left, each.twist.w);
    }
  }
  return twist.v == 0.0 && t - rolled_at_ <= kRollsUnmeasured && twist.w >= right - kTurning &&
         twist.w <= left + kTurning;
}

bool WindowJudge::wheels_stand(double t) const {
  return !wheels_ || zero(wheels_->twist) || rolls_out(t, wheels_->twist) ||
         t - wheels_->t > limits_.hold;
}

/// From the moment on at which the wheels are told so: the way to the standstill, and that it
/// lasts.
void WindowJudge::judge_stop(double t, std::optional<Stop>& stop, bool must, const char* why) {
  if (!must || !place_) {
    stop.reset();
    return;
  }
  if (!stop) stop = Stop{t, place_->pose, std::abs(speed_.v)};
  // Told so while it speeds up, a balancing base gets faster for a moment.
  if (t - stop->t < kLeansBack) stop->speed = std::max(stop->speed, std::abs(speed_.v));
  const double way = geometry::distance(stop->from, place_->pose);
  const double most = kWayShare * limits_.stopping.distance(stop->speed) + kWaySlack;
  if (!stop->settled && way > most) {
    violate(t, std::string(why) + ": " + number(way) + " m on from " + number(stop->speed) +
                   " m/s, at most " + number(most) + " m were allowed");
  }
  if (t - stop->t <= kSettled) return;
  // A balancing base sways on the spot.
  if (!stop->settled) stop->settled = place_->pose;
  const double crept = geometry::distance(*stop->settled, place_->pose);
  const double turned = std::abs(geometry::shortest_turn(stop->settled->yaw, place_->pose.yaw));
  if (crept > kCreep || turned > kSway) {
    violate(t,
            std::string(why) + ": still moves, " + number(crept) + " m " + number(turned) + " rad");
  }
}

/// The hold of the last command and the way to the standstill included.
bool WindowJudge::deaf(double t) const {
  return hit_ && std::any_of(expectations_.begin(), expectations_.end(), [&](const auto& each) {
           return each.deaf && t - *hit_ <= each.lasts + kSettled;
         });
}

void WindowJudge::truth(double t, const geometry::Pose2& pose, const geometry::Twist2& twist,
                        std::uint32_t contacts, const std::string& contact_with) {
  place_ = Place{t, pose};
  speed_ = twist;
  places_.push_back(*place_);
  drop_older(places_, t - kLastSeconds);
  speeds_.push_back({t, twist});
  drop_older(speeds_, t - kSettled);
  drop_older(obeyed_, t - kSettled);
  if (std::abs(twist.v) > kRolling) rolled_at_ = t;
  if (contacts > contacts_ && deaf(t)) deaf_contacts_ += contacts - contacts_;
  if (contacts > contacts_ && !deaf(t)) violate(t, "contact with '" + contact_with + "'");
  contacts_ = contacts;
  judge_stop(t, without_grant_, granted_at_ && !granted(t) && wheels_stand(t), "without a grant");
  judge_expectations(t);
}

void WindowJudge::judge_expectations(double t) {
  if (!hit_) return;
  const double since = t - *hit_;
  for (std::size_t i = 0; i < expectations_.size(); ++i) {
    const Expectation& expected = expectations_[i];
    const bool lasts = since < expected.lasts - kMoment;
    const bool must_stand = lasts && since > expected.zero_within;
    if (must_stand && !wheels_stand(t)) {
      violate(t, "the wheels are still told " + number(wheels_->twist.v) + " m/s " +
                     number(wheels_->twist.w) + " rad/s");
    }
    judge_stop(t, expected_stops_[i], must_stand, "during the fault");
    if (lasts && since > expected.revoked_within && granted(t))
      violate(t, "the right to drive is granted still");

    const bool barred = lasts && since > expected.forward_barred_within && place_;
    auto& bar = barred_[i];
    if (!barred) bar.reset();
    if (barred && !bar) bar = Stop{t, place_->pose, std::abs(speed_.v)};
    if (bar) {
      const double ahead = (geometry::inverse(bar->from) * place_->pose.position()).x();
      const double most = kWayShare * limits_.stopping.distance(bar->speed) + kWaySlack;
      if (ahead > most) violate(t, "forward against the whiskers: " + number(ahead) + " m");
      if (t - bar->t > kSettled && wheels_ && wheels_->twist.v > kStanding)
        violate(t, "the wheels are told to go forward against the whiskers");
    }
  }
  judge_words(t);
}

/// Of several things that go wrong at once the reason names one. A robot that has arrived stands
/// without a reason.
void WindowJudge::judge_words(double t) {
  if (navigation_ == kSucceeded) return;
  const double since = t - *hit_;
  std::string missing;
  for (const Expectation& expected : expectations_) {
    const bool stops = std::min(expected.zero_within, expected.forward_barred_within) <= since;
    // What has just ended may still be what is read.
    if (!stops || since > expected.lasts + expected.read_within || expected.words.empty()) continue;
    if (since <= expected.read_within || since > expected.lasts || reads(expected, t)) return;
    missing = expected.words.front();
  }
  if (missing.empty()) return;
  std::string read;
  for (const auto& line : lines(t)) read += (read.empty() ? "'" : "; ") + line;
  violate(t, "stands, but the operator does not read '" + missing +
                 "': " + (read.empty() ? "nothing" : read + "'"));
}

std::vector<std::string> WindowJudge::lines(double t) const {
  if (t - told_at_ > kUnheard) return {"supervisor: silent"};
  return lines_;
}

bool WindowJudge::reads(const Expectation& expectation, double t) const {
  if (expectation.words.empty()) return true;
  auto read = lines(t);
  read.push_back(navigation_reason_);
  return std::any_of(read.begin(), read.end(), [&](const std::string& line) {
    return std::any_of(
        expectation.words.begin(), expectation.words.end(),
        [&](const std::string& word) { return line.find(word) != std::string::npos; });
  });
}

void WindowJudge::grant(double t, bool foreign, bool granted, const Writer& holder,
                        std::uint64_t epoch) {
  if (foreign) return;
  if (!granted) {
    if (!withdrawn_at_) withdrawn_at_ = t;
    return;
  }
  withdrawn_at_.reset();
  if (holder != holder_) number_.reset();
  holder_ = holder;
  epoch_ = epoch;
  granted_at_ = t;
}

void WindowJudge::command(double t, const Writer& writer, std::uint64_t epoch, std::uint64_t number,
                          const geometry::Twist2& twist) {
  drop_older(valid_, t - expiry());
  if (writer != holder_ || holder_ == drive::kNobody) return;
  const bool grows = !number_ || number > *number_;
  if (grows) number_ = number;
  const bool fast = std::abs(twist.v) > limits_.fastest || std::abs(twist.w) > limits_.fastest_turn;
  if (grows && epoch == epoch_ && twist.finite() && !fast && granted(t)) {
    valid_.push_back({t, twist});
  } else {
    valid_.clear();  // a faulty command ends the one before it
  }
}

void WindowJudge::wheels(double t, const geometry::Twist2& twist) {
  wheels_ = At{t, twist};
  if (zero(twist) || rolls_out(t, twist)) return;
  told_to_drive_ = t;
  if (!granted(t)) {
    violate(t, "the wheels are told " + number(twist.v) + " m/s without a live grant");
    return;
  }
  drop_older(valid_, t - expiry());
  const bool commanded = std::any_of(valid_.begin(), valid_.end(),
                                     [&](const At& each) { return each.twist == twist; });
  if (!commanded) {
    violate(t, "the wheels are told " + number(twist.v) + " m/s " + number(twist.w) +
                   " rad/s, which the holder of the grant did not command");
    return;
  }
  obeyed_.push_back({t, twist});
}

void WindowJudge::wish(double t, std::size_t source, const geometry::Twist2& twist) {
  if (twist.finite()) wishes_.push_back({t, source, twist});
}

void WindowJudge::enable(double t, const std::array<bool, 4>& sources) {
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (sources[i]) enabled_at_[i] = t;
  }
}

void WindowJudge::limit(double t, double linear) { limits_told_.emplace_back(t, linear); }

void WindowJudge::chosen(double t, const geometry::Twist2& twist) {
  // A wish is fresh for a quarter of a second, and its ramp takes what is left of the memory.
  drop_older(wishes_, t - limits_.memory);
  while (!limits_told_.empty() && limits_told_.front().first < t - limits_.memory)
    limits_told_.pop_front();
  if (zero(twist) || rolls_out(t, twist) || !twist.finite()) {
    within_limit_at_ = t;
    return;
  }
  geometry::Twist2 low, high;
  for (const Wish& wish : wishes_) {
    const auto& enabled = enabled_at_[wish.source];
    if (!enabled || *enabled < wish.t - expiry()) continue;
    low = {std::min(low.v, wish.twist.v), std::min(low.w, wish.twist.w)};
    high = {std::max(high.v, wish.twist.v), std::max(high.w, wish.twist.w)};
  }
  const bool outside = twist.v > high.v + kHullSlack || twist.v < low.v - kHullSlack ||
                       twist.w > high.w + kTurnHullSlack || twist.w < low.w - kTurnHullSlack;
  if (outside) {
    violate(t, "commanded " + number(twist.v) + " m/s " + number(twist.w) +
                   " rad/s, which no enabled source wished");
  }
  double most = limits_told_.empty() ? limits_.fastest : 0.0;
  for (const auto& [at, linear] : limits_told_) most = std::max(most, linear);
  if (std::abs(twist.v) <= most + kLimitSlack) {
    within_limit_at_ = t;
  } else if (t - within_limit_at_ > kBeyondLimit) {
    violate(t, "commanded " + number(twist.v) + " m/s, the limit is " + number(most) + " m/s");
  }
}

void WindowJudge::told(double t, const std::vector<std::string>& lines) {
  told_at_ = t;
  if (!hit_) before_ = {lines.begin(), lines.end()};
  if (!lines_.empty()) read_last_ = {t, lines_.front()};
  lines_.clear();
  std::copy_if(lines.begin(), lines.end(), std::back_inserter(lines_),
               [&](const std::string& line) { return !before_.contains(line); });
}

void WindowJudge::navigation(double t, std::uint8_t state, const std::string& reason) {
  navigation_ = state;
  if (!reason.empty()) waited_ = {t, reason};
  navigation_reason_ = reason;
}

void WindowJudge::hit(double t, std::vector<Expectation> expectations) {
  hit_ = t;
  expectations_ = std::move(expectations);
  expected_stops_.assign(expectations_.size(), std::nullopt);
  barred_.assign(expectations_.size(), std::nullopt);
}

Judgement WindowJudge::judgement(double t) const {
  Judgement judgement;
  judgement.violation = violation_;
  judgement.deaf_contacts = deaf_contacts_;
  // From where it was: a balancing base that stands sways to and fro.
  const Place* from = nullptr;
  double way = 0.0, turn = 0.0, yaw = 0.0;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i].t < t - kLastSeconds) continue;
    if (from == nullptr) {
      from = &places_[i];
      continue;
    }
    yaw += geometry::shortest_turn(places_[i - 1].pose.yaw, places_[i].pose.yaw);
    way = std::max(way, geometry::distance(from->pose, places_[i].pose));
    turn = std::max(turn, std::abs(yaw));
  }
  const bool active = navigation_ == kActive || navigation_ == kWaiting;
  if (navigation_ == kSucceeded) {
    judgement.end = WindowEnd::kArrived;
  } else if (told_to_drive_ && t - *told_to_drive_ < kLastSeconds &&
             std::hypot(way / kMoved, turn / kTurned) > 1.0) {
    judgement.end = WindowEnd::kDrives;
  } else if (const auto read = lines(t); !read.empty()) {
    judgement.end = WindowEnd::kStands;
    judgement.reason = read.front();
  } else if (!read_last_.second.empty() && t - read_last_.first < kUnheard) {  // it ended just now
    judgement.end = WindowEnd::kStands;
    judgement.reason = read_last_.second;
  } else if (active && !waited_.second.empty() && t - waited_.first < kLastSeconds) {
    judgement.end = WindowEnd::kWaits;
    judgement.reason = waited_.second;
  } else if (!active && navigation_ <= kReplaced && !navigation_reason_.empty()) {
    judgement.end = WindowEnd::kGaveUp;
    judgement.reason = navigation_reason_;
  }
  if (judgement.end == WindowEnd::kUnexplained && judgement.violation.empty())
    judgement.violation = "stands in the end, and nobody says why";
  return judgement;
}

}  // namespace usher::operations
