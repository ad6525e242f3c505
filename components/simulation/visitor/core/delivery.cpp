#include "simulation/visitor/core/delivery.hpp"

#include <algorithm>

namespace usher::visitor {

void Delivery::want(Wanted wanted, double now) {
  if (wanted_ && wanted_->screen_id == wanted.screen_id && wanted_->option == wanted.option) return;
  wanted_ = std::move(wanted);
  heard_at_ = next_at_ = now;
  said_ = 0;
}

void Delivery::see(std::uint64_t screen_id, const std::vector<std::string>& options) {
  if (!wanted_) return;
  const bool offered = std::find(options.begin(), options.end(), wanted_->option) != options.end();
  if (wanted_->screen_id != screen_id || !offered) wanted_.reset();
}

std::optional<Deed> Delivery::reply(const Ear& ear, double now) {
  if (ear.sounds || now < next_at_) return std::nullopt;
  next_at_ = now + kSayAgain;
  const bool right = !label_.empty() && ear.hint.find('"' + label_ + '"') != std::string::npos;
  return Deed{Means::kVoice, right ? "yes" : "no"};
}

Deed Delivery::touch(double now) {
  next_at_ = now + kTouchAgain;
  return {Means::kTouch, wanted_->option};
}

std::optional<Deed> Delivery::step(const Ear& ear, double now) {
  // Its question may come sooner than the visitor would have said it again.
  if (ear.asks && asked_ != ear.hint) next_at_ = now + kPause;
  asked_ = ear.asks ? ear.hint : "";
  if (ear.asks) return reply(ear, now);
  if (!wanted_) {
    label_.clear();
    return std::nullopt;
  }
  if (ear.listens) heard_at_ = now;
  if (now < next_at_) return std::nullopt;
  if (wanted_->means == Means::kTouch) return touch(now);
  if (said_ == kMostSaid || now - heard_at_ >= kDeaf) {
    wanted_->means = Means::kTouch;
    ++fell_back_;
    return touch(now);
  }
  if (!ear.listens || (ear.sounds && !wanted_->urgent)) return std::nullopt;
  ++said_;
  label_ = wanted_->label;
  next_at_ = now + kSayAgain;
  return Deed{Means::kVoice, label_};
}

}  // namespace usher::visitor
