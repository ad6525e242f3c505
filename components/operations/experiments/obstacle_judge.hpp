#pragma once

#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "runtime/api/time.hpp"
#include "simulation/world/core/scene.hpp"

namespace usher::operations {

/// Something in the robot's way, of one part or several: a chair has a foot, a seat, a back.
struct JudgedObject {
  std::string name;
  std::vector<world::Thing> parts;
};

/// The things of a world that nobody has mapped, those of one piece of furniture together: the
/// parser calls them "chair", "chair foot", ...
std::vector<JudgedObject> objects_of(const std::vector<world::Thing>& obstacles);

/// Says of every object whether it was in the local costmap before the robot was so near that it
/// could not stop any more, and what stood in the costmap where nothing is. Knows the truth; the
/// costs are laid over it by the odometry of their own time, so that it judges the sensors and the
/// costmap and not the localization.
class ObstacleJudge {
 public:
  struct Config {
    std::vector<geometry::Point2> footprint;  ///< of the robot, counter-clockwise
    double height = 1.8;                      ///< [m] higher things do not concern it
    double stopping_time = 1.48;              ///< [s] d(v) of table 8.1 over v
    double near = 0.15;   ///< [m] of a lethal cell from the object's nearest point
    double stray = 0.25;  ///< [m] what is seen so far from everything is false
    /// [m] that the costmap takes low things to be thick: a lethal cell is false beyond `stray` and
    /// this.
    double thickness = 0.3;
  };
  struct Verdict {
    std::string name;
    /// [m] of the outline from the object when it was first in the costmap; NaN: never.
    double first_seen = std::numeric_limits<double>::quiet_NaN();
    double first_pitch = 0.0;  ///< [rad] of the body then
    /// [s] in which the robot was within its stopping distance of it, it was not behind, and not in
    /// the costmap: before it was first seen, and later.
    double too_late = 0.0, forgotten = 0.0;
    double closest = std::numeric_limits<double>::infinity();  ///< [m] of the outline
    bool judged = false;      ///< a costmap came that it could have been in
    bool approached = false;  ///< the robot was within its stopping distance, and it not behind

    bool seen() const { return std::isfinite(first_seen); }
    /// Whether it was in the costmap each time that the robot was within its stopping distance.
    /// What never was in it is in time only where the robot never got so near.
    bool in_time() const {
      return seen() ? too_late <= 0.0 && forgotten <= 0.0 : judged && !approached;
    }
  };

  ObstacleJudge(const Config& config, std::vector<JudgedObject> objects,
                std::vector<world::Thing> everything, double ceiling);

  void take_truth(runtime::Time stamp, const geometry::Pose2& world_T_base, double v, double pitch);
  void take_odometry(runtime::Time stamp, const geometry::Pose2& odom_T_base);
  /// The local costs in odom with the stamp of what is in them. Those without a truth and an
  /// odometry of that time are left out.
  void take_costs(runtime::Time stamp, const grid::Grid<std::uint8_t>& costs);
  /// A scan of obstacles as a depth camera's pipeline tells it.
  struct Scan {
    runtime::Time stamp{};
    double mount_x = 0.0;                     ///< [m] where it is seen from, ahead of the axle
    double angle_min = 0.0, increment = 0.0;  ///< [rad] counter-clockwise
    std::vector<float> ranges;
  };
  /// It is judged when the truth of its time has come.
  void take_scan(Scan scan);

  const std::vector<Verdict>& verdicts() const { return verdicts_; }
  std::size_t costmaps() const { return costmaps_; }
  std::size_t false_costmaps() const { return false_costmaps_; }  ///< with false cells
  std::size_t false_cells() const { return false_cells_; }        ///< of all costmaps
  std::size_t scans() const { return scans_; }
  std::size_t false_scans() const { return false_scans_; }  ///< with false ends on the floor
  double false_share() const {                              ///< of the bearings
    return bearings_ > 0 ? static_cast<double>(false_bearings_) / static_cast<double>(bearings_)
                         : 0.0;
  }

 private:
  using Stamped = std::deque<std::pair<runtime::Time, geometry::Pose2>>;
  static std::optional<geometry::Pose2> at(const Stamped& poses, runtime::Time stamp);
  void judge(const Scan& scan, const geometry::Pose2& world_T_base);
  void judge(std::size_t object, const geometry::Pose2& odom_T_world,
             const grid::Grid<std::uint8_t>& costs, double seconds);

  Config config_;
  std::vector<JudgedObject> objects_;
  std::vector<world::Scene> scenes_;  ///< of each object alone
  world::Scene everything_;
  std::vector<Verdict> verdicts_;
  Stamped truth_, odometry_;
  std::deque<Scan> waiting_;  ///< for the truth of their time
  double v_ = 0.0, pitch_ = 0.0;
  std::optional<runtime::Time> judged_;  ///< stamp of the last costs
  std::size_t costmaps_ = 0, false_costmaps_ = 0, false_cells_ = 0;
  std::size_t scans_ = 0, false_scans_ = 0, bearings_ = 0, false_bearings_ = 0;
};

}  // namespace usher::operations
