#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "navigation/costmap/core/costmap.hpp"
#include "runtime/api/host.hpp"
#include "wire/transform_input.hpp"

namespace usher::costmap {

/// Keeps two costmaps from the same sensors: a window that rolls with the robot in odom, for the
/// local planner, and the whole map in map, for the global one. Event-driven: a scan is in the
/// local costs that leave in the same turn.
class CostmapComponent final : public runtime::Component {
 public:
  explicit CostmapComponent(runtime::Host& host);

 private:
  /// One costmap with a layer for each sensor.
  struct Map {
    const char* frame = "";
    std::optional<Costmap> costs;
    Costmap::LayerId laser = 0, ultrasonic = 0, whiskers = 0, depth = 0, near = 0, low = 0,
                     feet = 0, rear = 0;
    bool static_known = false;
    /// When the newest data in it was true, an observation or the map, on this host's clock:
    /// readers age the costs by it, and the layers what they remember.
    runtime::Time newest{};
  };
  /// Beam directions of one scanner, computed when its angles change.
  struct Beams {
    float angle_min = 0.0F, increment = 0.0F;
    std::size_t count = 0;
    std::vector<geometry::Point2> directions;
    int turn = 0;                   ///< of the scans, those that go into the global costs
    runtime::Duration max_age{};    ///< older ones say what was
    std::uint64_t* late = nullptr;  ///< counts them
  };

  CostmapConfig config(bool rolling, const grid::GridGeometry& window) const;
  Costmap make(bool rolling, const grid::GridGeometry& window);
  void add_layers(Map& map);
  void read_settings(runtime::Parameters& parameters);
  void read_depth_settings(runtime::Parameters& parameters);
  void read_echo_settings(runtime::Parameters& parameters);
  void listen();
  void read_depth();
  void take_map(const nav_msgs::msg::OccupancyGrid& message, runtime::Time effective);
  void refuse_map(const std::string& reason);
  void take_scan(std::shared_ptr<const sensor_msgs::msg::LaserScan> scan,
                 const runtime::SampleInfo& info, Beams& beams, Costmap::LayerId Map::*layer);
  void place_scan(const sensor_msgs::msg::LaserScan& scan, Beams& beams,
                  Costmap::LayerId Map::*layer, runtime::Time stamp, runtime::Time effective,
                  const geometry::Pose2& odom_T_sensor);
  void hear(const sensor_msgs::msg::LaserScan& sonar, const Beams& rays,
            const geometry::Pose2& odom_T_sonar);
  void keep_unexplained(const sensor_msgs::msg::LaserScan& sonar,
                        const geometry::Pose2& odom_T_sonar);
  bool take_depth(Map& map, const sensor_msgs::msg::LaserScan& scan, const RangeObservation& seen);
  bool take_rear(Map& map, const RangeObservation& seen);
  void place_people(std::span<const geometry::Point2> in_odom,
                    const geometry::Pose2& window_T_odom);
  bool take_low(Map& map, const sensor_msgs::msg::LaserScan& scan, RangeObservation seen);
  void take_whiskers(std::shared_ptr<const usher_msgs::msg::Whiskers> message);
  void place_whiskers(const usher_msgs::msg::Whiskers& message, runtime::Time stamp,
                      const geometry::Pose2& odom_T_base);
  bool observe(Map& map, Costmap::LayerId layer, const RangeObservation& observation);
  void remember_contacts(std::span<const geometry::Point2> in_odom, runtime::Time stamp);
  void take_people(const usher_msgs::msg::People& message);
  void forget_people();
  void publish_local();
  void place_static_map();
  void publish_global();
  void report();

  runtime::Host& host_;
  geometry::Footprint footprint_;
  CostmapConfig settings_;  ///< what both maps share
  ObstacleLayerConfig laser_settings_, ultrasonic_settings_, depth_settings_;
  double depth_near_range_ = 0.0, low_blind_range_ = 0.0, rear_blind_range_ = 0.0;
  double low_thickness_ = 0.0, low_persistence_ = 0.0;
  double local_size_, resolution_, local_persistence_ = 0.0;
  bool static_in_local_;
  runtime::Duration local_period_;

  double echo_half_cone_, echo_tolerance_, ultrasonic_cone_, clearing_cone_;
  std::vector<float> echoes_, cone_ranges_, middle_ranges_, lasting_ranges_;
  std::vector<float> own_ranges_;                  ///< a layer's part of a scan that two share
  std::vector<geometry::Point2> near_, standing_;  ///< people: ahead, in odom; who stands, in map
  std::vector<geometry::Point2> bodies_;           ///< all of them, in odom
  std::vector<geometry::Point2> maybe_there_;      ///< and those who were seen a little before
  std::vector<geometry::Point2> told_;             ///< and those who are remembered
  bool people_heard_ = false;                      ///< once
  bool people_known_ = false;                      ///< now
  std::vector<geometry::Point2> places_;           ///< theirs in a map's frame

  struct Contact {
    geometry::Point2 place;  ///< in map
    runtime::Time stamp;
  };
  std::vector<Contact> contacts_;  ///< of the whiskers, lately
  std::vector<geometry::Point2> contact_places_;

  std::uint64_t& rejected_scans_;
  std::uint64_t& placeless_scans_;
  std::uint64_t& invalid_ranges_;
  std::uint64_t& sensors_outside_;
  std::uint64_t& rejected_maps_;
  std::uint64_t& rejected_people_;
  std::string refused_map_;  ///< why; empty: the newest map was none that was refused
  Map local_, global_;
  std::optional<grid::OccupancyGrid> waiting_map_;  ///< for the window, until its place is known
  std::optional<Costmap> static_costs_;             ///< of the map alone, like global_
  grid::Grid<std::uint8_t> passing_;                ///< the global costs as published
  Beams laser_beams_, ultrasonic_beams_, depth_beams_, low_beams_, rear_beams_;
  runtime::Time laser_stamp_{};  ///< of the newest laser scan, on its own host's clock: for tf
  runtime::Time local_published_{};
  std::uint64_t last_request_ = 0;

  wire::TransformInput transforms_;
  runtime::Input<nav_msgs::msg::OccupancyGrid> map_;
  runtime::Input<sensor_msgs::msg::LaserScan> scan_;
  runtime::Input<sensor_msgs::msg::LaserScan> ultrasonic_;
  runtime::Input<sensor_msgs::msg::LaserScan> depth_, low_, rear_;
  runtime::Input<usher_msgs::msg::Whiskers> whiskers_;
  runtime::Input<usher_msgs::msg::People> people_;
  runtime::Input<usher_msgs::msg::CostmapRequest> request_;
  runtime::Output<usher_msgs::msg::Costmap> local_costs_;
  runtime::Output<usher_msgs::msg::Costmap> global_costs_;
  runtime::Output<nav_msgs::msg::OccupancyGrid> local_view_;
  runtime::Output<nav_msgs::msg::OccupancyGrid> global_view_;
  runtime::Timer global_timer_;
  runtime::Timer view_timer_;
};

}  // namespace usher::costmap
