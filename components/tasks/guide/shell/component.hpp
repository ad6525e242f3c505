#pragma once

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "tasks/guide/core/guide.hpp"
#include "wire/repeater.hpp"

namespace usher::guide {

/// The dialogue with the visitor: publishes screens, takes answers, asks supervisor and navigator.
class GuideComponent final : public runtime::Component {
 public:
  explicit GuideComponent(runtime::Host& host);

 private:
  static Parameters read_parameters(runtime::Parameters& parameters);
  Time now() const { return host_.now().time_since_epoch(); }
  Surroundings surroundings() const;
  void take_locations(const usher_msgs::msg::Locations& message);
  void take_supervisor(const usher_msgs::msg::SupervisorStatus& status);
  void step() { act(core_.step(surroundings(), now())); }
  void act(const Actions& actions);
  void publish_screen();

  runtime::Host& host_;
  Guide core_;
  float max_speed_;
  std::uint64_t& ignored_answers_;
  std::uint64_t& rejected_locations_;

  runtime::Input<usher_msgs::msg::SupervisorStatus> supervisor_;
  runtime::Input<usher_msgs::msg::NavigateStatus> navigation_;
  runtime::Input<usher_msgs::msg::Locations> locations_;
  runtime::Input<usher_msgs::msg::DialogueAnswer> answers_;
  runtime::Output<usher_msgs::msg::DialogueScreen> screen_;
  wire::Repeater<usher_msgs::msg::SupervisorRequest> requests_;
  wire::Repeater<usher_msgs::msg::NavigateGoal> goals_;
  runtime::Output<usher_msgs::msg::GoalCancel> cancel_;
  runtime::Timer timer_;
};

}  // namespace usher::guide
