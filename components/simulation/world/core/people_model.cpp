#include "simulation/world/core/people_model.hpp"

#include <algorithm>
#include <cmath>

namespace usher::world {

namespace {

constexpr double kBeam = 4.0;        // [pixels] between two beams
constexpr double kSlice = 0.2;       // [m] of a body that a fan stands for
constexpr double kTallest = 2.0;     // [m]
constexpr double kBurstBlind = 0.3;  // a burst of noise from which nobody is found
// Parts of a body whose colors the detector takes for those of the clothes: shares of the standing
// height.
constexpr double kUpperFrom = 0.55, kUpperTo = 0.82;
constexpr double kLegsFrom = 0.10, kLegsTo = 0.46;
constexpr std::uint8_t kOverexposed = 252, kUnderexposed = 4;  // colors that it leaves out

Fan fan_for(const rendering::Lens& lens) {
  const double right = std::atan((lens.width - 0.5 - lens.cx) / lens.fx);
  const double left = std::atan((lens.cx + 0.5) / lens.fx);
  const double increment = std::atan(kBeam / lens.fx);
  return {-right, increment, static_cast<int>((left + right) / increment) + 1};
}

bool is_upright(const Person& person) {
  return person.posture == rendering::Posture::kStanding ||
         person.posture == rendering::Posture::kWalking ||
         person.posture == rendering::Posture::kArmsOut;
}

}  // namespace

PeopleModel::PeopleModel(const PeopleModelConfig& config, std::uint64_t seed)
    : config_(config),
      random_(stream_seed(seed, "people model")),
      color_random_(stream_seed(seed, "colors of the people model")),
      fan_(fan_for(config.lens)) {
  see_through_.assign(static_cast<std::size_t>(fan_.count()), 0);
}

bool PeopleModel::in_view(double forward, double height) const {
  return in_rows(config_.lens, forward, height - camera_height_, down_, config_.nearest);
}

bool PeopleModel::may_be_seen(const Person& person, const Pose2& origin) const {
  const Point2 place = inverse(origin) * person.position;
  const double edge = std::tan(-fan_.angle_min());
  return place.x() > 0.2 && place.x() < config_.farthest + 0.5 &&
         std::abs(place.y()) < edge * place.x() + 0.5;
}

/// Fans at many heights: which share of each body no thing and nobody hides.
void PeopleModel::look(const World& world, const DepthCamera& camera, const Pose2& origin) {
  const geometry::Pose3 pose = camera.pose(world);
  camera_height_ = pose.translation.z();
  down_ = -std::asin(std::clamp((pose.rotation * Eigen::Vector3d::UnitX()).z(), -1.0, 1.0));
  ahead_ = (inverse(origin) * pose.translation.head<2>()).x();
  const auto people = world.people();
  movers_.clear();
  for (const Person& person : people)
    movers_.push_back(
        {person.position, person.radius, rendering::top_of(person.posture, person.height)});
  visible_.assign(people.size(), {});
  const auto things = static_cast<std::int32_t>(world.scene().things().size());
  for (int slice = 0; (slice + 0.5) * kSlice < kTallest; ++slice) {
    const double height = (slice + 0.5) * kSlice;
    const geometry::Pose3 plane{{origin.x, origin.y, height}, geometry::to_space(origin).rotation};
    caster_.cast(
        world.scene(), fan_, plane,
        {.max_range = config_.farthest + 1.0, .glass_flags = see_through_, .glass_cosine = 2.0},
        movers_, hits_);
    for (std::size_t i = 0; i < hits_.what.size(); ++i) {
      const std::int32_t who = hits_.what[i] - things;
      if (who < 0) continue;
      const auto range = static_cast<double>(hits_.range[i]);
      if (!in_view(range * static_cast<double>(fan_.cosines()[i]) - ahead_, height)) continue;
      Visible& visible = visible_[static_cast<std::size_t>(who)];
      const Person& person = people[static_cast<std::size_t>(who)];
      const double share = height / person.height;
      const double area = config_.filled * kSlice * range * fan_.increment();
      visible.area += area;
      if (share > kUpperFrom && share < kUpperTo) visible.upper += area;
      if (share > kLegsFrom && share < kLegsTo && is_upright(person)) visible.legs += area;
      visible.top = height + 0.5 * kSlice;
    }
  }
}

/// As a color camera shows clothes in that light; not known when too little of them is seen.
imaging::ClothesColor PeopleModel::color_of(const rendering::Clothes::Color& clothes,
                                            double visible, const rendering::Gains& gains) {
  const double lighter = color_random_.gaussian(0.0, config_.lightness);
  const double redder = color_random_.gaussian(0.0, config_.chromaticity);
  const double yellower = color_random_.gaussian(0.0, config_.chromaticity);
  if (visible < config_.least_clothes) return {};
  std::array<double, 3> linear{};
  std::uint8_t brightest = 0;
  for (std::size_t k = 0; k < linear.size(); ++k) {
    linear[k] = config_.shade * gains[k] * imaging::to_linear(clothes[k]);
    brightest = std::max(brightest, imaging::to_srgb(linear[k]));
  }
  if (brightest >= kOverexposed || brightest <= kUnderexposed) return {};
  imaging::LabColor color = imaging::to_lab(linear);
  color.lightness = std::clamp(color.lightness + lighter, 0.0, 100.0);
  color.a += redder, color.b += yellower;
  return {color, 1};
}

void PeopleModel::find(const World& world, const DepthCamera& camera, bool colors,
                       std::vector<ModelledSighting>& sightings) {
  sightings.clear();
  const Pose2 base = world.base().truth().pose;
  const bool backward = std::cos(camera.config().mount.yaw) < 0.0;
  const double yaw = backward ? base.yaw + geometry::kPi : base.yaw;
  const Pose2 origin = Pose2{base.x, base.y, yaw} * Pose2{config_.origin, 0.0, 0.0};
  const auto people = world.people();
  const bool anybody = std::any_of(people.begin(), people.end(), [&](const Person& person) {
    return may_be_seen(person, origin);
  });
  if (!anybody || camera.burst() > kBurstBlind) return;
  look(world, camera, origin);
  for (std::size_t i = 0; i < people.size(); ++i) {
    const Visible& visible = visible_[i];
    const Point2 place = inverse(origin) * people[i].position;
    if (visible.area <= 0.0 || place.x() > config_.farthest) continue;
    const double odds = (visible.area - config_.likely_area) / config_.area_slope;
    const double found = (1.0 - config_.missed) / (1.0 + std::exp(-odds));
    const double along = random_.gaussian(0.0, config_.along);
    const double across = random_.gaussian(0.0, config_.across);
    const double higher = random_.gaussian(0.0, config_.height);
    if (random_.uniform() >= found) continue;
    const Point2 sight = place.normalized();
    const Point2 seen = place + along * sight + across * Point2(-sight.y(), sight.x());
    const double top = movers_[i].top;
    const bool cut = !in_view(place.x() - ahead_, top);
    // The highest slice that a ray can meet stands for all that is above it.
    const bool hidden = visible.top < kSlice * std::floor(top / kSlice + 0.5) - 0.5 * kSlice;
    sightings.push_back(
        {seen.x(), seen.y(), cut ? 0.0 : std::max(0.1, (hidden ? visible.top : top) + higher)});
    sightings.back().head_hidden = !cut && hidden;
    if (!colors) continue;
    const auto gains = camera.gains(world, people[i].position);
    const rendering::Clothes& clothes = people[i].clothes;
    sightings.back().appearance = {color_of(clothes.upper, visible.upper, gains),
                                   color_of(clothes.legs, visible.legs, gains)};
  }
}

}  // namespace usher::world
