#pragma once

#include "idl/topics.hpp"
#include "interaction/phrases/shell/place_titles.hpp"
#include "runtime/api/host.hpp"
#include "tasks/guide/core/guide.hpp"
#include "tasks/guide/core/visit_log.hpp"
#include "wire/keeper.hpp"
#include "wire/repeater.hpp"
#include "wire/transform_input.hpp"

namespace usher::guide {

/// The dialogue with the visitor: publishes screens, takes answers, asks supervisor and navigator.
class GuideComponent final : public runtime::Component {
 public:
  explicit GuideComponent(runtime::Host& host);

 private:
  static Parameters read_parameters(runtime::Parameters& parameters);
  static Guide make(runtime::Host& host, const std::string& kept);
  Time now() const { return host_.now().time_since_epoch(); }
  Surroundings surroundings() const;
  void place(const usher_msgs::msg::Visitor& visitor);
  void take_locations(const usher_msgs::msg::Locations& message);
  void take_supervisor(const usher_msgs::msg::SupervisorStatus& status);
  void take_answer(const usher_msgs::msg::DialogueAnswer& answer);
  void tick();
  void step() { act(core_.step(surroundings(), now())); }
  void act(const Actions& actions);
  void publish_screen();
  void publish_status();
  usher_msgs::msg::GuideVisit to_message(const Visit& visit) const;

  runtime::Host& host_;
  wire::Keeper memory_;
  wire::Keeper visits_kept_;
  Guide core_;
  VisitLog log_;
  float max_speed_;
  std::uint64_t& ignored_answers_;
  std::uint64_t& rejected_locations_;
  phrases::PlaceTitles titles_;
  std::uint64_t ticks_ = 0;
  usher_msgs::msg::GuideStatus told_;               ///< the newest status
  std::optional<geometry::Point2> visitor_in_map_;  ///< [m] of the newest sighting
  std::uint64_t placed_ = 0;                        ///< sightings

  wire::TransformInput transforms_;
  runtime::Input<usher_msgs::msg::SupervisorStatus> supervisor_;
  runtime::Input<usher_msgs::msg::NavigateStatus> navigation_;
  runtime::Input<usher_msgs::msg::FollowStatus> follow_;
  runtime::Input<usher_msgs::msg::Locations> locations_;
  runtime::Input<usher_msgs::msg::LocalizationStatus> localization_;
  runtime::Input<usher_msgs::msg::Visitor> visitor_;
  runtime::Input<usher_msgs::msg::SpeechStatus> speech_;
  runtime::Input<usher_msgs::msg::TorsoStatus> torso_;
  runtime::Input<usher_msgs::msg::DialogueAnswer> answers_;
  runtime::Output<usher_msgs::msg::DialogueScreen> screen_;
  runtime::Output<usher_msgs::msg::GuideStatus> status_;
  runtime::Output<usher_msgs::msg::GuideVisit> visits_;
  runtime::Output<usher_msgs::msg::NavigatePace> pace_;
  wire::Repeater<usher_msgs::msg::SupervisorRequest> requests_;
  wire::Repeater<usher_msgs::msg::NavigateGoal> goals_;
  runtime::Output<usher_msgs::msg::GoalCancel> cancel_;
  runtime::Output<usher_msgs::msg::FaceTarget> target_;
  runtime::Timer timer_;
};

}  // namespace usher::guide
