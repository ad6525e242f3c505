#include "localization/amcl/core/beam_model.hpp"

#include <cassert>
#include <cmath>

namespace usher::amcl {
namespace {

double beam_likelihood(const SensorParameters& p, double max_range, double range, double expected) {
  const double deviation = (range - expected) / p.sigma_hit;
  double likelihood = p.z_hit * std::exp(-0.5 * deviation * deviation);
  if (range < expected)
    likelihood += p.z_short * p.lambda_short * std::exp(-p.lambda_short * range);
  likelihood += range >= max_range ? p.z_max : p.z_rand / max_range;
  return likelihood;
}

}  // namespace

void beam_model_log_likelihood(const grid::DistanceField& field, const SensorParameters& parameters,
                               double max_range, const Particles& particles,
                               const geometry::Pose2& base_T_laser, std::span<const Beam> beams,
                               std::span<double> log_likelihood) {
  assert(!field.empty() && log_likelihood.size() == particles.size());
  const double share = beams.empty() ? 0.0 : 1.0 / static_cast<double>(beams.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const geometry::Pose2 map_T_base = particles.pose(i);
    const geometry::Point2 laser = (map_T_base * base_T_laser).position();
    double sum = 0.0;
    for (const Beam& beam : beams) {
      const auto hit = field.cast_ray(laser, map_T_base.yaw + beam.angle, max_range);
      const double expected = hit ? hit->range : max_range;
      sum += std::log(beam_likelihood(parameters, max_range, beam.range, expected));
    }
    log_likelihood[i] = sum * share;
  }
}

}  // namespace usher::amcl
