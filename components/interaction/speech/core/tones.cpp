#include "interaction/speech/core/tones.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace usher::speech {

namespace {

struct Note {
  double frequency;  ///< [Hz], 0 = pause
  double duration;   ///< [s]
};

constexpr Note kMovingNotes[] = {{523.25, 0.14}, {659.26, 0.14}, {783.99, 0.22}};
constexpr Note kPleaseNotes[] = {{659.26, 0.15}, {0.0, 0.05}, {659.26, 0.15}};
constexpr Note kCallNotes[] = {{783.99, 0.2}, {523.25, 0.3}};
constexpr Note kListeningNotes[] = {{587.33, 0.07}, {880.0, 0.09}};
constexpr Note kHeardNotes[] = {{880.0, 0.07}, {587.33, 0.09}};

constexpr double kPeak = 8231.0;  // -12 dB
constexpr double kEdge = 0.012;   // [s]

std::span<const Note> notes(Tone tone) {
  switch (tone) {
    case Tone::kMoving:
      return kMovingNotes;
    case Tone::kPlease:
      return kPleaseNotes;
    case Tone::kCall:
      return kCallNotes;
    case Tone::kListening:
      return kListeningNotes;
    case Tone::kHeard:
      return kHeardNotes;
    case Tone::kNone:
      break;
  }
  return {};
}

}  // namespace

Sound tone(Tone tone, int rate) {
  Sound sound{rate, {}};
  for (const Note& note : notes(tone)) {
    const auto count = static_cast<int>(note.duration * rate);
    for (int i = 0; i < count; ++i) {
      const double t = static_cast<double>(i) / rate;
      const double edge = std::min({1.0, t / kEdge, (note.duration - t) / kEdge});
      const double soft = 0.5 - 0.5 * std::cos(std::numbers::pi * edge);
      const double wave = std::sin(2.0 * std::numbers::pi * note.frequency * t);
      sound.samples.push_back(static_cast<std::int16_t>(std::lround(kPeak * soft * wave)));
    }
  }
  return sound;
}

}  // namespace usher::speech
