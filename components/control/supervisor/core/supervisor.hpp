#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "control/supervisor/core/behavior.hpp"
#include "control/supervisor/core/fault_log.hpp"
#include "control/supervisor/core/heartbeat_table.hpp"
#include "control/supervisor/core/memory.hpp"
#include "drivers/base_obedience/core/base_obedience.hpp"
#include "drivers/base_obedience/core/response_watch.hpp"
#include "drivers/base_obedience/core/writer_right.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/goal/goal_state.hpp"
#include "foundation/result/result.hpp"

namespace usher::supervisor {

using drive::WriterSighting;

/// A topic that moves the robot, or by which it decides where to move, and who may write it.
struct WatchedTopic {
  std::string name;
  std::vector<std::string> participants;  ///< names in the manifest
  bool moves = true;  ///< the status lists its writers; of the others only foreign ones
};

/// Names in the manifest that the supervisor has a field or a rule for.
struct Names {
  std::string movement = "movement_control";  ///< the one that may write drive/command
  std::string interaction = "interaction_control";
  std::string gui = "tablet";
  std::string navigation = "navigator";
  std::string base = "segway_rmp";  ///< the driver, blamed for what the base does
};

struct Parameters {
  std::vector<WatchedComponent> components;  ///< from the manifest
  /// The first one is drive/command, whose writer gets the right to drive.
  std::vector<WatchedTopic> topics{{"drive/command", {"movement_control"}}};
  /// Of `topics`, on which the base tells of itself. Its epoch is believed of nobody who does not
  /// hold the right to write that; where that is not watched, since no component of the manifest
  /// writes it, of everybody, as far as a base would follow.
  std::string base_topic;
  std::uint64_t idl_digest = 0;  ///< of the supervisor's own build
  Names names;
  Time dwell = std::chrono::milliseconds(250);  ///< least time in Inactive; outlasts old commands
  double degraded_speed_factor = 0.5;           ///< {0..1}
  bool movement_on_at_start = true;
  /// Clients who may clear faults, and whose kMovementOn also ends the stops of others.
  std::vector<std::string> operators{"operator", "manual_control"};
  Time claim_slack = std::chrono::milliseconds(20);      ///< see WriterRight
  Time command_expiry = std::chrono::milliseconds(120);  ///< as at the base
  Time refusal_patience =
      std::chrono::milliseconds(300);                     ///< a new right takes its way to the base
  Time barred_patience = std::chrono::milliseconds(500);  ///< so long it may stand and not say why
  Time base_age = std::chrono::milliseconds(150);         ///< {> 0} nobody drives an older report
  Time reset_patience = std::chrono::seconds(5);          ///< for a base that leaves its emergency
  /// So long the holder of the right to drive may go on driving, or turning a base that stands,
  /// after movement was switched off, and so long turning one that rolls, on its arc.
  Time stop_patience = std::chrono::milliseconds(400), roll_out_patience = std::chrono::seconds(3);
  bool emergency_stop_when_disobeying = true;  ///< see ResponseWatch::runs_away
  drive::ResponseWatch::Parameters response;
  double process_rate = 50.0;                             ///< [Hz] reported only
  double camera_angle_default = 0.0;                      ///< [rad] up is positive
  double camera_angle_interaction = 0.17453292519943295;  ///< [rad] 10 deg
  double camera_angle_navigation = -0.08726646259971647;  ///< [rad] -5 deg
};

/// The numbers are those of SupervisorRequest on the wire.
enum class Command : std::uint8_t {
  kNone = 0,
  kStop = 1,  ///< movement off until kMovementOn; the state stays
  kMovementOn = 2,
  kManualOn = 3,
  kManualOff = 4,
  kNavigationStart = 5,  ///< a goal is chosen
  kNavigationGo = 6,     ///< the visitor is ready
  kNavigationEnd = 7,    ///< given up
  kEmergencyStop = 8,    ///< motors off, latched; of others than operators kStop, since it drops
                         ///< a balancing robot among people
  kClear = 9,            ///< ends latched faults whose cause is gone; operators only
};

/// What stops the robot, by whomever, in whose name ever, it is asked.
constexpr bool stops(Command command) {
  return command == Command::kStop || command == Command::kEmergencyStop;
}

struct Request {
  std::uint64_t id = 0;
  std::string client;
  Command command = Command::kNone;
  std::string goal;      ///< for kNavigationStart
  bool own_name = true;  ///< the client is the participant that wrote it
};

/// What became of a request.
struct Answer {
  std::uint64_t id = 0;
  bool done = false;
  std::string reason;  ///< why it was refused; empty when done
};

struct BaseReport {
  bool emergency = false;     ///< its motors are off after an emergency stop
  bool ready = true;          ///< its motors are on and it takes commands
  geometry::Twist2 measured;  ///< what it does
  std::uint64_t epoch = 0;    ///< the highest that it ever heard
  Time age{};                 ///< {>= 0} of the measurement when it arrived
  std::string refusal;        ///< why it does not drive what it is told; empty when it does
  double battery_percent = std::numeric_limits<double>::quiet_NaN();  ///< {0..100, NaN unknown}
  WriterId writer{};                                                  ///< who says so
};

/// What is to be published, at 50 Hz and after each event.
struct Decision {
  State state = State::kInitialise;
  drive::Grant grant;  ///< the writer is kNobody while nobody may drive
  Enables enables;
  double speed_factor = 1.0;    ///< {0..1}
  bool emergency_stop = false;  ///< the base shall switch its motors off
  bool reset_base = false;      ///< the base shall leave its emergency
  double camera_angle = 0.0;    ///< [rad]
  std::string_view reason;      ///< why the robot may not move; valid until the next call
};

/// Somebody who can write a watched topic.
struct CommandWriter {
  std::string topic;
  WriterSighting sighting;
  Time since{};          ///< when discovery saw it
  bool allowed = false;  ///< not foreign
  bool granted = false;  ///< holds the right to drive
};

/// Appendix A.3 of the thesis, without its topic names, and what an operator wants to know besides.
/// The power that A.3 speaks of is here the base's battery: nothing else tells of any.
struct SupervisorStatus {
  Time timeout_movement{};
  Time timeout_interaction{};
  Time timeout_power{};
  double process_rate = 0.0;
  double camera_angle_default = 0.0;
  double camera_angle_interaction = 0.0;
  double camera_angle_navigation = 0.0;
  State state = State::kInitialise;
  std::string current_goal;
  GoalState navigation = GoalState::kIdle;
  bool ok_movement = false;
  bool ok_interaction = false;
  bool ok_power = false;  ///< the battery is not empty
  bool connected_movement = false;
  bool connected_interaction = false;
  bool connected_power = false;  ///< its charge is heard
  bool connected_gui = false;
  bool connected_navigation = false;
  Enables enables;
  bool granted = false;
  std::uint64_t epoch = 0;
  double speed_factor = 1.0;            ///< {0..1}
  double camera_angle = 0.0;            ///< [rad] asked now
  std::string reason;                   ///< why the robot may not move; empty when it may
  std::vector<std::string> stopped_by;  ///< whose stops hold; movement is off while there are any
  std::vector<ComponentHealth> components;  ///< in the manifest's order
  std::vector<Fault> faults;                ///< newest last
  std::vector<CommandWriter> writers;       ///< see WatchedTopic
  Answer last_request;
  std::string last_client;  ///< whose request that was
};

/// Decides who may drive and what is enabled.
///
/// The right to drive is granted while every critical component is able, exactly one writer of
/// drive/command is there and it is the right one, the base reports and is in no emergency, and no
/// latched fault is active. Everything else is withheld at once; each new grant has a higher epoch.
///
/// Latched, until an operator clears them: a foreign writer on a watched topic, a disobeying base,
/// a holder of the right to drive who does not stand when movement is off, an emergency stop. The
/// loss of a component ends by itself.
///
/// Feed it what is heard, then call step(). `now` must not go back.
class Supervisor {
 public:
  Supervisor(const Parameters& parameters, Memory memory);

  void heartbeat(const Heartbeat& heartbeat, Time now);
  /// Discovery of writers on a watched topic; other topics are ignored.
  void writer_appeared(std::string_view topic, const WriterSighting& sighting, Time now);
  void writer_gone(std::string_view topic, const WriterId& writer);
  /// The participant that owns the writer shows life.
  void alive(const WriterId& writer, Time now);
  /// A sample of drive/command.
  void drive_command(const WriterId& writer, const geometry::Twist2& twist, Time now);
  void base(const BaseReport& report, Time now);
  /// movement_control's word why it commands zero; empty when it drives, or is told to stand.
  void movement(const std::string& barred_by, Time now);
  /// The navigator's status; `id` names the goal that it speaks of.
  void navigation(std::uint64_t id, GoalState state);
  /// The explorer's status: whether an exploration lasts that this client asked for. One that the
  /// client of the present navigation asked for is a journey of many goals: none of them ends the
  /// navigation, its own end does.
  void exploration(std::string_view client, bool lasts);
  /// The explorer is silent: from now on goals end the navigation as ever.
  void exploration_lost() { exploring_ = false; }

  /// Carries out or refuses. The same id of the same client gets the same answer and acts once.
  /// What somebody asks in another one's name is neither remembered nor answered in the status: the
  /// other one's own request may have that id. However many others ask, what operators asked is
  /// remembered and its answer told.
  Answer request(const Request& request, Time now);

  const Decision& step(Time now);
  const Decision& decision() const { return decision_; }

  SupervisorStatus status() const;
  /// To be kept over restarts whenever it differs from the last one.
  Memory memory() const;

  /// What became of keeping the memory: an error is a fault that bars nothing, until it is kept.
  void memory_kept(const Status& outcome, Time now);

  std::uint64_t unknown_heartbeats() const { return unknown_heartbeats_; }
  std::uint64_t rejected_reports() const { return rejected_reports_; }

 private:
  struct Handled {
    std::string client;
    Answer answer;
  };
  /// The last requests.
  struct HandledRing {
    std::array<Handled, 16> all;
    std::size_t next = 0;
  };
  struct Commanded {
    geometry::Twist2 twist;
    Time at{};
  };
  /// What comes again and again, though not at every look.
  struct Lasting {
    std::optional<Time> since;
    Time last{};

    Time see(bool there, Time now);  ///< how long it has lasted
  };
  struct Watched {
    std::string topic;
    bool moves = true;
    drive::WriterRight right;
  };

  void stop(const std::string& client);
  void movement_on(const std::string& client);
  bool is_operator(const std::string& client) const;
  Watched* watched(std::string_view topic);
  /// Whether the base can have heard an epoch that is higher than ours.
  bool believes(const BaseReport& report) const;
  void take_epoch(const BaseReport& report);
  /// Who may drive, if anybody.
  std::optional<WriterId> holder() const { return watched_.front().right.holder(); }
  /// The first topic that somebody writes who must not; null when all is well.
  const Watched* invaded() const;
  /// Why the request cannot be carried out; empty when it was.
  std::string carry_out(const Request& request, Time now);
  void tell(const Handled& handled, Time now);
  void note_faults(Time now);
  void note_base(Time now);
  void note_movement(Time now);
  bool base_heard(Time now) const { return base_ && now - base_at_ < parameters_.base_age; }
  /// [%] Of the base's battery, as of the last step; NaN while nobody tells.
  double charge() const;
  bool resetting(Time now) const { return reset_until_ && now < *reset_until_; }
  void grant(bool able);
  void explain(Time now);
  bool movement_died(Time now) const;
  /// What the base says, or shows, of a right to drive that it does not use; empty when all is
  /// well.
  std::string_view refusal(Time now) const;

  Parameters parameters_;
  HeartbeatTable table_;
  std::vector<Watched> watched_;  ///< the first is drive/command
  FaultLog faults_;
  Behavior behavior_;
  drive::ResponseWatch watch_;

  std::uint64_t epoch_;
  std::vector<std::string> stopped_by_;  ///< clients that hold a stop
  std::optional<BaseReport> base_;
  Time base_at_{};  ///< when that was measured
  std::string barred_by_;
  std::optional<Time> barred_since_;   ///< while it should navigate
  std::optional<Time> refused_since_;  ///< the base refuses though somebody has the right
  std::optional<Commanded> commanded_;
  Lasting drives_, turns_, spins_;       ///< commanded though movement is off
  bool drove_ = false, turned_ = false;  ///< was commanded since the last step
  bool runs_away_ = false;               ///< the base, until an operator clears
  std::optional<Time> reset_until_;      ///< an operator cleared an emergency of the base

  std::string goal_;
  std::uint64_t navigation_id_ = 0;
  GoalState navigation_ = GoalState::kIdle;
  std::uint64_t id_before_goal_ = 0;  ///< the navigator's goal when the present one was chosen
  std::optional<std::uint64_t> active_goal_;  ///< the last that was active while it drove
  std::string navigation_client_;             ///< who had it started
  bool exploring_ = false;

  HandledRing handled_by_operators_, handled_by_others_;
  Answer last_request_;
  std::string last_client_;
  Time answered_at_{};

  Decision decision_;
  std::string reason_;
  std::uint64_t unknown_heartbeats_ = 0;
  std::uint64_t rejected_reports_ = 0;
};

}  // namespace usher::supervisor
