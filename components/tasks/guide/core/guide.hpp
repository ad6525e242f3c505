#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/result/result.hpp"
#include "tasks/guide/core/screen.hpp"

namespace usher::guide {

/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

/// Where the guide can go.
struct Location {
  std::string name;   ///< what the navigator knows
  std::string title;  ///< what people know
  bool operator==(const Location&) const = default;
};

/// The sentences of the thesis, section 7.2. "{place}" stands for the title of the location.
struct Texts {
  std::string hello = "Hello, I am MARVIN.";
  std::string touch_to_start = "Touch Start if you would like me to guide you somewhere.";
  std::string not_ready = "I am not ready yet. One moment, please.";
  std::string no_places = "I do not know any places yet.";
  std::string operator_drives = "An operator is driving me.";
  std::string where_to = "Where would you like to go?";
  std::string choose = "Please choose a place.";
  std::string will_take = "I will take you to {place}.";
  std::string tell_when_ready = "Tell me when you are ready to go.";
  std::string guiding = "I am taking you to {place}.";
  std::string lets_go = "All right, let's go. Tell me if we need to stop.";
  std::string in_the_way = "Something is in the way. I am waiting until we can go on.";
  std::string one_moment = "One moment, please. I have to wait for a part of me.";
  std::string stopped = "I have stopped.";
  std::string tell_when_to_go_on = "Tell me when we can go on.";
  std::string arrived = "We have arrived.";
  std::string this_is = "This is {place}.";
  std::string sorry = "Sorry, I was unable to guide you.";
  std::string try_again = "Would you like to try again?";
  std::string anything_else = "Can I do anything else for you?";
  std::string see_you = "OK, See you later.";
  std::string start = "Start";
  std::string stop = "Stop";
  std::string go_on = "Continue";
  std::string cancel = "Cancel";
  std::string more = "More";
  std::string yes = "Yes";
  std::string no = "No";
};

struct Parameters {
  Texts texts;
  Time greeting = std::chrono::seconds(2);     ///< how long a detected visitor is greeted
  Time answer = std::chrono::seconds(60);      ///< a question waits so long
  Time pause = std::chrono::seconds(120);      ///< a stop on the way waits so long
  Time arrived = std::chrono::seconds(4);      ///< then the next question
  Time goodbye = std::chrono::seconds(4);      ///< then idle again
  Time acknowledge = std::chrono::seconds(5);  ///< the navigator must take the goal by then
  Time recovery = std::chrono::seconds(60);    ///< a robot that may not move is waited for
  Time refresh = std::chrono::seconds(1);      ///< least time between two updates of progress
  std::size_t options_on_screen = 8;           ///< {>= 3} more places go on further pages
};

/// The supervisor's states as far as they concern a guide.
enum class Supervisor : std::uint8_t {
  kUnknown,     ///< nothing fresh heard
  kNotReady,    ///< initialising
  kInactive,    ///< nothing may move for now
  kAvailable,   ///< Interaction
  kNavigation,  ///< Navigation start, active, end
  kManual,
  kFault,
};

enum class NavigationState : std::uint8_t {
  kIdle = 0,
  kActive = 1,
  kWaiting = 2,
  kSucceeded = 3,
  kFailed = 4,
  kCancelled = 5,
  kReplaced = 6,
};

struct Navigation {
  std::uint64_t goal_id = 0;
  NavigationState state = NavigationState::kIdle;
  double progress = 0.0;                                  ///< {0..1}
  double eta = std::numeric_limits<double>::quiet_NaN();  ///< [s]
  std::string reason;                                     ///< why it failed or waits
};

/// What is known of the rest of the robot.
struct Surroundings {
  Supervisor supervisor = Supervisor::kUnknown;
  std::optional<Navigation> navigation;  ///< nothing: the navigator is silent
  std::optional<bool> visitor_near;      ///< nothing: nobody looks
};

enum class RequestKind : std::uint8_t {
  kNavigationStart,  ///< a goal is chosen; carries its name
  kNavigationGo,     ///< the visitor is ready
  kNavigationEnd,
  kStop,        ///< the visitor wants to stop for a moment
  kMovementOn,  ///< and to go on
};

/// To the supervisor. To be repeated until it is answered.
struct Request {
  RequestKind kind = RequestKind::kNavigationEnd;
  std::string goal;
  bool operator==(const Request&) const = default;
};

struct Goal {
  std::uint64_t id = 0;
  std::string location;
};

/// What a step asks of the others.
struct Actions {
  bool screen_changed = false;
  std::vector<Request> requests;  ///< in this order
  std::optional<Goal> goal;
  std::optional<std::uint64_t> cancel;  ///< id of the goal to give up
};

enum class State : std::uint8_t {
  kIdle,      ///< nobody is served
  kGreeting,  ///< a visitor came near
  kOptions,   ///< which place?
  kConfirm,   ///< ready to go?
  kGuiding,
  kPaused,  ///< the visitor asked to stop
  kArrived,
  kFailed,   ///< another try?
  kAskMore,  ///< anything else?
  kEnd,      ///< goodbye
};

std::string_view text(State state);

/// A guide of a few states: asks where to go, takes the visitor there, asks what else.
///
///   idle -> [greeting] -> options -> confirm -> guiding <-> paused
///   guiding -> arrived -> ask more -> options | end -> idle
///   confirm, guiding, paused -> failed -> options | ask more
///   any question without an answer -> end
///
/// Every accepted answer leads to a screen with a new id, so that a repeated or late answer has no
/// effect. Nothing blocks: whatever the rest of the robot does, each state has a way and a time
/// out.
class Guide {
 public:
  /// `first_goal_id` must be above all ids that this guide used before a restart.
  Guide(const Parameters& parameters, std::uint64_t first_goal_id);

  /// The places to offer. Refused, and nothing changed, when a name is empty, occurs twice or is
  /// the id of a button ("cancel", "more").
  Status set_locations(std::vector<Location> locations, Time now);

  /// An answer arrived.
  const Actions& answer(const Answer& answer, Time now);

  /// Time passed, or something else of the robot changed.
  const Actions& step(const Surroundings& surroundings, Time now);

  /// The supervisor refused a request of this guide.
  const Actions& refused(std::string_view reason, Time now);

  State state() const { return state_; }
  const Screen& screen() const { return screen_; }
  std::uint64_t ignored_answers() const { return ignored_answers_; }

 private:
  void begin();
  void enter(State state, Time now);
  void show(State state);
  void show_idle();
  void show_options();
  void fail(std::string_view reason, Time now);
  void give_up_goal();
  bool ready() const;
  bool journey() const { return state_ == State::kGuiding || state_ == State::kPaused; }
  std::string with_place(const std::string& text) const;
  bool choose(const std::string& option, Time now);
  void watch_robot(Time now);
  void watch_navigation(Time now);
  void refresh_journey(Time now);
  void pass_time(Time now);

  Parameters parameters_;
  std::uint64_t next_goal_id_;
  std::vector<Location> locations_;
  State state_ = State::kIdle;
  Time since_{};  ///< when this state was entered
  Screen screen_;
  Surroundings surroundings_;
  bool greeted_ = false;  ///< the visitor who is near was served already
  std::size_t page_ = 0;
  Location place_;                     ///< where to
  std::uint64_t goal_id_ = 0;          ///< 0: none was given
  Time goal_at_{};                     ///< when it was given
  bool acknowledged_ = false;          ///< the navigator named it
  std::optional<Time> unheard_since_;  ///< the navigator's silence
  std::optional<Time> held_since_;     ///< the supervisor lets nothing move
  std::string failure_;
  Time refreshed_{};
  Actions actions_;
  std::uint64_t ignored_answers_ = 0;
};

}  // namespace usher::guide
