#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "simulation/world/core/torso.hpp"
#include "simulation/world/core/world.hpp"
#include "simulation/world/shell/depth_output.hpp"

namespace usher::world {

/// The world as one component: simulated devices and ground truth out, commands of the wheels and
/// of scripted people in. Paced by its host's clock; says how far it is behind. Robots of a fleet
/// have a world each, that tell each other where the robots are; one of them moves the people.
class WorldComponent final : public runtime::Component {
 public:
  explicit WorldComponent(runtime::Host& host);

 private:
  static WorldConfig read_robot(runtime::Host& host);
  std::unique_ptr<World> make(runtime::Host& host);
  void take_command(const usher_sim_msgs::msg::BaseCommand& command);
  void take_person_goal(const usher_sim_msgs::msg::PersonGoal& goal);
  void move_person(const usher_sim_msgs::msg::PersonGoal& goal, const std::string& leader);
  void take_body(const usher_sim_msgs::msg::FleetBody& body);
  void take_torso(const usher_sim_msgs::msg::TorsoCommand& command);
  void take_people(const usher_sim_msgs::msg::FleetPeople& message);
  void publish_to_fleet();
  void advance(std::uint64_t skipped);
  void publish_feedback();
  void publish_scan();
  void publish_sensor_board();
  void publish_torso();
  void publish_truth();

  runtime::Host& host_;
  std::uint64_t seed_ = 0;
  std::string people_of_;  ///< robot whose world moves the people; empty: this one does
  Torso torso_;
  std::unique_ptr<World> world_;  ///< null while the component is only described
  runtime::Time start_{};
  std::int64_t steps_ = 0;
  std::int64_t scan_every_ = 2;  ///< [steps]
  std::map<std::string, OtherRobot> others_;
  double range_min_ = 0.5;  ///< [m]
  std::unique_ptr<DepthOutput> depth_;
  sensor_msgs::msg::LaserScan scan_;
  usher_sim_msgs::msg::SensorBoardReading board_;
  std::uint64_t& rejected_;
  std::uint64_t& late_steps_;
  runtime::Time fell_behind_at_{};

  runtime::Input<usher_sim_msgs::msg::BaseCommand> command_;
  runtime::Input<usher_sim_msgs::msg::PersonGoal> person_goal_;
  runtime::Input<usher_sim_msgs::msg::SensorBoardCommand> tilt_command_;
  runtime::Input<usher_sim_msgs::msg::TorsoCommand> torso_command_;
  runtime::Output<usher_sim_msgs::msg::BaseFeedback> feedback_;
  runtime::Output<sensor_msgs::msg::LaserScan> scans_;
  runtime::Output<usher_sim_msgs::msg::SensorBoardReading> boards_;
  runtime::Output<usher_sim_msgs::msg::TorsoReading> torsos_;
  runtime::Output<usher_sim_msgs::msg::GroundTruth> truth_;
  runtime::Output<usher_sim_msgs::msg::FleetBody> bodies_;
  runtime::Output<usher_sim_msgs::msg::FleetPeople> people_;
  runtime::Output<usher_sim_msgs::msg::FleetPersonGoal> person_goals_;
  runtime::Timer timer_;
};

}  // namespace usher::world
