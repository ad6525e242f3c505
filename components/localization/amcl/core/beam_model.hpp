#pragma once

#include <span>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/distance_field.hpp"
#include "localization/amcl/core/laser_beams.hpp"
#include "localization/amcl/core/particles.hpp"
#include "localization/amcl/core/sensor_parameters.hpp"

namespace usher::amcl {

/// The beam model [thrun2005, table 6.1]: each beam against the range z* that the map promises from
/// the particle, as a mixture of hit, early end, no return and anything. log_likelihood[i] is the
/// mean of log p over the beams, as in LikelihoodField. Rays are cast through the distance field:
/// about a hundred times the cost of LikelihoodField, for places where what a beam passes on its
/// way tells the truth (glass behind furniture, symmetric rooms). `max_range` [m] is where a beam
/// counts as without return. 0 without beams.
void beam_model_log_likelihood(const grid::DistanceField& field, const SensorParameters& parameters,
                               double max_range, const Particles& particles,
                               const geometry::Pose2& base_T_laser, std::span<const Beam> beams,
                               std::span<double> log_likelihood);

}  // namespace usher::amcl
