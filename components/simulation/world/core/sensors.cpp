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

// A draw with 12 of the bits.
bool chance(std::uint64_t bits, unsigned shift, double share) {
  return static_cast<double>((bits >> shift) & kNoiseMask) <
         share * static_cast<double>(kNoiseMask + 1);
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
  glass_.resize(static_cast<std::size_t>(config.count));
}

void Laser::scan(const Scene& scene, std::span<const Mover> movers,
                 const geometry::Pose3& world_T_base, std::vector<float>& ranges) {
  for (std::uint8_t& flag : glass_) flag = chance(random_.next(), 0, config_.glass_share) ? 1 : 0;
  caster_.cast(scene, fan_, world_T_base * config_.mount.base_T_sensor(),
               {.max_range = config_.range_max, .glass_flags = glass_}, movers, hits_);
  const auto count = static_cast<std::size_t>(config_.count);
  ranges.resize(count);
  const float step = static_cast<float>(config_.step);
  const float per_step = 1.0f / step;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t bits = random_.next();
    float range = hits_.range[i];
    const bool returns = self_[i] > 0.0f || hits_.what[i] != kNothing;
    if (!returns) {
      ranges[i] = kInfinity;
      continue;
    }
    if (self_[i] > 0.0f) {
      range = self_[i];
    } else {
      const std::size_t next = std::min(i + 1, count - 1);
      const float jump = hits_.range[next] - range;
      if (std::abs(jump) > kEdge && hits_.what[next] != kNothing &&
          chance(bits, kNoiseBits, config_.mixed_share)) {
        range += jump * static_cast<float>((bits >> 40) & 255U) / 255.0f;
      }
    }
    range += systematic_[static_cast<std::size_t>(range / static_cast<float>(kSystematicStep))] +
             noise_[bits & kNoiseMask];
    ranges[i] =
        static_cast<float>(static_cast<int>(std::max(range, step) * per_step + 0.5f)) * step;
  }
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
  const auto bent = [&](double x, double y, double angle) {
    const Pose2 root = robot * Pose2{x, y, angle};
    caster_.cast(scene, beam_, {{root.x, root.y, config_.z}, geometry::to_space(root).rotation},
                 {.max_range = config_.length}, movers, hits_);
    return hits_.what[0] != kNothing;
  };
  const double x = config_.x;
  const double y = config_.y;
  const double back = geometry::kPi - config_.outward;
  return {.front_left = bent(x, y, config_.outward),
          .front_right = bent(x, -y, -config_.outward),
          .back_left = bent(-x, y, back),
          .back_right = bent(-x, -y, -back)};
}

}  // namespace usher::world
