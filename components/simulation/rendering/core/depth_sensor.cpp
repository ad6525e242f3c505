#include "simulation/rendering/core/depth_sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace usher::rendering {

namespace {

constexpr std::size_t kGaussians = 1 << 14;
constexpr std::size_t kAngles = 256;
constexpr float kEdge = 0.15F;  // [m] a larger step between neighbours is an edge
constexpr int kBlobsOfABurst = 60;
constexpr int kLargestBlob = 14;  // [pixels] radius

std::uint64_t hash(std::uint64_t value) { return Random(value).next(); }

}  // namespace

DepthSensorConfig kinect_v2() { return {}; }

DepthSensorConfig kinect_v1() {
  DepthSensorConfig config;
  config.lens = {640, 480, 575.8, 575.8, 319.5, 239.5};
  config.noise = DepthSensorConfig::Noise::kStructuredLight;
  config.dropouts = 0.03;
  config.dark_dropouts = 0.9;
  config.shadow = 0.075;
  return config;
}

DepthSensorConfig rear_camera() {
  DepthSensorConfig config = kinect_v1();
  config.lens = {320, 240, 287.9, 287.9, 159.5, 119.5};
  return config;
}

DepthSensor::DepthSensor(const DepthSensorConfig& config, std::uint64_t seed)
    : config_(config), seed_(seed), random_(stream_seed(seed, "depth sensor")) {
  gaussian_.resize(kGaussians);
  for (float& value : gaussian_) value = static_cast<float>(random_.gaussian());
  by_angle_.resize(kAngles + 1);
  for (std::size_t i = 0; i <= kAngles; ++i) {
    const double angle = std::acos(static_cast<double>(i) / kAngles);
    const double ratio = angle / std::max(0.02, geometry::kPi / 2.0 - angle);
    by_angle_[i] = static_cast<float>(ratio * ratio);
  }
}

/// Standard deviation along the axis [m].
float DepthSensor::sigma(float depth, float cosine) const {
  const float angle = by_angle_[static_cast<std::size_t>(cosine * kAngles)];
  const float root = std::sqrt(depth);
  if (config_.noise == DepthSensorConfig::Noise::kTimeOfFlight) {
    return 1e-3F * (1.5F - 0.5F * depth + 0.3F * depth * depth + 0.1F * depth * root * angle);
  }
  const float off = depth - 0.4F;
  return 0.0012F + 0.0019F * off * off + 0.0001F / root * angle;
}

void DepthSensor::measure(Renderer& renderer, const geometry::Pose3& world_T_camera, double burst,
                          std::vector<std::uint16_t>& millimeters) {
  renderer.render(config_.lens, world_T_camera, config_.most + 1.0, hits_);
  seen_.assign(hits_.depth.begin(), hits_.depth.end());
  mirror(renderer, world_T_camera);
  if (config_.shadow > 0.0) lose_shadows();
  millimeters.resize(seen_.size());
  add_noise(millimeters);
  if (burst > 0.0) add_burst(std::min(burst, 1.0), millimeters);
}

bool DepthSensor::patch_mirrors(double x, double y) const {
  const auto cell = [&](double v) {
    return static_cast<std::uint64_t>(
        static_cast<std::int64_t>(std::floor(v / config_.mirror_patch)));
  };
  const std::uint64_t bits = hash(hash(seed_ ^ cell(x)) ^ cell(y));
  return static_cast<double>(bits >> 11) * 0x1.0p-53 < config_.mirror_share;
}

/// Vinyl that is seen at a grazing angle shows, in places, what it mirrors: surfaces appear to go
/// on below the floor.
void DepthSensor::mirror(Renderer& renderer, const geometry::Pose3& world_T_camera) {
  if (config_.mirror_share <= 0.0) return;
  const Lens& lens = config_.lens;
  const Eigen::Matrix3d turn = world_T_camera.rotation.toRotationMatrix();
  for (int row = 0; row < lens.height; ++row) {
    for (int column = 0; column < lens.width; ++column) {
      const auto pixel = static_cast<std::size_t>(row * lens.width + column);
      if (hits_.material[pixel] != static_cast<std::uint8_t>(Material::kVinyl) ||
          static_cast<double>(hits_.cosine[pixel]) > config_.mirror_cosine) {
        continue;
      }
      const Eigen::Vector3d along =
          turn * Eigen::Vector3d(1.0, -(column - lens.cx) / lens.fx, -(row - lens.cy) / lens.fy);
      const auto depth = static_cast<double>(hits_.depth[pixel]);
      const Eigen::Vector3d on_floor = world_T_camera.translation + depth * along;
      if (!patch_mirrors(on_floor.x(), on_floor.y())) continue;
      const double length = along.norm();
      const Eigen::Vector3d up(along.x(), along.y(), -along.z());
      const double further =
          renderer.distance(on_floor + 1e-4 * Eigen::Vector3d::UnitZ(), up / length, config_.most);
      seen_[pixel] = std::isfinite(further) ? static_cast<float>(depth + further / length) : 0.0F;
    }
  }
}

/// The projector stands to the right of the camera: what it cannot see past an edge has no depth.
void DepthSensor::lose_shadows() {
  const Lens& lens = config_.lens;
  const auto base = static_cast<float>(config_.shadow * lens.fx);  // [m pixels]
  for (int row = 0; row < lens.height; ++row) {
    float* line = seen_.data() + static_cast<std::ptrdiff_t>(row) * lens.width;
    // A surface at depth z hides, from the projector, all that has a larger disparity column.
    float lit_from = 1e9F;
    for (int column = lens.width - 1; column >= 0; --column) {
      if (line[column] <= 0.0F) continue;
      const float position = static_cast<float>(column) - base / line[column];
      if (position >= lit_from) {
        line[column] = 0.0F;
      } else {
        lit_from = position;
      }
    }
  }
}

void DepthSensor::add_noise(std::vector<std::uint16_t>& millimeters) {
  const auto least = static_cast<float>(config_.least);
  const auto most = static_cast<float>(config_.most);
  const auto grazing = static_cast<float>(config_.grazing);
  const auto share = [](double value) { return static_cast<std::uint32_t>(value * 0x1p32); };
  const std::array<std::uint32_t, 4> lost{share(config_.dropouts), share(0.9995),
                                          share(config_.dropouts), share(config_.dark_dropouts)};
  const std::uint32_t flying = share(config_.flying);
  const auto width = static_cast<std::size_t>(config_.lens.width);
  const bool steps = config_.noise == DepthSensorConfig::Noise::kStructuredLight;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    millimeters[i] = 0;
    float depth = seen_[i];
    const std::uint64_t bits = random_.next();
    if (depth <= 0.0F || hits_.cosine[i] < grazing) continue;
    if (static_cast<std::uint32_t>(bits) < lost[hits_.material[i]]) continue;
    const std::size_t before = i % width > 0 ? i - 1 : i;
    if (std::abs(seen_[before] - depth) > kEdge && seen_[before] > 0.0F &&
        static_cast<std::uint32_t>(bits >> 32) < flying) {
      const float share_of_it = static_cast<float>(bits & 0xff) / 256.0F;
      depth += share_of_it * (seen_[before] - depth);
    }
    depth += sigma(depth, hits_.cosine[i]) * gaussian_[(bits >> 40) & (kGaussians - 1)];
    if (steps) {
      const float step = 2.85e-3F * depth * depth;
      depth = step * std::round(depth / step);
    }
    if (depth < least || depth > most) continue;
    millimeters[i] = static_cast<std::uint16_t>(depth * 1000.0F + 0.5F);
  }
}

/// Patches of senseless depth, elsewhere in every frame.
void DepthSensor::add_burst(double burst, std::vector<std::uint16_t>& millimeters) {
  const Lens& lens = config_.lens;
  const int blobs = static_cast<int>(std::lround(burst * kBlobsOfABurst));
  for (int blob = 0; blob < blobs; ++blob) {
    const auto x = static_cast<int>(random_.below(static_cast<std::uint64_t>(lens.width)));
    const auto y = static_cast<int>(random_.below(static_cast<std::uint64_t>(lens.height)));
    const int radius = 1 + static_cast<int>(random_.below(kLargestBlob));
    const double depth = random_.uniform(config_.least, 3.0);
    for (int row = std::max(0, y - radius); row < std::min(lens.height, y + radius); ++row) {
      for (int column = std::max(0, x - radius); column < std::min(lens.width, x + radius);
           ++column) {
        if ((row - y) * (row - y) + (column - x) * (column - x) > radius * radius) continue;
        const double value = depth * (1.0 + 0.05 * static_cast<double>(gaussian()));
        millimeters[static_cast<std::size_t>(row * lens.width + column)] =
            static_cast<std::uint16_t>(std::max(0.0, value) * 1e3);
      }
    }
  }
}

void paint(const Hits& hits, std::vector<std::uint8_t>& rgb) {
  constexpr std::array<std::array<float, 3>, 4> kMaterials{
      {{{205, 200, 190}}, {{150, 190, 205}}, {{120, 125, 130}}, {{45, 45, 50}}}};
  constexpr std::array<std::array<float, 3>, 6> kPeople{{{{190, 70, 60}},
                                                         {{60, 110, 180}},
                                                         {{80, 150, 90}},
                                                         {{200, 160, 60}},
                                                         {{140, 90, 160}},
                                                         {{70, 150, 160}}}};
  rgb.resize(3 * hits.depth.size());
  for (std::size_t i = 0; i < hits.depth.size(); ++i) {
    const auto& color = hits.body[i] >= 0
                            ? kPeople[static_cast<std::size_t>(hits.body[i]) % kPeople.size()]
                            : kMaterials[hits.material[i]];
    const float light = hits.depth[i] > 0.0F ? 0.35F + 0.65F * hits.cosine[i] : 0.1F;
    for (std::size_t k = 0; k < 3; ++k)
      rgb[3 * i + k] = static_cast<std::uint8_t>(std::min(255.0F, light * color[k]));
  }
}

}  // namespace usher::rendering
