#include "control/movement_control/core/situation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace usher::movement_control {

namespace {

constexpr double kSlice = 0.25;  // [m]
constexpr std::size_t kMaxSlices = 32;

bool fits(const FreeSpace& space, const RoomNeeded& room, double tolerance) {
  const double width = space.width + tolerance;
  const double ahead = space.ahead + tolerance;
  return (width >= room.area_width && ahead >= room.area_ahead) ||
         (width >= room.corridor_width && ahead >= room.corridor_ahead);
}

}  // namespace

std::string_view text(Situation situation) {
  switch (situation) {
    case Situation::kConfined:
      return "confined";
    case Situation::kCorridor:
      return "corridor";
    case Situation::kOpen:
      return "open space";
  }
  return "unknown";
}

std::optional<FreeSpace> free_space(std::span<const float> ranges, double angle_min,
                                    double angle_increment, const FreeSpaceParameters& parameters) {
  assert(parameters.half_width > 0.0 && parameters.look_ahead > 0.0 &&
         parameters.horizon > parameters.look_ahead);
  if (!std::isfinite(angle_min) || !std::isfinite(angle_increment)) return std::nullopt;

  struct Slice {
    double left;
    double right;
  };
  std::array<Slice, kMaxSlices> slices;
  slices.fill({parameters.horizon, parameters.horizon});
  const auto wanted = static_cast<std::size_t>(std::ceil(parameters.look_ahead / kSlice));
  const std::size_t count = std::clamp<std::size_t>(wanted, 1, kMaxSlices);

  const geometry::Pose2& sensor = parameters.base_T_sensor;
  double ahead = parameters.horizon;
  std::size_t forward = 0, unknown = 0;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double range = ranges[i];
    const double angle = sensor.yaw + angle_min + angle_increment * static_cast<double>(i);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    if (c > 0.0) ++forward, unknown += std::isnan(range);
    if (!(range <= parameters.horizon)) continue;
    const double reach = std::max(range, 0.0);  // -infinity: right at the sensor
    const double x = sensor.x + reach * c;
    const double y = sensor.y + reach * s;
    if (x <= 0.0) continue;
    if (std::abs(y) < parameters.half_width) {
      ahead = std::min(ahead, x);
    } else if (const auto slice = static_cast<std::size_t>(x / kSlice); slice < count) {
      double& side = y > 0.0 ? slices[slice].left : slices[slice].right;
      side = std::min(side, std::abs(y));
    }
  }
  if (2 * unknown >= forward) return std::nullopt;  // blind on half of what is ahead

  // What stands beside the thing ahead belongs to it: a wall ahead is not a narrow place before it.
  const auto nearer = static_cast<std::size_t>(std::max(0.0, ahead / kSlice - 1.0));
  double width = 2.0 * parameters.horizon;
  for (std::size_t i = 0; i < std::min(count, nearer); ++i) {
    width = std::min(width, slices[i].left + slices[i].right);
  }
  return FreeSpace{ahead, width};
}

SituationFilter::SituationFilter() : SituationFilter(Parameters{}) {}

SituationFilter::SituationFilter(const Parameters& parameters) : parameters_(parameters) {}

Situation SituationFilter::classify(const FreeSpace& space) const {
  if (fits(space, parameters_.open, parameters_.tolerance)) return Situation::kOpen;
  if (fits(space, parameters_.corridor, parameters_.tolerance)) return Situation::kCorridor;
  return Situation::kConfined;
}

Situation SituationFilter::update(const std::optional<FreeSpace>& space, Time now) {
  const Situation seen = space ? classify(*space) : Situation::kConfined;
  if (seen <= situation_) {
    situation_ = seen;
    wider_since_.reset();
    return situation_;
  }
  if (!wider_since_) {
    wider_since_ = now;
    wider_ = seen;
  }
  wider_ = std::min(wider_, seen);
  if (now - *wider_since_ >= parameters_.settle) {
    situation_ = wider_;
    wider_since_.reset();
  }
  return situation_;
}

}  // namespace usher::movement_control
