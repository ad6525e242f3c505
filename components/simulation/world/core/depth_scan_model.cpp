#include "simulation/world/core/depth_scan_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace usher::world {

namespace {

constexpr float kFree = std::numeric_limits<float>::infinity();
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr double kUnderFloor = -0.04;  // [m] where pits are looked for
constexpr double kLowThing = 0.5;      // [m] a thing of less height is cut near its top
constexpr double kBurstLoss = 0.5;     // share of bearings that a full burst spoils

Fan fan_for(const DepthScanModelConfig& config) {
  const rendering::Lens& lens = config.lens;
  const double right = std::atan((lens.width - 0.5 - lens.cx) / lens.fx / config.widest);
  const double left = std::atan((lens.cx + 0.5) / lens.fx / config.widest);
  const double increment = std::atan(1.0 / lens.fx);
  return {-right, increment, static_cast<int>(std::ceil((left + right) / increment))};
}

/// What of a body is beyond the disc round its hips: a disc on the floor, for a scan keeps no
/// heights. Shares of the standing height; what has two sides is there on both.
struct Part {
  double ahead, aside, radius, top;
};
constexpr Part kSitting[] = {{0.19, 0.0, 0.12, 0.46}, {0.33, 0.055, 0.03, 0.05}};
constexpr Part kSquatting[] = {{0.18, 0.0, 0.12, 0.57},
                               {0.32, 0.115, 0.03, 0.32},
                               {0.38, 0.115, 0.03, 0.32},
                               {0.45, 0.115, 0.03, 0.32}};
constexpr Part kBending[] = {
    {0.14, 0.0, 0.12, 0.66}, {0.28, 0.0, 0.14, 0.65}, {0.40, 0.0, 0.06, 0.67}};
constexpr Part kArmsOut[] = {{0.0, 0.17, 0.03, 0.84},  {0.0, 0.22, 0.03, 0.84},
                             {0.0, 0.27, 0.03, 0.84},  {0.0, 0.32, 0.03, 0.84},
                             {0.0, 0.37, 0.025, 0.83}, {0.0, 0.42, 0.025, 0.83},
                             {0.0, 0.47, 0.025, 0.82}};

std::span<const Part> parts_of(rendering::Posture posture) {
  switch (posture) {
    case rendering::Posture::kSitting:
      return kSitting;
    case rendering::Posture::kSquatting:
      return kSquatting;
    case rendering::Posture::kBending:
      return kBending;
    case rendering::Posture::kArmsOut:
      return kArmsOut;
    default:
      return {};
  }
}

void add_parts(const Person& person, std::vector<Mover>& movers) {
  const Pose2 pose{person.position.x(), person.position.y(), person.yaw};
  for (const Part& part : parts_of(person.posture)) {
    for (const double side : {1.0, -1.0}) {
      if (side < 0.0 && part.aside == 0.0) continue;
      const Point2 place = person.height * Point2(part.ahead, side * part.aside);
      movers.push_back({pose * place, person.height * part.radius, person.height * part.top});
    }
  }
}

/// [m] height of the lowest feet that stick out, of those who sit; infinite: nobody sits.
double lowest_feet(std::span<const Person> people) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Person& person : people) {
    if (person.posture == rendering::Posture::kSitting)
      lowest = std::min(lowest, person.height * kSitting[1].top);
  }
  return lowest;
}

}  // namespace

DepthScanModel::DepthScanModel(const DepthScanModelConfig& config, std::uint64_t seed)
    : config_(config), random_(stream_seed(seed, "depth scan model")), fan_(fan_for(config)) {
  const auto count = static_cast<std::size_t>(fan_.count());
  see_through_.assign(count, 0);
  high_.resize(count);
  low_.resize(count);
  hidden_.resize(count);
}

/// Heights so that every thing is cut by a fan, low things near their top, and feet of that height.
void DepthScanModel::choose_heights(const Scene& scene, double feet) {
  struct Span {
    double bottom, top;
  };
  std::vector<Span> spans;
  for (const double height : {0.3, 0.6, 1.0, 1.5, 1.9}) spans.push_back({height - 0.1, height});
  if (std::isfinite(feet)) spans.push_back({0.5 * feet, feet});
  for (const Thing& thing : scene.things()) {
    if (thing.top <= 0.0 || thing.bottom >= config_.ceiling) continue;
    const double top = std::min(thing.top, config_.ceiling);
    const double room = top < kLowThing ? 0.15 * top : 0.4;
    spans.push_back({std::max(thing.bottom, top - room), top});
  }
  std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) { return a.top < b.top; });
  heights_.clear();
  for (const Span& span : spans) {
    if (!heights_.empty() && heights_.back() > span.bottom) continue;
    heights_.push_back(span.top - 0.05 * (span.top - span.bottom) - 1e-4);
  }
}

/// Whether a point straight ahead is in the image, by its height.
bool DepthScanModel::in_view(double forward, double height) const {
  return in_rows(config_.lens, forward, height - camera_height_, down_, config_.least_depth);
}

/// [m] Along the optical axis.
double DepthScanModel::depth_of(double forward, double height) const {
  return forward * std::cos(down_) - (height - camera_height_) * std::sin(down_);
}

void DepthScanModel::cast(const World& world, const Pose2& camera, double height) {
  const geometry::Pose3 pose{{camera.x, camera.y, height}, geometry::to_space(camera).rotation};
  caster_.cast(world.scene(), fan_, pose,
               {.max_range = config_.max_range, .glass_flags = see_through_, .glass_cosine = 2.0},
               movers_, hits_);
}

void DepthScanModel::scan(const World& world, const DepthCamera& camera, DepthScanResult& result) {
  const double feet = lowest_feet(world.people());
  if (version_ != world.scene_version() || feet_ != feet) choose_heights(world.scene(), feet);
  version_ = world.scene_version();
  feet_ = feet;
  movers_.clear();
  for (const Person& person : world.people()) {
    movers_.push_back({person.position, person.radius * config_.body_radius,
                       rendering::top_of(person.posture, person.height)});
    add_parts(person, movers_);
  }
  for (const Mover& body : world.robot_bodies()) movers_.push_back(body);
  const geometry::Pose3 pose = camera.pose(world);
  const Eigen::Vector3d axis = pose.rotation * Eigen::Vector3d::UnitX();
  camera_height_ = pose.translation.z();
  down_ = -std::asin(std::clamp(axis.z(), -1.0, 1.0));
  const Pose2 base = world.base().truth().pose;
  const bool backward = std::cos(camera.config().mount.yaw) < 0.0;
  const double yaw = backward ? base.yaw + geometry::kPi : base.yaw;
  const Pose2 origin = Pose2{base.x, base.y, yaw} * Pose2{config_.origin, 0.0, 0.0};
  const double ahead = (inverse(origin) * pose.translation.head<2>()).x();  // the camera's place

  std::fill(high_.begin(), high_.end(), kFree);
  std::fill(low_.begin(), low_.end(), kFree);
  std::fill(hidden_.begin(), hidden_.end(), std::uint8_t{0});
  bool first = true;  // of the fans that tell what is hidden
  const auto things = world.scene().things();
  const auto take = [&](double height, bool pits) {
    cast(world, origin, height);
    std::vector<float>& nearest = height > config_.low_height ? high_ : low_;
    // Where the nearest thing that can be measured would be in the image at this height.
    const double nearest_forward =
        (config_.least_depth + (height - camera_height_) * std::sin(down_)) / std::cos(down_);
    const bool tells_hidden =
        height > config_.low_height && in_view(nearest_forward + 1e-6, height);
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      const auto range = static_cast<double>(hits_.range[i]);
      const double forward = range * static_cast<double>(fan_.cosines()[i]) - ahead;
      const bool hit = hits_.what[i] >= 0 && range < config_.max_range;
      if (tells_hidden) {
        const bool near = hit && depth_of(forward, height) < config_.least_depth;
        hidden_[i] = near && (first || hidden_[i] != 0) ? 1 : 0;
      }
      if (!hit) continue;
      if (pits) {
        const auto thing = static_cast<std::size_t>(hits_.what[i]);
        if (thing >= things.size() || things[thing].top > 0.0 || forward > config_.drop_range)
          continue;
      } else if (height < config_.floor_margin + config_.floor_angle * forward +
                              config_.floor_growth * forward * forward) {
        continue;
      }
      if (!in_view(forward, std::max(height, 0.0))) continue;
      nearest[i] = std::min(nearest[i], hits_.range[i]);
    }
    first = first && !tells_hidden;
  };
  for (const double height : heights_) take(height, false);
  const auto is_pit = [](const Thing& thing) { return thing.top <= 0.0; };
  if (std::any_of(things.begin(), things.end(), is_pit)) take(kUnderFloor, true);

  result.angle_min = fan_.angle_min();
  result.increment = fan_.increment();
  result.ranges.resize(high_.size());
  result.low.resize(high_.size());
  for (std::size_t i = 0; i < high_.size(); ++i) {
    const bool alone = low_[i] + static_cast<float>(config_.low_gap) < high_[i];
    result.ranges[i] = std::min(high_[i], low_[i]);
    result.low[i] = alone || (low_[i] == kFree && high_[i] == kFree) ? low_[i] : -result.ranges[i];
    // Where the image does not show the floor from there on, nothing says that nothing low is
    // there.
    const double from = config_.low_from * static_cast<double>(fan_.cosines()[i]) - ahead;
    if (!in_view(from, 0.0) && !(result.low[i] > 0.0F && result.low[i] < kFree))
      result.low[i] = kUnknown;
    if (hidden_[i] != 0) result.ranges[i] = result.low[i] = kUnknown;
  }
  disturb(camera.burst(), result);
}

void DepthScanModel::disturb(double burst, DepthScanResult& result) {
  const double lost = config_.lost + kBurstLoss * burst;
  for (std::size_t i = 0; i < result.ranges.size(); ++i) {
    const auto range = static_cast<double>(result.ranges[i]);
    const double noise = random_.gaussian();
    if (random_.uniform() < lost) {
      result.ranges[i] = result.low[i] = kUnknown;
      continue;
    }
    if (!std::isfinite(range)) continue;
    const double sigma = config_.noise + config_.noise_growth * range * range;
    const auto off = static_cast<float>(sigma * noise);
    result.ranges[i] += off;
    if (std::isfinite(result.low[i])) result.low[i] += result.low[i] < 0.0F ? -off : off;
  }
}

}  // namespace usher::world
