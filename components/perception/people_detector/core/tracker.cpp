#include "perception/people_detector/core/tracker.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <string>

#include "foundation/result/bounds.hpp"

namespace usher::people_detector {

namespace {

using geometry::Point2;

constexpr double kForbidden = 1e6;
constexpr double kSitsDown = 9.0;  // most that another height costs: who sits down is the same
constexpr double kNewcomer = 4.0;  // what a track costs that is not confirmed
constexpr double kNever = -std::numeric_limits<double>::infinity();
constexpr double kFirstSpeed = 0.8;   // [m/s] standard deviation of somebody new
constexpr double kLongest = 1.0;      // [s] of one prediction; a gap of the sensors is no time
constexpr double kHeightShare = 0.1;  // of a new height in the mean

bool usable(const Observation& one) {
  const Eigen::Matrix2d& c = one.covariance;
  return one.position.allFinite() && std::isfinite(one.height) && c.allFinite() && c(0, 0) > 0.0 &&
         c.determinant() > 0.0;
}

}  // namespace

Eigen::Matrix2d covariance_along(double bearing, double along, double across) {
  const Eigen::Vector2d sight(std::cos(bearing), std::sin(bearing));
  return across * across * Eigen::Matrix2d::Identity() +
         (along * along - across * across) * sight * sight.transpose();
}

Status check(const TrackerConfig& c) {
  return within({{"acceleration", c.acceleration, 0.1, 5.0},
                 {"gate", c.gate, 1.0, 50.0},
                 {"reach", c.reach, 0.2, 3.0},
                 {"height_sigma", c.height_sigma, 0.02, 1.0},
                 {"confirmations", static_cast<double>(c.confirmations), 1, 30},
                 {"travel", c.travel, 0.0, 3.0},
                 {"patience", c.patience, 0.1, 2.0},
                 {"walk", c.walk, 0.5, 3.0},
                 {"memory", c.memory, 0.5, 30.0},
                 {"coasting", c.coasting, 0.1, 5.0}});
}

/// White noise on the acceleration; who was not seen for a moment is taken to slow down.
void Tracker::predict(Track& track, double seconds) const {
  if (seconds <= 0.0) return;
  Eigen::Matrix4d transition = Eigen::Matrix4d::Identity();
  transition.topRightCorner<2, 2>() = seconds * Eigen::Matrix2d::Identity();
  const bool hidden = now_ - track.last_seen() > 0.5 * config_.coasting;
  if (hidden) transition.bottomRightCorner<2, 2>() *= std::exp(-seconds / config_.coasting);
  const double q = config_.acceleration * config_.acceleration;
  track.state = transition * track.state;
  track.covariance = transition * track.covariance * transition.transpose();
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    track.covariance(axis, axis) += q * seconds * seconds * seconds / 3.0;
    track.covariance(axis, axis + 2) += q * seconds * seconds / 2.0;
    track.covariance(axis + 2, axis) += q * seconds * seconds / 2.0;
    track.covariance(axis + 2, axis + 2) += q * seconds;
  }
}

/// What of a state an observation shows that is so late [s]: where the person was then.
Tracker::Gain Tracker::seen_at(double late) const {
  Gain look = Gain::Zero();
  look.leftCols<2>().setIdentity();
  look.rightCols<2>() = -late * Eigen::Matrix2d::Identity();
  return look;
}

double Tracker::cost(const Track& track, const Observation& observation, const Gain& look) const {
  const Point2 away = observation.position - look * track.state;
  if (away.norm() > config_.reach) return kForbidden;
  const Eigen::Matrix2d spread =
      look * track.covariance * look.transpose() + observation.covariance;
  double distance = away.dot(spread.inverse() * away);
  if (observation.height > 0.0 && track.height > 0.0) {
    const double higher = (observation.height - track.height) / config_.height_sigma;
    distance += std::min(kSitsDown, higher * higher);
  }
  if (distance > config_.gate) return kForbidden;
  return distance + std::log(spread.determinant()) + (track.confirmed ? 0.0 : kNewcomer);
}

void Tracker::correct(Track& track, const Observation& observation, const Gain& look,
                      Source source) {
  const Eigen::Matrix2d spread =
      look * track.covariance * look.transpose() + observation.covariance;
  const Eigen::Matrix<double, 4, 2> gain = track.covariance * look.transpose() * spread.inverse();
  track.state += gain * (observation.position - look * track.state);
  const Eigen::Matrix4d updated = track.covariance - gain * (look * track.covariance);
  track.covariance = 0.5 * (updated + updated.transpose());
  if (observation.height > 0.0) {
    track.height = track.height > 0.0
                       ? track.height + kHeightShare * (observation.height - track.height)
                       : observation.height;
  }
  if (source != Source::kLaser) ++track.sightings;
  if (track.confirmed) return;
  track.confirmed = track.fresh = track.sightings >= config_.confirmations ||
                                  (track.position() - track.birthplace).norm() > config_.travel;
}

void Tracker::add(const Observation& observation, Source source, double time) {
  if (tracks_.size() >= kMost) return;
  Track track;
  track.id = next_id_++;
  track.state.head<2>() = track.birthplace = observation.position;
  track.covariance.topLeftCorner<2, 2>() = observation.covariance;
  track.covariance.bottomRightCorner<2, 2>() *= kFirstSpeed * kFirstSpeed;
  track.height = observation.height;
  track.born = time;
  track.seen.fill(kNever);
  track.seen[static_cast<std::size_t>(source)] = time;
  track.sightings = source == Source::kLaser ? 0 : 1;
  track.confirmed = track.sightings >= config_.confirmations;
  tracks_.push_back(track);
}

/// Who has just been confirmed may be somebody who was hidden for a while and came out elsewhere
/// than expected: near enough to have walked there, and of the same height.
void Tracker::recognize() {
  for (Track& track : tracks_) {
    if (!track.fresh) continue;
    track.fresh = false;
    Track* best = nullptr;
    double least = 1.0;
    for (Track& hidden : tracks_) {
      const double unseen = now_ - hidden.last_seen();
      if (!hidden.confirmed || &hidden == &track || hidden.last_seen() >= track.born) continue;
      const double away = (hidden.position() - track.position()).norm();
      double distance = away / (config_.reach + config_.walk * unseen);
      if (hidden.height > 0.0 && track.height > 0.0)
        distance += std::abs(hidden.height - track.height) / (4.0 * config_.height_sigma);
      if (distance < least) least = distance, best = &hidden;
    }
    if (best == nullptr) continue;
    track.id = best->id;
    track.born = best->born;
    best->seen.fill(kNever);  // is forgotten
  }
}

void Tracker::forget() {
  std::erase_if(tracks_, [&](const Track& track) {
    return now_ - track.last_seen() > (track.confirmed ? config_.memory : config_.patience);
  });
}

bool Tracker::update(double time, Source source, std::span<const Observation> observations) {
  if (!(time >= now_ - kLatest) || std::isinf(time)) return false;
  const double passed = tracks_.empty() ? 0.0 : std::clamp(time - now_, 0.0, kLongest);
  now_ = std::max(now_, time);
  for (Track& track : tracks_) predict(track, passed);
  observations_.clear();
  for (const Observation& one : observations) {
    if (observations_.size() == kMost) break;
    if (usable(one)) observations_.push_back(one);
  }
  const Gain look = seen_at(now_ - time);
  costs_.clear();
  for (const Track& track : tracks_) {
    for (const Observation& one : observations_) {
      costs_.push_back(cost(track, one, look));
    }
  }
  const auto count = static_cast<int>(tracks_.size());
  const auto pairs =
      assignment_.solve(costs_, count, static_cast<int>(observations_.size()), kForbidden);
  used_.assign(observations_.size(), 0);
  for (std::size_t t = 0; t < static_cast<std::size_t>(count); ++t) {
    if (pairs[t] < 0) continue;
    const auto which = static_cast<std::size_t>(pairs[t]);
    used_[which] = 1;
    double& seen = tracks_[t].seen[static_cast<std::size_t>(source)];
    seen = std::max(seen, time);
    correct(tracks_[t], observations_[which], look, source);
  }
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    if (!used_[i]) add(observations_[i], source, time);
  }
  recognize();
  forget();
  people_.clear();
  std::copy_if(tracks_.begin(), tracks_.end(), std::back_inserter(people_),
               [](const Track& track) { return track.confirmed; });
  return true;
}

const Track* Tracker::find(std::uint64_t id) const {
  const auto found = std::find_if(people_.begin(), people_.end(),
                                  [&](const Track& track) { return track.id == id; });
  return found == people_.end() ? nullptr : &*found;
}

}  // namespace usher::people_detector
