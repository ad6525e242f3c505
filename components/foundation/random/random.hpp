#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace usher {

/// A deterministic random number stream (splitmix64): the same seed gives the same numbers on every
/// machine, which std::normal_distribution does not promise. Source: Steele, Lea, Flood 2014
/// [steele2014splitmix].
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in {0, ..., count - 1}; count must be positive.
  std::uint64_t below(std::uint64_t count) { return next() % count; }
  /// Standard normal (Box-Muller, cosine branch; two draws a call, so that streams stay aligned).
  double gaussian() {
    const double u1 = uniform() + 1e-300;
    const double u2 = uniform();
    return std::sqrt(-2.0 * std::log(u1)) * std::cos(2.0 * std::numbers::pi * u2);
  }
  double gaussian(double mean, double sigma) { return mean + sigma * gaussian(); }

 private:
  std::uint64_t state_;
};

/// A seed for a named stream, so that streams of one world do not depend on the order in which they
/// are made.
constexpr std::uint64_t stream_seed(std::uint64_t seed, const char* name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL ^ seed;  // FNV-1a
  for (; *name != '\0'; ++name)
    hash = (hash ^ static_cast<unsigned char>(*name)) * 0x100000001b3ULL;
  return hash;
}

}  // namespace usher
