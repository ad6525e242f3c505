#include "localization/amcl/core/laser_beams.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace usher::amcl {
namespace {

enum class Kind { kReturn, kNoReturn, kOutOfRange, kNotFinite };

Kind kind_of(float range, const LaserBeams& scan, double max_range) {
  if (!std::isfinite(range)) return Kind::kNotFinite;
  if (range < scan.range_min || range <= 0.0F) return Kind::kOutOfRange;
  return range >= max_range ? Kind::kNoReturn : Kind::kReturn;
}

}  // namespace

BeamCounts choose_beams(const LaserBeams& scan, std::size_t max_beams, double max_range,
                        bool with_no_return, std::vector<Beam>& beams) {
  assert(max_beams >= 2);
  beams.clear();
  const double farthest = std::min(max_range, scan.range_max);
  BeamCounts counts;
  const auto wanted = [&](Kind kind) {
    return kind == Kind::kReturn || (with_no_return && kind == Kind::kNoReturn);
  };
  std::size_t usable = 0;
  for (const float range : scan.ranges) {
    const Kind kind = kind_of(range, scan, farthest);
    counts.not_finite += kind == Kind::kNotFinite;
    counts.out_of_range += kind == Kind::kOutOfRange;
    counts.no_return += kind == Kind::kNoReturn;
    usable += wanted(kind);
  }
  const std::size_t count = std::min(usable, max_beams);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < scan.ranges.size() && beams.size() < count; ++i) {
    if (!wanted(kind_of(scan.ranges[i], scan, farthest))) continue;
    // The k-th chosen is usable beam number k (usable - 1) / (count - 1), rounded down.
    const std::size_t next = count < 2 ? 0 : beams.size() * (usable - 1) / (count - 1);
    if (seen++ != next) continue;
    const double range = std::min<double>(scan.ranges[i], farthest);
    const double bearing = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    const double angle = bearing + scan.base_T_laser.yaw;
    const double c = std::cos(angle), s = std::sin(angle);
    beams.push_back(
        {scan.base_T_laser.x + range * c, scan.base_T_laser.y + range * s, range, angle, c, s});
  }
  counts.used = beams.size();
  return counts;
}

}  // namespace usher::amcl
