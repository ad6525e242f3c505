#pragma once

#include <memory>
#include <optional>
#include <string>

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "sensing/scan_filter/core/scan_filter.hpp"
#include "wire/pitch_input.hpp"

namespace usher::scan_filter {

/// Takes floor, own body and lean out of laser and ultrasonic scans, with the pitch of each scan's
/// own time.
class ScanFilterComponent final : public runtime::Component {
 public:
  explicit ScanFilterComponent(runtime::Host& host);

 private:
  /// One sensor's way through the component.
  struct Channel {
    const char* frame = "";
    std::optional<ScanFilter> filter;
    std::shared_ptr<const sensor_msgs::msg::LaserScan> waiting;  ///< for the pitch of its time
    PlanarScan planar;
    bool placed = false;  ///< the frame is in tf_static
    runtime::Output<sensor_msgs::msg::LaserScan> output;
  };

  Channel make_channel(const char* frame, const ScanFilterConfig& config,
                       runtime::Output<sensor_msgs::msg::LaserScan> output);
  void filter_waiting();
  void take_scan(Channel& channel, std::shared_ptr<const sensor_msgs::msg::LaserScan> scan);
  void refuse(const Channel& channel, const std::string& reason);
  bool filter(Channel& channel, const sensor_msgs::msg::LaserScan& scan);
  void place_frames();

  runtime::Host& host_;
  wire::PitchInput pitch_;
  std::uint64_t& rejected_;
  std::uint64_t& without_pitch_;
  std::uint64_t &floor_, &high_, &mixed_, &invalid_;  ///< beams of the laser
  Channel laser_, ultrasonic_;
  runtime::Time laser_left_{};  ///< when the last laser scan did
  runtime::Input<sensor_msgs::msg::LaserScan> scan_;
  runtime::Input<sensor_msgs::msg::LaserScan> sonar_;
  runtime::Output<tf2_msgs::msg::TFMessage> frames_;
};

}  // namespace usher::scan_filter
