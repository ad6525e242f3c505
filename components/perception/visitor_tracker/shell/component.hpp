#pragma once

#include <vector>

#include "idl/topics.hpp"
#include "perception/visitor_tracker/core/visitor_tracker.hpp"
#include "runtime/api/host.hpp"

namespace usher::visitor_tracker {

/// Says which of the people around is the visitor. Driven by the people tracker's messages.
class VisitorTrackerComponent final : public runtime::Component {
 public:
  explicit VisitorTrackerComponent(runtime::Host& host);

 private:
  static Config read_config(runtime::Parameters& parameters);
  void take(const usher_msgs::msg::People& people);
  Service service() const;
  void publish(const Estimate& estimate, runtime::Time stamp);
  void report();

  runtime::Host& host_;
  VisitorTracker core_;
  std::vector<Person> people_;
  std::uint64_t& rejected_;

  runtime::Input<usher_msgs::msg::People> input_;
  runtime::Input<nav_msgs::msg::Odometry> odom_;
  runtime::Input<usher_msgs::msg::GuideStatus> guide_;
  runtime::Output<usher_msgs::msg::Visitor> visitor_;
};

}  // namespace usher::visitor_tracker
