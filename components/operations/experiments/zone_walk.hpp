#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "operations/experiments/hall.hpp"
#include "operations/experiments/lockstep_run.hpp"

namespace usher::operations {

/// MARVIN in the middle of an empty hall, and one visitor who goes where told: what the robot makes
/// of where the visitor is, beside where that really is.
class ZoneWalk {
 public:
  struct Sample {
    double t = 0.0;                     ///< [s]
    double range = 0.0, bearing = 0.0;  ///< of the visitor in base_footprint, true [m, rad]
    std::string zone, pose;             ///< as the robot says
    bool posed = false;
    std::array<double, 7> joints{};   ///< measured [rad, m]
    std::array<float, 3> left_eye{};  ///< as shown
    double yaw = 0.0;                 ///< of the robot in map, true [rad]
  };

  /// The empty hall, the robot in its middle.
  static Hall hall();

  /// `folder` exists; the hall's site is written into it.
  static Result<std::unique_ptr<ZoneWalk>> create(const Installation& installation,
                                                  const std::string& folder,
                                                  const std::vector<Override>& overrides,
                                                  std::uint64_t seed);

  /// Until the robot poses for whom it sees, at most 60 s; an error says what stands in the way.
  Status get_ready();
  /// The visitor goes to this place in base_footprint as it lies now [m, rad, m/s], and stays.
  void send(double range, double bearing, double speed);
  /// The robot's recogniser listens from now on, or no longer.
  void listen(bool on) { listens_ = on; }
  /// [s]; notes a sample each 50 ms.
  void run(double seconds);
  /// Runs until the visitor is there, at most for so long [s].
  void arrive(double longest);

  const std::vector<Sample>& samples() const { return samples_; }
  const Sample& now() const { return now_; }
  LockstepRun& robot() { return *run_; }

 private:
  explicit ZoneWalk(std::unique_ptr<LockstepRun> run);
  void speak();

  std::unique_ptr<LockstepRun> run_;
  Sample now_;
  std::vector<Sample> samples_;
  geometry::Pose2 map_T_base_;
  geometry::Point2 visitor_ = geometry::Point2::Zero(), goal_ = geometry::Point2::Zero();
  bool poses_ = false;  ///< interaction_control may, and all is there
  bool listens_ = false;
};

}  // namespace usher::operations
