#pragma once

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "simulation/visitor/core/visitor.hpp"

namespace usher::visitor {

/// A simulated visitor: answers the dialogue and moves a person of the world.
class VisitorComponent final : public runtime::Component {
 public:
  explicit VisitorComponent(runtime::Host& host);

 private:
  void step();

  runtime::Host& host_;
  Visitor core_;
  std::string person_;
  double speed_;
  std::uint64_t answers_ = 0;
  runtime::Input<usher_msgs::msg::DialogueScreen> screen_;
  runtime::Output<usher_msgs::msg::DialogueAnswer> answer_;
  runtime::Output<usher_sim_msgs::msg::PersonGoal> walk_;
  runtime::Timer timer_;
};

}  // namespace usher::visitor
