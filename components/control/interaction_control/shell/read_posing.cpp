#include "control/interaction_control/shell/read_posing.hpp"

#include <utility>

#include "wire/torso.hpp"

namespace usher::interaction_control {

namespace {

using runtime::ParameterKind;

std::vector<runtime::RecordField> zone_fields() {
  constexpr runtime::Range kReach{0, 20}, kTurn{-6.3, 6.3};
  std::vector<runtime::RecordField> fields{
      {"name", ParameterKind::kText, "-", {}, "Unique."},
      {"enabled", ParameterKind::kFlag, "-", {}, "False: nobody enters it."},
      {"range_min", ParameterKind::kNumber, "m", kReach, "Nearest place in it; 0 has no border."},
      {"range_max", ParameterKind::kNumber, "m", kReach, "Farthest place in it."},
      {"bearing_min", ParameterKind::kNumber, "rad", kTurn, "From there counter-clockwise ..."},
      {"bearing_max", ParameterKind::kNumber, "rad", kTurn, "... to there; left is positive."},
      {"tracking", ParameterKind::kFlag, "-", {}, "The base turns to face the person."},
      {"voice", ParameterKind::kFlag, "-", {}, "The eyes follow the robot's voice."},
      {"left_eye", ParameterKind::kText, "-", {}, "Color, \"#rrggbb\"."},
      {"right_eye", ParameterKind::kText, "-", {}, "Color, \"#rrggbb\"."}};
  for (std::size_t i = 0; i < kinematics::kTorsoJoints; ++i) {
    const bool length = kinematics::is_length(i);
    fields.push_back({std::string(kinematics::kTorsoJointNames[i]), ParameterKind::kNumber,
                      length ? "m" : "rad",
                      length ? runtime::Range{-0.5, 0.5} : runtime::Range{-1.6, 1.6},
                      "Where this joint goes, within its limits."});
  }
  return fields;
}

/// The error names the zone and what is no color.
Status read_eyes(const runtime::Record& record, Zone& zone) {
  for (auto [field, eye] :
       {std::pair("left_eye", &zone.left_eye), {"right_eye", &zone.right_eye}}) {
    const auto color = color_from(record.text(field));
    if (!color) {
      return Error{"zone '" + zone.name + "': " + field +
                   " must be a color like \"#20c040\", got \"" + record.text(field) + "\""};
    }
    *eye = *color;
  }
  return {};
}

}  // namespace

Zones::Thresholds read_thresholds(runtime::Parameters& p) {
  Zones::Thresholds thresholds;
  thresholds.range = p.number("zone_range_threshold", "m", {0, 1}, thresholds.range,
                              "So far beyond the border of a zone a person is still in it.");
  thresholds.bearing = p.number("zone_bearing_threshold", "rad", {0, 0.5}, thresholds.bearing,
                                "The same of its bearings.");
  return thresholds;
}

Result<Zones> read_zones(runtime::Parameters& p, const Zones::Thresholds& thresholds,
                         const kinematics::TorsoLimits& limits) {
  const auto records = p.records(
      "zones", zone_fields(),
      "What the torso does for whom stands where; the first zone that holds the person counts.");
  std::vector<Zone> zones;
  zones.reserve(records.size());
  for (const auto& record : records) {
    Zone& zone = zones.emplace_back();
    zone.name = record.text("name");
    zone.enabled = record.flag("enabled");
    zone.range_min = record.number("range_min");
    zone.range_max = record.number("range_max");
    zone.bearing_min = record.number("bearing_min");
    zone.bearing_max = record.number("bearing_max");
    zone.tracking = record.flag("tracking");
    zone.voice = record.flag("voice");
    for (std::size_t i = 0; i < kinematics::kTorsoJoints; ++i)
      zone.pose[i] = record.number(std::string(kinematics::kTorsoJointNames[i]));
    if (auto eyes = read_eyes(record, zone); !eyes) return Error{eyes.error()};
  }
  return Zones::make(std::move(zones), thresholds, limits);
}

Posing read_posing(runtime::Host& host, const Zones::Thresholds& thresholds) {
  const kinematics::TorsoLimits limits = wire::read_torso_limits(host);
  auto& p = host.parameters();
  auto zones = read_zones(p, thresholds, limits);
  if (!zones) host.fault(zones.error());
  Posing::Parameters posing;
  posing.rest = p.text("rest", "",
                       "Zone whose pose the torso takes for nobody and while it drives; empty: the "
                       "last one stays.");
  posing.rest_after = p.number("rest_after", "s", {0, 600}, posing.rest_after,
                               "Nobody in a zone for so long: it goes to rest.");
  posing.margin = p.number("person_margin", "m", {0, 2}, posing.margin,
                           "It turns to another person who is nearer by so much.");
  posing.motion.limits = limits;
  posing.motion.pace = p.number("torso_pace", "-", {0.1, 1}, posing.motion.pace,
                                "Part of the rates of the torso's joints that poses use.");
  posing.motion.shortest = p.number("pose_time", "s", {0.2, 5}, posing.motion.shortest,
                                    "A pose takes at least so long.");
  posing.eyes.silent = p.number("eye_brightness", "-", {0, 1}, posing.eyes.silent,
                                "Of the eyes while the robot says nothing; its voice adds.");
  if (!posing.rest.empty() && !zones->empty() && zones->find(posing.rest) == nullptr)
    host.fault("rest must be the name of a zone, got \"" + posing.rest + "\"");
  return {posing, std::move(zones).value()};
}

}  // namespace usher::interaction_control
