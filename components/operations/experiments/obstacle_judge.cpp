#include "operations/experiments/obstacle_judge.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/grid/costs.hpp"

namespace usher::operations {

namespace {

constexpr std::size_t kKept = 200;     // poses
constexpr double kMoves = 0.05;        // [m/s] who is slower stands
constexpr double kScanReach = 4.0;     // [m] farther ends are in no costmap
constexpr double kObjectReach = 20.0;  // [m]

}  // namespace

std::vector<JudgedObject> objects_of(const std::vector<world::Thing>& obstacles) {
  std::vector<JudgedObject> objects;
  for (const world::Thing& thing : obstacles) {
    if (objects.empty() || !thing.name.starts_with(objects.back().name + " "))
      objects.push_back({thing.name, {}});
    objects.back().parts.push_back(thing);
  }
  return objects;
}

ObstacleJudge::ObstacleJudge(const Config& config, std::vector<JudgedObject> objects,
                             std::vector<world::Thing> everything, double ceiling)
    : config_(config), objects_(std::move(objects)), everything_(std::move(everything), ceiling) {
  scenes_.reserve(objects_.size());
  verdicts_.reserve(objects_.size());
  for (const JudgedObject& object : objects_) {
    scenes_.emplace_back(object.parts, ceiling);
    verdicts_.push_back({.name = object.name});
  }
}

std::optional<geometry::Pose2> ObstacleJudge::at(const Stamped& poses, runtime::Time stamp) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), stamp,
                       [](const auto& pose, runtime::Time wanted) { return pose.first < wanted; });
  if (after == poses.end()) return std::nullopt;
  if (after->first == stamp) return after->second;
  if (after == poses.begin()) return std::nullopt;
  const auto before = after - 1;
  return geometry::interpolate(
      before->second, after->second,
      runtime::seconds(stamp - before->first) / runtime::seconds(after->first - before->first));
}

void ObstacleJudge::take_truth(runtime::Time stamp, const geometry::Pose2& world_T_base, double v,
                               double pitch) {
  truth_.emplace_back(stamp, world_T_base);
  if (truth_.size() > kKept) truth_.pop_front();
  v_ = v;
  pitch_ = pitch;
  while (!waiting_.empty() && waiting_.front().stamp <= stamp) {
    if (const auto pose = at(truth_, waiting_.front().stamp)) judge(waiting_.front(), *pose);
    waiting_.pop_front();
  }
}

void ObstacleJudge::take_odometry(runtime::Time stamp, const geometry::Pose2& odom_T_base) {
  odometry_.emplace_back(stamp, odom_T_base);
  if (odometry_.size() > kKept) odometry_.pop_front();
}

void ObstacleJudge::take_costs(runtime::Time stamp, const grid::Grid<std::uint8_t>& costs) {
  const auto world_T_base = at(truth_, stamp);
  const auto odom_T_base = at(odometry_, stamp);
  if (!world_T_base || !odom_T_base) return;
  const geometry::Pose2 odom_T_world = *odom_T_base * geometry::inverse(*world_T_base);
  const double seconds = judged_ ? runtime::seconds(stamp - *judged_) : 0.0;
  judged_ = stamp;
  ++costmaps_;
  for (std::size_t i = 0; i < objects_.size(); ++i) judge(i, odom_T_world, costs, seconds);
  const geometry::Pose2 world_T_odom = geometry::inverse(odom_T_world);
  const double stray = config_.stray + config_.thickness;
  std::size_t strays = 0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (costs[i] != grid::kLethalCost) continue;
    const geometry::Point2 place = world_T_odom * costs.geometry().center(costs.geometry().cell(i));
    strays += everything_.nearest(place, config_.height, stray).thing < 0;
  }
  false_cells_ += strays;
  false_costmaps_ += strays > 0;
}

void ObstacleJudge::judge(std::size_t object, const geometry::Pose2& odom_T_world,
                          const grid::Grid<std::uint8_t>& costs, double seconds) {
  const geometry::Pose2 world_T_base = truth_.back().second;
  std::vector<geometry::Point2> outline;
  outline.reserve(config_.footprint.size());
  for (const auto& corner : config_.footprint) outline.push_back(world_T_base * corner);
  const auto nearest = scenes_[object].nearest(outline, config_.height, kObjectReach);
  Verdict& verdict = verdicts_[object];
  verdict.judged = true;
  if (nearest.thing < 0) return;
  verdict.closest = std::min(verdict.closest, nearest.distance);
  const geometry::Point2 place = odom_T_world * nearest.point;
  const grid::Cell middle = costs.geometry().cell_at(place);
  const int reach = static_cast<int>(std::ceil(config_.near / costs.resolution()));
  bool present = false;
  for (int y = middle.y - reach; y <= middle.y + reach; ++y) {
    for (int x = middle.x - reach; x <= middle.x + reach; ++x) {
      const grid::Cell cell{x, y};
      present =
          present || (costs.geometry().contains(cell) && costs.at(cell) == grid::kLethalCost &&
                      (costs.geometry().center(cell) - place).norm() <= config_.near);
    }
  }
  const bool seen = verdict.seen();
  if (present && !seen) {
    verdict.first_seen = nearest.distance;
    verdict.first_pitch = pitch_;
  }
  const bool behind = (geometry::inverse(world_T_base) * nearest.point).x() < 0.0;
  if (behind || nearest.distance > config_.stopping_time * std::max(0.0, v_)) return;
  verdict.approached = true;
  if (present || v_ < kMoves) return;
  (seen ? verdict.forgotten : verdict.too_late) += seconds;
}

void ObstacleJudge::take_scan(Scan scan) {
  waiting_.push_back(std::move(scan));
  if (waiting_.size() > kKept) waiting_.pop_front();
}

void ObstacleJudge::judge(const Scan& scan, const geometry::Pose2& world_T_base) {
  ++scans_;
  bearings_ += scan.ranges.size();
  std::size_t strays = 0;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto range = static_cast<double>(scan.ranges[i]);
    if (!(range < kScanReach)) continue;
    const double bearing = scan.angle_min + scan.increment * static_cast<double>(i);
    const geometry::Point2 end =
        world_T_base *
        geometry::Point2(scan.mount_x + range * std::cos(bearing), range * std::sin(bearing));
    strays += everything_.nearest(end, config_.height, config_.stray).thing < 0;
  }
  false_bearings_ += strays;
  false_scans_ += strays > 0;
}

}  // namespace usher::operations
