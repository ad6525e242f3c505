#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "foundation/grid/way_lengths.hpp"
#include "foundation/result/result.hpp"
#include "interaction/phrases/core/phrase_file.hpp"
#include "tasks/meeting/core/cleared_space.hpp"
#include "tasks/meeting/core/faces.hpp"
#include "tasks/meeting/core/mission.hpp"
#include "tasks/meeting/core/motion.hpp"
#include "tasks/meeting/core/people.hpp"
#include "tasks/meeting/core/team.hpp"
#include "tasks/meeting/core/texts.hpp"
#include "tasks/service/core/screen.hpp"

namespace usher::meeting {

struct Parameters {
  std::string robot;                       ///< name in the fleet; empty: belongs to none
  Time limit = std::chrono::minutes(15);   ///< of a mission, unless its request names another
  Time answer = std::chrono::seconds(15);  ///< an invitation waits so long
  Time tone = std::chrono::seconds(1);     ///< from the tone to the first motion of a guidance
  Time arrived = std::chrono::seconds(3);  ///< the thanks are shown
  Time over = std::chrono::seconds(5);     ///< the outcome is shown, then the next request
  Time check = std::chrono::milliseconds(2500);  ///< without a face: it was none
  Time check_most = std::chrono::seconds(10);    ///< a face that is not confirmed by then is none
  Time nobody = std::chrono::seconds(2);         ///< nobody seen where somebody was: has gone
  Time unseen = std::chrono::seconds(20);        ///< who is guided is looked for after that
  Time look_back = std::chrono::seconds(27);     ///< and is lost when not seen for so long
  Time call = std::chrono::seconds(9);           ///< after that it calls and looks all round
  Time scan_most = std::chrono::seconds(60);     ///< a turn takes at most so long
  Time recovery = std::chrono::seconds(60);      ///< a robot that may not move is waited for
  Time ask_again = std::chrono::seconds(180);    ///< who did not answer, or could not be reached
  Time refused = std::chrono::seconds(20);       ///< where a face was none, none is looked for
  int confirmations = 3;                         ///< {>= 1} messages in a row confirm a face
  int notice = 2;                                ///< {>= 1} and so many stop an exploration
  double field_of_view = 0.9948;                 ///< [rad] of the camera's width
  double centered = 0.2;                         ///< [rad] a face is centered within that
  double follows = 1.1;                          ///< [m] behind the robot walks who follows it
  double stand_off = 1.0;                        ///< [m] from the person, to talk
  double near = 1.4;                             ///< [m] nearer it asks from where it stands
  double same_person = 0.8;    ///< [m] faces nearer to each other are one person's
  double seen_again = 1.5;     ///< [m] from where somebody was seen on the way
  double room_margin = 0.2;    ///< [m] a face in the wall of a room is one in the room
  double passing_room = 0.27;  ///< [m] from obstacles, for lengths of ways
  double turning_room = 0.38;  ///< [m] from obstacles, to turn round on the way
  int most_failures = 5;       ///< explorations that fail in a row end the mission
};

/// A room where people can meet, as the site describes it.
struct RoomArea {
  std::string name;              ///< of the location where the robot turns round in it
  Point2 low{0, 0}, high{0, 0};  ///< [m] corners in map
};

/// A place that the navigator knows.
struct Place {
  std::string name, title;
  Point2 at{0, 0};  ///< [m] in map
};

struct MissionRequest {
  std::uint64_t id = 0;
  std::string client;
  std::uint32_t persons = 0;  ///< 1..100
  double time_limit = 0.0;    ///< [s] 0: the parameter
};

/// What a mission has come to.
struct Report {
  std::uint64_t id = 0;  ///< 0: there was none yet
  std::string client;
  Outcome outcome = Outcome::kOpen;
  std::string reason, room;
  std::uint32_t wanted = 0, brought = 0;
  std::uint32_t rooms_scanned = 0, rooms_occupied = 0;
  std::uint32_t faces_checked = 0, faces_refused = 0;
  std::uint32_t invited = 0, accepted = 0, declined = 0, unanswered = 0, lost = 0;
  std::optional<Time> room_time;  ///< until the room was found
  Time duration{};
};

/// What a step asks of the others.
struct Actions {
  MotionActions motion;
  bool screen_changed = false;
  bool status_changed = false;
  std::optional<Report> report;    ///< a mission is over
  std::optional<WorkShare> share;  ///< another one than before, for the explorer
};

/// Calls a meeting (meeting report III-B-5, fig. 4): finds a room where nobody is, looks for
/// people, invites and brings them until as many are there as were asked for. mission.hpp has all
/// edges.
///
/// Robots of a fleet call one meeting together (Team): one looks for the room while the others
/// explore and remember whom they see; each looks at its own part first; nobody is asked or counted
/// twice. A robot that has no mission joins one that it hears of.
///
/// Nothing blocks: whatever the rest of the robot does, each state has a way and a time-out, and
/// the mission a limit.
class Meeting {  // NOLINT(clang-analyzer-optin.performance.Padding): there is one
 public:
  /// `first_id` must be above all ids of goals and screens used before a restart. The phrases are
  /// those of kTextKeys; `language` is one of theirs.
  Meeting(const Parameters& parameters, std::vector<RoomArea> rooms, phrases::PhraseBook phrases,
          std::size_t language, std::uint64_t first_id);

  /// An error leaves what was there.
  Status set_map(const grid::OccupancyGrid& map);
  /// Places that the navigator knows, the rooms' among them. Those that are not finite are left
  /// out.
  void set_places(const std::vector<Place>& places);

  /// A repeated request changes nothing. The error says why it is refused: one mission at a time.
  Status request(const MissionRequest& request, Time now);
  /// Id 0 gives up whatever runs.
  const Actions& cancel(std::uint64_t id, Time now);
  const Actions& answer(const service::Answer& answer, Time now);
  /// What another robot of the fleet says.
  void hear(const TeamReport& report) { team_.take(report); }
  /// What the others are to know, now and again; without robot and sequence.
  TeamReport tell(Time now) const;
  /// A message of the face detector; faces that are none are left out and counted.
  const Actions& see(Faces faces, Time now);
  /// What the laser sees now, and from where, in map; heard while the robot guides somebody and
  /// looks back at him.
  const Actions& look(const Point2& from, std::span<const Point2> points, Time now);
  /// Time passed, or something else of the robot changed. At 5 Hz or faster.
  const Actions& step(const Surroundings& robot, Time now);

  State state() const { return state_; }
  /// Where the robot shall turn now, while it stands; the bearing [rad] of kFace, the sign of
  /// kSearch. Toward a face, and on the way, only where it has the room on the map.
  Turn turn() const {
    const bool anywhere = turn_ == Turn::kSearch && state_ == State::kScanRoom;
    return anywhere || may_face() ? turn_ : Turn::kStand;
  }
  double bearing() const;
  const service::Screen& screen() const { return screen_; }
  /// Of the drive that goes on, or was the last.
  std::uint64_t goal_id() const { return motion_.goal_id(); }
  const Report& report() const { return report_; }
  const People& people() const { return people_; }
  /// What it waits for, or why the newest request was refused.
  const std::string& reason() const { return reason_; }
  std::optional<Time> time_left(Time now) const;
  /// Since the mission that goes on began.
  Time elapsed(Time now) const { return now - began_; }
  std::uint64_t rejected_faces() const { return rejected_faces_; }
  std::uint64_t ignored_answers() const { return ignored_answers_; }
  const service::Answer& last_answer() const { return last_answer_; }
  service::AnswerResult last_result() const { return last_result_; }
  /// The newest request, taken or refused.
  std::uint64_t last_request() const { return last_request_; }
  const std::string& last_client() const { return last_client_; }
  /// How often each edge of kEdges was taken.
  const std::array<std::uint64_t, kEdges.size()>& edges_taken() const { return edges_taken_; }

 private:
  struct Room {
    RoomArea area;
    std::string title;
    std::optional<Point2> place;
    bool contains(const Point2& point, double margin) const;
  };
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  const Actions& finish(Time now);
  void begin(const MissionRequest& request, Time limit, Time now);
  void enter(State state, Cause cause, Time now);
  void arrive_in(State state, Time now);
  void end(Outcome outcome, Cause cause, const std::string& reason, Time now);
  std::string lacks() const;
  bool in_a_room(const Point2& point) const;

  // Rooms.
  void choose_room();
  void leave_room(Cause cause, bool occupied, Time now);
  void scan(Time now);

  // The other robots.
  void follow_team(Time now);
  void join(Time now);
  void divide_work();
  bool follow_room(Time now);
  bool follow_person(Time now);
  void follow_sightings(Time now);
  void adopt_room(const std::string& room, Time now);
  const Room* room_named(const std::string& name) const;
  std::optional<Point2> claimed() const;
  bool may_invite() const;
  bool taken_care_of(const Point2& at, Time now) const {
    return people_.left_alone(at, now) || team_.left_alone(at, now);
  }
  void met(Met kind, const Point2& at, Time until) { team_.add(kind, at, until, report_.room); }

  // Faces.
  bool may_be_asked(const Face& face, Time now) const;
  void notice(const Faces& all, Time now);
  void check(const Faces& all, Time now);
  void confirm(Time now);
  void refuse_face(Time now);
  void remember_seen(const Faces& all, Time now);

  // The way.
  /// What it cannot see says nothing.
  bool is_blind() const { return !robot_.sees || !robot_.pose; }
  void watch_robot(Time now);
  void follow_motion(Time now);
  void drive_failed(Time now);
  void pass_time(Time now);
  void pass_time_on_the_way(Time now);
  void pass_time_looking_back(Time now);
  void look_for_people(Cause cause, Time now);
  void visit_if_remembered(Time now);
  void approach(Time now);
  Point2 place_to_talk();
  void depart(Time now);
  void trail_follower();
  void look_for_follower(const Faces& all, Time now);
  void has_followed(Time now);
  bool calls(Time now) const;
  bool cannot_turn(Time now);
  bool may_face() const { return robot_.pose && turning_.free(robot_.pose->position()); }
  bool is_inside(const Point2& point, double by) const;
  bool is_another_robot(const Point2& point) const;
  bool others_count() const;
  bool is_there() const;

  // Screens.
  service::Screen build(Time now) const;
  void build_invitation(service::Screen& screen, Time now) const;
  void build_way(service::Screen& screen, Time now) const;
  void says(service::Screen& screen, const std::string& words, service::Tone tone) const;
  std::string say(Text text) const;
  std::string room_title() const;

  Parameters parameters_;
  std::vector<Room> rooms_;
  phrases::PhraseBook phrases_;
  std::size_t language_;
  grid::WayLengths ways_;
  grid::FreeSpace turning_;  ///< where it may turn round
  Motion motion_;
  People people_;
  Team team_;
  Surroundings robot_;
  State state_ = State::kInitialise;
  double turned_to_ = 0.0;  ///< [rad] in map: of its turns when it looks back, the last
  Time turned_at_{};
  Time since_{};
  Actions actions_;
  Turn turn_ = Turn::kStand;
  Point2 face_to_{0, 0};  ///< [m] in map, of Turn::kFace
  std::string reason_;

  // This mission.
  Report report_;
  Time began_{}, limit_{};
  std::vector<std::size_t> order_;  ///< rooms as they were gone to
  std::size_t stop_ = 0;            ///< in order_
  bool second_pass_ = false;
  std::size_t reached_ = 0;  ///< rooms of this pass
  std::size_t room_ = kNone;
  bool visiting_ = false;        ///< person_ is whom somebody saw before
  double room_way_ = 0.0;        ///< [m] to it, when it was chosen
  std::optional<Point2> place_;  ///< [m] in map, where it began to look for people
  WorkShare share_;              ///< that the explorer has
  double turned_ = 0.0;          ///< [rad] in this room
  std::optional<double> yaw_;
  FaceTrack track_, passing_;
  Time face_seen_{};
  bool anew_ = false;  ///< the exploration begins
  int failures_ = 0;
  Point2 person_{0, 0};     ///< [m] in map, who is approached, asked, guided
  Point2 departure_{0, 0};  ///< [m] in map, of the guidance
  int tries_ = 0;
  bool departed_ = false;
  Point2 follower_{0, 0};          ///< [m] in map, where it should be
  ClearedSpace cleared_;           ///< while it drove with it
  int stands_there_ = 0;           ///< scans in a row that have somebody where nobody was
  bool in_the_room_ = false;       ///< the guidance is at its end
  bool waits_for_others_ = false;  ///< another robot was in the room first, and counts
  Time others_settle_{};  ///< until then somebody whom another robot brought may walk there
  std::optional<Time> arrived_at_;  ///< where somebody was seen

  std::optional<Time> held_since_, lost_since_, blind_since_;

  std::uint64_t last_request_ = 0;
  std::string last_client_;
  std::uint64_t next_screen_;
  service::Screen screen_;
  std::map<std::string, std::uint64_t> handled_;  ///< newest answer of each client
  service::Answer last_answer_;
  service::AnswerResult last_result_ = service::AnswerResult::kNone;
  std::uint64_t rejected_faces_ = 0, ignored_answers_ = 0;
  std::array<std::uint64_t, kEdges.size()> edges_taken_{};
};

}  // namespace usher::meeting
