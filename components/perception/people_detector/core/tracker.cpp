#include "perception/people_detector/core/tracker.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace usher::people_detector {

namespace {

using geometry::Point2;

constexpr double kForbidden = 1e6;
constexpr double kSitsDown = 9.0;  // most that another height costs: who sits down is the same ...
constexpr double kWatched = 0.3;   // [s] ... if he was seen so lately
constexpr double kOtherLight = 9.0;  // and other colors: he stepped into other light
constexpr double kNewcomer = 4.0;    // what a track costs that is not confirmed
constexpr double kNever = -std::numeric_limits<double>::infinity();
constexpr double kFirstSpeed = 0.8;  // [m/s] standard deviation of somebody new
constexpr double kLongest = 1.0;     // [s] of one prediction; a gap of the sensors is no time
constexpr int kHeights = 10;         // sightings that a mean height is of
constexpr double kColors = 0.5;      // what a unit of imaging::unlikeness() costs ...
constexpr double kAsUsual = 3.0;     // ... from that on by which somebody looks unlike himself
constexpr double kPosture = 0.03;    // [m] by which it changes while somebody is hidden
constexpr double kReach = 6.0;       // what the farthest place costs where he can be ...
constexpr double kAnother = 9.0;     // ... and all together if he is another one
constexpr double kDoubt = 1.5;       // by so little more he is the second one
constexpr double kStrays = 0.3;      // [m/s] how far from where he is expected
constexpr double kSure = 0.5;        // [s] after which that is settled all the same

/// What other colors of clothes cost; whoever looks alike is the likelier for it.
double cost_of_colors(std::optional<double> unlikeness) {
  return unlikeness ? kColors * (*unlikeness - kAsUsual) : 0.0;
}

/// As the camera of that source shows somebody; as nothing, from other sensors.
imaging::Appearances seen_by(Source source, const imaging::Appearance& appearance) {
  imaging::Appearances seen;
  const auto camera = static_cast<std::size_t>(source);
  if (camera < seen.size()) seen[camera] = appearance;
  return seen;
}

/// [m] By which one of a height is higher than another one; by which at least, of whom less is
/// seen.
double higher(double height, bool hidden, double than) {
  return hidden ? std::max(0.0, height - than) : height - than;
}

/// [m] By which somebody new is taller than somebody hidden, or must be.
double taller(const Track& track, const Track& hidden) {
  if (track.heights > 0 && hidden.heights > 0) return track.height - hidden.height;
  if (hidden.heights > 0) return std::max(0.0, track.at_least - hidden.height);
  return track.heights > 0 ? std::min(0.0, track.height - hidden.at_least) : 0.0;
}

void learn_height(Track& track, const Observation& seen) {
  if (!(seen.height > 0.0)) return;
  if (seen.head_hidden) {
    track.at_least = std::max(track.at_least, seen.height);
    return;
  }
  track.heights = std::min(track.heights + 1, kHeights);
  track.height += (seen.height - track.height) / track.heights;
}

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

double Tracker::cost(const Track& track, const Observation& observation, const Gain& look,
                     Source source) const {
  const Point2 away = observation.position - look * track.state;
  if (away.norm() > config_.reach) return kForbidden;
  const Eigen::Matrix2d spread =
      look * track.covariance * look.transpose() + observation.covariance;
  double distance = away.dot(spread.inverse() * away);
  const bool watched = now_ - track.last_seen() <= kWatched;
  if (observation.height > 0.0 && track.height > 0.0) {
    const double unlike =
        higher(observation.height, observation.head_hidden, track.height) / config_.height_sigma;
    distance += watched ? std::min(kSitsDown, unlike * unlike) : unlike * unlike;
  }
  double colors = 0.0;
  if (observation.appearance.known()) {
    const auto seen = seen_by(source, observation.appearance);
    colors = std::max(0.0, cost_of_colors(imaging::unlikeness(track.appearances, seen)));
  }
  // Whom a camera watches may step into other light: no reason to take him for somebody new.
  const double shown = std::max(track.seen[static_cast<std::size_t>(Source::kKinect)],
                                track.seen[static_cast<std::size_t>(Source::kRearCamera)]);
  if (distance + (now_ - shown <= kWatched ? 0.0 : colors) > config_.gate) return kForbidden;
  distance += std::min(kOtherLight, colors);
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
  learn_height(track, observation);
  if (const auto camera = static_cast<std::size_t>(source); camera < track.appearances.size())
    imaging::learn(track.appearances[camera], observation.appearance);
  if (source != Source::kLaser) ++track.sightings;
  const bool walked = (track.position() - track.birthplace).norm() > config_.travel;
  if (!track.confirmed) track.fresh = track.sightings >= config_.confirmations || walked;
  if (walked) {
    track.birthplace = track.position();
    track.walked = now_;
  }
  if (track.sightings == 0 && now_ - track.walked > config_.stands) track.confirmed = false;
}

void Tracker::add(const Observation& observation, Source source, double time) {
  if (tracks_.size() >= kMost) return;
  Track track;
  track.id = next_id_++;
  track.state.head<2>() = track.birthplace = observation.position;
  track.covariance.topLeftCorner<2, 2>() = observation.covariance;
  const double strayed = kFirstSpeed * (now_ - time);
  track.covariance.topLeftCorner<2, 2>() += strayed * strayed * Eigen::Matrix2d::Identity();
  track.covariance.bottomRightCorner<2, 2>() *= kFirstSpeed * kFirstSpeed;
  learn_height(track, observation);
  track.appearances = seen_by(source, observation.appearance);
  track.born = track.walked = time;
  track.seen.fill(kNever);
  track.seen[static_cast<std::size_t>(source)] = time;
  track.sightings = source == Source::kLaser ? 0 : 1;
  track.fresh = track.sightings >= config_.confirmations;
  tracks_.push_back(track);
}

/// From where he was hidden to where somebody new turned up.
bool Tracker::may_have_walked(const Track& hidden, const Track& track) const {
  return hidden.last_seen() < track.born &&
         (hidden.position() - track.position()).norm() <
             config_.reach + config_.walk * (now_ - hidden.last_seen());
}

/// How little somebody new is like somebody hidden, who may be: near enough to have walked here
/// since, of the same height and in the same clothes. Of whom neither height nor clothes are known
/// only the place speaks.
double Tracker::unlikeness(const Track& hidden, const Track& track) const {
  if (hidden.last_seen() >= track.born) return kForbidden;
  const bool measured = hidden.heights > 0 && track.heights > 0;
  const auto colors = imaging::unlikeness(hidden.appearances, track.appearances);
  const double range = (measured || colors ? config_.walk : kStrays) * (now_ - hidden.last_seen());
  const double away = (hidden.position() - track.position()).norm() / (config_.reach + range);
  if (away > 1.0) return kForbidden;
  double unlike = kReach * away * away + cost_of_colors(colors);
  const double noise = config_.height_sigma * config_.height_sigma;
  const double spread = 2.0 * kPosture * kPosture + noise / std::max(1, track.heights) +
                        noise / std::max(1, hidden.heights);
  const double by = taller(track, hidden);
  unlike += by * by / spread;
  return unlike < kAnother ? unlike : kForbidden;
}

/// He may be either of two; while his head is hidden, anybody who may have walked here.
bool Tracker::is_doubtful(std::size_t newcomer) const {
  const Track& track = tracks_[newcomers_[newcomer]];
  if (track.heights == 0 && track.at_least > 0.0) {
    return std::any_of(hidden_.begin(), hidden_.end(),
                       [&](std::size_t i) { return may_have_walked(tracks_[i], track); });
  }
  double least = kForbidden, second = kForbidden;
  for (std::size_t i = 0; i < hidden_.size(); ++i) {
    const double unlike = costs_[newcomer * hidden_.size() + i];
    second = std::min(second, std::max(unlike, least));
    least = std::min(least, unlike);
  }
  return least < kForbidden && second - least < kDoubt;
}

/// Who has just been confirmed may be somebody who was hidden for a while and came out elsewhere
/// than expected.
void Tracker::recognize() {
  newcomers_.clear(), hidden_.clear(), costs_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i].fresh)
      newcomers_.push_back(i);
    else if (tracks_[i].confirmed)
      hidden_.push_back(i);
  }
  for (const std::size_t one : newcomers_) {
    for (const std::size_t other : hidden_)
      costs_.push_back(unlikeness(tracks_[other], tracks_[one]));
  }
  const auto pairs = assignment_.solve(costs_, static_cast<int>(newcomers_.size()),
                                       static_cast<int>(hidden_.size()), kForbidden);
  for (std::size_t i = 0; i < newcomers_.size(); ++i) {
    Track& track = tracks_[newcomers_[i]];
    if (now_ - track.born < kSure && is_doubtful(i)) continue;
    track.fresh = false;
    track.confirmed = true;
    if (pairs[i] < 0) continue;
    Track& hidden = tracks_[hidden_[static_cast<std::size_t>(pairs[i])]];
    track.id = hidden.id;
    track.born = hidden.born;
    track.sightings += hidden.sightings;
    if (hidden.heights > track.heights)
      track.height = hidden.height, track.heights = hidden.heights;
    track.at_least = std::max(track.at_least, hidden.at_least);
    for (std::size_t camera = 0; camera < track.appearances.size(); ++camera)
      if (!track.appearances[camera].known())
        track.appearances[camera] = hidden.appearances[camera];
    hidden.seen.fill(kNever);  // is forgotten
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
      costs_.push_back(cost(track, one, look, source));
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
