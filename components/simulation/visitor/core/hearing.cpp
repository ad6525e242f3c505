#include "simulation/visitor/core/hearing.hpp"

#include <algorithm>
#include <utility>

namespace usher::visitor {

namespace {

/// As the robot's ear has it (interaction/speech/core/conversation.cpp).
bool unasked(const std::string& option) {
  return option == "stop" || option == "cancel" || option == "stay" || option == "done";
}

}  // namespace

void Hearing::want(std::uint64_t screen_id, std::string option, double now) {
  if (wanted_ == option && screen_id_ == screen_id) return;
  screen_id_ = screen_id;
  wanted_ = std::move(option);
  asks_ = false;
  next_at_ = now;
  tries_ = 0;
}

void Hearing::see(std::uint64_t screen_id, std::vector<std::string> options, bool listens) {
  options_ = std::move(options);
  listens_ = listens;
  if (!wanted_) return;
  const bool offered = std::ranges::find(options_, *wanted_) != options_.end();
  if (screen_id != screen_id_ || !offered) wanted_.reset();
}

std::optional<Hearing::Answer> Hearing::other() {
  std::vector<std::string> others;
  others.reserve(options_.size());
  for (const auto& option : options_) {
    if (option != *wanted_) others.push_back(option);
  }
  if (others.empty()) return std::nullopt;
  ++mistaken_;
  return Answer{others[random_.below(others.size())]};
}

std::optional<Hearing::Answer> Hearing::step(double now) {
  if (!wanted_ || now < next_at_) return std::nullopt;
  next_at_ = now + Delivery::kSayAgain;
  if (asks_) {  // "yes"
    asks_ = false;
    ++said_;
    return random_.uniform() < rates_.confirmed ? std::optional(Answer{*wanted_}) : std::nullopt;
  }
  if (tries_ == Delivery::kMostSaid) {
    next_at_ = now + Delivery::kTouchAgain;
    ++fell_back_;
    return Answer{*wanted_, Means::kTouch};
  }
  ++tries_;
  ++said_;
  if (!listens_ && !unasked(*wanted_)) return std::nullopt;
  const double drawn = random_.uniform();
  if (drawn < rates_.understood) return Answer{*wanted_};
  if (drawn < rates_.understood + rates_.asked_back) {
    ++asked_back_;
    asks_ = true;
    next_at_ = now + kQuestion;
    return std::nullopt;
  }
  return drawn < rates_.understood + rates_.asked_back + rates_.mistaken ? other() : std::nullopt;
}

}  // namespace usher::visitor
