#include "localization/amcl/core/amcl_config.hpp"

#include "foundation/result/bounds.hpp"

namespace usher::amcl {

Status AmclConfig::validate() const {
  const auto number = [](std::size_t value) { return static_cast<double>(value); };
  return within({
      {"z_hit", sensor.z_hit, 0.01, 1.0},
      {"z_short", sensor.z_short, 0.0, 1.0},
      {"z_max", sensor.z_max, 0.0, 1.0},
      {"z_rand", sensor.z_rand, 0.001, 1.0},
      {"sigma_hit", sensor.sigma_hit, 0.005, 1.0, "m"},
      {"lambda_short", sensor.lambda_short, 0.0, 10.0, "1/m"},
      {"field_radius", sensor.field_radius, 0.1, 20.0, "m"},
      {"max_range", sensor.max_range, 0.5, 200.0, "m"},
      {"max_beams", number(max_beams), 2, 4096},
      {"independent_beams", independent_beams, 0.1, 100.0},
      {"alpha1", noise.alpha1, 0.0, 10.0},
      {"alpha2", noise.alpha2, 0.0, 10.0},
      {"alpha3", noise.alpha3, 0.0, 10.0},
      {"alpha4", noise.alpha4, 0.0, 10.0},
      {"min_particles", number(min_particles), 10, number(max_particles)},
      {"max_particles", number(max_particles), 10, 1e6},
      {"global_particles", number(global_particles), 10, 1e6},
      {"kld_epsilon", kld_epsilon, 1e-3, 1.0},
      {"kld_quantile", kld_quantile, 0.0, 10.0},
      {"bin_position", bin_position, 0.05, 10.0, "m"},
      {"bin_yaw", bin_yaw, 0.01, 2.0 * geometry::kPi, "rad"},
      {"update_distance", update_distance, 0.0, 10.0, "m"},
      {"update_angle", update_angle, 0.0, geometry::kPi, "rad"},
      {"resample_interval", static_cast<double>(resample_interval), 1, 1000},
      {"max_step", max_step, 0.1, 1000.0, "m"},
      {"recovery_slow", recovery_slow, 0.0, recovery_fast},
      {"recovery_fast", recovery_fast, 0.0, 1.0},
      {"search_candidates", number(search_candidates), number(search_hypotheses), 1e6},
      {"search_hypotheses", number(search_hypotheses), 0, number(max_particles) / 2},
      {"refine_beams", number(refine_beams), 0, 4096},
      {"refinement.sigma", refinement.sigma, 0.005, 1.0, "m"},
      {"refinement.max_shift", refinement.max_shift, 0.0, 2.0, "m"},
      {"refinement.max_turn", refinement.max_turn, 0.0, 1.0, "rad"},
      {"refinement.iterations", static_cast<double>(refinement.iterations), 0, 100},
      {"confidence.explained_distance", confidence.explained_distance, 0.01, sensor.field_radius,
       "m"},
      {"confidence.good_explained", confidence.good_explained, confidence.lost_explained, 1.0},
      {"confidence.lost_explained", confidence.lost_explained, 0.0, 1.0},
      {"confidence.good_unmapped", confidence.good_unmapped, 0.0, 1.0},
      {"confidence.good_beams", number(confidence.good_beams), 0, 4096},
      {"confidence.good_sigma", confidence.good_sigma, 0.01, 100.0, "m"},
      {"confidence.good_weight", confidence.good_weight, 0.0, 1.0},
  });
}

}  // namespace usher::amcl
