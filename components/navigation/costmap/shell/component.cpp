#include "navigation/costmap/shell/component.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "navigation/costmap/core/echo_check.hpp"
#include "navigation/costmap/core/low_things.hpp"
#include "wire/conversions.hpp"
#include "wire/footprint.hpp"
#include "wire/frames.hpp"
#include "wire/low_scan.hpp"

namespace usher::costmap {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr double kRemembered = 0.15;  // [m]
constexpr int kConeBeams = 13;        // a cell apart at 2.5 m
constexpr auto kUltrasonicAge = milliseconds(500);
constexpr auto kDepthAge = milliseconds(500);
constexpr auto kWhiskerAge = milliseconds(300);
constexpr auto kPeopleAge = milliseconds(400);
constexpr double kSeenLately = 0.5;    // [s] who was not seen for longer gets no room
constexpr double kMaybeThere = 2.0;    // [s] who passes beside the cameras is not seen for so long
constexpr double kKnown = 2.0;         // [s] after somebody is seen he is known as such
constexpr double kWalks = 0.3;         // [m/s] who walks is elsewhere when the robot comes
constexpr double kWhiskerReach = 0.1;  // [m]
constexpr double kFoot = 0.5;          // [m] so near to what the laser sees a low thing is its foot
constexpr double kApproach = 0.6;      // [m] before it is too near to be measured, a thing is seen
constexpr double kComes = 0.1;         // [m] more than that, what comes by itself appears within
constexpr float kSure = 0.8F;          // confidence of what is remembered
constexpr double kSamePlace = 0.1;     // [m] what two sensors see so near is one surface
constexpr double kFelt = 0.2;          // [m] from where a contact is put
constexpr auto kContactsKept = std::chrono::seconds(60);
constexpr std::size_t kMostContacts = 64;
constexpr std::uint8_t kPassingCost = 252;  // the highest that a planner crosses
// Every fifth scan of a sensor goes into the global costs, which planning reads once a second.
constexpr int kGlobalShare = 5;

double in_seconds(runtime::Time time) { return runtime::seconds(time.time_since_epoch()); }

grid::OccupancyGrid viewed(const grid::Grid<std::uint8_t>& costs) {
  grid::OccupancyGrid view(costs.geometry());
  for (std::size_t i = 0; i < costs.size(); ++i) view[i] = kOccupancyOfCost[costs[i]];
  return view;
}

/// Whether the costs know an obstacle so near that it may be what bends a whisker.
bool bars_near(const grid::Grid<std::uint8_t>& costs, const geometry::Point2& place) {
  const grid::Cell middle = costs.geometry().cell_at(place);
  const int reach = static_cast<int>(std::ceil(kFelt / costs.resolution()));
  for (int y = middle.y - reach; y <= middle.y + reach; ++y) {
    for (int x = middle.x - reach; x <= middle.x + reach; ++x)
      if (costs.value_or({x, y}, kFreeCost) == kLethalCost) return true;
  }
  return false;
}

}  // namespace

CostmapComponent::CostmapComponent(runtime::Host& host)
    : host_(host),
      footprint_(wire::read_footprint(host)),
      rejected_scans_(host.health().counter("scan: rejected")),
      placeless_scans_(host.health().counter("scan: without pose")),
      invalid_ranges_(host.health().counter("ranges: invalid")),
      sensors_outside_(host.health().counter("scan: sensor outside")),
      rejected_maps_(host.health().counter("map: rejected")),
      rejected_people_(host.health().counter("people: rejected")),
      transforms_(host) {
  read_settings(host.parameters());
  local_.frame = frames::kOdom;
  global_.frame = frames::kMap;
  const int cells = static_cast<int>(std::lround(local_size_ / resolution_));
  local_.costs.emplace(make(true, {cells, cells, resolution_, 0.0, 0.0}));
  add_layers(local_);
  listen();
  local_costs_ = host.output(topics::kLocalCosts);
  global_costs_ = host.output(topics::kGlobalCosts);
  local_view_ = host.output(topics::kLocalCostmap);
  global_view_ = host.output(topics::kGlobalCostmap);
  global_timer_ =
      host.timer("global costs", milliseconds(1000), [this](auto) { publish_global(); });
  view_timer_ = host.timer("views", milliseconds(200), [this](auto) {
    if (local_.costs && local_view_.reader_count() > 0) {
      local_view_.publish(
          wire::to_message(local_.newest, local_.frame, viewed(local_.costs->costs())));
    }
    report();
  });
}

void CostmapComponent::read_settings(runtime::Parameters& parameters) {
  resolution_ =
      parameters.number("resolution", "m", {0.01, 0.5}, 0.05, "Side of a cell of the local costs.");
  local_size_ = parameters.number("local_size", "m", {2, 40}, 6.0,
                                  "Side of the window that rolls with the robot.");
  local_period_ = runtime::from_seconds(parameters.number(
      "local_period", "s", {0.01, 1}, 0.03, "Shortest time between two local costs."));
  static_in_local_ = parameters.flag("static_in_local", true,
                                     "The static map fills what no sensor has seen in the window.");
  settings_.inflation_radius =
      parameters.number("inflation_radius", "m", {0.1, 3}, 0.75, "No cost beyond this distance.");
  settings_.cost_scaling = parameters.number("cost_scaling", "-", {0, 100}, 4.0,
                                             "How fast costs fall with distance, per meter.");
  settings_.unseen =
      parameters.flag("unknown_is_free", true,
                      "Space that nobody has seen yet costs nothing; else plans keep out of it, "
                      "and the local planner does not.")
          ? Inflation::Unseen::kFree
          : Inflation::Unseen::kUnknown;
  settings_.social.radius =
      parameters.number("social_radius", "m", {0, 3}, settings_.social.radius,
                        "Room that people get where there is room; 0 = none.");
  settings_.social.cost = static_cast<std::uint8_t>(
      parameters.integer("social_cost", "-", {0, 252}, settings_.social.cost,
                         "What it costs to be where somebody is; it falls to 0 over that room."));
  laser_settings_.name = "laser";
  laser_settings_.clears_only_what_all_beams_pass = true;
  laser_settings_.max_obstacle_range = parameters.number("laser_obstacle_range", "m", {0.5, 30},
                                                         8.0, "Farther laser echoes mark nothing.");
  laser_settings_.max_raytrace_range =
      parameters.number("laser_clear_range", "m", {0.5, 30}, 9.0, "The laser clears no farther.");
  // The laser sees through glass that the map has.
  laser_settings_.overrules_static_map = parameters.flag(
      "laser_overrules_map", false,
      "What the laser sees free hides the static map; false where the map has glass.");
  laser_settings_.persistence =
      parameters.number("persistence", "s", {0, 600}, 20.0,
                        "Obstacles that are not seen again are forgotten; 0 = never.");
  local_persistence_ = parameters.number("local_persistence", "s", {0, 600}, 60.0,
                                         "The same in the window around the robot.");
  laser_settings_.kept_range = parameters.number(
      "blind_range", "m", {0, 2}, 0.6,
      "Nearer than this to the axle no sensor may see again what it saw: a recovery keeps it.");
  ultrasonic_settings_.name = "ultrasonic";
  ultrasonic_settings_.max_obstacle_range = parameters.number(
      "ultrasonic_obstacle_range", "m", {0.2, 6}, 2.5, "Farther ultrasonic echoes mark nothing.");
  ultrasonic_settings_.max_raytrace_range = ultrasonic_settings_.max_obstacle_range;
  ultrasonic_settings_.overrules_static_map = false;
  ultrasonic_settings_.kept_range = laser_settings_.kept_range;
  ultrasonic_settings_.persistence = parameters.number("ultrasonic_persistence", "s", {0, 600}, 5.0,
                                                       "The same for the ultrasonic sensors.");
  read_depth_settings(parameters);
  read_echo_settings(parameters);
}

void CostmapComponent::read_echo_settings(runtime::Parameters& parameters) {
  echo_half_cone_ =
      parameters.number("echo_half_cone", "rad", {0, 0.8}, 0.21,
                        "Half of an ultrasonic cone, where the laser explains echoes.");
  ultrasonic_cone_ = parameters.number("ultrasonic_cone", "rad", {0, 0.8}, 0.28,
                                       "Full width of a cone: an echo may come from all of it.");
  clearing_cone_ = parameters.number(
      "ultrasonic_clearing_cone", "rad", {0, 0.8}, 0.16,
      "The middle of it, which tells that nothing is there, in 13 rays; 0: the axis alone.");
  echo_tolerance_ = parameters.number("echo_tolerance", "m", {0, 1}, 0.3,
                                      "So much nearer than an echo may be what explains it.");
}

void CostmapComponent::listen() {
  const auto judge = [this](Beams& beams, runtime::Duration max_age, const std::string& name) {
    beams.max_age = max_age;
    beams.late = &host_.health().counter(name + ": late");
  };
  const runtime::Duration silence = runtime::from_seconds(host_.parameters().number(
      "robot.laser.silence", "s", {0.05, 1}, 0.3, "A laser without a scan for so long is lost."));
  judge(laser_beams_, silence, "scan");
  judge(ultrasonic_beams_, kUltrasonicAge, "ultrasonic");
  judge(depth_beams_, kDepthAge, "kinect");
  judge(low_beams_, kDepthAge, "kinect low");
  judge(rear_beams_, kDepthAge, "rear camera");

  map_ = host_.input(topics::kMap, {}, [this](const auto& message, const auto& info) {
    take_map(message, info.effective);
  });
  scan_ = host_.input(
      topics::kScanFiltered,
      {.max_age = silence, .on_loss = "publishes no local costs: the local planner stops"},
      [this](const auto&, const auto& info) {
        take_scan(scan_.share(), info, laser_beams_, &Map::laser);
      },
      [this] { host_.health().set(HealthState::kDegraded, "no scan"); });
  ultrasonic_ =
      host_.input(topics::kUltrasonicFiltered,
                  {.max_age = kUltrasonicAge, .on_loss = "goes on without glass", .optional = true},
                  [this](const auto&, const auto& info) {
                    take_scan(ultrasonic_.share(), info, ultrasonic_beams_, &Map::ultrasonic);
                  });
  read_depth();
  whiskers_ =
      host_.input(topics::kWhiskers,
                  {.max_age = kWhiskerAge, .on_loss = "keeps the last contacts", .optional = true},
                  [this](const auto&, const auto&) { take_whiskers(whiskers_.share()); });
  people_ = host_.input(
      topics::kPeople,
      {.max_age = kPeopleAge, .on_loss = "gives nobody room but as obstacles", .optional = true},
      [this](const auto& people, const auto&) { take_people(people); },
      [this] { forget_people(); });
  request_ = host_.input(topics::kCostmapRequest, {.optional = true},
                         [this](const auto& request, const auto&) {
                           if (request.id() == last_request_) return;
                           last_request_ = request.id();
                           if (local_.costs) local_.costs->forget();
                           if (global_.costs) global_.costs->forget();
                         });
}

void CostmapComponent::read_depth_settings(runtime::Parameters& parameters) {
  depth_settings_.name = "depth";
  depth_settings_.max_obstacle_range =
      parameters.number("depth_obstacle_range", "m", {0.5, 8}, 4.0,
                        "Farther obstacles of depth cameras mark nothing.");
  depth_settings_.max_raytrace_range =
      parameters.number("depth_clear_range", "m", {0.5, 8}, 4.5, "Depth cameras clear no farther.");
  depth_settings_.overrules_static_map = false;
  depth_settings_.persistence = laser_settings_.persistence;
  depth_settings_.kept_range = laser_settings_.kept_range;
  depth_near_range_ = parameters.number(
      "depth_near_range", "m", {0, 2}, 0.9,
      "Nearer than this much leaves the Kinect's image, and below 0.5 m it measures nothing: what "
      "it saw before stays there.");
  low_blind_range_ = wire::read_kinect_blind_range(parameters);
  rear_blind_range_ = parameters.number(
      "rear_blind_range", "m", {0, 4}, 1.2,
      "Nearer than this the rear camera looks over low things: what is marked there stays.");
  low_persistence_ = parameters.number("low_persistence", "s", {0, 600}, 300.0,
                                       "The same for what leaves the Kinect's image near the "
                                       "robot: nobody sees it again while it stands.");
  low_thickness_ = parameters.number(
      "low_thickness", "m", {0, 1}, 0.3,
      "Low things are taken to be so thick: the Kinect tells of their near edges only.");
}

void CostmapComponent::read_depth() {
  const auto read = [this](const topics::Topic<sensor_msgs::msg::LaserScan>& topic,
                           runtime::Input<sensor_msgs::msg::LaserScan>& input, Beams& beams,
                           Costmap::LayerId Map::*layer) {
    input = host_.input(topic,
                        {.max_age = kDepthAge,
                         .on_loss = "keeps what this camera saw, goes on with the others",
                         .optional = true},
                        [this, &input, &beams, layer](const auto&, const auto& info) {
                          take_scan(input.share(), info, beams, layer);
                        });
  };
  read(topics::kKinectScan, depth_, depth_beams_, &Map::depth);
  read(topics::kKinectScanLow, low_, low_beams_, &Map::low);
  read(topics::kRearScan, rear_, rear_beams_, &Map::rear);
}

CostmapConfig CostmapComponent::config(bool rolling, const grid::GridGeometry& window) const {
  CostmapConfig config = settings_;
  config.window = window;
  config.rolling = rolling;
  config.footprint.assign(footprint_.corners().begin(), footprint_.corners().end());
  return config;
}

Costmap CostmapComponent::make(bool rolling, const grid::GridGeometry& window) {
  auto made = Costmap::make(config(rolling, window));
  if (!made) host_.fault("costmap: " + made.error());
  return std::move(made).value();
}

void CostmapComponent::add_layers(Map& map) {
  const auto add = [&](const ObstacleLayerConfig& config) {
    const auto id = map.costs->add_obstacle_layer(config);
    if (!id) host_.fault("layer " + config.name + ": " + id.error());
    return *id;
  };
  // Near a wall the laser is blind (0.5 m), so the window around the robot remembers for longer
  // than the map does.
  ObstacleLayerConfig laser = laser_settings_;
  if (&map == &local_) laser.persistence = local_persistence_;
  map.laser = add(laser);
  map.ultrasonic = add(ultrasonic_settings_);
  // What is too near to be measured, or leaves a camera's image near the robot, is kept in layers
  // that are cleared from afar only.
  ObstacleLayerConfig depth = depth_settings_;
  if (&map == &local_) depth.persistence = local_persistence_;
  map.depth = add(depth);
  ObstacleLayerConfig near = depth_settings_;
  near.name = "near";
  near.min_raytrace_range = depth_near_range_;
  near.max_obstacle_range = depth_near_range_ + kApproach;
  near.kept_range = depth_near_range_ + footprint_.inscribed_radius();  // no camera sticks out
  near.persistence = low_persistence_;
  near.negative_clears = true;
  map.near = add(near);
  ObstacleLayerConfig rear = depth;
  rear.name = "rear";
  rear.min_raytrace_range = rear_blind_range_;
  rear.kept_range = std::numeric_limits<double>::infinity();
  map.rear = add(rear);
  ObstacleLayerConfig low = rear;
  low.name = "low";
  low.min_raytrace_range = low_blind_range_;
  low.persistence = low_persistence_;
  low.thickness = low_thickness_;
  low.negative_clears = true;
  map.low = add(low);
  low.name = "feet";
  map.feet = add(low);
  ObstacleLayerConfig whiskers;
  whiskers.name = "whiskers";
  whiskers.footprint_clearing = false;
  whiskers.overrules_static_map = false;
  whiskers.kept_range = laser_settings_.kept_range;
  map.whiskers = add(whiskers);
}

void CostmapComponent::refuse_map(const std::string& reason) {
  ++rejected_maps_;
  refused_map_ = "map refused: " + reason;
  report();
}

void CostmapComponent::take_map(const nav_msgs::msg::OccupancyGrid& message,
                                runtime::Time effective) {
  const auto map = wire::from_message(message);
  if (!map) {
    refuse_map(map.error());
    return;
  }
  auto costs = Costmap::make(config(false, map->geometry()));
  const Status usable = costs ? costs->set_static_map(*map) : Status(Error{costs.error()});
  if (!usable) {
    refuse_map(usable.error());
    return;
  }
  refused_map_.clear();
  static_costs_.emplace(std::move(costs).value());
  static_costs_->update(0.0);
  global_.costs.emplace(make(false, map->geometry()));
  add_layers(global_);
  if (const auto status = global_.costs->set_static_map(*map); !status)
    host_.fault("map: " + status.error());
  contacts_.clear();  // they were in the former map
  global_.static_known = true;
  if (static_in_local_) waiting_map_ = *map;
  global_.newest = effective;
  publish_global();
}

void CostmapComponent::take_scan(std::shared_ptr<const sensor_msgs::msg::LaserScan> scan,
                                 const runtime::SampleInfo& info, Beams& beams,
                                 Costmap::LayerId Map::*layer) {
  if (const auto status = wire::check(*scan); !status) {
    ++rejected_scans_;
    return;
  }
  if (beams.angle_min != scan->angle_min() || beams.increment != scan->angle_increment() ||
      beams.count != scan->ranges().size()) {
    const float first = scan->angle_min();
    const float increment = scan->angle_increment();
    const std::size_t count = scan->ranges().size();
    beams.angle_min = first;
    beams.increment = increment;
    beams.count = count;
    beams.directions = layer == &Map::ultrasonic
                           ? cone_directions(first, increment, count, ultrasonic_cone_, kConeBeams)
                           : beam_directions(first, increment, count);
  }
  const runtime::Time stamp = wire::from_message(scan->header().stamp());
  const std::string frame = scan->header().frame_id();
  transforms_.when_known(frames::kOdom, frame, stamp,
                         [this, scan = std::move(scan), &beams, layer, stamp,
                          effective = info.effective](const auto& pose) {
                           if (host_.now() - effective > beams.max_age) {
                             ++*beams.late;  // nobody drives on what was
                           } else {
                             place_scan(*scan, beams, layer, stamp, effective,
                                        geometry::to_plane(pose));
                           }
                         });
}

/// `stamp` is on the clock of the sensor's host, as tf of that time; `effective` on this one's.
void CostmapComponent::place_scan(const sensor_msgs::msg::LaserScan& scan, Beams& beams,
                                  Costmap::LayerId Map::*layer, runtime::Time stamp,
                                  runtime::Time effective, const geometry::Pose2& odom_T_sensor) {
  const auto odom_T_base = transforms_.lookup_planar(frames::kOdom, frames::kBaseFootprint, stamp);
  if (!odom_T_base) {
    ++placeless_scans_;
    return;
  }
  if (layer == &Map::ultrasonic) hear(scan, beams, odom_T_sensor);
  if (layer == &Map::low) {
    lasting_ranges_ = scan.ranges();
    drop_what_people_hide(beams.directions, odom_T_sensor, maybe_there_, lasting_ranges_);
    for (std::size_t i = 0; i < lasting_ranges_.size(); ++i)
      if (wire::is_drop_behind_floor(scan, i)) lasting_ranges_[i] = scan.ranges()[i];
  }
  const geometry::Pose2 base_T_odom = geometry::inverse(*odom_T_base);
  const auto take = [&](Map& map, const geometry::Pose2& window_T_base,
                        const geometry::Pose2& window_T_sensor) {
    if (!map.costs->move_to(window_T_base)) ++rejected_scans_;
    RangeObservation seen{window_T_sensor, beams.directions, scan.ranges(), in_seconds(effective)};
    if (layer == &Map::ultrasonic) {
      seen.ranges = middle_ranges_;
      if (!observe(map, map.*layer, seen)) return;
      seen.ranges = cone_ranges_;
      seen.clears = false;
    }
    const bool camera = layer == &Map::depth || layer == &Map::rear;
    if (camera)
      place_people(layer == &Map::depth ? told_ : maybe_there_, window_T_base * base_T_odom);
    const bool taken = layer == &Map::low     ? take_low(map, scan, seen)
                       : layer == &Map::depth ? take_depth(map, scan, seen)
                       : layer == &Map::rear  ? take_rear(map, seen)
                                              : observe(map, map.*layer, seen);
    if (!taken) return;
    if (layer == &Map::laser) map.costs->keep_beside(map.feet, map.laser, kFoot);
    if (&map == &local_ && layer == &Map::laser && effective >= map.newest) laser_stamp_ = stamp;
    // The local costs are as old as their laser scan, whatever else was seen since.
    if (&map == &global_ || layer == &Map::laser) map.newest = std::max(map.newest, effective);
  };
  take(local_, *odom_T_base, odom_T_sensor);
  const auto map_T_odom = transforms_.lookup_planar(frames::kMap, frames::kOdom, stamp);
  if (map_T_odom && global_.costs &&
      (layer == &Map::ultrasonic || beams.turn++ % kGlobalShare == 0))
    take(global_, *map_T_odom * *odom_T_base, *map_T_odom * odom_T_sensor);
  if (layer == &Map::laser && host_.now() - local_published_ >= local_period_) publish_local();
}

/// What the Kinect alone sees near the robot stays there when it is too near to be seen again: not
/// people, who walk on, nor what the laser sees at the same place, which its own layer has as long
/// as it is there. Whom nobody told of yet when he was seen is forgotten when he is told of. What
/// appears near where nothing was has come by itself, and goes.
bool CostmapComponent::take_depth(Map& map, const sensor_msgs::msg::LaserScan& scan,
                                  const RangeObservation& seen) {
  if (!observe(map, map.depth, seen)) return false;
  if (people_heard_ && !people_known_) return true;  // it could be anybody
  RangeObservation lasting = seen;
  lasting_ranges_ = scan.ranges();
  drop_what_people_hide(seen.directions, seen.sensor, places_, lasting_ranges_);
  const ObstacleLayerConfig& layer = map.costs->layer(map.near).config();
  const auto came = [&](float range, const geometry::Point2& direction) {
    return range > 0.0F && static_cast<double>(range) < layer.min_raytrace_range + kComes &&
           map.costs->seen_free(map.near, seen.sensor * (static_cast<double>(range) * direction));
  };
  for (std::size_t i = 0; i < lasting_ranges_.size(); ++i)
    if (came(lasting_ranges_[i], seen.directions[i])) lasting_ranges_[i] = std::nanf("");
  const auto& sure = scan.intensities();
  const auto stays = [&](std::size_t bearing, const geometry::Point2& place) {
    const auto range = static_cast<double>(scan.ranges()[bearing]);
    if (range > layer.max_obstacle_range) return false;
    if (bearing < sure.size() && sure[bearing] < kSure) return false;
    const geometry::Point2 in_window = seen.sensor * place;
    const auto beside = [&](const auto& person) { return (person - in_window).norm() <= kFoot; };
    return std::ranges::none_of(places_, beside) &&
           !map.costs->beside(map.laser, in_window, kSamePlace);
  };
  keep_own(lasting_ranges_, seen.directions, stays, own_ranges_);
  lasting.ranges = own_ranges_;
  if (!observe(map, map.near, lasting)) return false;
  map.costs->forget_since(map.near, seen.stamp - kKnown, places_, kFoot);
  return true;
}

/// What is low beside something that the laser sees and the map has not may be a foot of it: that
/// is remembered as long as the laser sees such a thing there. Where floor is missing is nobody's
/// foot. False when a layer refused the scan.
bool CostmapComponent::take_low(Map& map, const sensor_msgs::msg::LaserScan& scan,
                                RangeObservation seen) {
  const auto is_foot = [&](std::size_t bearing, const geometry::Point2& place) {
    return !wire::is_drop(scan, bearing) &&
           map.costs->unmapped_beside(map.laser, seen.sensor * place, kFoot);
  };
  keep_own(lasting_ranges_, seen.directions, is_foot, own_ranges_);
  seen.ranges = own_ranges_;
  if (!observe(map, map.feet, seen)) return false;
  keep_own(lasting_ranges_, seen.directions, std::not_fn(is_foot), own_ranges_);
  seen.ranges = own_ranges_;
  return observe(map, map.low, seen);
}

void CostmapComponent::place_people(std::span<const geometry::Point2> in_odom,
                                    const geometry::Pose2& window_T_odom) {
  places_.clear();
  for (const geometry::Point2& person : in_odom) places_.push_back(window_T_odom * person);
}

/// What the rear camera saw stays where it looks over it: but not where somebody is or was a moment
/// ago, once the camera looks beyond that place. He walks on.
bool CostmapComponent::take_rear(Map& map, const RangeObservation& seen) {
  if (!observe(map, map.rear, seen)) return false;
  map.costs->forget_passed(map.rear, seen, places_, kFoot);
  return true;
}

/// What the ultrasonic sensors hear and the laser does not see, over their whole cones, and what
/// the middle of each tells.
void CostmapComponent::hear(const sensor_msgs::msg::LaserScan& sonar, const Beams& rays,
                            const geometry::Pose2& odom_T_sonar) {
  keep_unexplained(sonar, odom_T_sonar);
  drop_remembered_echoes(local_.costs->layer(local_.laser), local_.costs->raster(), odom_T_sonar,
                         rays.directions, kRemembered, echoes_);
  spread_echoes(echoes_, rays.directions, odom_T_sonar, bodies_, cone_ranges_);
  middle_ranges_ = cone_ranges_;
  keep_middle(rays.directions, echoes_.size(), clearing_cone_, middle_ranges_);
}

/// The echoes that the newest laser scan does not explain.
void CostmapComponent::keep_unexplained(const sensor_msgs::msg::LaserScan& sonar,
                                        const geometry::Pose2& odom_T_sonar) {
  echoes_ = sonar.ranges();
  const auto* laser = scan_.fresh();
  if (laser == nullptr || !wire::check(*laser)) return;
  const auto odom_T_laser = transforms_.lookup_planar(frames::kOdom, laser->header().frame_id(),
                                                      wire::from_message(laser->header().stamp()));
  if (!odom_T_laser) return;
  drop_explained_echoes(
      {*odom_T_laser, laser->angle_min(), laser->angle_increment(), laser->ranges()},
      {odom_T_sonar, sonar.angle_min(), sonar.angle_increment(), {}}, echo_half_cone_,
      echo_tolerance_, echoes_);
}

bool CostmapComponent::observe(Map& map, Costmap::LayerId layer,
                               const RangeObservation& observation) {
  const ObstacleLayer& taken = map.costs->layer(layer);
  const std::uint64_t invalid = taken.invalid_ranges();
  const std::uint64_t outside = taken.sensors_outside();
  if (!map.costs->observe(layer, observation)) {
    ++rejected_scans_;
    return false;
  }
  if (&map == &local_) invalid_ranges_ += taken.invalid_ranges() - invalid;
  sensors_outside_ += taken.sensors_outside() - outside;
  return true;
}

void CostmapComponent::take_whiskers(std::shared_ptr<const usher_msgs::msg::Whiskers> message) {
  const runtime::Time stamp = wire::from_message(message->header().stamp());
  transforms_.when_known(frames::kOdom, frames::kBaseFootprint, stamp,
                         [this, message = std::move(message), stamp](const auto& pose) {
                           place_whiskers(*message, stamp, geometry::to_plane(pose));
                         });
}

void CostmapComponent::place_whiskers(const usher_msgs::msg::Whiskers& message, runtime::Time stamp,
                                      const geometry::Pose2& odom_T_base) {
  double front = 0.0, back = 0.0, side = 0.0;  // the footprint's corners
  for (const auto& corner : footprint_.corners()) {
    front = std::max(front, corner.x());
    back = std::min(back, corner.x());
    side = std::max(side, std::abs(corner.y()));
  }
  std::vector<geometry::Point2> touched;
  const auto touch = [&](bool pressed, double x, double y) {
    if (pressed) touched.push_back(odom_T_base * geometry::Point2(x, y));
  };
  // What bends a whisker is just beyond the corner; on it, the robot would stand in an obstacle and
  // not find a way out.
  front += kWhiskerReach;
  back -= kWhiskerReach;
  touch(message.front_left(), front, side);
  touch(message.front_right(), front, -side);
  touch(message.back_left(), back, side);
  touch(message.back_right(), back, -side);
  if (!local_.costs->replace(local_.whiskers, touched, in_seconds(stamp))) ++rejected_scans_;
  remember_contacts(touched, stamp);
}

/// On the map: what nothing but a whisker feels is in no other layer, and once the robot has backed
/// off the next plan would lead there again.
void CostmapComponent::remember_contacts(std::span<const geometry::Point2> in_odom,
                                         runtime::Time stamp) {
  if (!global_.costs || (in_odom.empty() && contacts_.empty())) return;
  const auto map_T_odom = transforms_.lookup_planar(frames::kMap, frames::kOdom, stamp);
  if (!map_T_odom) return;
  std::erase_if(contacts_, [&](const Contact& one) { return stamp - one.stamp > kContactsKept; });
  for (const geometry::Point2& point : in_odom) {
    const geometry::Point2 place = *map_T_odom * point;
    const auto known = std::find_if(contacts_.begin(), contacts_.end(), [&](const Contact& one) {
      return (one.place - place).norm() < kFelt;
    });
    if (known != contacts_.end()) {
      known->stamp = stamp;
      continue;
    }
    if (bars_near(global_.costs->costs(), place)) continue;
    if (contacts_.size() == kMostContacts)
      contacts_.erase(
          std::min_element(contacts_.begin(), contacts_.end(),
                           [](const Contact& a, const Contact& b) { return a.stamp < b.stamp; }));
    contacts_.push_back({place, stamp});
  }
  contact_places_.clear();
  for (const Contact& one : contacts_) contact_places_.push_back(one.place);
  if (!global_.costs->replace(global_.whiskers, contact_places_, in_seconds(stamp)))
    ++rejected_scans_;
}

/// Room in the window for who is ahead (who comes from behind sees the robot), on the map for who
/// stands.
void CostmapComponent::take_people(const usher_msgs::msg::People& message) {
  people_heard_ = true;
  const runtime::Time stamp = wire::from_message(message.header().stamp());
  const auto base_T_odom = transforms_.lookup_planar(frames::kBaseFootprint, frames::kOdom, stamp);
  if (message.header().frame_id() != frames::kOdom || !base_T_odom) {
    ++rejected_people_;
    forget_people();
    return;
  }
  const auto map_T_odom = transforms_.lookup_planar(frames::kMap, frames::kOdom, stamp);
  near_.clear();
  standing_.clear();
  bodies_.clear();
  maybe_there_.clear();
  told_.clear();
  people_known_ = true;
  for (const auto& person : message.people()) {
    const geometry::Point2 place(person.x(), person.y());
    told_.push_back(place);
    if (static_cast<double>(person.unseen()) <= kMaybeThere) maybe_there_.push_back(place);
    if (!(static_cast<double>(person.unseen()) <= kSeenLately)) continue;
    bodies_.push_back(place);
    if ((*base_T_odom * place).x() > 0.0) near_.push_back(place);
    if (map_T_odom && std::hypot(person.vx(), person.vy()) < kWalks)
      standing_.push_back(*map_T_odom * place);
  }
  local_.costs->set_people(near_);
  if (global_.costs) global_.costs->set_people(standing_);
}

void CostmapComponent::forget_people() {
  people_known_ = false;
  bodies_.clear();
  maybe_there_.clear();
  told_.clear();
  local_.costs->set_people({});
  if (global_.costs) global_.costs->set_people({});
}

void CostmapComponent::publish_local() {
  if (static_in_local_ && global_.static_known) {
    if (const auto map_T_odom =
            transforms_.lookup_planar(frames::kMap, frames::kOdom, laser_stamp_)) {
      if (!local_.costs->set_static_transform(*map_T_odom)) ++rejected_maps_;
      if (waiting_map_) place_static_map();
    }
  }
  local_costs_.publish(wire::to_message(local_.newest, local_.frame,
                                        local_.costs->update(in_seconds(local_.newest))));
  local_published_ = host_.now();
}

/// Into the window; before anybody knows where the map lies it would stand in the robot's way.
void CostmapComponent::place_static_map() {
  if (const auto status = local_.costs->set_static_map(*waiting_map_); !status)
    host_.fault("map: " + status.error());
  waiting_map_.reset();
}

void CostmapComponent::publish_global() {
  if (!global_.costs) return;
  const auto& costs = global_.costs->update(in_seconds(host_.now()));
  passing_ = costs;
  // What stands in the way by the map's own free ground may be gone when the robot gets there: the
  // plan goes round it where that is not much longer, and through it, to wait there, where it is
  // the only way.
  const auto& mapped = static_costs_->costs();
  for (std::size_t i = 0; i < passing_.size(); ++i) {
    if (passing_[i] >= kInscribedCost && passing_[i] != kUnknownCost && mapped[i] < kInscribedCost)
      passing_[i] = kPassingCost;
  }
  global_costs_.publish(wire::to_message(global_.newest, global_.frame, passing_));
  if (global_view_.reader_count() > 0) {
    global_view_.publish(wire::to_message(global_.newest, global_.frame, viewed(costs)));
  }
}

void CostmapComponent::report() {
  if (!scan_.fresh()) {
    host_.health().set(HealthState::kDegraded, "no scan");
  } else if (host_.now() - local_published_ > laser_beams_.max_age + local_period_) {
    host_.health().set(HealthState::kDegraded, "no scan that can be used");
  } else if (!refused_map_.empty()) {
    host_.health().set(HealthState::kDegraded, refused_map_);
  } else if (!global_.static_known) {
    host_.health().set(HealthState::kDegraded, "no map");
  } else if (!transforms_.lookup(frames::kMap, frames::kBaseFootprint, laser_stamp_)) {
    host_.health().set(HealthState::kDegraded, "robot not localized");
  } else {
    host_.health().set(HealthState::kOk);
  }
}

}  // namespace usher::costmap
