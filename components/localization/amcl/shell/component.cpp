#include "localization/amcl/shell/component.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "foundation/grid/fingerprint.hpp"
#include "localization/amcl/core/kept_pose.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::amcl {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kScanAge = milliseconds(500);
/// map -> odom changes slowly: it is valid until the next scan, and half as long again, so that
/// whoever looks at that scan sooner than the filter knows where it belongs.
constexpr auto kShortestLife = milliseconds(50);
constexpr auto kLongestLife = milliseconds(300);
constexpr const char* kPoseKey = "session.pose";  // a boot may find the robot elsewhere
constexpr double kOdometryContinues =
    3.0;  // [m] a longer way since the pose was kept is a restarted odometry
constexpr std::size_t kCloudSize = 500;

Eigen::Matrix3d spread(double position_sigma, double yaw_sigma) {
  return Eigen::Vector3d(position_sigma * position_sigma, position_sigma * position_sigma,
                         yaw_sigma * yaw_sigma)
      .asDiagonal();
}

}  // namespace

AmclConfig AmclComponent::read_parameters(runtime::Host& host) {
  auto& p = host.parameters();
  AmclConfig c;
  c.sensor_model = p.choice("sensor_model", {"likelihood_field", "beam"}, "likelihood_field",
                            "How a scan is compared with the map.") == "beam"
                       ? SensorModel::kBeam
                       : SensorModel::kLikelihoodField;
  const auto count = [&](const char* name, std::size_t& value, double low, double high,
                         const char* text) {
    value = static_cast<std::size_t>(
        p.integer(name, "-", {low, high}, static_cast<std::int64_t>(value), text));
  };
  count("max_beams", c.max_beams, 10, 1000, "Beams of a scan that are used.");
  count("min_particles", c.min_particles, 50, 100000, "Fewest particles.");
  count("max_particles", c.max_particles, 100, 100000, "Most particles while tracking.");
  count("global_particles", c.global_particles, 100, 200000, "Particles for a global start.");
  c.sensor.z_hit = p.number("z_hit", "-", {0, 1}, c.sensor.z_hit,
                            "Share of beams that end at the map's obstacles.");
  c.sensor.z_short =
      p.number("z_short", "-", {0, 1}, c.sensor.z_short, "Beam model: share that ends early.");
  c.sensor.z_max =
      p.number("z_max", "-", {0, 1}, c.sensor.z_max, "Beam model: share without return.");
  c.sensor.z_rand = p.number("z_rand", "-", {0, 1}, c.sensor.z_rand, "Share that ends anywhere.");
  c.sensor.sigma_hit =
      p.number("sigma_hit", "m", {0.005, 1}, c.sensor.sigma_hit, "Blur of an obstacle.");
  c.sensor.field_radius = p.number("field_radius", "m", {0.1, 10}, c.sensor.field_radius,
                                   "Likelihood field: farther ends count as random.");
  c.sensor.max_range = p.number("max_range", "m", {1, 100}, c.sensor.max_range,
                                "Readings from here on saw nothing.");
  c.noise.alpha1 =
      p.number("alpha1", "-", {0, 10}, c.noise.alpha1, "Rotation noise from rotation.");
  c.noise.alpha2 =
      p.number("alpha2", "-", {0, 10}, c.noise.alpha2, "Rotation noise from translation.");
  c.noise.alpha3 =
      p.number("alpha3", "-", {0, 10}, c.noise.alpha3, "Translation noise from translation.");
  c.noise.alpha4 =
      p.number("alpha4", "-", {0, 10}, c.noise.alpha4, "Translation noise from rotation.");
  c.update_distance =
      p.number("update_distance", "m", {0, 5}, c.update_distance, "Way between two updates.");
  c.update_angle =
      p.number("update_angle", "rad", {0, 3.2}, c.update_angle, "Turn between two updates.");
  c.recovery_slow = p.number("recovery_slow", "-", {0, 1}, c.recovery_slow,
                             "Decay of the long-term scan likelihood; 0 switches recovery off.");
  c.recovery_fast =
      p.number("recovery_fast", "-", {0, 1}, c.recovery_fast, "Decay of the short-term one.");
  count("refine_beams", c.refine_beams, 0, 1000,
        "Beams of the refinement of the estimate on the scan; 0 switches it off.");
  if (const auto status = c.validate(); !status) host.fault(status.error());
  return c;
}

AmclComponent::AmclComponent(runtime::Host& host)
    : host_(host),
      core_(read_parameters(host), host.random("amcl").next()),
      rejected_scans_(host.health().counter("scan: rejected")),
      rejected_odometry_(host.health().counter("odom: rejected")),
      odometry_leaps_(host.health().counter("odom: leaps")),
      rejected_maps_(host.health().counter("map: rejected")),
      rejected_poses_(host.health().counter("initialpose: rejected")),
      bad_beams_(host.health().counter("scan: beams without a number")),
      memory_(host, kPoseKey),
      transforms_(host) {
  auto& p = host.parameters();
  const auto start = p.numbers("site.initial_pose", "-", {-1e4, 1e4}, 3, 3, {0, 0, 0},
                               "Where the robot usually starts: x in m, y in m, yaw in rad.");
  const bool global = p.flag("start_globally", false,
                             "Start anywhere on the map instead of at the site's initial pose.");
  if (!global && start.size() == 3) site_pose_ = {start[0], start[1], start[2]};
  initial_position_sigma_ =
      p.number("initial_position_sigma", "m", {0.01, 10}, initial_position_sigma_,
               "How well the initial pose is known.");
  initial_yaw_sigma_ = p.number("initial_yaw_sigma", "rad", {0.01, 3.2}, initial_yaw_sigma_,
                                "The same for its yaw.");

  map_ =
      host.input(topics::kMap, {}, [this](const auto& message, const auto&) { take_map(message); });
  scan_ = host.input(
      topics::kScanFiltered, {.max_age = kScanAge, .on_loss = "reports lost: navigation stops"},
      [this](const auto&, const auto& info) { take_scan(scan_.share(), info.effective); },
      [this] { publish_status(); });
  initial_pose_ =
      host.input(topics::kInitialPose, {.optional = true},
                 [this](const auto& message, const auto&) { take_initial_pose(message); });
  transform_ = host.output(topics::kTf);
  pose_ = host.output(topics::kAmclPose);
  status_ = host.output(topics::kLocalizationStatus);
  cloud_ = host.output(topics::kParticleCloud);
  status_timer_ = host.timer("status", milliseconds(100), [this](auto) { publish_status(); });
  slow_timer_ = host.timer("keep", milliseconds(500), [this](auto) {
    keep();
    if (cloud_.reader_count() > 0) publish_cloud();
  });
}

void AmclComponent::take_map(const nav_msgs::msg::OccupancyGrid& message) {
  const auto map = wire::from_message(message);
  const Status status = map ? core_.set_map(*map) : Status(Error{map.error()});
  if (!status) {
    ++rejected_maps_;
    host_.health().set(HealthState::kDegraded, "map refused: " + status.error());
    return;
  }
  map_known_ = true;
  map_fingerprint_ = grid::fingerprint(*map);
}

void AmclComponent::take_initial_pose(
    const geometry_msgs::msg::PoseWithCovarianceStamped& message) {
  const auto pose = wire::to_planar(message.pose().pose());
  const auto covariance = wire::from_covariance(message.pose().covariance());
  if (!pose || !covariance || message.header().frame_id() != frames::kMap ||
      !core_.set_initial_pose(*pose, *covariance)) {
    ++rejected_poses_;
    return;
  }
  started_ = true;
}

/// From what was kept over a restart, else from the site's initial pose, else anywhere.
void AmclComponent::start(const geometry::Pose2& odom_T_base) {
  started_ = true;
  if (!memory_.found().empty()) {
    const auto kept = read_kept_pose(memory_.found(), map_fingerprint_);
    if (kept) {
      const geometry::Pose2& map = kept->map_T_base;
      const geometry::Pose2& odom = kept->odom_T_base;
      const bool continues = geometry::distance(odom, odom_T_base) < kOdometryContinues;
      const geometry::Pose2 pose = continues ? map * geometry::inverse(odom) * odom_T_base : map;
      if (core_.set_initial_pose(pose, spread(initial_position_sigma_, initial_yaw_sigma_))) return;
    } else {
      refused_memory_ = kept.error();
      ++host_.health().counter("pose: not taken up");
    }
  }
  if (site_pose_ &&
      core_.set_initial_pose(*site_pose_, spread(initial_position_sigma_, initial_yaw_sigma_)))
    return;
  core_.start_globally();
}

void AmclComponent::take_scan(std::shared_ptr<const sensor_msgs::msg::LaserScan> scan,
                              runtime::Time effective) {
  if (!wire::check(*scan)) {
    ++rejected_scans_;
    return;
  }
  const runtime::Time stamp = wire::from_message(scan->header().stamp());
  transforms_.when_known(frames::kOdom, frames::kBaseFootprint, stamp,
                         [this, scan = std::move(scan), stamp, effective](const auto& pose) {
                           update(*scan, stamp, effective, geometry::to_plane(pose));
                         });
}

void AmclComponent::update(const sensor_msgs::msg::LaserScan& scan, runtime::Time stamp,
                           runtime::Time effective, const geometry::Pose2& odom_T_base) {
  const auto base_T_laser =
      transforms_.lookup_planar(frames::kBaseFootprint, scan.header().frame_id(), stamp);
  if (!base_T_laser) {
    ++rejected_scans_;
    return;
  }
  if (!started_ && map_known_) start(odom_T_base);
  const LaserBeams beams{*base_T_laser,    scan.angle_min(), scan.angle_increment(),
                         scan.range_min(), scan.range_max(), scan.ranges()};
  // What moved the robot in a gap nobody counted: a base that rolled out, somebody who pushed.
  if (last_scan_ != runtime::Time{} && stamp - last_scan_ > kScanAge) {
    doubtful_ = true;
    core_.look_again();
  }
  const UpdateResult result = core_.update(odom_T_base, beams);
  bad_beams_ += result.beams.out_of_range;
  if (result.outcome == Outcome::kOdometryRejected) ++rejected_odometry_;
  if (result.odometry_restarted) ++odometry_leaps_;
  if (result.outcome == Outcome::kScanRejected) ++rejected_scans_;
  if (result.outcome != Outcome::kOdometryRejected && result.outcome != Outcome::kScanRejected) {
    if (last_scan_ != runtime::Time{}) scan_interval_ = stamp - last_scan_;
    last_scan_ = stamp;
    last_used_ = effective;
  }
  if (result.outcome == Outcome::kUpdated &&
      core_.estimate()->quality.confidence == Confidence::kGood)
    doubtful_ = false;
  if (!core_.estimate() || last_scan_ != stamp) return;
  publish_transform(stamp);
  if (result.outcome == Outcome::kUpdated) {
    publish_pose(stamp);
    publish_status();
  }
}

void AmclComponent::publish_transform(runtime::Time stamp) {
  const auto life =
      std::clamp<runtime::Duration>(scan_interval_ * 3 / 2, kShortestLife, kLongestLife);
  // Never earlier than before: readers refuse that.
  valid_until_ = std::max(valid_until_ + std::chrono::nanoseconds(1), stamp + life);
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(
      wire::transform(valid_until_, frames::kMap, frames::kOdom,
                      geometry::to_space(core_.estimate()->map_T_odom())));
  transform_.publish(message);
}

void AmclComponent::publish_pose(runtime::Time stamp) {
  geometry_msgs::msg::PoseWithCovarianceStamped message;
  message.header(wire::header(stamp, frames::kMap));
  message.pose().pose(wire::to_message(core_.estimate()->map_T_base));
  message.pose().covariance(wire::to_covariance(core_.estimate()->covariance));
  pose_.publish(message);
}

void AmclComponent::publish_status() {
  usher_msgs::msg::LocalizationStatus message;
  message.header(wire::header(last_used_, frames::kMap));  // readers age it
  message.particles(static_cast<std::uint32_t>(core_.particles().size()));
  std::string reason;
  Confidence confidence = Confidence::kLost;
  if (const auto& estimate = core_.estimate()) {
    confidence = estimate->quality.confidence;
    const Eigen::Matrix2d position = estimate->covariance.topLeftCorner<2, 2>();
    const double largest =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(position, Eigen::EigenvaluesOnly)
            .eigenvalues()(1);
    message.position_deviation(static_cast<float>(std::sqrt(std::max(largest, 0.0))));
    message.yaw_deviation(static_cast<float>(std::sqrt(std::max(estimate->covariance(2, 2), 0.0))));
    message.explained(static_cast<float>(estimate->quality.explained));
    if (confidence != Confidence::kGood) {
      reason = "the map explains " +
               std::to_string(static_cast<int>(100.0 * estimate->quality.explained)) +
               " % of the scan";
    }
    if (doubtful_) {
      confidence = Confidence::kLost;
      reason = "scans or their places were missing" + (reason.empty() ? "" : "; " + reason);
    }
  } else {
    reason = map_known_ ? "no pose yet" : "no map";
  }
  // Scans that come but say nothing, or whose place is not known, are none.
  if (!scan_.fresh() || host_.now() - last_used_ > kScanAge) {
    confidence = Confidence::kLost;
    reason = scan_.fresh() ? "no scan that can be used" : "no scan";
  }
  if (!refused_memory_.empty()) reason += (reason.empty() ? "" : "; ") + refused_memory_;
  message.state(static_cast<std::uint8_t>(confidence));
  message.reason(reason);
  status_.publish(message);
  host_.health().set(confidence == Confidence::kGood ? HealthState::kOk : HealthState::kDegraded,
                     reason);
}

void AmclComponent::publish_cloud() {
  geometry_msgs::msg::PoseArray message;
  message.header(wire::header(last_scan_, frames::kMap));
  const std::size_t count = core_.particles().size();
  const std::size_t step = std::max<std::size_t>(1, count / kCloudSize);
  for (std::size_t i = 0; i < count; i += step)
    message.poses().push_back(wire::to_message(core_.particles().pose(i)));
  cloud_.publish(message);
}

void AmclComponent::keep() {
  const auto& estimate = core_.estimate();
  if (!estimate || doubtful_ || estimate->quality.confidence != Confidence::kGood) return;
  refused_memory_.clear();
  // A robot that cannot write its disk still localizes; it only starts at the site's pose the next
  // time.
  memory_.keep(to_text({map_fingerprint_, estimate->map_T_base, estimate->odom_T_base}));
}

}  // namespace usher::amcl
