#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/goal/goal_state.hpp"
#include "foundation/result/result.hpp"
#include "interaction/phrases/core/phrase_file.hpp"
#include "tasks/guide/core/dialogue.hpp"
#include "tasks/guide/core/follow_check.hpp"
#include "tasks/guide/core/places.hpp"
#include "tasks/guide/core/screen.hpp"
#include "tasks/guide/core/texts.hpp"
#include "tasks/guide/core/trail.hpp"
#include "tasks/guide/core/visit.hpp"
#include "tasks/service/core/robot.hpp"

namespace usher::guide {

struct Parameters {
  Time introduction = std::chrono::seconds(6);  ///< the greeting is shown; a language can be chosen
  Time answer = std::chrono::seconds(60);       ///< a question waits so long
  Time warning = std::chrono::seconds(20);      ///< before it is given up; one touch asks for more
  Time pause = std::chrono::seconds(120);       ///< a stop on the way waits so long
  Time arrived = std::chrono::seconds(4);       ///< then the next question
  Time goodbye = std::chrono::seconds(4);       ///< then inactive, when nobody is there
  Time left = std::chrono::seconds(15);         ///< nobody there for so long: the visitor has gone
  Time greet_after = std::chrono::milliseconds(1000);  ///< who passes by is not greeted
  double greet_within = 2.0;                           ///< [m] in front
  double greet_below = 0.6;                            ///< [m/s] who walks faster passes by
  Time tone = std::chrono::milliseconds(1000);         ///< from the tone to the first motion
  Time acknowledge = std::chrono::seconds(5);          ///< the navigator must take the goal by then
  Time recovery = std::chrono::seconds(60);            ///< a robot that may not move is waited for
  Time finish = std::chrono::seconds(6);   ///< what is said may hold a screen so much longer
  Time refresh = std::chrono::seconds(1);  ///< least time between two updates of progress
  Time please = std::chrono::seconds(3);   ///< blocked for so long: asks to make way
  Time please_again = std::chrono::seconds(8);
  double speed = 1.15;                ///< [m/s] pace of guiding; limits of the place still hold
  std::size_t options_on_screen = 8;  ///< {>= 4} more places go on further pages
  std::size_t recent = 3;             ///< places that were reached lately come first
  FollowLimits follow;
  double behind = 1.2;         ///< [m] so far behind a visitor whom the robot follows
  bool questionnaire = false;  ///< at the end of a visit that arrived, asks what was thought of it
};

using service::Request;
using service::RequestKind;
using service::Supervisor;

struct Navigation {
  std::uint64_t goal_id = 0;
  GoalState state = GoalState::kIdle;
  double progress = 0.0;        ///< {0..1}
  double eta = kNothing;        ///< [s]
  double remaining = kNothing;  ///< [m]
  bool blocked = false;         ///< something stands in the way now
  std::uint32_t replans = 0;
  bool ours = false;  ///< this guide gave the goal, in this life or an earlier one
};

/// Whether the robot may drive where it wants to.
enum class Permission : std::uint8_t {
  kGiven,
  kStopped,  ///< not while somebody else's stop lasts
  kRefused,  ///< the supervisor gives nobody the right to drive
};

/// What the speech component does, where it can be heard.
struct Speech {
  std::uint64_t spoken_id = 0;  ///< of the newest sentence that it said or says
  bool finished = true;         ///< it was said to its end, or broken off
  bool understands = false;     ///< answers may be spoken
};

/// Whom the people detector sees: before a journey in front, on it behind.
struct VisitorSighting {
  bool seen = false;
  double x = 0.0, y = 0.0;  ///< [m] from the robot; x ahead
  double speed = kNothing;  ///< [m/s] in the map
  /// [m] in map, where the robot was when it saw him; nothing: not known.
  std::optional<geometry::Point2> in_map = std::nullopt;
  std::uint64_t person = 0;  ///< identity; 0: none
};

/// What is known of the rest of the robot.
struct Surroundings {
  Supervisor supervisor = Supervisor::kUnknown;
  Permission permission = Permission::kGiven;
  std::optional<bool> stop_holds;          ///< this guide's own; nothing: not known
  std::optional<Navigation> navigation;    ///< nothing: the navigator is silent
  std::optional<VisitorSighting> visitor;  ///< nothing: nobody looks
  std::optional<geometry::Pose2> pose;     ///< in map; nothing: not localized
  std::optional<Speech> speech;            ///< nothing: nobody speaks aloud
  bool torso = false;                      ///< there is a body that moves
};

struct Goal {
  std::uint64_t id = 0;
  std::string location;                 ///< empty: the pose
  std::optional<geometry::Pose2> pose;  ///< in map
};

/// What a step asks of the others.
struct Actions {
  bool screen_changed = false;
  std::vector<Request> requests;  ///< in this order
  std::optional<Goal> goal;
  std::optional<std::uint64_t> cancel;  ///< id of the goal to give up
  std::optional<double> pace;           ///< [m/s] for the goal that runs
  bool remember = false;                ///< memory() is worth keeping
  std::optional<Visit> visit;           ///< one is over
};

/// Leads a visit through the states of fig. 7.1 of the thesis: greets, shows where we are, asks
/// where to go, takes the visitor there, waits for him, asks what else. dialogue.hpp has all edges.
///
/// Every accepted answer that changes the question leads to a screen with a new id, so that a
/// repeated or late answer has no effect. Nothing blocks: whatever the rest of the robot does, each
/// state has a way and a time out; the last seconds of a question are shown and can be extended.
class Guide {  // NOLINT(clang-analyzer-optin.performance.Padding): there is one
 public:
  /// `first_id` must be above all ids of goals, screens and visits that this guide used before a
  /// restart; `memory` is what it kept.
  Guide(const Parameters& parameters, phrases::PhraseBook phrases, std::uint64_t first_id,
        const Memory& memory, Time now);

  /// The places to offer. Refused, and nothing changed, when a name is empty, occurs twice or is
  /// the id of another button.
  Status set_locations(std::vector<Location> locations, Time now);

  /// An answer arrived. One that its client repeats changes nothing.
  const Actions& answer(const Answer& answer, Time now);

  /// Time passed, or something else of the robot changed. At 5 Hz or faster.
  const Actions& step(const Surroundings& surroundings, Time now);

  /// The supervisor refused a request of this guide.
  const Actions& refused(Time now);

  const Parameters& parameters() const { return parameters_; }
  State state() const { return state_; }
  const Screen& screen() const { return screen_; }
  Human human() const;
  const Surroundings& surroundings() const { return surroundings_; }
  /// Nobody is served, and somebody looks but sees nobody: the robot may turn slowly to look for
  /// people. Where nobody looks, a turn would find nobody.
  /// Not before the tone has sounded, and not after a stop that nobody has answered: then the robot
  /// stays as it stands until somebody begins a visit, who is greeted, or touches the screen.
  bool seeks() const { return turns_now_ && may_seek(); }
  /// A visit goes on.
  bool serves() const { return visit_.id != 0 && visit_.outcome == Outcome::kOpen; }
  /// A journey goes on: the visitor follows.
  bool guides() const { return journey(); }
  /// The robot follows the visitor.
  bool follows() const { return state_ == State::kFollowMe; }
  /// The bearing of the visitor [rad], whom the robot turns to on arrival; nothing: to nobody, or
  /// not yet, while the tone sounds.
  std::optional<double> turns_to() const;
  const Visit& visit() const { return visit_; }
  const Funnel& funnel() const { return funnel_; }
  Memory memory() const;
  std::uint64_t ignored_answers() const { return ignored_answers_; }
  /// Table 6.2: whose answer came last, which one, what became of it.
  const Answer& last_answer() const { return last_answer_; }
  AnswerResult last_result() const { return last_result_; }
  /// How often each edge of kEdges was taken.
  const std::array<std::uint64_t, kEdges.size()>& edges_taken() const { return edges_taken_; }

 private:
  void begin();
  const Actions& finish(Time now);
  void enter(State state, Cause cause, Time now);
  void begin_visit(bool greeted, Time now);
  void end_visit(Cause cause, Time now);
  void leave_journey(bool stopped = false);
  void lift_stop();

  // Screens.
  Screen build(Time now) const;
  void build_state(Screen& screen) const;
  void build_offer(Screen& screen) const;
  void build_start(Screen& screen) const;
  void build_following(Screen& screen) const;
  void build_failure(Screen& screen) const;
  void build_goodbye(Screen& screen) const;
  void build_places(Screen& screen) const;
  void build_journey(Screen& screen) const;
  void build_map(Screen& screen) const;
  void build_languages(Screen& screen) const;
  void build_statement(Screen& screen) const;
  const std::string& tag() const { return phrases_.languages()[language_].tag; }
  void add_services(Screen& screen, Time now) const;
  void add_yes_and_no(Screen& screen) const;
  void add_secondary(Screen& screen, const char* id, Text label) const;
  bool stands() const;
  std::string status() const;
  void add(Screen& screen, const char* id, Text label, OptionKind kind, Panel panel) const;
  std::string say(Text text) const;
  std::string say_place(Text text) const;
  std::string way_words(double meters) const;
  std::string time_words(double seconds) const;
  Text idle_text() const;
  void speak(const std::string& sentence, Tone tone = Tone::kNone);
  void speak_screen();
  void sound(Tone tone);
  std::vector<const Location*> offered() const;

  // Answers.
  AnswerResult judge(const Answer& answer, Time now);
  bool choose(const std::string& option, Time now);
  bool choose_service(const std::string& option, Time now);
  bool choose_place(const std::string& option, Time now);
  bool choose_on_the_way(const std::string& option, Time now);
  bool choose_following(const std::string& option, Time now);
  bool rate(const std::string& option, Time now);
  bool asks(std::size_t statement) const;
  void skip_what_is_not_there();
  void choose_language(std::size_t language);

  // The way.
  bool ready() const { return surroundings_.supervisor == Supervisor::kAvailable && known(); }
  bool known() const { return !locations_.empty(); }
  bool journey() const { return state_ == State::kGuideActive || state_ == State::kGuidePaused; }
  bool on_the_way() const { return journey() || follows(); }
  /// At an error: a journey has a place, a following has none.
  bool failed_to_follow() const { return place_.name.empty(); }
  /// What the supervisor shows as the goal.
  std::string goal_name() const { return follows() ? "visitor" : place_.name; }
  bool question() const;
  bool may_seek() const {
    return state_ == State::kInactive && human() == Human::kNo &&
           surroundings_.permission == Permission::kGiven && !stays_;
  }
  Time patience() const {
    return state_ == State::kGuidePaused ? parameters_.pause : parameters_.answer;
  }
  void depart(Time now);
  void move_when_due(Time now);
  void stop_robot();
  void keep_own_stop();
  void end_forgotten_journey();
  void go_on(Time now);
  void fail(Text reason, Cause cause, Time now);
  void watch_robot(Time now);
  std::optional<Text> stands_for(Time now) const;
  void tell_why_it_stands(Time now);
  bool navigator_drives() const;
  void await_navigator(Time now);
  std::optional<bool> goal_reached(Time now);
  void watch_navigation(Time now);
  void arrive(Time now);
  void watch_follower(Time now);
  void follow_visitor(Time now);
  void watch_following(Time now);
  void go_behind(Time now);
  void look_round(Time now);
  bool go_to(const geometry::Pose2& place, Time now);
  void start_navigation();
  std::optional<std::uint64_t> own_goal() const;
  void watch_obstacle(Time now);
  void watch_progress(Time now);
  void watch_turns(Time now);
  void watch_encounter(Time now);
  bool another(const VisitorSighting& visitor) const;
  void remember(std::uint64_t person);
  bool speaks() const;
  void refresh_journey(Time now);
  void say_on_the_way(Text text, Tone tone, Time now);
  bool there(const VisitorSighting& visitor) const;
  void pass_time(Time now);

  Parameters parameters_;
  phrases::PhraseBook phrases_;
  std::vector<Location> locations_;
  std::uint64_t next_id_;
  State state_ = State::kInitialise;
  Time since_{};  ///< when this state was entered or its time was extended
  std::size_t language_ = 0;
  Screen screen_;
  Screen published_;
  Surroundings surroundings_;
  Actions actions_;

  // This question.
  std::size_t page_ = 0;
  bool offers_following_ = false;  ///< as long as the question stands, whom it sees meanwhile
  bool searching_ = false;
  std::string query_;
  bool warned_ = false;

  // This visit.
  Visit visit_;
  Time visit_since_{};
  Funnel funnel_;
  std::vector<std::string> recent_;
  bool greeted_ = false;  ///< the visitor who is there was greeted already
  /// Those who were greeted or served since somebody came, newest last, at most kMostGreeted;
  /// empty: not known who it was.
  std::vector<std::uint64_t> greeted_persons_;
  std::uint64_t near_person_ = 0;
  bool lost_visitor_ = false;
  bool turns_ = false;           ///< to the visitor, on arrival
  std::optional<Time> turn_at_;  ///< after the tone, to him or in search of somebody
  bool turns_now_ = false;
  std::optional<Time> near_since_, nobody_since_;

  // This journey.
  Location place_;
  std::uint64_t goal_id_ = 0;  ///< 0: none was given
  Time departed_{};
  bool acknowledged_ = false;  ///< the navigator named it
  int given_again_ = 0;
  std::optional<Time> move_at_;        ///< after the tone
  bool stopped_ = false;               ///< this guide has asked the supervisor to stop
  bool stays_ = false;                 ///< a visit ended, unanswered, while somebody's stop held it
  std::optional<Time> unheard_since_;  ///< the navigator's silence
  std::optional<Time> not_allowed_since_;  ///< the supervisor lets nothing move, or somebody's stop
  std::optional<Time> waits_since_;        ///< the navigator, for something else than the way
  std::optional<Text> stands_told_;        ///< why it stands, as the visitor was told last
  Time asked_again_{};
  std::optional<Time> blocked_since_;
  Time pleaded_{};
  std::uint32_t replans_at_plea_ = 0;
  bool pleads_ = false;
  std::optional<geometry::Point2> stuck_at_;  ///< since then it has not come far from here
  Time stuck_since_{};
  FollowCheck follow_;
  Trail trail_;                   ///< of the visitor whom the robot follows
  std::uint64_t first_goal_ = 0;  ///< of this following; its goals up to goal_id_ are all ours
  std::optional<geometry::Point2> going_to_;
  bool looks_round_ = false;  ///< the newest goal is to turn, in search of him
  int looks_ = 0;             ///< so many such goals, up to a whole turn
  Time goal_given_at_{};
  Time moved_at_{};       ///< when the newest goal of a following was given
  Time drove_at_{};       ///< when a following last had a goal, or announced one
  int goals_failed_ = 0;  ///< in a row
  std::optional<Time> unseen_since_;
  std::uint32_t calls_heard_ = 0;
  std::string sentence_;  ///< the newest on the way
  Time sentence_at_{};
  bool told_eta_ = false, told_almost_ = false;
  double first_eta_ = kNothing, first_way_ = kNothing;
  Time first_eta_at_{};
  Text failure_ = Text::kNoWay;
  Time refreshed_{};

  struct Handled {
    std::uint64_t id = 0;
    AnswerResult result = AnswerResult::kNone;
  };
  std::map<std::string, Handled> handled_;  ///< newest answer of each client
  Answer last_answer_;
  AnswerResult last_result_ = AnswerResult::kNone;
  std::uint64_t ignored_answers_ = 0;
  std::array<std::uint64_t, kEdges.size()> edges_taken_{};
};

}  // namespace usher::guide
