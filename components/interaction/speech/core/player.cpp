#include "interaction/speech/core/player.hpp"

#include <algorithm>
#include <cmath>

#include "interaction/speech/core/loudness.hpp"

namespace usher::speech {

void Player::add(Utterance utterance) {
  if (waiting_.size() == kMostWaiting) waiting_.erase(waiting_.begin() + (position_ > 0 ? 1 : 0));
  waiting_.push_back(std::move(utterance));
}

void Player::break_off() {
  if (!waiting_.empty() && position_ > 0 && !given_.empty()) given_.back().whole = true;
  waiting_.clear();
  position_ = 0;
}

void Player::take(std::span<std::int16_t> samples) {
  const double step = 1.0 / (0.01 * rate_);
  for (std::int16_t& sample : samples) {
    sample = 0;
    while (!waiting_.empty() && position_ >= waiting_.front().sound.samples.size()) {
      if (position_ > 0 && !given_.empty()) given_.back().whole = true;
      waiting_.pop_front();
      position_ = 0;
    }
    gain_now_ += std::clamp(gain_ - gain_now_, -step, step);
    if (!waiting_.empty()) {
      const Utterance& utterance = waiting_.front();
      if (position_ == 0) {
        if (given_.size() == kMostGiven) given_.pop_front();
        Given given;
        given.caption.id = utterance.id;
        given.caption.sentence = utterance.sentence;
        given.words = utterance.words;
        given.begin = given.end = place_;
        given_.push_back(std::move(given));
      }
      sample =
          static_cast<std::int16_t>(std::lround(gain_now_ * utterance.sound.samples[position_++]));
      given_.back().end = place_ + 1;
    }
    ++place_;
  }
  if (!waiting_.empty() && position_ >= waiting_.front().sound.samples.size()) {
    if (position_ > 0) given_.back().whole = true;
    waiting_.pop_front();
    position_ = 0;
  }
  record(samples);
}

void Player::record(std::span<const std::int16_t> samples) {
  std::uint64_t at = place_ - samples.size();
  for (const std::int16_t sample : samples) {
    frame_.push_back(sample);
    if (++at % kFrame != 0) continue;
    loudness_[(at / kFrame - 1) % kFrames] = loudness_db(frame_);
    frame_.clear();
  }
}

std::optional<Caption> Player::caption(std::uint64_t unheard) const {
  if (heard(unheard) == 0) return std::nullopt;
  const std::uint64_t now = heard(unheard) - 1;  // the last sample that was heard
  for (const Given& given : given_) {
    if (now < given.begin || now >= given.end || given.caption.sentence.empty()) continue;
    Caption caption = given.caption;
    const double time = static_cast<double>(now - given.begin) / rate_;
    for (const Word& word : given.words) {
      if (word.time > time) break;
      caption.word_begin = word.begin;
      caption.word_length = word.length;
    }
    return caption;
  }
  return std::nullopt;
}

double Player::loudness(std::uint64_t unheard) const {
  const std::uint64_t last = heard(unheard) / kFrame;
  const std::uint64_t frames = static_cast<std::uint64_t>(0.04 * rate_) / kFrame + 1;
  double loudest = -100.0;
  for (std::uint64_t i = 0; i < frames && i < last; ++i)
    loudest = std::max(loudest, loudness_[(last - 1 - i) % kFrames]);
  return loudest;
}

bool Player::sounds(std::uint64_t unheard) const {
  return busy() || (!given_.empty() && heard(unheard) < given_.back().end);
}

std::uint64_t Player::finished(std::uint64_t unheard) const {
  std::uint64_t id = 0;
  for (const Given& given : given_) {
    if (given.whole && heard(unheard) >= given.end) id = std::max(id, given.caption.id);
  }
  return id;
}

}  // namespace usher::speech
