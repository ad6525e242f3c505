#include "control/manual_control/core/manual_control.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace usher::manual_control {

namespace {

/// Of a pad that was not heard: held or not, only what stops the robot counts at once.
constexpr std::array kMayBeHeld = {false, true, true, true};

bool pressed(std::span<const std::int32_t> buttons, std::size_t number) {
  return number < buttons.size() && buttons[number] != 0;
}

}  // namespace

ManualControl::ManualControl(const Parameters& parameters) : parameters_(parameters) {
  assert(parameters.linear > 0.0 && parameters.angular > 0.0);
  assert(parameters.dead_zone >= 0.0 && parameters.dead_zone < 1.0);
}

ManualControl::Pad& ManualControl::pad_of(const drive::WriterId& writer, Time now) {
  const auto end = pads_.begin() + static_cast<std::ptrdiff_t>(pad_count_);
  auto pad = std::find_if(pads_.begin(), end, [&](const Pad& p) { return p.writer == writer; });
  if (pad == end) {
    if (pad_count_ < kMostPads) {
      ++pad_count_;
    } else {  // the one that was not heard for longest makes room
      pad = std::min_element(pads_.begin(), end,
                             [](const Pad& a, const Pad& b) { return a.heard_at < b.heard_at; });
    }
    *pad = Pad{writer, now, false, kMayBeHeld};
  }
  // Whoever was silent for long may have been pressed meanwhile: that is no new press.
  if (now - pad->heard_at > parameters_.patience) {
    pad->seen_released = false;
    pad->wishes = kMayBeHeld;
  }
  pad->heard_at = now;
  return *pad;
}

Wish ManualControl::edge(Pad& pad, const Sticks& sticks) const {
  const Mapping& map = mapping_of(sticks);
  // What stops wins when two are pressed at once.
  const std::array<std::pair<std::size_t, Wish>, 4> buttons{{{map.movement_off, Wish::kMovementOff},
                                                             {map.manual_off, Wish::kManualOff},
                                                             {map.manual_on, Wish::kManualOn},
                                                             {map.movement_on, Wish::kMovementOn}}};
  Wish wish = Wish::kNone;
  for (std::size_t i = 0; i < buttons.size(); ++i) {
    const bool down = pressed(sticks.buttons, buttons[i].first);
    if (down && !pad.wishes[i] && wish == Wish::kNone) wish = buttons[i].second;
    pad.wishes[i] = down;
  }
  return wish;
}

double ManualControl::deflection(float value) const {
  const double size = std::min(1.0, std::abs(static_cast<double>(value)));
  const double beyond = (size - parameters_.dead_zone) / (1.0 - parameters_.dead_zone);
  return std::copysign(std::max(0.0, beyond), static_cast<double>(value));
}

void ManualControl::release(Time now) {
  holder_.reset();
  twist_ = {};
  released_at_ = now;
}

Wish ManualControl::take(const Sticks& sticks, Time now) {
  command(now);  // a holder that was silent for too long no longer is one
  Pad& pad = pad_of(sticks.writer, now);
  const Mapping& map = mapping_of(sticks);
  const bool finite = std::all_of(sticks.axes.begin(), sticks.axes.end(),
                                  [](float axis) { return std::isfinite(axis); });
  if (!finite) ++rejected_;
  const bool complete = map.forward_axis < sticks.axes.size() && map.turn_axis < sticks.axes.size();
  const bool down = pressed(sticks.buttons, map.dead_man) && finite && complete && !sticks.late;
  if (!down) pad.seen_released = finite && !sticks.late;
  if (down && pad.seen_released && !holder_) holder_ = sticks.writer;
  if (holder_ == sticks.writer) {
    if (down) {
      held_at_ = now;
      twist_ = {parameters_.linear * deflection(sticks.axes[map.forward_axis]),
                parameters_.angular * deflection(sticks.axes[map.turn_axis])};
    } else {
      release(now);
    }
  }
  return edge(pad, sticks);
}

std::optional<geometry::Twist2> ManualControl::command(Time now) {
  if (holder_ && now - held_at_ >= parameters_.patience) {
    for (Pad& pad : pads_) {
      if (pad.writer == *holder_) pad.seen_released = false;
    }
    release(now);
  }
  if (holder_) return twist_;
  if (released_at_ && now - *released_at_ < parameters_.farewell) return geometry::Twist2{};
  return std::nullopt;
}

}  // namespace usher::manual_control
