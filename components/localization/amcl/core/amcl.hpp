#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/cpu/cpu.hpp"
#include "foundation/estimation/gaussian_pose.hpp"
#include "foundation/estimation/pose_histogram.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/random/random.hpp"
#include "foundation/result/result.hpp"
#include "localization/amcl/core/amcl_config.hpp"
#include "localization/amcl/core/laser_beams.hpp"
#include "localization/amcl/core/likelihood_field.hpp"
#include "localization/amcl/core/particles.hpp"

namespace usher::amcl {

/// Whether the rest of the robot may believe a pose.
enum class Confidence {
  kLost,      ///< no pose, or the scan contradicts it
  kDegraded,  ///< several places are possible, the position is vague, or much of the scan is
              ///< unexplained (a crowd)
  kGood,
};

/// How well the estimate explains the last scan; ConfidenceLimits turn it into a level. Beams that
/// met something unmapped count in `unmapped` alone.
struct Quality {
  double explained = 0.0;       ///< [0, 1] share of the beams that end at an obstacle of the map
  double likelihood = 0.0;      ///< [0, 1] mean likelihood of a beam
  double unmapped = 0.0;        ///< [0, 1] share of beams that ended before the map's walls: people
  std::size_t beams = 0;        ///< how many beams were looked at
  double cluster_weight = 0.0;  ///< [0, 1] share of the belief in the estimate's cluster
  double sigma = 0.0;  ///< [m] largest standard deviation of the position within the cluster
  Confidence confidence = Confidence::kLost;
};

struct Estimate {
  geometry::Pose2 map_T_base;   ///< mean of the heaviest cluster, refined on the scan
  geometry::Pose2 odom_T_base;  ///< odometry of the same moment
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of the cluster: x, y [m], yaw [rad]
  Quality quality;

  /// The correction of the odometry, valid until the next estimate.
  geometry::Pose2 map_T_odom() const { return map_T_base * inverse(odom_T_base); }
};

enum class Outcome {
  kUpdated,           ///< motion and scan went into the belief, there is a new estimate
  kNotMoved,          ///< less than update_distance and update_angle since the last update
  kNoMap,             ///< set_map() first
  kNoPose,            ///< set_initial_pose() or start_globally() first
  kOdometryRejected,  ///< not finite: nothing was changed
  kScanRejected,  ///< not finite in its geometry, or without beams to use: the motion was applied,
                  ///< no estimate made
};

struct UpdateResult {
  Outcome outcome = Outcome::kNoMap;
  bool resampled = false;
  bool odometry_restarted =
      false;  ///< the step was longer than max_step: taken as a restart, the belief stayed put
  double injected = 0.0;  ///< [0, 1] share of new hypotheses drawn to recover
  BeamCounts beams;
};

/// Adaptive Monte-Carlo localization [thrun2005, chapter 8]: particles moved by odometry, weighted
/// by the scan (likelihood field or beam model), resampled with low variance, their number adapted
/// to the spread of the belief [fox2003kld]. The published pose is the mean of the heaviest cluster
/// of particles, refined on the scan by a few Gauss-Newton steps; every fifth particle of that
/// cluster follows the refinement.
///
/// People: where the robot is known to be, beams that end well before the map's wall met something
/// unmapped and are left out [fox1999dynamic]; a crowd around the robot does not push its pose
/// away.
///
/// Recovery: the likelihood of scans has a short-term and a long-term mean (augmented MCL). When
/// the short one falls well below the long one [gutmann2002], or at a global start, a search
/// begins: each scan counts for little, so that several places live on, and random poses of the
/// free space are tried against it; the best of them, refined, join the particles, until one place
/// has stood several scans. After a single scan that fits badly, the same is done with poses near
/// the estimate: wheels slip, and some odometries count backwards driving as forwards.
///
/// Deterministic: the same seed and inputs give the same estimates on every instruction set. No
/// allocation in update() once its buffers have grown.
class Amcl {
 public:
  /// The configuration must be valid (AmclConfig::validate()).
  Amcl(const AmclConfig& config, std::uint64_t seed, cpu::Simd simd = cpu::best_simd());

  /// Takes a map; an estimate and the particles stay, since maps are exchanged under a running
  /// robot. Refuses a map without cells, without free or without occupied ones.
  Status set_map(const grid::OccupancyGrid& map);

  /// Starts (again) from a pose with an uncertainty; refuses what GaussianPose::make() refuses. The
  /// next update counts whatever the robot moved.
  Status set_initial_pose(const geometry::Pose2& map_T_base, const Eigen::Matrix3d& covariance);

  /// After a time in which the odometry counted nothing: the next scan counts whatever it says that
  /// the robot moved, and no beam is taken for somebody's until the estimate is good, or scans have
  /// not made it so for a while.
  void look_again();

  /// Starts (again) knowing only that the robot stands in the map's free space.
  void start_globally();

  /// Brings in the odometry's pose at the time of a scan, and the scan. Bad input changes nothing
  /// but what Outcome says. With particles spread over the whole map this costs milliseconds, while
  /// tracking some ten microseconds.
  UpdateResult update(const geometry::Pose2& odom_T_base, const LaserBeams& scan);

  /// The newest estimate: of the last kUpdated, or the initial pose before the first. Nothing
  /// before a start, or while a global start waits for its first scan.
  const std::optional<Estimate>& estimate() const { return estimate_; }
  const Particles& particles() const { return particles_; }
  const AmclConfig& config() const { return config_; }

 private:
  struct Cluster {
    geometry::Pose2 mean;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    double weight = 0.0;       // share of the belief
    std::uint32_t number = 0;  // of the histogram
  };

  /// New hypotheses to draw: where, and what share of the particles.
  struct Recovery {
    enum class Where { kNowhere, kNearby, kEverywhere } where = Where::kNowhere;
    double share = 0.0;
  };

  bool due(const geometry::Pose2& base0_T_base1);
  void spread_over_free_space(const LaserBeams& scan);
  geometry::Pose2 random_free_pose();
  geometry::Pose2 random_nearby_pose();
  double drop_unmapped(const LaserBeams& scan, const geometry::Pose2& odom_T_base);
  bool fits(const geometry::Pose2& map_T_base) const;
  void scan_likelihood(const LaserBeams& scan, const Particles& particles);
  double weigh(Particles& particles, double evidence) const;
  void end_search(const Cluster& cluster);
  Recovery recovery(double likelihood);
  void find_bins();
  Cluster heaviest_cluster();
  void resample(const LaserBeams& scan, const Recovery& recovery, const Cluster& cluster);
  std::size_t adapted_count();
  void search(const LaserBeams& scan, const Recovery& recovery, std::size_t count);
  void make_estimate(const Cluster& cluster, const geometry::Pose2& odom_T_base, double unmapped);
  Quality quality_of(const geometry::Pose2& pose, const Cluster& cluster, double unmapped) const;
  Confidence confidence_of(const Quality& quality) const;

  AmclConfig config_;
  cpu::Simd simd_;
  Random random_;
  grid::GridGeometry map_;
  std::vector<std::uint32_t> free_cells_;
  LikelihoodField field_;

  Particles particles_, next_, candidates_;
  std::vector<double> log_likelihood_;
  std::vector<Beam> beams_, dense_beams_, kept_beams_, kept_dense_beams_;
  estimation::PoseHistogram histogram_;
  std::vector<std::uint32_t> bin_;  // of each particle
  std::vector<std::uint32_t> picked_, order_;
  std::vector<double> cluster_weight_;
  std::vector<std::uint8_t> bin_used_;

  std::optional<geometry::Pose2> last_odom_T_base_;
  bool force_update_ = true;
  bool spread_pending_ = false;  // a global start waits for its map or first scan
  int search_updates_ = 0;       // since a search over the whole map began; 0 without one
  int doubting_updates_ = 0;     // left in which no beam is taken for somebody's
  int updates_since_resampling_ = 0;
  int idle_scans_ = 0;                                    // since the last update, while lost
  double slow_likelihood_ = 0.0, fast_likelihood_ = 0.0;  // 0: none yet
  double unmapped_lately_ = 0.0;                          ///< [0, 1] share of beams
  double range_offset_ = 0.0;  ///< [m] that all beams are too short by, learnt while tracking
  std::optional<Estimate> estimate_;
};

}  // namespace usher::amcl
