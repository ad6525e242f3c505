#include "control/interaction_control/core/zones.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "foundation/geometry/angle.hpp"

namespace usher::interaction_control {

namespace {

std::optional<int> digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

std::string shortened(double value) {
  std::string text = std::to_string(value);
  return text.substr(0, text.size() - 3);
}

/// What is wrong with a zone; empty when nothing is.
std::string objection(const Zone& zone, const kinematics::TorsoLimits& limits) {
  if (zone.name.empty()) return "a zone must have a name";
  if (!(zone.range_min <= zone.range_max)) return "range_min must not be above range_max";
  if (!(zone.bearing_min <= zone.bearing_max)) return "bearing_min must not be above bearing_max";
  for (std::size_t i = 0; i < kinematics::kTorsoJoints; ++i) {
    if (limits[i].holds(zone.pose[i])) continue;
    std::string text(kinematics::kTorsoJointNames[i]);
    text += " must be in [" + shortened(limits[i].low) + ", " + shortened(limits[i].high) +
            "], the joint's limits, got " + shortened(zone.pose[i]);
    return text;
  }
  return {};
}

}  // namespace

bool Zone::holds(const Polar& person, double range_margin, double bearing_margin) const {
  // Nobody is nearer than at the robot's middle, so a zone from there has no inner border.
  const double nearest = range_min > 0.0 ? range_min - range_margin : 0.0;
  if (!(person.range >= nearest && person.range <= range_max + range_margin)) return false;
  const double half = 0.5 * (bearing_max - bearing_min);
  if (half >= geometry::kPi) return true;
  const double off = std::abs(geometry::shortest_turn(bearing_min + half, person.bearing));
  return off <= half + bearing_margin;
}

std::optional<kinematics::EyeColor> color_from(std::string_view text) {
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  kinematics::EyeColor color{};
  for (std::size_t i = 0; i < color.size(); ++i) {
    const auto high = digit(text[1 + 2 * i]);
    const auto low = digit(text[2 + 2 * i]);
    if (!high || !low) return std::nullopt;
    color[i] = static_cast<float>(*high * 16 + *low) / 255.0F;
  }
  return color;
}

Result<Zones> Zones::make(std::vector<Zone> zones, const Thresholds& thresholds,
                          const kinematics::TorsoLimits& limits) {
  for (std::size_t i = 0; i < zones.size(); ++i) {
    const std::string wrong = objection(zones[i], limits);
    if (!wrong.empty()) return Error{"zone '" + zones[i].name + "': " + wrong};
    for (std::size_t j = 0; j < i; ++j) {
      if (zones[j].name == zones[i].name)
        return Error{"zone '" + zones[i].name + "' is there twice"};
    }
  }
  Zones result;
  result.zones_ = std::move(zones);
  result.thresholds_ = thresholds;
  return result;
}

const Zone* Zones::find(std::string_view name) const {
  const auto found = std::find_if(zones_.begin(), zones_.end(),
                                  [name](const Zone& zone) { return zone.name == name; });
  return found == zones_.end() ? nullptr : &*found;
}

bool Zones::reaches(const Polar& person) const { return choose(person) != nullptr; }

const Zone* Zones::choose(const Polar& person) const {
  const auto found = std::find_if(zones_.begin(), zones_.end(), [&person](const Zone& zone) {
    return zone.enabled && zone.holds(person);
  });
  return found == zones_.end() ? nullptr : &*found;
}

const Zone* Zones::update(const std::optional<Polar>& person) {
  if (!person || !std::isfinite(person->range) || !std::isfinite(person->bearing)) {
    current_.reset();
    return nullptr;
  }
  const Zone* candidate = choose(*person);
  if (current_) {
    const Zone& current = zones_[*current_];
    const bool called = candidate != nullptr && candidate < &current &&
                        candidate->holds(*person, -thresholds_.range, -thresholds_.bearing);
    if (!called && current.holds(*person, thresholds_.range, thresholds_.bearing)) return &current;
  }
  if (candidate == nullptr) {
    current_.reset();
  } else {
    current_ = static_cast<std::size_t>(candidate - zones_.data());
  }
  return candidate;
}

}  // namespace usher::interaction_control
