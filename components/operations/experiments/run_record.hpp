#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"
#include "idl/topics.hpp"
#include "runtime/api/time.hpp"

namespace usher::operations {

/// What happened in one run of a simulated robot, as a judge beside the simulation sees it.
class RunRecord {
 public:
  struct Sample {
    runtime::Time stamp{};
    geometry::Pose2 truth;
    double v = 0.0;
    double pitch = 0.0;
    double clearance = 0.0;
    double wanted_v = 0.0, wanted_w = 0.0;        ///< [m/s] [rad/s] of the navigation
    double commanded_v = 0.0, commanded_w = 0.0;  ///< [m/s] [rad/s] to the base
    std::string whiskers;                         ///< touched: fl fr bl br
    double person = 0.0, person_bearing = 0.0;    ///< [m] [rad] of the nearest one ahead
    std::string state;                            ///< of the navigation, with its reason
  };
  struct Summary {
    double seconds = 0.0;                ///< of motion, from the first to the last
    double path = 0.0;                   ///< [m] really driven
    double mean_speed = 0.0;             ///< [m/s] while the goal was active
    double smallest_clearance = 0.0;     ///< [m]
    double localization_mean = 0.0;      ///< [m] of the estimated position
    double localization_max = 0.0;       ///< [m]
    double localization_yaw_mean = 0.0;  ///< [rad]
    std::size_t estimates = 0;
    std::uint32_t contacts = 0;
    std::uint32_t touches = 0;
    std::string contact_with;  ///< the last one: with what, where, how fast, when
    double worst_lag = 0.0;    ///< [s]
  };

  /// How far an estimate was from the truth.
  struct Error {
    runtime::Time stamp{};
    double distance = 0.0;  ///< [m]
    double yaw = 0.0;       ///< [rad]
  };

  void take(const usher_sim_msgs::msg::GroundTruth& truth);
  void take(const geometry_msgs::msg::PoseWithCovarianceStamped& estimate);
  void take(const nav_msgs::msg::Path& plan);
  void take(const usher_msgs::msg::NavigateStatus& status);
  void take(const usher_msgs::msg::DialogueScreen& screen);
  void take(const geometry_msgs::msg::TwistStamped& wanted);
  void take(const usher_msgs::msg::DriveCommand& command);
  void take(const usher_msgs::msg::Whiskers& whiskers);

  const std::vector<Sample>& samples() const { return samples_; }
  const std::vector<std::vector<geometry::Point2>>& plans() const { return plans_; }
  const std::map<std::uint32_t, std::vector<geometry::Point2>>& people() const { return people_; }
  /// The newest position of a person by name.
  std::optional<geometry::Point2> person(const std::string& name) const;
  const std::optional<usher_msgs::msg::NavigateStatus>& navigation() const { return navigation_; }
  bool reached_a_goal() const { return reached_; }                        ///< the navigator says so
  const std::vector<std::string>& dialogue() const { return dialogue_; }  ///< states, in order
  const std::optional<usher_msgs::msg::DialogueScreen>& screen() const { return screen_; }
  std::optional<geometry::Pose2> truth() const;
  std::vector<Error> localization_errors() const;
  Summary summary() const;

 private:
  std::optional<geometry::Pose2> truth_at(runtime::Time stamp) const;

  std::vector<Sample> samples_;
  std::vector<std::pair<runtime::Time, geometry::Pose2>> estimates_;
  std::vector<std::vector<geometry::Point2>> plans_;
  std::map<std::uint32_t, std::vector<geometry::Point2>> people_;
  std::map<std::string, geometry::Point2> named_;
  std::optional<usher_msgs::msg::NavigateStatus> navigation_;
  bool reached_ = false;
  geometry_msgs::msg::TwistStamped wanted_;
  usher_msgs::msg::DriveCommand command_;
  std::string whiskers_;
  std::optional<usher_msgs::msg::DialogueScreen> screen_;
  std::vector<std::string> dialogue_;
  std::optional<runtime::Time> active_from_, active_until_;
  std::uint32_t contacts_ = 0, touches_ = 0;
  std::string contact_with_;
  double worst_lag_ = 0.0;
};

/// Map, planned and driven way, people, start and goal as a picture (PNG).
Status draw_run(const RunRecord& record, const grid::OccupancyGrid& map, const std::string& title,
                const std::string& path);

/// Several runs over one map: where each started, drove and should have arrived; goals that were
/// not reached say so.
Status draw_runs(const std::vector<RunRecord>& runs, const grid::OccupancyGrid& map,
                 const std::string& title, const std::string& path);

/// Ways over a map, the later ones on top; labels for the legend, those without are not in it.
struct DrawnWay {
  std::string label;
  int red = 0, green = 0, blue = 0;
  int thickness = 2;  ///< [px]
  std::vector<geometry::Point2> points;

  /// In the color of somebody's number: six that are easily told apart, over and over.
  void paint(std::uint64_t number);
};
Status draw_ways(const std::vector<DrawnWay>& ways, const grid::OccupancyGrid& map,
                 const std::string& title, const std::string& path);

/// How often each cell of a map was looked at: from blue (seldom) to red (as often as the most
/// looked at 5 % of the cells), floor that was never seen in white; the way driven over it in
/// black, its start in pink.
Status draw_heat_map(const grid::OccupancyGrid& map, const grid::Grid<std::uint32_t>& looks,
                     const std::vector<geometry::Point2>& way, const std::string& title,
                     const std::string& path);

/// What happened over time, a line for each sample of the truth.
std::string run_csv(const RunRecord& record);

}  // namespace usher::operations
