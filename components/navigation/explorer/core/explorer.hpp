#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foundation/goal/goal_state.hpp"
#include "navigation/explorer/core/ground.hpp"
#include "navigation/explorer/core/seen_area.hpp"
#include "navigation/explorer/core/share.hpp"
#include "navigation/explorer/core/strategy.hpp"

namespace usher::explorer {

/// Times are seconds on any clock that does not go back.
struct ExplorerConfig {
  Camera camera;
  StrategyConfig strategy;
  std::vector<Rectangle> leave_out;  ///< nobody is looked for there
  double passing_room = 0.24;        ///< [m] from obstacles, to drive; [0.05, 2]
  double standing_room = 0.35;       ///< [m] to turn at a viewpoint; [passing_room, 2]
  int most_recoveries = 2;           ///< of the navigator, for one viewpoint; [0, 100]
  int most_failures = 5;             ///< viewpoints in a row that cannot be reached; [1, 100]
  double client_silence = 3.0;       ///< [s] of who asked, then it ends; [0.5, 60]
};

struct ExploreRequest {
  std::uint64_t id = 0;  ///< unique per client, not 0; a repeated one says that it is still wanted
  std::string client;
  std::uint32_t rounds = 0;  ///< 0 = until cancelled
  bool anew = false;         ///< else the round before goes on
  double max_speed = 0.0;    ///< [m/s] 0 = default
};

/// The navigator's word on one of its goals.
struct DriveReport {
  std::uint64_t id = 0;  ///< 0 = it has none
  std::string client;
  GoalState state = GoalState::kIdle;
  std::string reason;
  std::uint32_t recoveries = 0;  ///< that this goal has taken
};

/// What the robot knows now.
struct Situation {
  double time = 0.0;                      ///< [s]
  std::optional<Pose2> pose;              ///< in map; absent: not localized
  std::optional<DriveReport> navigation;  ///< absent: the navigator is not heard
  std::string client;                     ///< who the explorer is to the navigator
};

struct Drive {
  std::uint64_t id = 0;
  Pose2 view;
  double max_speed = 0.0;  ///< [m/s] 0 = default
};

/// What to tell the navigator now.
struct Decision {
  std::optional<Drive> drive;           ///< a new goal
  std::optional<std::uint64_t> cancel;  ///< the goal to give up
};

struct ExploreStatus {
  std::uint64_t id = 0;  ///< 0 = no goal yet
  std::string client;
  GoalState state = GoalState::kIdle;
  std::string reason;
  std::uint32_t round = 0;     ///< done since the goal began
  std::uint32_t views = 0;     ///< reached, or seen from the way
  std::uint32_t given_up = 0;  ///< viewpoints that could not be reached
  Pose2 view;
};

/// Sees to it that the camera looks everywhere: keeps book of what it saw, chooses viewpoints, and
/// has the navigator drive to one after the other. What it saw is kept while nobody explores, too.
class Explorer {
 public:
  /// The error names the value that is out of its range. Drives count up from `first_id`.
  static Result<Explorer> create(const ExplorerConfig& config, std::uint64_t seed,
                                 std::uint64_t first_id);

  /// Takes a map with nothing seen. An error leaves what was there.
  Status set_map(const grid::OccupancyGrid& map);
  /// What others look at is looked at after all else of a round. More places than Share::kMost, or
  /// an own one that is not among them, are an error and change nothing.
  Status set_share(const Share& share);
  /// The camera looks, with the robot, or another one that has the same camera, at this pose in
  /// map.
  void look(const Pose2& robot) { seen_.look(robot); }

  /// The newest goal wins; one that is none is refused and does not disturb what runs. Ends when
  /// it is not repeated: nobody would come for whom the robot finds.
  void request(const ExploreRequest& request);
  /// Id 0 cancels whatever runs. False when no such goal is active.
  bool cancel(std::uint64_t id);
  Decision step(const Situation& situation);

  const ExploreStatus& status() const { return status_; }
  bool active() const {
    return status_.state == GoalState::kActive || status_.state == GoalState::kWaiting;
  }
  const SeenArea& seen() const { return seen_; }

 private:
  Explorer(const ExplorerConfig& config, SeenArea seen, std::unique_ptr<Strategy> strategy,
           std::uint64_t first_id)
      : config_(config),
        seen_(std::move(seen)),
        strategy_(std::move(strategy)),
        last_drive_(first_id) {}

  void begin_round();
  void divide_work();
  void wait(const std::string& reason);
  void finish(GoalState state, const std::string& reason);
  void follow_drive(const Situation& situation);
  void take_report(const Situation& situation, const DriveReport& report);
  void reached();
  void failed(const std::string& reason);
  void choose(const Situation& situation);
  std::optional<Pose2> next_view(const Pose2& robot);
  void send(const Situation& situation);

  ExplorerConfig config_;
  SeenArea seen_;
  std::unique_ptr<Strategy> strategy_;
  Ground ground_;
  std::vector<Point2> given_up_;
  Share share_;
  std::vector<std::uint8_t> of_others_;  // per cell; empty: nothing is divided

  ExploreStatus status_;
  ExploreRequest request_;
  bool driving_ = false;  // a viewpoint was sent and is neither reached nor given up
  std::uint64_t last_drive_ = 0;
  bool answered_ = false;  // the navigator has named the drive
  bool asked_ = false;     // since the last step
  double asked_at_ = 0.0;
  double sent_at_ = 0.0;
  int failures_ = 0;  // in a row
  Decision decision_;
};

}  // namespace usher::explorer
