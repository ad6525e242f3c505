#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "foundation/cpu/cpu.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/grid/wavefront.hpp"
#include "foundation/kinematics/acceleration_limiter.hpp"
#include "foundation/kinematics/stopping_distance.hpp"
#include "foundation/kinematics/whisker_rods.hpp"
#include "foundation/result/result.hpp"
#include "navigation/local_planner/core/contact.hpp"
#include "navigation/local_planner/core/lane.hpp"
#include "navigation/local_planner/core/path_follower.hpp"
#include "navigation/local_planner/core/reference_path.hpp"
#include "navigation/local_planner/core/rollout.hpp"
#include "navigation/local_planner/core/trail.hpp"

namespace usher::local_planner {

/// How strongly each critic counts; the trajectory with the smallest weighted sum wins. README.md
/// has the formulas.
struct CriticWeights {
  double path = 1.2;        ///< per metre from the path, mean over the trajectory
  double goal = 1.0;        ///< per metre of way left to the local goal
  double alignment = 0.6;   ///< per metre from the path, seen from a point ahead
  double goal_front = 0.4;  ///< per metre of way left, seen from a point ahead
  double obstacle =
      1.0;  ///< for the mean cost under the base, 0..1, and for a way that ends at an obstacle
  double moving_obstacle = 2.0;  ///< for brushing past a moving disc, 0..1
  double speed = 1.0;            ///< for the lacking part of the allowed speed, 0..1
  double twirling = 0.03;        ///< per rad/s
  double smoothness = 0.15;      ///< per rad/s and per m/s of change of the target command
  double oscillation = 1e3;      ///< for turning back and forth on the spot, 0 or 1
};

/// Which velocities are sampled.
enum class Sampling : std::uint8_t {
  kDynamicWindow,      ///< those that can be reached within `window` [fox1997dynamic]
  kTrajectoryRollout,  ///< those that can be reached within the simulated time [gerkey2008planning]
};

struct DynamicWindowConfig {
  Footprint footprint = Footprint::rectangle(0.61, 0.61);
  kinematics::WhiskerMount whiskers;
  kinematics::StoppingDistance stopping;  ///< what "can be stopped" means
  kinematics::AccelerationLimits limits;  ///< of the command
  BaseResponse response;

  double pace = 1.15;          ///< [m/s] the speed to keep where it can be stopped
  double slowest = 0.1;        ///< [m/s] the base does not follow slower commands well
  double careful_speed = 0.4;  ///< [m/s] up to here half of the clearance is enough
  double clearance = 0.06;     ///< [m] kept around the outline above the careful speed
  double disc_clearance =
      0.2;  ///< [m] kept from moving discs above the careful speed, a quarter of it below
  double tight_speed =
      0.25;  ///< [m/s] where only the robot's own outline fits, not the whole lethal cells
  double fastest_turn = 1.0;   ///< [rad/s]
  double slowest_turn = 0.15;  ///< [rad/s] turning in place
  double spot_turn = 0.8;      ///< [rad/s] turning in place
  double tight_turn = 0.15;    ///< [rad/s] turning in place without half of the clearance,
                               ///< half as fast again without the whole
  /// [m/s2] bounds speed x turn rate, but where only a harder turn brakes past something.
  double lateral_acceleration = 0.8;
  double turn_stopping_time = 0.6;  ///< [s] a turn stops within this time x its rate
  double braking = 2.0;             ///< [m/s2] slope of the command when it must stop

  Sampling sampling = Sampling::kDynamicWindow;
  double window = 0.4;          ///< [s] of the dynamic window
  int speed_samples = 8;        ///< 3 to 64
  int turn_samples = 25;        ///< 3 to 255
  double simulated_time = 1.7;  ///< [s] 1 to 4
  int steps = 20;               ///< of the simulated time, 6 to 40

  double margin = 0.10;              ///< [m] left free after stopping
  double forward_point = 0.325;      ///< [m] ahead of the base: where alignment looks from
  double position_tolerance = 0.15;  ///< [m]
  double yaw_tolerance = 0.10;       ///< [rad]
  double turn_first_angle =
      1.2;  ///< [rad] between heading and path from which a moving robot stops to turn
  bool keep_left = false;  ///< to which side it makes room for who comes the other way
  bool unknown_is_lethal = false;
  CriticWeights weights;
};
/// Fails with what is out of its bounds.
Status check(const DynamicWindowConfig& config);

/// Follows a path on a local cost grid [fox1997dynamic, gerkey2008planning]. Grid, path, poses and
/// people are in one frame (odom). One call a control cycle, 10 to 50 Hz; a call costs some tens of
/// microseconds and allocates only when grid or samples grow. Same inputs, same decisions, on every
/// processor.
class DynamicWindow final  // NOLINT(clang-analyzer-optin.performance.Padding): there is one
    : public PathFollower {
 public:
  /// An error names the value that is out of its range.
  static Result<DynamicWindow> make(const DynamicWindowConfig& config,
                                    cpu::Simd simd = cpu::best_simd());

  /// A new path. Progress at the goal (position reached, turning) is kept when the goal stays
  /// within tolerance.
  Status set_path(std::span<const geometry::Pose2> path) override;
  void clear_path() override;
  double remaining() const override { return path_.remaining(); }
  /// What the corners touch from now on. A turn in place that a touch bars waits until the corner
  /// has been taken away: forward from a touch behind, backward from one in front. A touch of what
  /// the costs know anyway bars none that keeps half of the clearance for now.
  void set_touches(const kinematics::Whiskers& touches) override { touches_ = touches; }
  /// The speed to keep from now on [m/s]; at least `slowest`, not finite is refused.
  Status set_pace(double pace) override;

  /// Where the robot is, for backing off along its way; decide() notes it by itself.
  void note_place(const geometry::Pose2& pose) { trail_.add(pose); }

  /// `people`: everybody who is known to be one, also who stands, in the frame of the costs. Who
  /// walks, not behind the axle, is foreseen; who stands is where the costs say. Before whom it
  /// meets on its way it stands for a while and lets them pass.
  Decision decide(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& pose,
                  const geometry::Twist2& measured, const geometry::Twist2& last_command,
                  double seconds_since_last, std::span<const MovingDisc> people = {}) override;

  /// Recovery: back the way it came at `speed` [m/s, positive], straight where it does not know
  /// that way, while the footprint meets nothing, and nobody, that it does not touch already. Stops
  /// (kBlocked) otherwise. Nobody sees behind: the navigator bounds the way.
  Decision back_off(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& pose,
                    const geometry::Twist2& measured, const geometry::Twist2& last_command,
                    double seconds_since_last, double speed,
                    std::span<const MovingDisc> people = {}) override;
  /// Recovery: turns in place at `rate` [rad/s, either sign], checked in the same way.
  Decision rotate(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& pose,
                  const geometry::Twist2& measured, const geometry::Twist2& last_command,
                  double seconds_since_last, double rate,
                  std::span<const MovingDisc> people = {}) override;

  const DynamicWindowConfig& config() const { return config_; }
  const ReferencePath& path() const { return path_; }

 private:
  struct Input {
    const grid::Grid<std::uint8_t>& costs;
    geometry::Pose2 pose;
    geometry::Twist2 measured;
    geometry::Twist2 last_command;
    double seconds = 0.0;
    std::span<const MovingDisc> people;
    std::span<const MovingDisc> walkers;  // of them
  };

  DynamicWindow(const DynamicWindowConfig& config, cpu::Simd simd);

  bool valid(const Input& input) const;
  void stand_in_the_way(const Input& input);
  void find_walkers(const geometry::Pose2& pose, std::span<const MovingDisc> people);
  void find_neighbours(const Input& input);
  void keep_speed(double v);
  void load(const Input& input);
  void explain_touches(const Input& input);

  // What to do (dynamic_window.cpp).
  Decision at_goal(const Input& input);
  std::optional<Decision> turn_a_little(const Input& input, double angle);
  std::optional<Decision> free_corner(const Input& input, double angle);
  Decision turn_to(const Input& input, double yaw, Reason reason);
  Decision follow(const Input& input);
  Decision brake(const Input& input);
  bool gives_way(const Input& input);
  bool somebody_beside(const Input& input) const;
  double speed_before_people(const Input& input) const;
  Decision halt(const Input& input, Reason reason, double deceleration) const;
  Decision drive(const Input& input, const ContactTests& contacts, double fastest,
                 double corner_speed);
  double no_faster_than_it_rolls(const Input& input, const Decision& decision) const;
  void spare_front(const Input& input, Decision& decision);
  Decision recover(const Input& input, const geometry::Twist2& wanted);
  int turn_of_tail() const;
  bool must_turn_first(const Input& input, double& heading);
  bool touches(const Input& input, const ContactTest& contact, const geometry::Pose2& pose) const;
  bool leads_out(const Input& input, double error);
  bool is_given_up(const geometry::Point2& position, int sense);
  void forget_other_places(const geometry::Point2& position);
  double creeping_turn(const Input& input) const;
  double turn_rate(const Input& input, double angle) const;
  bool leave_out_people(const Input& input);
  geometry::Twist2 ramped(const Input& input, const geometry::Twist2& target, double fall) const;

  // What the critics see (critics.cpp).
  void choose_local_goal(const Input& input);
  bool leaves_window(const Input& input, const geometry::Point2& place) const;
  double obstacle_on_path(const Input& input) const;
  void sample(const Input& input, double fastest);
  void sample_turns(const Input& input, double reach, int steps);
  void measure_path(const Input& input);
  double way_left(const std::vector<std::uint16_t>& lengths, const Input& input, double x,
                  double y) const;
  int best_trajectory(const Input& input, double fastest, CriticScores& best);
  bool rolls_out_free(const Input& input, std::size_t index) const;
  CriticScores score(const Input& input, std::size_t index, double fastest) const;
  bool forbidden_turn(double speed, double turn) const;
  void note_turn(const Input& input, const geometry::Twist2& command);

  DynamicWindowConfig config_;
  ContactTest roomy_;   // whole cells, with clearance
  ContactTest narrow_;  // whole cells, with half of it: what the prediction may be wrong by
  ContactTest whole_;   // whole cells
  ContactTest center_;  // centers of cells
  Rollout rollout_;
  grid::Wavefront wavefront_;
  ReferencePath path_;
  PolylineDistance path_distance_;
  Lane lane_;
  std::vector<MovingDisc> walkers_;
  std::vector<MovingDisc> neighbours_;
  /// Free steps of each arc to brake on, people in the way, and without them.
  std::vector<int> among_people_, without_people_;
  SpeedProfile kept_;
  std::optional<double> arc_, braked_arc_;    ///< [1/m] that it brakes on, now and a cycle before
  double gave_way_ = 0.0, met_nobody_ = 0.0;  // [s]
  LethalBits bits_;

  bool position_reached_ = false;
  int turning_ = 0;  // +1, -1: turning first, in this sense
  struct {
    geometry::Point2 at = geometry::Point2::Constant(1e9);
    int left = 0, right = 0;
    int freeing = 0;  // +1, -1: the last corner was freed forward, back
    int to_and_fro = 0;
  } barred_;  // how often a turn at a place could not go on in a sense
  struct WayOut {
    geometry::Point2 at;
    double error;  // [rad]
  };
  std::optional<WayOut> way_out_;   // where it began to look for room to turn towards its path
  std::optional<double> turns_to_;  // [rad] on an arc, since there is no room to turn in place
  double oscillation_sign_ = 0.0, oscillation_forbidden_ = 0.0;
  geometry::Pose2 oscillation_pose_;
  Trail trail_;
  kinematics::WhiskerRods rods_;
  kinematics::Whiskers touches_, unexplained_;
  std::vector<geometry::Point2> at_whiskers_;  // lethal cells, in base_footprint
  std::optional<geometry::Pose2> touched_at_;  // in front, where it waits
  double careful_turn_ = 0.0;                  // [rad/s] the fastest without the whole clearance
  bool tight_ = false;  // only its own outline fits: the path's line counts for more

  double local_goal_arc_ = 0.0;
  bool goal_in_window_ = false;
  bool way_open_ = false;  // the local goal can be reached around the obstacles of the window
  bool aligned_ =
      false;  // alignment and goal-front count: the goal is farther than the forward point
  std::vector<std::uint16_t> goal_lengths_, front_lengths_;
  std::vector<SpeedProfile> speeds_, turns_;
  std::vector<float> points_x_, points_y_,
      point_distances_;         // 4 per trajectory: three parts, the point ahead
  std::vector<double> totals_;  // of the scores; infinite where it may not be driven
  std::vector<geometry::Pose2> winner_;
};

}  // namespace usher::local_planner
