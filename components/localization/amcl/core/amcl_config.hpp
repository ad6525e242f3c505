#pragma once

#include <cstddef>

#include "foundation/geometry/angle.hpp"
#include "foundation/result/result.hpp"
#include "localization/amcl/core/motion_model.hpp"
#include "localization/amcl/core/scan_refinement.hpp"
#include "localization/amcl/core/sensor_parameters.hpp"

namespace usher::amcl {

enum class SensorModel { kLikelihoodField, kBeam };

/// What decides between Confidence levels, see Quality.
struct ConfidenceLimits {
  double explained_distance =
      0.2;  ///< [m] a beam that ends nearer to an obstacle of the map is explained
  double good_explained =
      0.75;  ///< [0, 1] share of explained beams below which the pose is doubtful
  double lost_explained = 0.4;  ///< [0, 1] below which it is wrong
  double good_unmapped = 0.4;   ///< [0, 1] largest share of beams that met something unmapped
  double good_sigma = 0.5;   ///< [m] largest standard deviation of a position that may be trusted
  double good_weight = 0.8;  ///< [0, 1] least share of the belief in the best cluster
  std::size_t good_beams = 20;  ///< fewer beams with a return explain themselves too easily

  bool operator==(const ConfidenceLimits&) const = default;
};

struct AmclConfig {
  SensorModel sensor_model = SensorModel::kLikelihoodField;
  SensorParameters sensor;
  std::size_t max_beams = 60;
  /// How many independent measurements a scan is worth: its beams hit the same walls and share the
  /// map's errors, so their plain product would make the filter far too sure. The mean log
  /// likelihood of a beam counts this often.
  double independent_beams = 10.0;
  MotionNoise noise;

  std::size_t min_particles = 200;
  std::size_t max_particles = 5000;
  std::size_t global_particles = 30000;      ///< for the first scan of a global start
  double kld_epsilon = 0.05;                 ///< see kld_sample_bound()
  double kld_quantile = 2.33;                ///< 99 %
  double bin_position = 0.5;                 ///< [m] of the pose histogram behind KLD and clusters
  double bin_yaw = geometry::radians(10.0);  ///< [rad]

  double update_distance = 0.1;  ///< [m] driven since the last update before the next
  double update_angle = 0.1;     ///< [rad] turned, likewise
  int resample_interval = 1;     ///< updates per resampling
  double max_step = 2.0;  ///< [m] a longer odometry step is a restart of the odometry, not a motion

  double recovery_slow =
      0.001;                   ///< decay of the long-term scan likelihood; 0 switches recovery off
  double recovery_fast = 0.1;  ///< decay of the short-term one
  std::size_t search_candidates = 5000;  ///< random poses tried per update while searching
  std::size_t search_hypotheses = 40;    ///< best of them that become particles

  std::size_t refine_beams = 180;  ///< 0 switches refinement off
  RefinementParameters refinement;
  ConfidenceLimits confidence;

  /// The first value out of range, with its range.
  Status validate() const;

  bool operator==(const AmclConfig&) const = default;
};

}  // namespace usher::amcl
