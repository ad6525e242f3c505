#pragma once

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "simulation/visitor/core/visitor.hpp"
#include "wire/repeater.hpp"

namespace usher::visitor {

/// A simulated visitor: answers the dialogue and moves a person of the world.
class VisitorComponent final : public runtime::Component {
 public:
  explicit VisitorComponent(runtime::Host& host);

 private:
  static Character read_character(runtime::Parameters& parameters);
  void take(const usher_msgs::msg::DialogueScreen& screen);
  void step();

  runtime::Host& host_;
  Visitor core_;
  std::string person_;
  double speed_;
  std::vector<double> leaves_to_;  ///< x, y [m] in map
  std::uint8_t input_;
  runtime::Input<usher_msgs::msg::DialogueScreen> screen_;
  wire::Repeater<usher_msgs::msg::DialogueAnswer> answers_;
  runtime::Output<usher_sim_msgs::msg::PersonGoal> walk_;
  Walk walks_ = Walk::kStand;
  runtime::Timer timer_;
};

}  // namespace usher::visitor
