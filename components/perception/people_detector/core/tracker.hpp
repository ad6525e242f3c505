#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/imaging/appearance.hpp"
#include "perception/people_detector/core/assignment.hpp"

namespace usher::people_detector {

enum class Source : std::uint8_t { kKinect = 0, kRearCamera = 1, kLaser = 2, kFace = 3 };
inline constexpr std::size_t kSources = 4;

/// One person as one sensor saw it, in odom.
struct Observation {
  geometry::Point2 position = geometry::Point2::Zero();               ///< [m]
  Eigen::Matrix2d covariance = 0.0064 * Eigen::Matrix2d::Identity();  ///< [m^2] of the position
  double height = 0.0;             ///< [m] of the highest point; 0: not known
  imaging::Appearance appearance;  ///< only a camera with a color image knows it
  bool head_hidden = false;        ///< who is seen is at least so high
};

/// The covariance of a position that is `along` uncertain on the line of sight, at `bearing` [rad],
/// and `across` beside it; both are standard deviations [m].
Eigen::Matrix2d covariance_along(double bearing, double along, double across);

struct Track {
  std::uint64_t id = 0;                             ///< from 1 on, never given again
  Eigen::Vector4d state = Eigen::Vector4d::Zero();  ///< x, y [m], vx, vy [m/s] in odom
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();
  double height = 0.0;                  ///< [m] 0: not known
  int heights = 0;                      ///< {0..10} sightings behind it
  double at_least = 0.0;                ///< [m] highest point while the head was hidden
  double born = 0.0;                    ///< [s]
  std::array<double, kSources> seen{};  ///< [s] last time by each source; -infinity: never
  geometry::Point2 birthplace = geometry::Point2::Zero();
  double walked = 0.0;  ///< [s] when it got there
  int sightings = 0;
  bool confirmed = false;
  imaging::Appearances appearances;  ///< as Kinect and rear camera showed them lately
  bool fresh = false;                ///< not confirmed yet: may be somebody who was hidden

  geometry::Point2 position() const { return state.head<2>(); }
  geometry::Point2 velocity() const { return state.tail<2>(); }
  double last_seen() const { return *std::max_element(seen.begin(), seen.end()); }
};

struct TrackerConfig {
  double acceleration = 0.9;   ///< [m/s^1.5] {0.1..5} density of the random acceleration
  double gate = 13.8;          ///< [-] {1..50} largest squared Mahalanobis distance (99.9 %)
  double reach = 0.7;          ///< [m] {0.2..3} and largest distance
  double height_sigma = 0.05;  ///< [m] {0.02..1} by which heights of one person differ
  int confirmations = 4;       ///< {1..30} sightings by a camera until somebody is believed
  double travel = 0.5;         ///< [m] {0..3} that legs must go, seen by the laser alone
  double stands = 20.0;        ///< [s] {1..600} after which they do not count any more: a chair
  double patience = 0.4;       ///< [s] {0.1..2} until who is not confirmed is forgotten
  double walk = 1.5;           ///< [m/s] {0.5..3} how fast who was hidden may come out elsewhere
  double memory = 6.0;         ///< [s] {0.5..30} until who is not seen any more is forgotten
  double coasting = 0.8;       ///< [s] {0.1..5} in which who is not seen is taken to slow down
};

/// Follows people over time and sensors: a Kalman filter of constant velocity for each, global
/// nearest neighbours by position, height and the colors of clothes. Who is hidden is kept for some
/// seconds where the person would have walked on, more and more uncertain, and found again there;
/// whose clothes have clearly other colors is another one. Only cameras make people; legs in the
/// laser must walk before they count, and count no more when they have stood for long: a chair
/// that somebody moved.
class Tracker {
 public:
  static constexpr std::size_t kMost = 64;
  static constexpr double kLatest = 0.3;  ///< [s] before the newest update

  explicit Tracker(const TrackerConfig& config) : config_(config) {}

  /// All that one sensor saw at one time [s]. What is late, by up to `kLatest`, is compared with
  /// where people were then; what is later, and observations that are not finite, are left out.
  /// False when all of it was.
  bool update(double time, Source source, std::span<const Observation> observations);

  /// Confirmed people as of the last update, by id.
  std::span<const Track> people() const { return people_; }
  /// [s] of the newest update; the states are for this time.
  double now() const { return now_; }
  /// One of them.
  const Track* find(std::uint64_t id) const;

 private:
  void predict(Track& track, double seconds) const;
  using Gain = Eigen::Matrix<double, 2, 4>;
  Gain seen_at(double late) const;
  double cost(const Track& track, const Observation& observation, const Gain& look,
              Source source) const;
  void correct(Track& track, const Observation& observation, const Gain& look, Source source);
  void add(const Observation& observation, Source source, double time);
  double unlikeness(const Track& hidden, const Track& track) const;
  bool may_have_walked(const Track& hidden, const Track& track) const;
  bool is_doubtful(std::size_t newcomer) const;
  void recognize();
  void forget();

  TrackerConfig config_;
  double now_ = 0.0;
  std::uint64_t next_id_ = 1;
  std::vector<Track> tracks_, people_;
  std::vector<Observation> observations_;
  std::vector<double> costs_;
  std::vector<char> used_;
  std::vector<std::size_t> newcomers_, hidden_;
  Assignment assignment_;
};

}  // namespace usher::people_detector
