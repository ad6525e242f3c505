#include "interaction/speech/core/resample.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace usher::speech {

namespace {

constexpr double kBeta = 6.8;         // Kaiser window, 70 dB
constexpr double kCutoff = 0.46;      // of the lower rate
constexpr int kLobes = 20;            // of the sinc to each side
constexpr int kTelephoneRate = 8000;  // [Hz]
constexpr double kMirror = 0.056;     // -25 dB

double bessel_i0(double x) {
  double sum = 1.0, term = 1.0;
  for (int k = 1; k < 40; ++k) {
    term *= (x / (2.0 * k)) * (x / (2.0 * k));
    sum += term;
  }
  return sum;
}

/// One filter for each place between two input samples that an output sample can have.
struct PolyphaseFilter {
  int up = 1, down = 1;      ///< rates over their greatest common divisor
  int reach = 0;             ///< taps to each side, in input samples
  std::vector<double> taps;  ///< up x (2 reach + 1)

  PolyphaseFilter(int from, int to) {
    const int divisor = std::gcd(from, to);
    up = to / divisor;
    down = from / divisor;
    const double cutoff = kCutoff * std::min(1.0, static_cast<double>(to) / from);
    const double half = kLobes / (2.0 * cutoff);  // [input samples]
    reach = static_cast<int>(std::ceil(half));
    const int width = 2 * reach + 1;
    taps.resize(static_cast<std::size_t>(up) * static_cast<std::size_t>(width));
    for (int phase = 0; phase < up; ++phase) {
      double* row = &taps[static_cast<std::size_t>(phase) * static_cast<std::size_t>(width)];
      double sum = 0.0;
      for (int k = -reach; k <= reach; ++k) {
        const double t = k - static_cast<double>(phase) / up;
        const double u = t / half;
        const double window =
            std::abs(u) >= 1.0 ? 0.0 : bessel_i0(kBeta * std::sqrt(1.0 - u * u)) / bessel_i0(kBeta);
        const double x = 2.0 * std::numbers::pi * cutoff * t;
        row[k + reach] = window * (t == 0.0 ? 1.0 : std::sin(x) / x);
        sum += row[k + reach];
      }
      for (int k = 0; k < width; ++k) row[k] /= sum;
    }
  }
};

std::int16_t to_sample(double value) {
  return static_cast<std::int16_t>(std::lround(std::clamp(value, -32768.0, 32767.0)));
}

}  // namespace

Sound resampled(const Sound& sound, int rate) {
  if (rate == sound.rate) return sound;
  const PolyphaseFilter filter(sound.rate, rate);
  const auto count = static_cast<std::int64_t>(sound.samples.size());
  Sound out{rate, {}};
  out.samples.resize(static_cast<std::size_t>((count * filter.up + filter.down - 1) / filter.down));
  const int width = 2 * filter.reach + 1;
  for (std::size_t i = 0; i < out.samples.size(); ++i) {
    const std::int64_t place = static_cast<std::int64_t>(i) * filter.down;
    const std::int64_t middle = place / filter.up;
    const double* row =
        &filter.taps[static_cast<std::size_t>(place % filter.up) * static_cast<std::size_t>(width)];
    const std::int64_t first = std::max<std::int64_t>(0, middle - filter.reach);
    const std::int64_t last = std::min<std::int64_t>(count - 1, middle + filter.reach);
    double sum = 0.0;
    for (std::int64_t j = first; j <= last; ++j)
      sum += row[j - middle + filter.reach] * sound.samples[static_cast<std::size_t>(j)];
    out.samples[i] = to_sample(sum);
  }
  return out;
}

Sound for_recognizer(const Sound& sound) {
  Sound out = resampled(sound, kSpeechRate);
  if (sound.rate != kTelephoneRate) return out;
  for (std::size_t i = 0; i < out.samples.size(); ++i) {
    // Zeros between the samples give the band and its mirror; less the band, the mirror remains.
    const double both = i % 2 == 0 ? 2.0 * sound.samples[i / 2] : 0.0;
    out.samples[i] = to_sample(out.samples[i] + kMirror * (both - out.samples[i]));
  }
  return out;
}

}  // namespace usher::speech
