#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "simulation/visitor/core/delivery.hpp"
#include "simulation/visitor/core/hearing.hpp"
#include "simulation/visitor/core/visitor.hpp"
#include "simulation/visitor/shell/limbs.hpp"
#include "wire/repeater.hpp"

namespace usher::visitor {

/// A simulated visitor: answers the dialogue and moves a person of the world.
class VisitorComponent final : public runtime::Component {
 public:
  /// Without finger and mouth: writes its answers itself.
  explicit VisitorComponent(runtime::Host& host) : VisitorComponent(host, nullptr) {}
  /// With them, where the parameters say what they reach.
  VisitorComponent(runtime::Host& host, std::shared_ptr<Voice> voice);

 private:
  enum class Input : std::uint8_t { kTouch, kVoice, kMixed };
  static Character read_character(runtime::Parameters& parameters);
  static HearingRates read_hearing(runtime::Host& host);
  void take(const usher_msgs::msg::DialogueScreen& screen);
  void step();
  void give(const Choice& choice);
  void write(const Choice& choice, Means means);
  void deliver(double now);
  void speak(double now);
  bool at_screen(double now);
  /// Where the robot and somebody are, if it is told.
  std::optional<geometry::Pose2> robot() const;
  std::optional<geometry::Point2> place_of(const std::string& whom) const;
  void step_up(double range);
  void walk(double now);
  void block();
  void lead(double now);
  void come_back();
  geometry::Point2 led_along(std::size_t point) const {
    return {leads_along_[2 * point], leads_along_[2 * point + 1]};
  }
  void gather(bool crowded);
  void send(const std::string& whom, const geometry::Point2& place, double speed,
            bool follow = false);
  std::string label_of(const std::string& option) const;

  runtime::Host& host_;
  Visitor core_;
  std::string person_;
  double speed_;
  std::vector<double> leaves_to_;  ///< x, y [m] in map
  double steps_up_to_;             ///< [m] 0: stays where it is
  double comes_after_;             ///< [s]
  std::optional<double> invited_at_;
  bool steps_up_ = false;                               ///< is on the way to the screen
  std::vector<double> leads_along_;                     ///< x, y [m] in map, one after the other
  std::size_t led_past_ = 0;                            ///< points of it
  std::map<std::string, geometry::Point2> bystanders_;  ///< and where they stood before
  bool gathered_ = false;
  Input input_ = Input::kTouch;
  std::uint64_t turns_ = 0;
  std::unique_ptr<Limbs> limbs_;
  Delivery delivery_;
  Hearing hearing_;  ///< of the robot, where this visitor has no mouth
  std::uint64_t& fell_back_;
  std::uint64_t& said_;
  std::uint64_t& asked_back_;
  std::uint64_t& mistaken_;
  runtime::Input<usher_msgs::msg::DialogueScreen> screen_;
  runtime::Input<usher_msgs::msg::SpeechStatus> speech_;
  runtime::Input<usher_sim_msgs::msg::GroundTruth> truth_;
  wire::Repeater<usher_msgs::msg::DialogueAnswer> answers_;
  runtime::Output<usher_sim_msgs::msg::PersonGoal> walk_;
  Walk walks_ = Walk::kStand;
  runtime::Timer timer_;
};

}  // namespace usher::visitor
