#pragma once

#include <optional>
#include <string>
#include <vector>

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "tasks/meeting/core/meeting.hpp"
#include "wire/keeper.hpp"
#include "wire/repeater.hpp"
#include "wire/transform_input.hpp"

namespace usher::meeting {

/// Calls meetings: takes requests, faces and answers, asks supervisor, navigator, explorer and
/// interaction_control, publishes screens and how the mission stands.
class MeetingComponent final : public runtime::Component {
 public:
  explicit MeetingComponent(runtime::Host& host);

 private:
  static Parameters read_parameters(runtime::Host& host);
  static Meeting make(runtime::Host& host);
  Time now() const { return host_.now().time_since_epoch(); }
  std::optional<Pose2> pose() const;
  Surroundings surroundings() const;
  void take_map(const nav_msgs::msg::OccupancyGrid& message);
  void take_locations(const usher_msgs::msg::Locations& message);
  void take_faces(const usher_msgs::msg::Faces& message);
  void see(const usher_msgs::msg::Faces& message, const Pose2& pose);
  void take_scan();
  void look(const sensor_msgs::msg::LaserScan& scan, const Pose2& map_T_scan);
  void take_request(const usher_msgs::msg::MeetingRequest& request);
  void take_team(const usher_msgs::msg::FleetMeeting& message);
  void tell_team();
  void take_answer(const usher_msgs::msg::DialogueAnswer& answer);
  void tick();
  void step() { act(core_.step(surroundings(), now())); }
  void act(const Actions& actions);
  void turn();
  void remember();
  void recall();
  void end_what_was_left();
  void publish_screen();
  void publish_status();
  std::string lacks() const;

  runtime::Host& host_;
  Meeting core_;
  std::uint64_t& rejected_;
  std::uint64_t& rejected_faces_;
  std::uint64_t& ignored_answers_;
  std::uint64_t ticks_ = 0;
  std::vector<Point2> points_;
  std::uint64_t told_ = 0;  ///< number of the last report to the fleet; above all of a life before
  wire::Keeper memory_;     ///< the mission's report while it goes on
  std::optional<Report> left_;                            ///< of a mission that a restart ended
  std::optional<usher_msgs::msg::ExploreGoal> explores_;  ///< what the explorer does for it

  wire::TransformInput transforms_;
  runtime::Input<usher_msgs::msg::SupervisorStatus> supervisor_;
  runtime::Input<usher_msgs::msg::NavigateStatus> navigation_;
  runtime::Input<usher_msgs::msg::ExploreStatus> exploration_;
  runtime::Input<usher_msgs::msg::LocalizationStatus> localization_;
  runtime::Input<nav_msgs::msg::OccupancyGrid> map_;
  runtime::Input<usher_msgs::msg::Locations> locations_;
  runtime::Input<usher_msgs::msg::Faces> faces_;
  runtime::Input<sensor_msgs::msg::LaserScan> scan_;
  runtime::Input<usher_msgs::msg::MeetingRequest> request_;
  runtime::Input<usher_msgs::msg::GoalCancel> cancel_;
  runtime::Input<usher_msgs::msg::DialogueAnswer> answers_;
  runtime::Output<usher_msgs::msg::DialogueScreen> screen_;
  runtime::Output<usher_msgs::msg::MeetingStatus> status_;
  runtime::Output<usher_msgs::msg::MeetingReport> reports_;
  runtime::Output<usher_msgs::msg::FaceTarget> target_;
  runtime::Output<usher_msgs::msg::GoalCancel> cancel_drive_, cancel_exploration_;
  runtime::Input<usher_msgs::msg::FleetMeeting> team_;
  runtime::Input<usher_msgs::msg::FleetLook> places_;
  runtime::Output<usher_msgs::msg::FleetMeeting> team_told_;
  runtime::Output<usher_msgs::msg::ExploreShare> share_;
  wire::Repeater<usher_msgs::msg::SupervisorRequest> requests_;
  wire::Repeater<usher_msgs::msg::NavigateGoal> goals_;
  wire::Repeater<usher_msgs::msg::ExploreGoal> explorations_;
  runtime::Timer timer_;
};

}  // namespace usher::meeting
