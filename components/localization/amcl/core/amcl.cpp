#include "localization/amcl/core/amcl.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <numeric>

#include "foundation/estimation/pose_statistics.hpp"
#include "foundation/estimation/resampling.hpp"
#include "localization/amcl/core/beam_model.hpp"

namespace usher::amcl {
namespace {

constexpr double kSearchShare = 0.1;  // of hypotheses among the particles during a global start
constexpr double kSearchEvidence =
    2.0;  // independent beams then: several places shall live on for a while
constexpr double kWonWeight = 0.95;     // the cluster of this share ends a search ...
constexpr int kLeastSearch = 10;        // ... after so many updates
constexpr std::size_t kLeastBeams = 5;  // fewer tell nothing about a pose

// Beams that end this much [m] before the map's wall, seen from where the robot must be, met
// something unmapped and tell nothing about the place. When most beams do and the others do not fit
// either, or for long, the place is wrong, not the map.
constexpr double kUnmappedMargin = 0.5;
constexpr double kMostUnmapped = 0.6;
constexpr double kUnmappedGain = 0.05;  // of the share lately, in an update
// Updates after a gap that leave out no beam: those that tell of a wrong place would look unmapped.
constexpr int kDoubtingUpdates = 10;

// Recovery: how far the scan likelihood falls below its long-term mean before hypotheses are drawn.
constexpr double kLostRatio = 0.6;  // the short-term mean, anywhere on the map [gutmann2002]
constexpr double kUsualLikelihood =
    0.6;  // of a beam at the right place, where the long-term mean starts
constexpr double kDoubtRatio = 0.7;   // one scan, near the estimate
constexpr double kNearbyShare = 0.2;  // of hypotheses among the particles then
constexpr double kNearbySigma =
    0.5;  // [m] wheels that slipped, or counted backwards, between two updates
constexpr double kNearbyYawSigma = 0.2;  // [rad]
constexpr std::size_t kNearbyCandidates = 1000;
constexpr double kRangeOffsetGain =
    0.1;  // of what one scan says; the systematic error changes slowly if at all
constexpr double kMostRangeOffset = 0.08;  // [m] LMS100: 30 mm, and half a cell
constexpr int kIdleScans = 10;  // without motion, between two updates of a robot that is unsure
constexpr std::size_t kGuidedEvery = 5;  // particles that follow the refinement of the estimate

bool finite(const LaserBeams& scan) {
  return scan.base_T_laser.finite() && std::isfinite(scan.angle_min) &&
         std::isfinite(scan.angle_increment) && !std::isnan(scan.range_min) && scan.range_max > 0.0;
}

std::size_t most_particles(const AmclConfig& config) {
  return std::max(config.max_particles, config.global_particles);
}

}  // namespace

Amcl::Amcl(const AmclConfig& config, std::uint64_t seed, cpu::Simd simd)
    : config_(config),
      simd_(simd),
      random_(seed),
      histogram_(config.bin_position, config.bin_yaw, most_particles(config)) {
  assert(config.validate().ok());
  const std::size_t most = most_particles(config);
  for (Particles* particles : {&particles_, &next_}) particles->reserve(most);
  candidates_.reserve(std::max(config.search_candidates, kNearbyCandidates));
  log_likelihood_.reserve(std::max({most, config.search_candidates, kNearbyCandidates}));
  for (auto* indices : {&bin_, &picked_}) indices->reserve(most);
  beams_.reserve(config.max_beams);
  kept_beams_.reserve(config.max_beams);
  for (auto* dense : {&dense_beams_, &kept_dense_beams_}) {
    dense->reserve(std::max<std::size_t>(config.refine_beams, 2));
  }
}

Status Amcl::set_map(const grid::OccupancyGrid& map) {
  std::vector<std::uint32_t> free_cells;
  bool occupied = false;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] == grid::kFree) free_cells.push_back(static_cast<std::uint32_t>(i));
    occupied = occupied || map[i] == grid::kOccupied;
  }
  if (free_cells.empty()) return Error{"a map for localization needs free cells (0), found none"};
  if (!occupied) return Error{"a map for localization needs occupied cells (100), found none"};
  map_ = map.geometry();
  free_cells_ = std::move(free_cells);
  field_.build(map, config_.sensor, simd_);
  force_update_ = true;
  return {};
}

Status Amcl::set_initial_pose(const geometry::Pose2& map_T_base,
                              const Eigen::Matrix3d& covariance) {
  const auto gaussian = estimation::GaussianPose::make(map_T_base, covariance);
  if (!gaussian) return Error{"initial pose: " + gaussian.error()};
  const std::size_t count = config_.max_particles;
  particles_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    particles_.set(i, gaussian->sample(random_), 1.0 / static_cast<double>(count));
  }
  spread_pending_ = false;
  search_updates_ = 0;
  force_update_ = true;
  fast_likelihood_ = 0.0;
  unmapped_lately_ = 0.0;
  estimate_ = Estimate{map_T_base, last_odom_T_base_.value_or(geometry::Pose2{}), covariance, {}};
  return {};
}

void Amcl::start_globally() {
  particles_.resize(0);
  spread_pending_ = force_update_ = true;
  fast_likelihood_ = 0.0;
  estimate_.reset();
}

void Amcl::look_again() {
  force_update_ = true;
  doubting_updates_ = kDoubtingUpdates;
}

geometry::Pose2 Amcl::random_free_pose() {
  const grid::Cell cell = map_.cell(free_cells_[random_.below(free_cells_.size())]);
  const double x = map_.origin_x + (cell.x + random_.uniform()) * map_.resolution;
  const double y = map_.origin_y + (cell.y + random_.uniform()) * map_.resolution;
  return {x, y, random_.uniform(-geometry::kPi, geometry::kPi)};
}

geometry::Pose2 Amcl::random_nearby_pose() {
  const geometry::Pose2& center = estimate_->map_T_base;
  const double x = random_.gaussian(center.x, kNearbySigma);
  const double y = random_.gaussian(center.y, kNearbySigma);
  return {x, y, geometry::normalized(random_.gaussian(center.yaw, kNearbyYawSigma))};
}

/// A global start: many random poses, thinned to the most particles by what the first scan says of
/// them.
void Amcl::spread_over_free_space(const LaserBeams& scan) {
  next_.resize(config_.global_particles);
  for (std::size_t i = 0; i < next_.size(); ++i) next_.set(i, random_free_pose(), 1.0);
  scan_likelihood(scan, next_);
  weigh(next_, kSearchEvidence);
  picked_.resize(std::min(config_.max_particles, config_.global_particles));
  estimation::low_variance_resample(next_.weight, random_.uniform(), picked_);
  particles_.resize(picked_.size());
  const double weight = 1.0 / static_cast<double>(picked_.size());
  for (std::size_t i = 0; i < picked_.size(); ++i)
    particles_.set(i, next_.pose(picked_[i]), weight);
  spread_pending_ = false;
  search_updates_ = 1;
}

bool Amcl::due(const geometry::Pose2& base0_T_base1) {
  // A robot that does not know well where it is may stand still: it looks on all the same.
  const bool unsure =
      search_updates_ > 0 || (estimate_ && estimate_->quality.confidence != Confidence::kGood);
  if (unsure && ++idle_scans_ >= kIdleScans) return true;
  return force_update_ || std::hypot(base0_T_base1.x, base0_T_base1.y) >= config_.update_distance ||
         std::abs(base0_T_base1.yaw) >= config_.update_angle;
}

UpdateResult Amcl::update(const geometry::Pose2& odom_T_base, const LaserBeams& scan) {
  UpdateResult result;
  if (field_.empty()) return result;
  result.outcome = Outcome::kNoPose;
  if (particles_.size() == 0 && !spread_pending_) return result;
  result.outcome = Outcome::kOdometryRejected;
  if (!odom_T_base.finite()) return result;

  geometry::Pose2 step =
      last_odom_T_base_ ? inverse(*last_odom_T_base_) * odom_T_base : geometry::Pose2{};
  result.odometry_restarted = std::hypot(step.x, step.y) > config_.max_step;
  if (result.odometry_restarted) {
    step = {};
    force_update_ = true;
  }
  result.outcome = Outcome::kNotMoved;
  if (!due(step)) return result;

  move(particles_, step, config_.noise, random_);
  last_odom_T_base_ = odom_T_base;
  result.outcome = Outcome::kScanRejected;
  if (!finite(scan)) return result;
  result.beams = choose_beams(scan, config_.max_beams, config_.sensor.max_range,
                              config_.sensor_model == SensorModel::kBeam, beams_);
  if (beams_.size() < kLeastBeams) return result;
  choose_beams(scan, std::max<std::size_t>(config_.refine_beams, 2), config_.sensor.max_range,
               false, dense_beams_);

  const bool tracks = estimate_ && search_updates_ == 0 && doubting_updates_ == 0;
  const double unmapped =
      tracks && !result.odometry_restarted ? drop_unmapped(scan, odom_T_base) : 0.0;
  if (spread_pending_) spread_over_free_space(scan);
  scan_likelihood(scan, particles_);
  const double log_likelihood =
      weigh(particles_, search_updates_ > 0 ? kSearchEvidence : config_.independent_beams);
  find_bins();
  const Cluster cluster = heaviest_cluster();
  make_estimate(cluster, odom_T_base, unmapped);
  end_search(cluster);
  const Recovery recovery = this->recovery(std::exp(log_likelihood) * (1.0 - unmapped_lately_));
  result.injected = recovery.share;
  if (++updates_since_resampling_ >= config_.resample_interval || recovery.share > 0.0) {
    resample(scan, recovery, cluster);
    result.resampled = true;
    updates_since_resampling_ = 0;
  }
  const bool good = estimate_->quality.confidence == Confidence::kGood;
  doubting_updates_ = good ? 0 : std::max(0, doubting_updates_ - 1);
  force_update_ = false;
  idle_scans_ = 0;
  result.outcome = Outcome::kUpdated;
  return result;
}

/// Takes beams out of both sets that met people or moved furniture [fox1999dynamic]; returns their
/// share. Somebody close before the robot may leave few: when those fit, it stands where it
/// believes. Leaves all when that is not so, or they were most of the beams for long.
double Amcl::drop_unmapped(const LaserBeams& scan, const geometry::Pose2& odom_T_base) {
  const geometry::Pose2 map_T_base = estimate_->map_T_odom() * odom_T_base;
  const geometry::Point2 laser = (map_T_base * scan.base_T_laser).position();
  const auto mapped = [&](const Beam& beam) {
    const auto wall = field_.distances().cast_ray(laser, map_T_base.yaw + beam.angle,
                                                  beam.range + kUnmappedMargin);
    return wall.has_value();
  };
  kept_dense_beams_.clear();
  std::copy_if(dense_beams_.begin(), dense_beams_.end(), std::back_inserter(kept_dense_beams_),
               mapped);
  const double share = 1.0 - static_cast<double>(kept_dense_beams_.size()) /
                                 static_cast<double>(dense_beams_.size());
  unmapped_lately_ += kUnmappedGain * (share - unmapped_lately_);
  if (share > kMostUnmapped && (unmapped_lately_ > kMostUnmapped || !fits(map_T_base))) return 0.0;
  kept_beams_.clear();
  std::copy_if(beams_.begin(), beams_.end(), std::back_inserter(kept_beams_), mapped);
  if (kept_beams_.size() < kLeastBeams) return 0.0;
  std::swap(dense_beams_, kept_dense_beams_);
  std::swap(beams_, kept_beams_);
  return share;
}

/// Whether the beams that are kept end at the map's walls; few of them tell nothing.
bool Amcl::fits(const geometry::Pose2& map_T_base) const {
  const auto explained =
      std::count_if(kept_dense_beams_.begin(), kept_dense_beams_.end(), [&](const Beam& beam) {
        const geometry::Point2 end = map_T_base * geometry::Point2(beam.x, beam.y);
        return field_.distances().interpolated(end).distance <
               config_.confidence.explained_distance;
      });
  return kept_dense_beams_.size() >= kLeastBeams &&
         static_cast<double>(explained) >=
             config_.confidence.good_explained * static_cast<double>(kept_dense_beams_.size());
}

void Amcl::scan_likelihood(const LaserBeams& scan, const Particles& particles) {
  log_likelihood_.resize(particles.size());
  if (config_.sensor_model == SensorModel::kLikelihoodField) {
    field_.log_likelihood(particles, beams_, log_likelihood_, simd_);
  } else {
    const double max_range = std::min(config_.sensor.max_range, scan.range_max);
    beam_model_log_likelihood(field_.distances(), config_.sensor, max_range, particles,
                              scan.base_T_laser, beams_, log_likelihood_);
  }
}

/// Multiplies the weights with the likelihood of the scan as `evidence` independent beams and
/// normalizes them; returns how well the belief then explains a beam, its mean log likelihood.
double Amcl::weigh(Particles& particles, double evidence) const {
  const double exponent = std::min(static_cast<double>(beams_.size()), evidence);
  const double best = *std::max_element(log_likelihood_.begin(), log_likelihood_.end());
  double total = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles.weight[i] *= std::exp(exponent * (log_likelihood_[i] - best));
    total += particles.weight[i];
  }
  double mean = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles.weight[i] /= total;
    mean += particles.weight[i] * log_likelihood_[i];
  }
  return mean;
}

/// A search ends with one place that has stood several scans and explains what is seen.
void Amcl::end_search(const Cluster& cluster) {
  if (search_updates_ == 0) return;
  const bool won = search_updates_ >= kLeastSearch && cluster.weight >= kWonWeight &&
                   estimate_->quality.explained >= config_.confidence.good_explained;
  search_updates_ = won ? 0 : search_updates_ + 1;
  fast_likelihood_ = unmapped_lately_ = 0.0;
  estimate_->quality.confidence = confidence_of(estimate_->quality);
}

/// Augmented MCL [thrun2005, table 8.3], with a search nearby as soon as a scan fits badly.
Amcl::Recovery Amcl::recovery(double likelihood) {
  if (search_updates_ > 0) return {Recovery::Where::kEverywhere, kSearchShare};
  if (config_.recovery_slow <= 0.0) return {};
  if (fast_likelihood_ <= 0.0) {
    slow_likelihood_ = std::max(kUsualLikelihood, likelihood);
    fast_likelihood_ = likelihood;
  }
  slow_likelihood_ += config_.recovery_slow * (likelihood - slow_likelihood_);
  fast_likelihood_ += config_.recovery_fast * (likelihood - fast_likelihood_);
  const double share = 1.0 - fast_likelihood_ / (kLostRatio * slow_likelihood_);
  if (share > 0.0) {
    search_updates_ = 1;
    return {Recovery::Where::kEverywhere, kSearchShare};
  }
  if (likelihood < kDoubtRatio * slow_likelihood_) return {Recovery::Where::kNearby, kNearbyShare};
  return {};
}

void Amcl::find_bins() {
  histogram_.clear();
  bin_.resize(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) bin_[i] = histogram_.add(particles_.pose(i));
}

Amcl::Cluster Amcl::heaviest_cluster() {
  const auto cluster_of = histogram_.clusters();
  cluster_weight_.assign(histogram_.cluster_count(), 0.0);
  for (std::size_t i = 0; i < particles_.size(); ++i)
    cluster_weight_[cluster_of[bin_[i]]] += particles_.weight[i];
  const auto best = static_cast<std::size_t>(
      std::max_element(cluster_weight_.begin(), cluster_weight_.end()) - cluster_weight_.begin());
  const auto statistics = estimation::pose_statistics(
      particles_.size(), [&](std::size_t i) { return particles_.pose(i); },
      [&](std::size_t i) { return cluster_of[bin_[i]] == best ? particles_.weight[i] : 0.0; });
  return {statistics.mean, statistics.covariance, cluster_weight_[best],
          static_cast<std::uint32_t>(best)};
}

void Amcl::make_estimate(const Cluster& cluster, const geometry::Pose2& odom_T_base,
                         double unmapped) {
  geometry::Pose2 pose = cluster.mean;
  if (config_.refine_beams > 0) {
    // A floor of a millimetre keeps the prior finite when all particles agree.
    const Eigen::Matrix3d prior =
        (cluster.covariance + 1e-6 * Eigen::Matrix3d::Identity()).inverse();
    for (Beam& beam : dense_beams_) {
      beam.x += range_offset_ * beam.direction_x;
      beam.y += range_offset_ * beam.direction_y;
    }
    pose = refine(field_.distances(), dense_beams_, pose, prior, config_.refinement).pose;
  }
  estimate_ = Estimate{pose, odom_T_base, cluster.covariance, quality_of(pose, cluster, unmapped)};
  if (config_.refine_beams > 0 && estimate_->quality.confidence == Confidence::kGood) {
    const double step =
        range_offset(field_.distances(), dense_beams_, pose, config_.refinement.sigma);
    range_offset_ = std::clamp(range_offset_ + kRangeOffsetGain * std::clamp(step, -0.02, 0.02),
                               -kMostRangeOffset, kMostRangeOffset);
  }
}

Quality Amcl::quality_of(const geometry::Pose2& pose, const Cluster& cluster,
                         double unmapped) const {
  Quality quality;
  for (const Beam& beam : dense_beams_) {
    const double distance =
        field_.distances().interpolated(pose * geometry::Point2(beam.x, beam.y)).distance;
    quality.explained += distance < config_.confidence.explained_distance ? 1.0 : 0.0;
    quality.likelihood += field_.beam_likelihood(distance);
  }
  quality.beams = dense_beams_.size();
  const double share = quality.beams > 0 ? 1.0 / static_cast<double>(quality.beams) : 0.0;
  quality.explained *= share;
  quality.likelihood *= share;
  quality.unmapped = unmapped;
  quality.cluster_weight = cluster.weight;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(
      cluster.covariance.topLeftCorner<2, 2>(), Eigen::EigenvaluesOnly);
  quality.sigma = std::sqrt(std::max(0.0, axes.eigenvalues().maxCoeff()));
  quality.confidence = confidence_of(quality);
  return quality;
}

Confidence Amcl::confidence_of(const Quality& quality) const {
  const ConfidenceLimits& limits = config_.confidence;
  if (quality.explained < limits.lost_explained) return Confidence::kLost;
  const bool good =
      search_updates_ == 0 && quality.beams >= limits.good_beams &&
      quality.explained >= limits.good_explained && quality.unmapped <= limits.good_unmapped &&
      quality.cluster_weight >= limits.good_weight && quality.sigma <= limits.good_sigma;
  return good ? Confidence::kGood : Confidence::kDegraded;
}

/// KLD: as many particles as the bins that the belief really occupies ask for. They are counted on
/// a resampling of the present size, since bins with particles of no weight do not count.
std::size_t Amcl::adapted_count() {
  picked_.resize(std::min(particles_.size(), config_.max_particles));
  estimation::low_variance_resample(particles_.weight, random_.uniform(), picked_);
  bin_used_.assign(histogram_.bins(), 0);
  for (const std::uint32_t i : picked_) bin_used_[bin_[i]] = 1;
  const auto bins =
      static_cast<std::size_t>(std::accumulate(bin_used_.begin(), bin_used_.end(), std::size_t{0}));
  const double bound =
      estimation::kld_sample_bound(bins, config_.kld_epsilon, config_.kld_quantile);
  return std::clamp(static_cast<std::size_t>(bound), config_.min_particles, config_.max_particles);
}

void Amcl::resample(const LaserBeams& scan, const Recovery& recovery, const Cluster& cluster) {
  const std::size_t count = adapted_count();
  const auto injected =
      std::min<std::size_t>(config_.search_hypotheses,
                            static_cast<std::size_t>(recovery.share * static_cast<double>(count)));
  picked_.resize(count - injected);
  estimation::low_variance_resample(particles_.weight, random_.uniform(), picked_);
  next_.resize(count);
  const double weight = 1.0 / static_cast<double>(count);
  const geometry::Pose2 refinement = estimate_->map_T_base * inverse(cluster.mean);
  const auto cluster_of = histogram_.clusters();
  for (std::size_t i = 0; i < picked_.size(); ++i) {
    const std::uint32_t from = picked_[i];
    const bool guided = i % kGuidedEvery == 0 && cluster_of[bin_[from]] == cluster.number;
    next_.set(i, guided ? refinement * particles_.pose(from) : particles_.pose(from), weight);
  }
  if (injected > 0) {
    search(scan, recovery, injected);
    for (std::size_t i = 0; i < injected; ++i)
      next_.set(picked_.size() + i, candidates_.pose(order_[i]), weight);
  }
  std::swap(particles_, next_);
}

/// Tries random poses against the scan and leaves the best `count`, refined, as
/// candidates_[order_[0 .. count - 1]].
void Amcl::search(const LaserBeams& scan, const Recovery& recovery, std::size_t count) {
  const bool nearby = recovery.where == Recovery::Where::kNearby;
  candidates_.resize(nearby ? kNearbyCandidates : config_.search_candidates);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    candidates_.set(i, nearby ? random_nearby_pose() : random_free_pose(), 1.0);
  }
  scan_likelihood(scan, candidates_);
  order_.resize(candidates_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  const auto better = [&](std::uint32_t a, std::uint32_t b) {
    return log_likelihood_[a] != log_likelihood_[b] ? log_likelihood_[a] > log_likelihood_[b]
                                                    : a < b;
  };
  std::partial_sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(count),
                    order_.end(), better);
  RefinementParameters wide = config_.refinement;
  wide.sigma = std::max(wide.sigma, config_.sensor.sigma_hit);
  wide.max_shift = nearby ? kNearbySigma : config_.sensor.field_radius;
  wide.max_turn = 0.5;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = order_[k];
    const auto refined =
        refine(field_.distances(), beams_, candidates_.pose(i), Eigen::Matrix3d::Zero(), wide);
    candidates_.set(i, refined.pose, 1.0);
  }
}

}  // namespace usher::amcl
