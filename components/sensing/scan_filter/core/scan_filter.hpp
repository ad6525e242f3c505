#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "foundation/estimation/pitch_history.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/geometry/pose3.hpp"
#include "foundation/result/result.hpp"

namespace usher::scan_filter {

using estimation::Pitch;

/// The constants of one sensor's filter; the defaults are MARVIN's LMS100.
struct ScanFilterConfig {
  // Where the sensor sits on base_link, whose origin is the middle of the axle and which leans with
  // the body.
  double mount_x = 0.28;       ///< [m]
  double mount_y = 0.0;        ///< [m]
  double mount_z = 0.065;      ///< [m]
  double mount_yaw = 0.0;      ///< [rad]
  double mount_pitch = 0.0;    ///< [rad] positive looks down
  double axle_height = 0.235;  ///< [m] above the floor

  double bearing_limit = 2.0;  ///< [rad] beams beyond, to either side, see the robot itself
  double floor_margin = 0.04;  ///< [m] what is lower than this counts as floor,
  double floor_angle = 0.006;  ///< [rad] and this more for each metre of range: error of the pitch
  double floor_time = 0.003;   ///< [s] and this, times pitch rate and range: error of its time
  double max_height = 1.9;     ///< [m] what is higher is nothing to a robot of 1.8 m
  std::size_t least_echoes = 0;  ///< fewer beams with a range say that the sensor is blind
  bool joined =
      true;  ///< beams are so close that two neighbours on one surface stand for all between
  /// [m] lone ends from here on between a nearer and a farther neighbour are mixed; nearer ones
  /// are kept: no thing within a stop is left out.
  double mixed_from = 1.5;
};

/// What a scan says about its own beams.
struct ScanGeometry {
  double angle_min = 0.0;        ///< [rad] of the first beam, about the sensor's z axis
  double angle_increment = 0.0;  ///< [rad] above 0
  double range_min = 0.0;        ///< [m]
  double range_max = 0.0;        ///< [m]
  bool operator==(const ScanGeometry&) const = default;
};

/// A scan as if the robot stood upright: ranges in the horizontal plane, seen from a place that is
/// fixed on base_footprint (where the upright sensor is), at the input's own angles within the
/// bearing limit.
struct PlanarScan {
  geometry::Pose2 base_T_scan;  ///< from base_footprint
  ScanGeometry geometry;        ///< range_min and range_max leave room for the projection
  /// [m] finite: an obstacle; +infinity: free as far as the sensor sees; NaN: nothing known (floor,
  /// too high, own body, invalid): neither an obstacle nor free.
  std::vector<float> ranges;
};

/// What became of the beams since the filter was made.
struct FilterCounts {
  std::uint64_t scans = 0;     ///< filtered
  std::uint64_t rejected = 0;  ///< whole scans
  std::uint64_t floor = 0;     ///< beams that met the floor or a hole in it
  std::uint64_t high = 0;      ///< beams above max_height
  std::uint64_t invalid = 0;   ///< NaN, negative or nearer than range_min
  std::uint64_t mixed = 0;     ///< ends between two surfaces, where nothing is
};

/// Takes the lean out of a planar scan: thesis section 4.3 with its corrections.
///
/// 1. Bearings beyond the limit are cut off (figure 4.4).
/// 2. Sensor transform (4.2, 4.3): the mount is turned with the body about the axle by the pitch of
/// each beam's own time,
///    on a straight line from the first beam's to the last one's.
/// 3. Ground (4.4 to 4.6): a beam that ends lower than a margin above the floor has met the floor.
/// Said in height and
///    not, as the thesis does, in range, because an error of the pitch moves the predicted range
///    much at small pitch and little at large. Such a beam becomes "nothing known" (the thesis:
///    r_min, which means the same to ROS): the floor is no obstacle, and whether the space before
///    it is free holds only above the descending beam.
/// 4. Projection: the thesis scales all ranges by cos(pitch) (4.7), exact only straight ahead. Here
/// every beam's end is
///    projected to the plane, with its own bearing, and the surface between neighbouring ends is
///    sampled again at the regular angles (straight between two ends that belong together, nearest
///    angle for those that stand alone), so that walls stay straight and where they are. An upright
///    scan comes out unchanged.
///
/// 5. A beam whose spot falls on an edge returns from somewhere between both surfaces
/// [tuley2005artifacts]. It becomes "nothing known" where `joined`, from `mixed_from` on.
///
/// A beam without an echo stays "free" while it keeps between floor and max_height up to its full
/// range, else nothing is known. No allocation after the first scan; about 6 us for 541 beams.
class ScanFilter {
 public:
  /// Errors name the value that is out of range.
  static Result<ScanFilter> make(const ScanFilterConfig& config);

  /// `at_first` and `at_last`: the pitch at the first and at the last beam's time. Ranges as REP
  /// 117 has them: +infinity, or beyond range_max: no echo; NaN, -infinity or below range_min:
  /// invalid. A scan whose geometry is impossible or larger than kMaxBeams, without beams, or a
  /// pitch beyond 0.6 rad is rejected as a whole, counted, and leaves `out` alone.
  Status filter(const ScanGeometry& geometry, std::span<const float> ranges, const Pitch& at_first,
                const Pitch& at_last, PlanarScan& out);
  /// Of a scan that was made at one time.
  Status filter(const ScanGeometry& geometry, std::span<const float> ranges, const Pitch& pitch,
                PlanarScan& out) {
    return filter(geometry, ranges, pitch, pitch, out);
  }

  const FilterCounts& counts() const { return counts_; }
  const ScanFilterConfig& config() const { return config_; }

  static constexpr std::size_t kMaxBeams = 10000;

 private:
  enum class Kind : std::uint8_t { kUnknown, kEnd, kFree };

  explicit ScanFilter(const ScanFilterConfig& config) : config_(config) {}

  Status adopt(const ScanGeometry& geometry, std::size_t beams);
  /// The sensor's place and the axes of its plane, seen from base_T_scan above the floor.
  struct View {
    Eigen::Vector3f origin, ahead, left;
  };
  View view(double pitch) const;
  void project(std::span<const float> ranges, const Pitch& at_first, const Pitch& at_last);
  void find_surfaces();
  bool is_on_a_wall(std::size_t i) const;
  void drop_mixed();
  void join_ends(std::vector<float>& out) const;
  void place_lone_ends(std::vector<float>& out) const;
  void fill_free(std::vector<float>& out) const;
  std::size_t first_angle_after(float x, float y, std::size_t guess) const;
  std::size_t nearest_angle(std::size_t i) const;
  template <class Visit>
  void between_joined(Kind kind, Visit&& visit) const;

  ScanFilterConfig config_;
  FilterCounts counts_;
  ScanGeometry geometry_;
  std::size_t beams_ = 0;  // of the input
  float widest_ = 0.0f;    // tangent of the angle between ends that belong together
  std::size_t first_ = 0;  // beam within the bearing limit
  // Of the beams within the limit: their directions, which are the output's too, and where they
  // end.
  std::vector<float> cos_, sin_;
  std::vector<float> x_, y_;  // [m] seen from base_T_scan
  std::vector<float> away_;   // [m] distance of that
  std::vector<Kind> kind_;
  std::vector<std::uint8_t> joined_;  // with the next
};

}  // namespace usher::scan_filter
