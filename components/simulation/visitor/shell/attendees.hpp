#pragma once

#include <map>
#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "simulation/visitor/core/attendee.hpp"
#include "wire/meeting_rooms.hpp"
#include "wire/repeater.hpp"

namespace usher::visitor {

/// Simulated people who are invited to meetings: answer the robot that stands before them and move
/// as people of the world.
class AttendeesComponent final : public runtime::Component {
 public:
  explicit AttendeesComponent(runtime::Host& host);

 private:
  struct Somebody {
    std::string name;
    Attendee mind;
    geometry::Point2 seat{0, 0};  ///< [m] in map, once it goes there
    bool has_seat = false;
    bool moved = false;
  };
  void take(const usher_msgs::msg::DialogueScreen& screen);
  void step();
  const Somebody* asked() const;
  bool is_called_in(const Somebody& somebody) const;
  void choose_seat(Somebody& somebody);

  runtime::Host& host_;
  std::vector<Somebody> people_;
  std::vector<wire::MeetingRoom> rooms_;
  std::map<std::string, std::vector<geometry::Point2>> seats_;  ///< of each room
  double reach_;
  double speed_;
  Screen shown_;
  std::string room_;
  runtime::Input<usher_msgs::msg::DialogueScreen> screen_;
  runtime::Input<usher_msgs::msg::MeetingStatus> meeting_;
  runtime::Input<usher_sim_msgs::msg::GroundTruth> truth_;
  wire::Repeater<usher_msgs::msg::DialogueAnswer> answers_;
  runtime::Output<usher_sim_msgs::msg::PersonGoal> walk_;
  runtime::Timer timer_;
};

}  // namespace usher::visitor
