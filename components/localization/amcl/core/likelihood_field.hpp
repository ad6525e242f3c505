#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "foundation/cpu/cpu.hpp"
#include "foundation/grid/distance_field.hpp"
#include "foundation/grid/grid.hpp"
#include "localization/amcl/core/laser_beams.hpp"
#include "localization/amcl/core/particles.hpp"
#include "localization/amcl/core/sensor_parameters.hpp"

namespace usher::amcl {

/// The likelihood-field model [thrun2005, table 6.3]: a beam is as likely as its end is near an
/// obstacle of the map,
///
///     p = z_hit exp(-d^2 / 2 sigma_hit^2) + z_rand / max_range,
///
/// and a scan is as likely as the product of its beams.
///
/// The field holds log p of every cell in 16 bits (error of a beam's log p at most half of log(p
/// best / p worst) / 65535, 5e-5 with the default parameters) and 2 bytes a cell, so the
/// neighbourhood of a tracking filter stays in the first-level cache. See sum_field() for its cost.
class LikelihoodField {
 public:
  /// Keeps its memory for the next map. O(cells), see DistanceField.
  void build(const grid::OccupancyGrid& map, const SensorParameters& parameters,
             cpu::Simd simd = cpu::best_simd());

  bool empty() const { return distances_.empty(); }
  const grid::DistanceField& distances() const { return distances_; }

  /// log_likelihood[i] = mean of log p over the beams for particle i; 0 without beams. Does not
  /// allocate once as many particles and beams have been seen.
  void log_likelihood(const Particles& particles, std::span<const Beam> beams,
                      std::span<double> log_likelihood, cpu::Simd simd = cpu::best_simd());

  /// p of one beam that ends `distance` [m] from the nearest obstacle.
  double beam_likelihood(double distance) const;

 private:
  SensorParameters parameters_;
  grid::DistanceField distances_;
  double lowest_ = 0.0;                   // log p that is stored as 0
  double unit_ = 0.0;                     // of log p per stored step
  std::vector<std::uint16_t> by_square_;  // stored value by squared distance [cells^2]
  std::vector<std::uint16_t> field_;      // with a border of one cell, and one value more
  std::vector<float> x_, y_, cosine_, sine_, beam_x_, beam_y_;
  std::vector<double> yaw_;
  std::vector<std::uint32_t> sums_;
};

}  // namespace usher::amcl
