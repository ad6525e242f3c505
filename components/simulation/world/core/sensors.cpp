#include "simulation/world/core/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace usher::world {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kNoiseBits = 12;
constexpr std::uint64_t kNoiseMask = (1U << kNoiseBits) - 1;
constexpr double kSystematicStep = 0.1;  // [m] of range
constexpr int kConeRays = 7;
constexpr float kEdge = 0.1f;  // [m] a larger step between neighbouring beams is an edge

// Normal numbers with mean 0 and the deviation exactly: picking one is far cheaper than making one.
std::vector<float> normal_table(double sigma, Random& random) {
  std::vector<double> half(std::size_t{1} << (kNoiseBits - 1));
  double squares = 0.0;
  for (double& value : half) value = random.gaussian(), squares += value * value;
  const double scale = sigma / std::sqrt(squares / static_cast<double>(half.size()));
  std::vector<float> table;
  for (const double value : half) {
    table.push_back(static_cast<float>(scale * value));
    table.push_back(static_cast<float>(-scale * value));
  }
  return table;
}

// One draw a beam serves all its lotteries, 12 bits each.
constexpr unsigned kGlassShift = kNoiseBits;
constexpr unsigned kMixedShift = 2 * kNoiseBits;
constexpr unsigned kMixShift = 3 * kNoiseBits;

std::uint32_t lottery(std::uint64_t bits, unsigned shift) {
  return static_cast<std::uint32_t>((bits >> shift) & kNoiseMask);
}

// A lottery below this is won.
std::uint32_t threshold(double share) {
  return static_cast<std::uint32_t>(share * static_cast<double>(kNoiseMask + 1));
}

}  // namespace

Laser::Laser(const LaserConfig& config, std::uint64_t seed)
    : config_(config),
      fan_(config.angle_min, config.increment, config.count),
      random_(stream_seed(seed, config.name.c_str())),
      noise_(normal_table(config.statistical_error, random_)) {
  // A constant part and one that changes slowly with the range, together never beyond the bound.
  const double constant = 0.5 * config.systematic_error * random_.uniform(-1.0, 1.0);
  const double phase = random_.uniform(0.0, 2.0 * geometry::kPi);
  for (double range = 0.0; range <= config.range_max + kSystematicStep; range += kSystematicStep) {
    systematic_.push_back(static_cast<float>(constant + 0.5 * config.systematic_error *
                                                            std::sin(phase + 1.5 * range)));
  }
  for (int i = 0; i < config.count; ++i) {
    const double angle = fan_.angle(i);
    const bool own = std::abs(angle) > config.self_angle;
    self_.push_back(
        own ? static_cast<float>(config.self_range * (1.0 + 0.15 * std::sin(7.0 * angle))) : 0.0f);
  }
  bits_.resize(static_cast<std::size_t>(config.count));
  glass_.resize(static_cast<std::size_t>(config.count));
}

void Laser::scan(const Scene& scene, std::span<const Mover> movers,
                 const geometry::Pose3& world_T_base, std::vector<float>& ranges) {
  const auto count = static_cast<std::size_t>(config_.count);
  const std::uint32_t glass_below = threshold(config_.glass_share);
  for (std::size_t i = 0; i < count; ++i) {
    bits_[i] = random_.next();
    glass_[i] = lottery(bits_[i], kGlassShift) < glass_below ? 1 : 0;
  }
  caster_.cast(scene, fan_, world_T_base * config_.mount.base_T_sensor(),
               {.max_range = config_.range_max, .glass_flags = glass_}, movers, hits_);
  ranges.resize(count);
  const std::uint32_t mixed_below = threshold(config_.mixed_share);
  const float step = static_cast<float>(config_.step);
  const float steps_per_metre = 1.0f / step;
  const float growth = config_.statistical_error > 0.0
                           ? static_cast<float>(config_.relative_error / config_.statistical_error)
                           : 0.0F;
  constexpr float kBinsPerMetre = 1.0f / static_cast<float>(kSystematicStep);
  for (std::size_t i = 0; i < count; ++i) {
    float range = hits_.range[i];
    if (self_[i] > 0.0f) {
      range = self_[i];
    } else if (hits_.what[i] == kNothing) {
      ranges[i] = kInfinity;
      continue;
    } else if (lottery(bits_[i], kMixedShift) < mixed_below) {
      range = mixed(i);
    }
    range += systematic_[static_cast<std::size_t>(static_cast<int>(range * kBinsPerMetre))] +
             noise_[bits_[i] & kNoiseMask] * std::max(1.0F, range * growth);
    const int whole = static_cast<int>(range * steps_per_metre + 0.5f);
    ranges[i] = static_cast<float>(std::max(whole, 1)) * step;
  }
}

// The range of a beam that falls on an edge of a thing: somewhere between both surfaces; of any
// other beam: its own.
float Laser::mixed(std::size_t beam) const {
  const std::size_t next = std::min(beam + 1, hits_.range.size() - 1);
  const float jump = hits_.range[next] - hits_.range[beam];
  const bool things = hits_.what[beam] >= 0 && hits_.what[next] >= 0;
  if (!things || hits_.what[beam] == hits_.what[next] || std::abs(jump) < kEdge) {
    return hits_.range[beam];
  }
  return hits_.range[beam] + jump * static_cast<float>(lottery(bits_[beam], kMixShift)) /
                                 static_cast<float>(kNoiseMask);
}

Mount SonarConfig::mount(int i) const {
  const double yaw = (i - 0.5 * (count - 1)) * spacing;
  return {.x = ring_radius * std::cos(yaw), .y = ring_radius * std::sin(yaw), .z = z, .yaw = yaw};
}

Sonar::Sonar(const SonarConfig& config, std::uint64_t seed)
    : config_(config),
      fan_(-0.5 * config.cone, config.cone / (kConeRays - 1), kConeRays),
      random_(stream_seed(seed, "sonar")) {}

void Sonar::measure(const Scene& scene, std::span<const Mover> movers,
                    const geometry::Pose3& world_T_base, std::vector<float>& ranges) {
  ranges.resize(static_cast<std::size_t>(config_.count));
  for (int i = 0; i < config_.count; ++i) {
    caster_.cast(scene, fan_, world_T_base * config_.mount(i).base_T_sensor(),
                 {.max_range = config_.range_max}, movers, hits_);
    const double error = config_.noise * random_.gaussian();
    const double range = static_cast<double>(nearest_echo()) + error;
    const double inches = std::round(std::max(range, config_.range_min) / config_.step);
    ranges[static_cast<std::size_t>(i)] =
        range > config_.range_max ? kInfinity : static_cast<float>(inches * config_.step);
  }
}

// A ray counts when the surface, judged by a neighbouring ray on the same thing, faces the sensor.
float Sonar::nearest_echo() const {
  const float flattest = static_cast<float>(std::tan(config_.max_incidence) * fan_.increment());
  float nearest = kInfinity;
  for (std::size_t i = 0; i < hits_.range.size(); ++i) {
    if (hits_.what[i] == kNothing || hits_.what[i] == kFloor) continue;
    const std::size_t other = i > 0 ? i - 1 : i + 1;
    const bool same = hits_.what[other] == hits_.what[i];
    if (same && std::abs(hits_.range[i] - hits_.range[other]) > flattest * hits_.range[i]) continue;
    nearest = std::min(nearest, hits_.range[i]);
  }
  return nearest;
}

WhiskerContacts Whiskers::touch(const Scene& scene, std::span<const Mover> movers,
                                const Pose2& robot) {
  // Bent outward so far, by a wall ahead, its tip is still this far ahead of its root; bent inward
  // so far, by a wall beside, it lies along this angle.
  const double reach = config_.length * std::cos(config_.outward + config_.trigger_bend);
  const double angle = config_.outward - config_.trigger_bend;
  // From inside of the outline, since the root may stand in what the robot is about to touch.
  constexpr double kInside = 0.85;
  const auto bent = [&](double front, double left) {
    const geometry::Point2 root(kInside * front * config_.x, kInside * left * config_.y);
    const geometry::Point2 tip(front * (config_.x + reach * std::cos(angle)),
                               left * (config_.y + reach * std::sin(angle)));
    const geometry::Point2 way = tip - root;
    const Pose2 from = robot * Pose2{root.x(), root.y(), std::atan2(way.y(), way.x())};
    caster_.cast(scene, beam_, {{from.x, from.y, config_.z}, geometry::to_space(from).rotation},
                 {.max_range = way.norm()}, movers, hits_);
    return hits_.what[0] != kNothing;
  };
  return {.front_left = bent(1.0, 1.0),
          .front_right = bent(1.0, -1.0),
          .back_left = bent(-1.0, 1.0),
          .back_right = bent(-1.0, -1.0)};
}

}  // namespace usher::world
