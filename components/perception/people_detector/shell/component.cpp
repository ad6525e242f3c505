#include "perception/people_detector/shell/component.hpp"

#include <limits>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::people_detector {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kScanAge = milliseconds(250);
constexpr auto kPeriod = milliseconds(60);  // every third scan of a laser of 50 Hz
constexpr double kRecently = 1.0;           // [s]

LegFinderConfig leg_parameters(runtime::Parameters& p) {
  LegFinderConfig c;
  c.wall = p.number("legs.wall", "m", {0.05, 1}, c.wall,
                    "Nearer to something on the map it belongs to that.");
  c.widest = p.number("legs.widest", "m", {0.2, 2}, c.widest, "Wider is nobody.");
  c.farthest =
      p.number("legs.farthest", "m", {1, 30}, c.farthest, "Farther legs are too few beams.");
  return c;
}

TrackerConfig tracker_parameters(runtime::Parameters& p) {
  TrackerConfig c;
  c.travel = p.number("travel", "m", {0.1, 3}, c.travel,
                      "So far must walk whom only the laser sees, before that counts as a person.");
  c.memory = p.number("memory", "s", {0.5, 30}, c.memory,
                      "So long is remembered who is not seen any more.");
  return c;
}

usher_msgs::msg::Person to_message(const Track& track, double now) {
  usher_msgs::msg::Person person;
  person.id(track.id);
  person.x(track.state[0]);
  person.y(track.state[1]);
  person.vx(track.state[2]);
  person.vy(track.state[3]);
  Eigen::Map<Eigen::Matrix4d>(person.covariance().data()) = track.covariance;  // symmetric
  person.height(track.height > 0.0 ? static_cast<float>(track.height)
                                   : std::numeric_limits<float>::quiet_NaN());
  person.age(static_cast<float>(now - track.born));
  person.unseen(static_cast<float>(now - track.last_seen()));
  const auto by = [&](Source source) {
    return now - track.seen[static_cast<std::size_t>(source)] < kRecently;
  };
  person.by_kinect(by(Source::kKinect));
  person.by_rear(by(Source::kRearCamera));
  person.by_laser(by(Source::kLaser));
  return person;
}

}  // namespace

PeopleDetectorComponent::PeopleDetectorComponent(runtime::Host& host)
    : host_(host), rejected_(host.health().counter("scans: rejected")), transforms_(host) {
  auto legs = LegFinder::make(leg_parameters(host.parameters()));
  if (!legs) host.fault(legs.error());
  legs_.emplace(std::move(legs).value());
  tracker_.emplace(tracker_parameters(host.parameters()));

  map_ =
      host.input(topics::kMap, {}, [this](const auto& message, const auto&) { take_map(message); });
  scan_ = host.input(
      topics::kScanFiltered, {.max_age = kScanAge, .on_loss = "falls silent: nobody is foreseen"},
      [this](const auto&, const auto&) { take_scan(scan_.share()); },
      [this] { host_.health().set(HealthState::kDegraded, "no scan"); });
  people_ = host.output(topics::kPeople);
}

void PeopleDetectorComponent::take_map(const nav_msgs::msg::OccupancyGrid& message) {
  const auto map = wire::from_message(message);
  if (!map) {
    ++rejected_;
    host_.health().set(HealthState::kDegraded, "map refused: " + map.error());
    return;
  }
  legs_->set_map(*map);
}

void PeopleDetectorComponent::take_scan(std::shared_ptr<const sensor_msgs::msg::LaserScan> scan) {
  const runtime::Time stamp = wire::from_message(scan->header().stamp());
  if (stamp >= last_ && stamp - last_ < kPeriod) return;
  if (!wire::check(*scan)) {
    ++rejected_;
    return;
  }
  last_ = stamp;
  transforms_.when_known(frames::kOdom, frames::kBaseFootprint, stamp,
                         [this, scan = std::move(scan), stamp](const auto& pose) {
                           update(*scan, stamp, geometry::to_plane(pose));
                         });
}

void PeopleDetectorComponent::update(const sensor_msgs::msg::LaserScan& scan, runtime::Time stamp,
                                     const geometry::Pose2& odom_T_base) {
  const auto base_T_scan =
      transforms_.lookup_planar(frames::kBaseFootprint, scan.header().frame_id(), stamp);
  if (!base_T_scan) {
    ++rejected_;
    return;
  }
  const auto newest = transforms_.buffer().newest(frames::kMap, frames::kOdom);
  const auto map_T_odom =
      newest ? transforms_.lookup_planar(frames::kMap, frames::kOdom, runtime::Time(*newest))
             : Result<geometry::Pose2>(Error{"robot not localized"});
  const char* missing = !legs_->has_map() ? "no map" : !map_T_odom ? "robot not localized" : "";
  const double now = runtime::seconds(stamp.time_since_epoch());
  if (*missing != '\0') {
    host_.health().set(HealthState::kDegraded, missing);
    tracker_->update(now, Source::kLaser, {});
  } else {
    host_.health().set(HealthState::kOk);
    const geometry::Pose2 odom_T_scan = odom_T_base * *base_T_scan;
    const ScanView view{scan.angle_min(), scan.angle_increment(), scan.ranges()};
    tracker_->update(now, Source::kLaser,
                     legs_->find(view, *map_T_odom * odom_T_scan, odom_T_scan));
  }
  publish(stamp);
}

void PeopleDetectorComponent::publish(runtime::Time stamp) {
  usher_msgs::msg::People message;
  message.header(wire::header(stamp, frames::kOdom));
  const double now = runtime::seconds(stamp.time_since_epoch());
  for (const Track& track : tracker_->people()) message.people().push_back(to_message(track, now));
  people_.publish(message);
}

}  // namespace usher::people_detector
