#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "idl/topics.hpp"
#include "perception/people_detector/core/camera_view.hpp"
#include "perception/people_detector/core/leg_finder.hpp"
#include "perception/people_detector/core/person_ahead.hpp"
#include "runtime/api/host.hpp"
#include "wire/transform_input.hpp"

namespace usher::people_detector {

/// What the detector and its stand-in without pixels share: legs in the laser's scan, faces, the
/// tracker, and what is told of it.
class Following {
 public:
  /// `trouble` says what is wrong with the cameras; empty: nothing.
  Following(runtime::Host& host, std::function<std::string()> trouble);

  /// What a camera saw from a place at a time; late is counted, people are told of.
  void see(Source source, runtime::Time stamp, std::span<const Sighting> sightings,
           const geometry::Pose2& odom_T_base, const geometry::Pose2& base_T_foot);
  /// Says how the component is, now.
  void report();

  wire::TransformInput& transforms() { return transforms_; }

 private:
  void take_faces(const usher_msgs::msg::Faces& message);
  void see_faces(const usher_msgs::msg::Faces& message, runtime::Time stamp,
                 const geometry::Pose2& odom_T_base);
  void take_map(const nav_msgs::msg::OccupancyGrid& message);
  void take_scan(std::shared_ptr<const sensor_msgs::msg::LaserScan> scan);
  void update(const sensor_msgs::msg::LaserScan& scan, runtime::Time stamp,
              const geometry::Pose2& odom_T_base);
  /// map_T_odom, the newest; nothing where it is old: the walls are elsewhere by it.
  std::optional<geometry::Pose2> localization() const;
  bool followed(const geometry::Point2& in_odom) const;
  void note(runtime::Time stamp, const geometry::Pose2& odom_T_base);
  bool looks(Source source) const;
  void publish();
  void publish_frames();
  void publish_ahead();

  /// Where the base was at the newest sample, and how it moved since the one before.
  struct Motion {
    runtime::Time stamp{};
    geometry::Pose2 odom_T_base;
    geometry::Twist2 twist;
  };

  runtime::Host& host_;
  std::function<std::string()> trouble_;
  SightingErrors errors_;
  double in_wall_;
  bool show_frames_;
  AheadConfig ahead_;
  std::optional<LegFinder> legs_;
  std::optional<Tracker> tracker_;
  std::optional<Motion> motion_;
  std::vector<Observation> observations_;
  std::vector<Sighting> faced_;
  const char* legs_trouble_ = "";
  std::string refused_map_;  ///< why; empty: the newest map was none that was refused
  runtime::Time last_scan_{}, newest_{}, published_{}, framed_{};
  std::array<std::optional<runtime::Time>, kSources>
      looked_{};  ///< when people were last looked for
  usher_msgs::msg::People message_;
  tf2_msgs::msg::TFMessage frames_message_;
  std::uint64_t& rejected_;
  std::uint64_t& late_;
  std::uint64_t& late_scans_;
  std::uint64_t& rejected_faces_;
  std::uint64_t& rejected_maps_;

  wire::TransformInput transforms_;
  runtime::Input<nav_msgs::msg::OccupancyGrid> map_;
  runtime::Input<sensor_msgs::msg::LaserScan> scan_;
  runtime::Input<usher_msgs::msg::Faces> faces_;
  runtime::Output<usher_msgs::msg::People> people_;
  runtime::Output<usher_msgs::msg::PersonAhead> person_ahead_;
  runtime::Output<tf2_msgs::msg::TFMessage> frames_;
};

}  // namespace usher::people_detector
