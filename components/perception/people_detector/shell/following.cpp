#include "perception/people_detector/shell/following.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "wire/appearance.hpp"
#include "wire/conversions.hpp"
#include "wire/footprint.hpp"
#include "wire/frames.hpp"

namespace usher::people_detector {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kScanAge = milliseconds(250);
constexpr auto kFacesAge = milliseconds(1000);
constexpr auto kLooks = milliseconds(300);  // a camera that looked so long ago looks
constexpr auto kPeriod = milliseconds(50);  // of scans (every third of 50 Hz), and what is told
constexpr auto kLocalizationAge = milliseconds(1000);  // of map -> odom
constexpr auto kFramesPeriod = milliseconds(200);
constexpr std::size_t kMostFrames = 16;  // transforms in one message
constexpr double kBeside = 0.5;          // [m] from somebody who is followed, it is them
constexpr double kShortest = 0.04;       // [s] in which a motion is measured
constexpr double kLongest = 0.5;         // [s] after which nobody knows it
constexpr double kRecently = 1.0;        // [s]
constexpr double kAhead = 0.5;           // [rad]
constexpr double kNape = 0.10;           // [m] from a face to the body's middle
constexpr double kFaceHeight = 0.93;     // of the person's
constexpr double kFarthestFace = 20.0;   // [m]

double in_seconds(runtime::Time time) { return runtime::seconds(time.time_since_epoch()); }

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
  c.stands = p.number("stands", "s", {1, 600}, c.stands,
                      "Whom only the laser sees, and who has not walked for so long, is a thing.");
  c.memory = p.number("memory", "s", {0.5, 30}, c.memory,
                      "So long is remembered who is not seen any more.");
  return c;
}

double wall_parameter(runtime::Parameters& p) {
  return p.number("camera.wall", "m", {0, 0.2}, 0.15,
                  "Whose middle is nearer to something on the map is a part of that.");
}

bool frames_parameter(runtime::Parameters& p) {
  return p.flag("people_transforms", true,
                "Tells of people on tf, too, for rviz: odom -> person_<id>, 5 times a second.");
}

SightingErrors error_parameters(runtime::Parameters& p) {
  SightingErrors e;
  e.along = p.number("camera.along", "m", {0.01, 0.5}, e.along,
                     "Error of whom a camera sees, along the line of sight.");
  e.along_growth = p.number("camera.along_growth", "-", {0, 0.2}, e.along_growth,
                            "And this more for each metre of distance.");
  e.across = p.number("camera.across", "m", {0.01, 0.5}, e.across, "The same beside it.");
  e.across_growth = p.number("camera.across_growth", "-", {0, 0.2}, e.across_growth,
                             "And this more for each metre of distance.");
  return e;
}

AheadConfig ahead_parameters(runtime::Host& host) {
  auto& p = host.parameters();
  AheadConfig c;
  c.half_width = wire::read_footprint(host).half_width();
  c.beside = p.number("ahead.beside", "m", {0, 2}, c.beside,
                      "So near beside the robot's way somebody is in it.");
  c.reach = p.number("ahead.reach", "m", {0.5, 8}, c.reach, "So far ahead.");
  c.soon = p.number("ahead.soon", "s", {0, 3}, c.soon, "Who will be there by then is there.");
  return c;
}

/// A leaning laser meets the floor, and tells nothing of most beams.
bool knows_ahead(const sensor_msgs::msg::LaserScan& scan) {
  std::size_t known = 0, ahead = 0;
  for (std::size_t i = 0; i < scan.ranges().size(); ++i) {
    const double bearing = scan.angle_min() + scan.angle_increment() * static_cast<double>(i);
    if (std::abs(bearing) > kAhead) continue;
    ++ahead;
    known += std::isnan(scan.ranges()[i]) ? 0 : 1;
  }
  return 2 * known >= ahead && ahead > 0;
}

bool seen_lately(const Track& track, double now) { return now - track.last_seen() < kRecently; }

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
  person.by_face(by(Source::kFace));
  person.kinect_appearance(
      wire::to_message(track.appearances[static_cast<std::size_t>(Source::kKinect)]));
  person.rear_appearance(
      wire::to_message(track.appearances[static_cast<std::size_t>(Source::kRearCamera)]));
  return person;
}

}  // namespace

Following::Following(runtime::Host& host, std::function<std::string()> trouble)
    : host_(host),
      trouble_(std::move(trouble)),
      errors_(error_parameters(host.parameters())),
      in_wall_(wall_parameter(host.parameters())),
      show_frames_(frames_parameter(host.parameters())),
      ahead_(ahead_parameters(host)),
      rejected_(host.health().counter("scans: rejected")),
      late_(host.health().counter("images: late")),
      late_scans_(host.health().counter("scans: late")),
      rejected_faces_(host.health().counter("faces: rejected")),
      rejected_maps_(host.health().counter("maps: rejected")),
      transforms_(host) {
  auto legs = LegFinder::make(leg_parameters(host.parameters()));
  if (!legs) host.fault(legs.error());
  legs_.emplace(std::move(legs).value());
  tracker_.emplace(tracker_parameters(host.parameters()));

  map_ =
      host.input(topics::kMap, {}, [this](const auto& message, const auto&) { take_map(message); });
  scan_ = host.input(
      topics::kScanFiltered,
      {.max_age = kScanAge, .on_loss = "follows whom the cameras see; without them falls silent"},
      [this](const auto&, const auto&) { take_scan(scan_.share()); }, [this] { report(); });
  faces_ = host.input(
      topics::kFaces,
      {.max_age = kFacesAge, .on_loss = "goes on with the other sensors", .optional = true},
      [this](const auto& message, const auto&) { take_faces(message); });
  people_ = host.output(topics::kPeople);
  person_ahead_ = host.output(topics::kPersonAhead);
  frames_ = host.output(topics::kTf);
}

void Following::take_map(const nav_msgs::msg::OccupancyGrid& message) {
  const auto map = wire::from_message(message);
  refused_map_ = map ? "" : "map refused: " + map.error();
  if (map)
    legs_->set_map(*map);
  else
    ++rejected_maps_;
  report();
}

void Following::take_scan(std::shared_ptr<const sensor_msgs::msg::LaserScan> scan) {
  const runtime::Time stamp = wire::from_message(scan->header().stamp());
  if (stamp >= last_scan_ && stamp - last_scan_ < kPeriod) return;
  if (!wire::check(*scan)) {
    ++rejected_;
    return;
  }
  last_scan_ = stamp;
  transforms_.when_known(frames::kOdom, frames::kBaseFootprint, stamp,
                         [this, scan = std::move(scan), stamp](const auto& pose) {
                           update(*scan, stamp, geometry::to_plane(pose));
                         });
}

void Following::update(const sensor_msgs::msg::LaserScan& scan, runtime::Time stamp,
                       const geometry::Pose2& odom_T_base) {
  const auto base_T_scan =
      transforms_.lookup_planar(frames::kBaseFootprint, scan.header().frame_id(), stamp);
  if (!base_T_scan) {
    ++rejected_;
    return;
  }
  const auto map_T_odom = localization();
  legs_trouble_ = !legs_->has_map() ? "no map" : !map_T_odom ? "robot not localized" : "";
  const bool usable = *legs_trouble_ == '\0';
  const geometry::Pose2 odom_T_scan = odom_T_base * *base_T_scan;
  const ScanView view{scan.angle_min(), scan.angle_increment(), scan.ranges()};
  const auto legs = usable ? legs_->find(view, *map_T_odom * odom_T_scan, odom_T_scan)
                           : std::span<const Observation>{};
  if (!tracker_->update(in_seconds(stamp), Source::kLaser, legs)) {
    ++late_scans_;
    return;
  }
  if (usable && knows_ahead(scan)) looked_[static_cast<std::size_t>(Source::kLaser)] = host_.now();
  note(stamp, odom_T_base);
  publish();
}

void Following::take_faces(const usher_msgs::msg::Faces& message) {
  const runtime::Time stamp = wire::from_message(message.header().stamp());
  transforms_.when_known(frames::kOdom, frames::kBaseFootprint, stamp,
                         [this, message, stamp](const auto& pose) {
                           see_faces(message, stamp, geometry::to_plane(pose));
                         });
}

void Following::see_faces(const usher_msgs::msg::Faces& message, runtime::Time stamp,
                          const geometry::Pose2& odom_T_base) {
  faced_.clear();
  for (const auto& face : message.faces()) {
    const bool sane = face.range() >= 0.0F && face.range() < kFarthestFace &&
                      std::isfinite(face.bearing()) && face.elevation() > 0.0F &&
                      face.elevation() < 3.0F;
    if (!sane) {
      ++rejected_faces_;
      continue;
    }
    const double range = face.range() + kNape, bearing = face.bearing();
    faced_.push_back({range * std::cos(bearing),
                      range * std::sin(bearing),
                      face.elevation() / kFaceHeight,
                      0.0,
                      {}});
  }
  see(Source::kFace, stamp, faced_, odom_T_base, {});
}

std::optional<geometry::Pose2> Following::localization() const {
  return transforms_.newest_planar(frames::kMap, frames::kOdom, kLocalizationAge);
}

void Following::see(Source source, runtime::Time stamp, std::span<const Sighting> sightings,
                    const geometry::Pose2& odom_T_base, const geometry::Pose2& base_T_foot) {
  place_sightings(sightings, odom_T_base * base_T_foot, errors_, observations_);
  // Who is followed may lean on a wall.
  if (const auto map_T_odom = localization()) {
    std::erase_if(observations_, [&](const Observation& one) {
      return legs_->on_the_map(*map_T_odom * one.position, in_wall_) && !followed(one.position);
    });
  }
  if (!tracker_->update(in_seconds(stamp), source, observations_)) {
    ++late_;
    return;
  }
  looked_[static_cast<std::size_t>(source)] = host_.now();
  note(stamp, odom_T_base);
  publish();
}

/// Whether somebody who was just seen is there.
bool Following::followed(const geometry::Point2& in_odom) const {
  const auto people = tracker_->people();
  return std::any_of(people.begin(), people.end(), [&](const Track& track) {
    return seen_lately(track, tracker_->now()) && (track.position() - in_odom).norm() < kBeside;
  });
}

/// How the robot moves, from where it was.
void Following::note(runtime::Time stamp, const geometry::Pose2& odom_T_base) {
  newest_ = std::max(newest_, stamp);
  if (!motion_) motion_ = Motion{stamp, odom_T_base, {}};
  const double passed = runtime::seconds(stamp - motion_->stamp);
  if (passed < kShortest) return;
  const geometry::Pose2 moved = inverse(motion_->odom_T_base) * odom_T_base;
  const geometry::Twist2 twist{moved.x / passed, moved.yaw / passed};
  motion_ = Motion{stamp, odom_T_base, passed < kLongest ? twist : geometry::Twist2{}};
}

bool Following::looks(Source source) const {
  const auto& looked = looked_[static_cast<std::size_t>(source)];
  return looked && host_.now() - *looked <= kLooks;
}

void Following::publish() {
  if (newest_ - published_ < kPeriod) return;
  published_ = newest_;
  const double now = tracker_->now();
  message_.header(wire::header(newest_, frames::kOdom));
  message_.kinect_looks(looks(Source::kKinect));
  message_.rear_looks(looks(Source::kRearCamera));
  message_.people().clear();
  for (const Track& track : tracker_->people()) message_.people().push_back(to_message(track, now));
  people_.publish(message_);
  publish_frames();
  publish_ahead();
  report();
}

void Following::publish_frames() {
  if (!show_frames_ || published_ - framed_ < kFramesPeriod) return;
  frames_message_.transforms().clear();
  for (const Track& track : tracker_->people()) {
    if (frames_message_.transforms().size() == kMostFrames) break;
    if (!seen_lately(track, tracker_->now())) continue;
    const geometry::Pose2 place{track.state[0], track.state[1], 0.0};
    frames_message_.transforms().push_back(
        wire::transform(published_, frames::kOdom, frames::kPerson + std::to_string(track.id),
                        geometry::to_space(place)));
  }
  if (frames_message_.transforms().empty()) return;
  framed_ = published_;
  frames_.publish(frames_message_);
}

void Following::publish_ahead() {
  const auto person = person_ahead(tracker_->people(), tracker_->now(), motion_->odom_T_base,
                                   motion_->twist, ahead_);
  usher_msgs::msg::PersonAhead message;
  message.header(wire::header(published_, frames::kBaseFootprint));
  message.clear(!person && (looks(Source::kLaser) || looks(Source::kKinect)));
  message.distance(person ? static_cast<float>(person->distance)
                          : std::numeric_limits<float>::infinity());
  if (person) {
    message.bearing(static_cast<float>(person->bearing));
    message.closing_speed(static_cast<float>(person->closing_speed));
  }
  person_ahead_.publish(message);
}

void Following::report() {
  if (scan_.fresh() == nullptr) {
    host_.health().set(HealthState::kDegraded, "no scan");
  } else if (!refused_map_.empty()) {
    host_.health().set(HealthState::kDegraded, refused_map_);
  } else if (*legs_trouble_ != '\0') {
    host_.health().set(HealthState::kDegraded, legs_trouble_);
  } else if (std::string trouble = trouble_(); !trouble.empty()) {
    host_.health().set(HealthState::kDegraded, std::move(trouble));
  } else {
    host_.health().set(HealthState::kOk);
  }
}

}  // namespace usher::people_detector
