// `usher bench amcl`: the input of the published figures of ROS amcl, Beluga and MRPT.
#include <benchmark/benchmark.h>

#include <memory>

#include "foundation/estimation/gaussian_pose.hpp"
#include "localization/amcl/core/amcl.hpp"
#include "localization/amcl/test/willow_scan.hpp"
#include "support/bench.hpp"

namespace usher::amcl {
namespace {

using bench::Bench;
using bench::Bound;

const geometry::Pose2 kReference{27.5, 17.5, 0.0};

Eigen::Matrix3d start_covariance() {
  const double yaw = geometry::radians(15.0);
  return Eigen::Vector3d(0.25, 0.25, yaw * yaw).asDiagonal();
}

LaserBeams as_beams(const std::vector<float>& ranges) {
  return {{}, -0.75 * geometry::kPi, 1.5 * geometry::kPi / 540, 0.0, 30.0, ranges};
}

/// What a sensor update is to the peers: choose beams, likelihoods, weights, norm.
struct SensorUpdate {
  SensorUpdate(LikelihoodField& likelihood_field, const std::vector<float>& scan,
               std::size_t beam_count, std::size_t count)
      : field(likelihood_field), ranges(scan), max_beams(beam_count), likelihood(count) {
    const auto gaussian = estimation::GaussianPose::make(kReference, start_covariance());
    Random random(1);
    particles.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      particles.set(i, gaussian->sample(random), 1.0 / static_cast<double>(count));
    }
  }

  void operator()() {
    choose_beams(as_beams(ranges), max_beams, 30.0, false, beams);
    field.log_likelihood(particles, beams, likelihood);
    const double best = *std::max_element(likelihood.begin(), likelihood.end());
    double total = 0.0;
    for (std::size_t i = 0; i < likelihood.size(); ++i) {
      particles.weight[i] *= std::exp(AmclConfig{}.independent_beams * (likelihood[i] - best));
      total += particles.weight[i];
    }
    for (double& weight : particles.weight) weight /= total;
  }

  LikelihoodField& field;
  const std::vector<float>& ranges;
  std::size_t max_beams;
  Particles particles;
  std::vector<Beam> beams;
  std::vector<double> likelihood;
};

/// Motion of 0.2 m there or back, scan, resampling to a fixed number, estimate with refinement.
struct FullUpdate {
  FullUpdate(const grid::OccupancyGrid& map, const std::vector<float>& scan, std::size_t beams,
             std::size_t count)
      : ranges(scan), amcl(config(beams, count), 1) {
    if (!amcl.set_map(map) || !amcl.set_initial_pose(kReference, start_covariance())) std::abort();
  }
  static AmclConfig config(std::size_t beams, std::size_t count) {
    AmclConfig config;
    config.max_beams = beams;
    config.min_particles = config.max_particles = count;
    return config;
  }
  void operator()() {
    away = !away;
    amcl.update({away ? 0.2 : 0.0, 0.0, 0.0}, as_beams(ranges));
  }

  const std::vector<float>& ranges;
  Amcl amcl;
  bool away = false;
};

/// Tracking as it is: 0.2 m steps along +x, a scan of each place, adaptive particle count. The 20th
/// is judged.
struct Tracking {
  Tracking(const grid::OccupancyGrid& map, const std::vector<std::vector<float>>& scans)
      : ranges(scans), amcl({}, 1) {
    if (!amcl.set_map(map) || !amcl.set_initial_pose(kReference, start_covariance())) std::abort();
  }
  void operator()() {
    if (step == ranges.size()) return;
    ++step;
    amcl.update({0.2 * static_cast<double>(step), 0.0, 0.0}, as_beams(ranges[step - 1]));
  }

  const std::vector<std::vector<float>>& ranges;
  Amcl amcl;
  std::size_t step = 0;
};

int run(int argc, char** argv) {
  Bench bench(
      "amcl",
      "willow-trinary 1165x945 at 0.05 m, one 541-beam scan at (27.5, 17.5, 0), one thread");
  const std::string path = bench.data("peers/willow-trinary-0.05.pgm");
  if (path.empty()) return bench.run(argc, argv);
  const grid::OccupancyGrid map = load_willow(path);
  const std::vector<float> scan = marched_scan(map, kReference, 1);
  std::vector<std::vector<float>> scans;
  for (int k = 1; k <= 20; ++k) {
    scans.push_back(marched_scan(map, {kReference.x + 0.2 * k, kReference.y, 0.0},
                                 100 + static_cast<unsigned>(k)));
  }
  LikelihoodField field;
  field.build(map, SensorParameters{});

  SensorUpdate sensor(field, scan, 60, 2000), sensor_5000(field, scan, 60, 5000);
  SensorUpdate sensor_180(field, scan, 180, 2000), sensor_180_5000(field, scan, 180, 5000);
  FullUpdate full(map, scan, 60, 2000), full_180_5000(map, scan, 180, 5000);
  Tracking tracking(map, scans);
  bench.time("likelihood_field_ms", 1e-3, [&] { field.build(map, SensorParameters{}); });
  bench.time("sensor_update_us", 1e-6, std::ref(sensor));
  bench.time("sensor_update_5000_us", 1e-6, std::ref(sensor_5000));
  bench.time("sensor_update_180_us", 1e-6, std::ref(sensor_180));
  bench.time("sensor_update_180_5000_us", 1e-6, std::ref(sensor_180_5000));
  bench.time("full_update_us", 1e-6, std::ref(full));
  bench.time("full_update_180_5000_us", 1e-6, std::ref(full_180_5000));
  bench.instructions("sensor_update_instructions", std::ref(sensor));
  bench.instructions("sensor_update_180_5000_instructions", std::ref(sensor_180_5000));
  bench.instructions("full_update_instructions", std::ref(full), 2);
  bench.instructions("tracking_step20_instructions", std::ref(tracking), 19);
  bench.metric("tracking_step20_particles", [&] {
    Tracking fresh(map, scans);
    for (std::size_t k = 0; k < scans.size(); ++k) fresh();
    return static_cast<double>(fresh.amcl.particles().size());
  });
  bench.metric("tracking_step20_error_m", [&] {
    Tracking fresh(map, scans);
    for (std::size_t k = 0; k < scans.size(); ++k) fresh();
    return distance(fresh.amcl.estimate()->map_T_base, {kReference.x + 4.0, kReference.y, 0.0});
  });

  bench.published("likelihood_field_ms", 164, "ROS amcl");
  bench.published("likelihood_field_ms", 139, "Beluga");
  bench.published("sensor_update_instructions", 34189085, "ROS amcl");
  bench.published("sensor_update_instructions", 8626673, "Beluga");
  bench.published("sensor_update_us", 4452, "ROS amcl");
  bench.published("sensor_update_us", 725, "Beluga");
  bench.published("sensor_update_5000_us", 1871, "Beluga");
  bench.published("sensor_update_180_us", 2137, "Beluga");
  bench.published("sensor_update_180_5000_us", 4936, "Beluga");
  bench.published("sensor_update_180_5000_instructions", 63254556, "Beluga");
  bench.published("full_update_instructions", 58430073, "ROS amcl");
  bench.published("full_update_instructions", 12286025, "Beluga");
  bench.published("full_update_us", 1270, "Beluga");
  bench.published("full_update_180_5000_us", 6747, "Beluga");
  bench.published("tracking_step20_instructions", 5839082, "ROS amcl");
  bench.published("tracking_step20_instructions", 12642872, "Beluga");
  bench.target("sensor_update_instructions", Bound::kAtMost, 2.1e6);
  bench.target("likelihood_field_ms", Bound::kAtMost, 16);
  return bench.run(argc, argv);
}

}  // namespace
}  // namespace usher::amcl

int main(int argc, char** argv) { return usher::amcl::run(argc, argv); }
