#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foundation/grid/grid.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/run_record.hpp"
#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// Somebody who stands in the arena and looks at the robot.
struct MeetingPerson {
  std::string name;
  geometry::Point2 at{0, 0};  ///< [m] in map
  bool comes = false;         ///< says yes when it is invited; else it is asked nothing
  bool strays = false;        ///< stays behind on the way, the first time
};

/// A robot dies, all but its body, or one of its components, and is started again.
struct MeetingLoss {
  std::string robot;      ///< of a fleet
  double after = 0.0;     ///< [s] from the request
  double back = 0.0;      ///< [s] later; 0: never
  std::string component;  ///< the only one that dies; empty: all
};

struct MeetingCase {
  std::vector<MeetingPerson> people;
  geometry::Pose2 start;
  std::vector<geometry::Pose2> starts_of_others;  ///< of the robots of a fleet after the first
  std::optional<MeetingLoss> loss;
  std::uint32_t persons = 1;  ///< to be brought
  double longest = 900.0;     ///< [s]
  /// Ends the run before the mission's own end; empty: it does not.
  std::function<bool(const usher_msgs::msg::MeetingStatus&)> over;
};

struct MeetingRun {
  usher_msgs::msg::MeetingStatus
      status;  ///< the last one; of a fleet, of its first robot that is not lost
  std::map<std::string, usher_msgs::msg::MeetingStatus> statuses;  ///< of every robot, by name
  std::uint32_t robot_contacts = 0;  ///< with another robot, in `summary` too
  std::uint32_t robot_touches = 0;   ///< likewise, slow or unforeseeable ones
  double seconds = 0.0;              ///< from the request to the end
  std::string first_room;            ///< location of the first drive
  std::uint32_t missed = 0;   ///< times that somebody stood in view of the exploring robot for 1 s,
                              ///< and it went by; in a meeting room nobody is missed
  std::uint32_t present = 0;  ///< who really is in the meeting's room soon after the end
  std::string whereabouts;    ///< "ada 3.1 9.8; boole ..." [m], soon after the end
  std::vector<double> look_backs;  ///< [s] each, of those that saw whom the robot guided
  RunRecord::Summary summary;      ///< of a fleet, of its first robot, contacts and touches of all
  double wall = 0.0;               ///< [s]
  double simulated = 0.0;          ///< [s]
  std::uint64_t digest = 0;
  std::string complaints;
};

/// The meeting assistant at the pace of its report, 0.7 m/s and 0.4 rad/s: in the arena, or where
/// the site's file says.
Result<Deployment> meeting_deployment(const ExperimentOptions& options,
                                      const std::string& manifest = "meeting-demo.yaml",
                                      const std::string& site = {});

/// Two robots in the arena that call one meeting together, at the same pace.
Result<std::vector<Deployment>> meeting_fleet(const ExperimentOptions& options);

/// One mission in lock-step, called at the first robot of a fleet. People go through a file in
/// `folder`, named by `name`; with a `title` the run's picture, trace and states lie beside it.
Result<MeetingRun> run_meeting(std::vector<Deployment> fleet, const MeetingCase& one,
                               std::uint64_t seed, const std::string& folder,
                               const std::string& name, const std::string& title = {});
inline Result<MeetingRun> run_meeting(const Deployment& deployment, const MeetingCase& one,
                                      std::uint64_t seed, const std::string& folder,
                                      const std::string& name, const std::string& title = {}) {
  return run_meeting(std::vector{deployment}, one, seed, folder, name, title);
}

/// "1:05" of seconds.
std::string minutes(double seconds);

}  // namespace usher::operations
