#include "simulation/world/core/depth_cameras.hpp"

#include <algorithm>
#include <cmath>

namespace usher::world {

namespace {

constexpr int kDiscCorners = 16;
constexpr std::int8_t kOccupiedFrom = 65;
constexpr double kTiltLimit = geometry::radians(20.0);
// A pitch acceleration below the first does no harm, the second spoils as much as any [rad/s^2].
constexpr double kCalm = 4.0;
constexpr double kWild = 14.0;
constexpr double kBurstFade = 0.05;  // [s]
constexpr int kAdaptEvery = 20;      // steps until exposure and white balance have changed

std::vector<Point2> rectangle(const Point2& lower, const Point2& upper) {
  return {lower, {upper.x(), lower.y()}, upper, {lower.x(), upper.y()}};
}

/// Each run of occupied cells of a row as one block.
void add_cells(const grid::OccupancyGrid& map, double ceiling, rendering::Model& model) {
  const grid::GridGeometry& g = map.geometry();
  for (int y = 0; y < g.height; ++y) {
    int first = -1;
    for (int x = 0; x <= g.width; ++x) {
      const bool occupied = x < g.width && map.at({x, y}) >= kOccupiedFrom;
      if (occupied && first < 0) first = x;
      if (occupied || first < 0) continue;
      const Point2 lower(g.origin_x + first * g.resolution, g.origin_y + y * g.resolution);
      const Point2 upper(g.origin_x + x * g.resolution, g.origin_y + (y + 1) * g.resolution);
      model.prisms.push_back({rectangle(lower, upper), 0.0, ceiling, rendering::Material::kMatte});
      first = -1;
    }
  }
}

}  // namespace

rendering::Model model_of(const Scene& scene, const grid::OccupancyGrid* map) {
  rendering::Model model;
  model.ceiling = scene.ceiling();
  for (const Thing& thing : scene.things()) {
    rendering::Prism prism{thing.outline, thing.bottom, thing.top,
                           thing.material == Material::kGlass ? rendering::Material::kGlass
                                                              : rendering::Material::kMatte};
    if (thing.outline.empty()) {
      if (!(thing.radius > 0.0)) continue;  // the map's occupied cells
      for (int i = 0; i < kDiscCorners; ++i) {
        const double angle = 2.0 * geometry::kPi * i / kDiscCorners;
        prism.outline.push_back(thing.center +
                                thing.radius * Point2(std::cos(angle), std::sin(angle)));
      }
    }
    model.prisms.push_back(std::move(prism));
  }
  if (map != nullptr) add_cells(*map, scene.ceiling(), model);
  return model;
}

void bodies_of(std::span<const Person> people, std::vector<rendering::Body>& bodies) {
  bodies.clear();
  for (const Person& person : people) {
    bodies.push_back({.pose = {person.position.x(), person.position.y(), person.yaw},
                      .height = person.height,
                      .posture = person.posture,
                      .phase = person.stride,
                      .clothes = person.clothes});
  }
}

bool in_rows(const rendering::Lens& lens, double forward, double rise, double down,
             double nearest) {
  const double depth = forward * std::cos(down) - rise * std::sin(down);
  const double below = -forward * std::sin(down) - rise * std::cos(down);
  if (depth < nearest) return false;
  const double row = lens.cy + lens.fy * below / depth;
  return row >= 0.0 && row <= lens.height - 1.0;
}

DepthCamera::DepthCamera(const DepthCameraConfig& config, std::uint64_t seed)
    : config_(config), sensor_(config.sensor, seed), colors_(seed) {}

void DepthCamera::set_tilt(double servo) {
  if (std::isfinite(servo)) wanted_ = std::clamp(servo, -kTiltLimit, kTiltLimit);
}

void DepthCamera::step(const BaseTruth& base) {
  const double move = config_.servo_speed * kStep;
  servo_ += std::clamp(wanted_ - servo_, -move, move);
  const double acceleration = pitch_rate_ ? std::abs(base.pitch_rate - *pitch_rate_) / kStep : 0.0;
  pitch_rate_ = base.pitch_rate;
  const double jump = std::clamp((acceleration - kCalm) / (kWild - kCalm), 0.0, 1.0);
  burst_ = std::max(jump, burst_ * (1.0 - kStep / kBurstFade));
  if (burst_ < 0.02) burst_ = 0.0;
  if (++steps_ % kAdaptEvery == 0) colors_.advance(kAdaptEvery * kStep);
}

geometry::Pose3 DepthCamera::pose(const World& world) const {
  Mount mount = config_.mount;
  mount.pitch -= config_.servo_gain * servo_ + config_.servo_offset;
  return world.base_in_world() * mount.base_T_sensor();
}

rendering::Gains DepthCamera::gains(const World& world, const Point2& place) const {
  return colors_.gains(world.lighting(), place, pose(world).translation.head<2>());
}

Exposure DepthCamera::exposure(const World& world) const { return {pose(world), burst_}; }

void DepthCamera::measure(const Exposure& exposure, rendering::Renderer& renderer,
                          std::vector<std::uint16_t>& millimeters) {
  sensor_.measure(renderer, exposure.world_T_camera, exposure.burst, millimeters);
}

void WorldRenderer::look(const World& world, Moment& moment) {
  moment.scene.reset();
  if (version_ != world.scene_version()) moment.scene = model_of(world.scene(), world.map());
  version_ = world.scene_version();
  bodies_of(world.people(), moment.bodies);
}

Status WorldRenderer::show(const Moment& moment) {
  if (moment.scene) {
    auto made = rendering::Renderer::make(*moment.scene);
    if (!made) return Error{made.error()};
    renderer_.emplace(std::move(made).value());
  }
  renderer_->place(moment.bodies);
  return {};
}

Status WorldRenderer::update(const World& world) {
  look(world, moment_);
  return show(moment_);
}

}  // namespace usher::world
