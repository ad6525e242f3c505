#include "sensing/scan_filter/core/scan_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "foundation/geometry/pose3.hpp"
#include "foundation/result/bounds.hpp"

namespace usher::scan_filter {
namespace {

constexpr double kSteepest = 0.6;  // [rad]
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
// Two ends belong together while their distances differ by less than this; 0.06 allows a wall seen
// at up to 81 degrees from its normal at half a degree between beams.
constexpr float kJump = 0.05f;       // [m]
constexpr float kJumpOfFour = 0.3f;  // [m] where the noise of two others counts thrice
constexpr float kJumpShare = 0.06f;  // of the nearer
constexpr double kWidest = 4.0;      // beams' angles between two ends that belong together
constexpr float kSameAngle = 1e-6f;  // [rad] closer than this an end lies on an angle

// Takes the nearer where two surfaces meet one angle.
void offer(float& out, float range) {
  if (!(out <= range)) out = range;
}

}  // namespace

Result<ScanFilter> ScanFilter::make(const ScanFilterConfig& c) {
  if (const Status status = within({{"mount_x", c.mount_x, -2, 2, "m"},
                                    {"mount_y", c.mount_y, -2, 2, "m"},
                                    {"mount_z", c.mount_z, -1, 3, "m"},
                                    {"mount_yaw", c.mount_yaw, -4, 4, "rad"},
                                    {"mount_pitch", c.mount_pitch, -0.6, 0.6, "rad"},
                                    {"axle_height", c.axle_height, 0, 1, "m"},
                                    {"bearing_limit", c.bearing_limit, 0.01, 3.1, "rad"},
                                    {"floor_margin", c.floor_margin, 0, 1, "m"},
                                    {"floor_angle", c.floor_angle, 0, 0.1, "rad"},
                                    {"floor_time", c.floor_time, 0, 0.1, "s"},
                                    {"max_height", c.max_height, 0.1, 10, "m"},
                                    {"mixed_from", c.mixed_from, 0, 1000, "m"}});
      !status)
    return Error{status.error()};
  return ScanFilter(c);
}

Status ScanFilter::filter(const ScanGeometry& geometry, std::span<const float> ranges,
                          const Pitch& at_first, const Pitch& at_last, PlanarScan& out) {
  const auto reject = [&](Error error) {
    ++counts_.rejected;
    return error;
  };
  for (const Pitch& p : {at_first, at_last}) {
    if (!(std::abs(p.angle) <= kSteepest) || !std::isfinite(p.rate))
      return reject({"pitch must be within 0.6 rad, got " + std::to_string(p.angle)});
  }
  if (geometry != geometry_ || ranges.size() != beams_) {
    if (const Status status = adopt(geometry, ranges.size()); !status) {
      return reject({status.error()});
    }
  }
  const auto seen = ranges.subspan(first_, cos_.size());
  const auto low = static_cast<float>(geometry_.range_min);
  const auto high = static_cast<float>(geometry_.range_max);
  const auto echoes = static_cast<std::size_t>(
      std::count_if(seen.begin(), seen.end(), [=](float r) { return r >= low && r <= high; }));
  if (echoes < config_.least_echoes) {
    return reject({std::to_string(echoes) + " of " + std::to_string(seen.size()) +
                   " beams have an echo, expected " + std::to_string(config_.least_echoes) +
                   " at least: the sensor is blind"});
  }
  project(ranges, at_first, at_last);
  out.base_T_scan = {config_.mount_x, config_.mount_y, config_.mount_yaw};
  out.geometry = {geometry.angle_min + static_cast<double>(first_) * geometry.angle_increment,
                  geometry.angle_increment, 0.5 * geometry.range_min, geometry.range_max + 0.5};
  out.ranges.assign(cos_.size(), kNothing);
  if (config_.joined) {
    find_surfaces();
    drop_mixed();
  }
  join_ends(out.ranges);
  place_lone_ends(out.ranges);
  fill_free(out.ranges);
  ++counts_.scans;
  return {};
}

Status ScanFilter::adopt(const ScanGeometry& g, std::size_t beams) {
  if (beams == 0 || beams > kMaxBeams) {
    return Error{"a scan must have 1 to 10000 beams, got " + std::to_string(beams)};
  }
  if (!(std::abs(g.angle_min) <= 7.0) || !(g.angle_increment >= 1e-5 && g.angle_increment <= 4.0) ||
      static_cast<double>(beams - 1) * g.angle_increment > 2.0 * geometry::kPi + 1e-6) {
    return Error{"angles of a scan must rise within one turn, got " + std::to_string(beams) +
                 " beams from " + std::to_string(g.angle_min) + " rad every " +
                 std::to_string(g.angle_increment) + " rad"};
  }
  if (!(g.range_min >= 0.0 && g.range_min < g.range_max && g.range_max <= 1000.0)) {
    return Error{"ranges of a scan must be 0 <= range_min < range_max <= 1000 m, got " +
                 std::to_string(g.range_min) + " and " + std::to_string(g.range_max)};
  }
  std::size_t first = beams;
  std::size_t end = 0;
  for (std::size_t i = 0; i < beams; ++i) {
    const double angle = g.angle_min + static_cast<double>(i) * g.angle_increment;
    if (std::abs(angle) > config_.bearing_limit + 1e-9) continue;
    first = std::min(first, i);
    end = i + 1;
  }
  if (first >= end) return Error{"no beam of the scan lies within the bearing limit"};
  geometry_ = g;
  widest_ = static_cast<float>(std::tan(std::min(kWidest * g.angle_increment, 1.4)));
  beams_ = beams;
  first_ = first;
  cos_.clear();
  sin_.clear();
  for (std::size_t i = first; i < end; ++i) {
    const double angle = g.angle_min + static_cast<double>(i) * g.angle_increment;
    cos_.push_back(static_cast<float>(std::cos(angle)));
    sin_.push_back(static_cast<float>(std::sin(angle)));
  }
  x_.resize(cos_.size());
  y_.resize(cos_.size());
  away_.resize(cos_.size());
  kind_.resize(cos_.size());
  joined_.assign(cos_.size(), 0);
  return {};
}

// (4.2, 4.3)
ScanFilter::View ScanFilter::view(double pitch) const {
  const Eigen::Quaterniond lean = geometry::from_roll_pitch_yaw(0.0, pitch, 0.0);
  const Eigen::Quaterniond mount =
      geometry::from_roll_pitch_yaw(0.0, config_.mount_pitch, config_.mount_yaw);
  const Eigen::Vector3d place(config_.mount_x, config_.mount_y, config_.mount_z);
  const Eigen::Quaterniond to_scan(Eigen::AngleAxisd(-config_.mount_yaw, Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d origin =
      to_scan * (lean * place - Eigen::Vector3d(config_.mount_x, config_.mount_y, 0.0)) +
      Eigen::Vector3d(0.0, 0.0, config_.axle_height);
  const Eigen::Matrix3d turn = (to_scan * lean * mount).toRotationMatrix();
  return {origin.cast<float>(), turn.col(0).cast<float>(), turn.col(1).cast<float>()};
}

// Where each beam ends, seen from the upright sensor's place, and whether that is an obstacle.
void ScanFilter::project(std::span<const float> ranges, const Pitch& at_first,
                         const Pitch& at_last) {
  // The view turns by less than 0.1 rad during a scan: a straight line between its ends is off by
  // 1e-3 of the range at most, at 1 rad/s and 15 ms by 3e-5.
  const View first = view(at_first.angle);
  const View last = view(at_last.angle);
  const float share = beams_ > 1 ? 1.0f / static_cast<float>(beams_ - 1) : 0.0f;
  const Eigen::Vector3f moves = share * (last.origin - first.origin);  // from beam to beam
  const Eigen::Vector3f ahead_turns = share * (last.ahead - first.ahead);
  const Eigen::Vector3f left_turns = share * (last.left - first.left);

  const float range_min = static_cast<float>(geometry_.range_min);
  const float range_max = static_cast<float>(geometry_.range_max);
  const float margin = static_cast<float>(config_.floor_margin);
  const float margin_slope = static_cast<float>(
      config_.floor_angle +
      config_.floor_time * std::max(std::abs(at_first.rate), std::abs(at_last.rate)));
  const float max_height = static_cast<float>(config_.max_height);
  for (std::size_t i = 0; i < cos_.size(); ++i) {
    const float range = ranges[first_ + i];
    const bool echo = range <= range_max;
    const float length = echo ? range : range_max;
    const auto beam = static_cast<float>(first_ + i);
    const Eigen::Vector3f ahead = first.ahead + beam * ahead_turns;
    const Eigen::Vector3f left = first.left + beam * left_turns;
    const Eigen::Vector3f end =
        first.origin + beam * moves + length * (cos_[i] * ahead + sin_[i] * left);
    x_[i] = end.x();
    y_[i] = end.y();
    away_[i] = std::sqrt(x_[i] * x_[i] + y_[i] * y_[i]);
    const float height = end.z();
    if (!(range >= range_min)) {  // NaN too
      kind_[i] = Kind::kUnknown;
      ++counts_.invalid;
    } else if (echo && height < margin + margin_slope * length) {
      kind_[i] = Kind::kUnknown;
      ++counts_.floor;
    } else if (height > max_height || height < 0.0f) {
      kind_[i] = Kind::kUnknown;
      ++(height < 0.0f ? counts_.floor : counts_.high);
    } else {
      kind_[i] = echo ? Kind::kEnd : Kind::kFree;
    }
  }
}

// Which beams i and i + 1 end on one surface, seen in rising angle (or both in free space).
void ScanFilter::find_surfaces() {
  for (std::size_t i = 0; i + 1 < kind_.size(); ++i) {
    const float across = x_[i] * y_[i + 1] - y_[i] * x_[i + 1];
    const float along = x_[i] * x_[i + 1] + y_[i] * y_[i + 1];
    const float step = std::abs(away_[i] - away_[i + 1]);
    const float limit = kJump + kJumpShare * std::min(away_[i], away_[i + 1]);
    joined_[i] =
        static_cast<std::uint8_t>((kind_[i] == kind_[i + 1]) & (kind_[i] != Kind::kUnknown) &
                                  (across > 0.0f) & (across <= widest_ * along) & (step < limit));
  }
}

// Whether the end is of a wall that is met at a grazing angle: the inverses of its distances lie on
// a line. Three may do so by chance: a fourth one to either side must, where one is known.
bool ScanFilter::is_on_a_wall(std::size_t i) const {
  const auto inverse = [&](std::size_t k) {
    return kind_[k] == Kind::kFree ? 0.0f : 1.0f / away_[k];
  };
  if (std::abs(away_[i] - 2.0f / (inverse(i - 1) + inverse(i + 1))) >= kJump) return false;
  const auto known = [&](std::size_t k) { return k < kind_.size() && kind_[k] != Kind::kUnknown; };
  const auto fits = [&](std::size_t next, std::size_t k) {
    const float there = 2.0f * inverse(next) - inverse(i);
    if (kind_[k] == Kind::kFree) return there * static_cast<float>(geometry_.range_max) < 1.0f;
    return there > 0.0f && std::abs(away_[k] - 1.0f / there) < kJumpOfFour;
  };
  const bool before = known(i - 2), after = known(i + 2);
  return (before && fits(i - 1, i - 2)) || (after && fits(i + 1, i + 2)) || (!before && !after);
}

// A lone end between a nearer and a farther neighbour. A thing in front of both is nearer than
// they.
void ScanFilter::drop_mixed() {
  const auto from = static_cast<float>(config_.mixed_from);
  Kind own = kind_.empty() ? Kind::kUnknown : kind_.front();
  for (std::size_t i = 1; i + 1 < kind_.size(); ++i) {
    const Kind before = std::exchange(own, kind_[i]);  // though it was dropped
    const Kind after = kind_[i + 1];
    if (own != Kind::kEnd || away_[i] < from || joined_[i - 1] != 0 || joined_[i] != 0) continue;
    if (before == Kind::kUnknown || after == Kind::kUnknown) continue;
    const auto [near, far] = std::minmax({before == Kind::kEnd ? away_[i - 1] : kInfinity,
                                          after == Kind::kEnd ? away_[i + 1] : kInfinity});
    if (!(near < away_[i] && away_[i] < far)) continue;
    if (is_on_a_wall(i)) continue;
    kind_[i] = Kind::kUnknown;
    ++counts_.mixed;
  }
}

// The first of the regular angles that is not clockwise of a point; the count of angles when there
// is none.
std::size_t ScanFilter::first_angle_after(float x, float y, std::size_t guess) const {
  const float tolerance = kSameAngle * (std::abs(x) + std::abs(y));
  const auto before = [&](std::size_t k) { return x * sin_[k] - y * cos_[k] < -tolerance; };
  std::size_t k = guess;
  while (k < cos_.size() && before(k)) ++k;
  while (k > 0 && !before(k - 1)) --k;
  return k;
}

// Calls visit(angle, i) for each regular angle between the ends i and i + 1 of every joined pair of
// a kind.
template <class Visit>
void ScanFilter::between_joined(Kind kind, Visit&& visit) const {
  const std::size_t count = cos_.size();
  const float* cosines = cos_.data();
  const float* sines = sin_.data();
  std::size_t k = 0;
  bool goes_on = false;  // the pair before ends where this one begins
  for (std::size_t i = 0; i + 1 < count; ++i) {
    if (kind_[i] != kind || joined_[i] == 0) {
      goes_on = false;
      continue;
    }
    if (!goes_on) k = first_angle_after(x_[i], y_[i], k);
    goes_on = true;
    const float x = x_[i + 1];
    const float y = y_[i + 1];
    const float tolerance = kSameAngle * (std::abs(x) + std::abs(y));
    for (; k < count && x * sines[k] - y * cosines[k] <= tolerance; ++k) visit(k, i);
  }
}

void ScanFilter::join_ends(std::vector<float>& out) const {
  between_joined(Kind::kEnd, [&](std::size_t k, std::size_t i) {
    const float dx = x_[i + 1] - x_[i];
    const float dy = y_[i + 1] - y_[i];
    const float rate = cos_[k] * dy - sin_[k] * dx;
    if (rate > 0.0f) offer(out[k], (x_[i] * dy - y_[i] * dx) / rate);
  });
}

std::size_t ScanFilter::nearest_angle(std::size_t i) const {
  const auto off = [&](std::size_t k) { return std::abs(x_[i] * sin_[k] - y_[i] * cos_[k]); };
  const std::size_t after = std::min(first_angle_after(x_[i], y_[i], i), cos_.size() - 1);
  return after > 0 && off(after - 1) < off(after) ? after - 1 : after;
}

void ScanFilter::place_lone_ends(std::vector<float>& out) const {
  bool before = false;  // belongs to the end before
  for (std::size_t i = 0; i < kind_.size(); ++i) {
    const bool after = joined_[i] != 0;
    if (kind_[i] == Kind::kEnd && !(before && after)) {
      // The last end of a surface only fills what that surface left open.
      float& place = out[nearest_angle(i)];
      if (!(before || after) || std::isnan(place)) offer(place, away_[i]);
    }
    before = after;
  }
}

void ScanFilter::fill_free(std::vector<float>& out) const {
  const auto free = [](float& place) {
    if (std::isnan(place)) place = kInfinity;
  };
  for (std::size_t i = 0; i < kind_.size(); ++i) {
    if (kind_[i] != Kind::kFree) continue;
    if (joined_[i] == 0) free(out[nearest_angle(i)]);
  }
  between_joined(Kind::kFree, [&](std::size_t k, std::size_t) { free(out[k]); });
}

}  // namespace usher::scan_filter
