#pragma once

namespace usher::amcl {

/// Parameters of both sensor models [thrun2005, tables 6.1 and 6.3]; the shares need not add up
/// to 1.
struct SensorParameters {
  double z_hit =
      0.95;  ///< share of beams that end at the map's nearest obstacle, blurred by sigma_hit
  double z_short = 0.1;  ///< beam model: share that ends early, at people say
  double z_max = 0.05;   ///< beam model: share without return
  double z_rand = 0.05;  ///< share that ends anywhere
  double sigma_hit =
      0.2;  ///< [m] map, sensor and pose within one particle's neighbourhood together
  double lambda_short = 0.1;  ///< [1/m] beam model: decay of early ends
  double field_radius = 2.0;  ///< [m] likelihood field: farther ends count as random
  double max_range = 30.0;    ///< [m] readings from here on saw nothing

  bool operator==(const SensorParameters&) const = default;
};

}  // namespace usher::amcl
