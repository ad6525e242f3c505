#include "localization/amcl/core/motion_model.hpp"

#include <algorithm>
#include <cmath>

namespace usher::amcl {
namespace {

/// The turn without its direction of travel: pi is driving straight backwards.
double noisy_part(double rotation) {
  return std::min(std::abs(rotation), std::abs(geometry::shortest_turn(geometry::kPi, rotation)));
}

}  // namespace

void move(Particles& particles, const geometry::Pose2& base0_T_base1, const MotionNoise& noise,
          Random& random) {
  const double translation = std::hypot(base0_T_base1.x, base0_T_base1.y);
  const double rotation1 = translation < 0.01 ? 0.0 : std::atan2(base0_T_base1.y, base0_T_base1.x);
  const double rotation2 = geometry::shortest_turn(rotation1, base0_T_base1.yaw);
  const double noisy1 = noisy_part(rotation1);
  const double noisy2 = noisy_part(rotation2);
  const double square = translation * translation;
  const double sigma1 = std::sqrt(noise.alpha1 * noisy1 * noisy1 + noise.alpha2 * square);
  const double sigma_t =
      std::sqrt(noise.alpha3 * square + noise.alpha4 * (noisy1 * noisy1 + noisy2 * noisy2));
  const double sigma2 = std::sqrt(noise.alpha1 * noisy2 * noisy2 + noise.alpha2 * square);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double r1 = random.gaussian(rotation1, sigma1);
    const double t = random.gaussian(translation, sigma_t);
    const double r2 = random.gaussian(rotation2, sigma2);
    const double heading = particles.yaw[i] + r1;
    particles.x[i] += t * std::cos(heading);
    particles.y[i] += t * std::sin(heading);
    particles.yaw[i] = geometry::normalized(heading + r2);
  }
}

}  // namespace usher::amcl
