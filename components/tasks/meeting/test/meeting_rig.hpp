#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tasks/meeting/core/meeting.hpp"

namespace usher::meeting {

using service::RequestKind;
using service::Supervisor;
using std::chrono::milliseconds;

inline phrases::PhraseBook book() {
  auto book = phrases::PhraseBook::load(USHER_SOURCE_DIR "/config/dialogue",
                                        {"en", "mi", "de", "fr"}, "meeting", kTextKeys);
  EXPECT_TRUE(book.ok()) << (book.ok() ? "" : book.error());
  return std::move(book).value();
}

/// 20 x 10 m without walls; a room at each end.
inline grid::OccupancyGrid hall() {
  return grid::OccupancyGrid(grid::GridGeometry{200, 100, 0.1, 0.0, 0.0}, grid::kFree);
}
inline std::vector<RoomArea> rooms() {
  return {{"west", {0.0, 0.0}, {4.0, 4.0}}, {"east", {16.0, 6.0}, {20.0, 10.0}}};
}
inline std::vector<Place> places() {
  return {{"west", "West room", {2.0, 2.0}},
          {"east", "East room", {18.0, 8.0}},
          {"lounge", "Lounge", {10.0, 5.0}}};
}

/// The assistant in a robot that does what it is told at once; every action is written down.
class Rig {
 public:
  explicit Rig(const Parameters& parameters = {}, std::vector<RoomArea> areas = rooms(),
               std::size_t language = 0)
      : meeting(parameters, std::move(areas), book(), language, 100) {
    EXPECT_TRUE(meeting.set_map(hall()).ok());
    meeting.set_places(places());
    robot.supervisor = Supervisor::kAvailable;
    robot.pose = Pose2{8.0, 4.0, 0.0};
    robot.navigation = GoalReport{};
    robot.exploration = GoalReport{};
    robot.sees = true;
    wait(100);
  }

  Meeting meeting;
  Surroundings robot;
  int now_ms = 1000;
  bool obeys = true;  ///< supervisor, navigator and explorer take what they are told
  std::string done;   ///< actions since the last taken()
  std::uint64_t goal = 0, exploration = 0;
  Pose2 goal_pose;
  std::string goal_location;
  std::vector<Report> reports;
  std::vector<std::string> said;

  Time now() const { return milliseconds(now_ms); }
  State state() const { return meeting.state(); }
  std::string taken() { return std::exchange(done, {}); }

  void wait(int ms) {
    const int end = now_ms + ms;
    do {
      now_ms = std::min(now_ms + 100, end);
      note(meeting.step(robot, now()));
    } while (now_ms < end);
  }
  Status request(std::uint32_t persons, double time_limit = 0.0) {
    wait(100);
    Status status = meeting.request({++last_request_, "test", persons, time_limit}, now());
    wait(100);
    return status;
  }
  /// What navigator and explorer say of the goal that runs.
  void navigator(GoalState state, const std::string& reason = {}) {
    robot.navigation = GoalReport{goal, state, reason};
    if (state >= GoalState::kSucceeded) robot.supervisor = Supervisor::kAvailable;
    wait(100);
  }
  void explorer(GoalState state, const std::string& reason = {}) {
    robot.exploration = GoalReport{exploration, state, reason};
    if (state >= GoalState::kSucceeded) robot.supervisor = Supervisor::kAvailable;
    wait(100);
  }
  /// Until the journey that was begun is under way.
  void depart() { wait(500); }
  void arrive() {
    depart();
    for (const Place& place : places()) {
      if (place.name == goal_location) goal_pose = {place.at.x(), place.at.y(), 0.0};
    }
    robot.pose = goal_pose;
    navigator(GoalState::kSucceeded);
  }
  void no_way() { depart(), navigator(GoalState::kFailed, "blocked"); }
  /// Turns round once, to the left.
  void turn_round() {
    for (int i = 0; i < 70 && state() == State::kScanRoom; ++i) turn(0.1);
  }
  void turn(double angle) {
    robot.pose->yaw = geometry::normalized(robot.pose->yaw + angle);
    wait(100);
  }

  /// A face at a bearing [rad] and range [m], as the camera would show it.
  Face face(double range, double bearing) const {
    constexpr double kFocal = 590.0;
    Face face;
    face.width = face.height = 92.0 / range;
    face.left = 320.0 - kFocal * std::tan(bearing) - 0.5 * face.width;
    face.top = 200.0 - 0.5 * face.height;
    face.depth = range * std::cos(bearing);
    face.range = range;
    face.bearing = bearing;
    return face;
  }
  /// A face that stands at a point of the map.
  Face face_at(const Point2& point) const {
    const Point2 way = inverse(*robot.pose) * point;
    return face(way.norm(), std::atan2(way.y(), way.x()));
  }
  void see(const std::vector<Face>& faces, int times = 1) {
    for (int i = 0; i < times; ++i) {
      note(meeting.see({640.0, robot.pose, faces}, now()));
      wait(100);
    }
  }
  void see(double range, double bearing, int times = 1) { see({face(range, bearing)}, times); }
  void see_nobody(int times = 1) { see(std::vector<Face>{}, times); }
  void press(const std::string& option, std::uint64_t id = 0) {
    note(meeting.answer({meeting.screen().id, option, "", service::Input::kTouch, "tablet", id},
                        now()));
  }

  // Shortcuts; each asserts where it leads.
  void to_room(std::uint32_t persons = 1) {
    EXPECT_TRUE(request(persons).ok());
    EXPECT_EQ(state(), State::kToRoom);
  }
  void to_scan(std::uint32_t persons = 1) {
    to_room(persons);
    arrive();
    EXPECT_EQ(state(), State::kScanRoom);
  }
  void to_check_room() {
    to_scan();
    see(1.5, 0.1);
    EXPECT_EQ(state(), State::kCheckRoom);
  }
  void to_explore(std::uint32_t persons = 1) {
    to_scan(persons);
    turn_round();
    EXPECT_EQ(state(), State::kExplore);
    robot.pose = Pose2{8.0, 5.0, 0.0};
    depart();
  }
  void to_check_face() {
    to_explore();
    see(2.5, 0.3, 2);
    EXPECT_EQ(state(), State::kCheckFace);
  }
  void to_approach(std::uint32_t persons = 1) {
    to_explore(persons);
    see(2.5, 0.1, 4);
    EXPECT_EQ(state(), State::kApproach);
  }
  void to_invite(std::uint32_t persons = 1) {
    to_approach(persons);
    arrive();
    EXPECT_EQ(state(), State::kInvite);
  }
  void to_guide(std::uint32_t persons = 1) {
    to_invite(persons);
    press("yes");
    EXPECT_EQ(state(), State::kGuide);
  }
  void to_look_back(std::uint32_t persons = 1) {
    to_guide(persons);
    wait(1000);
    arrive();
    EXPECT_EQ(state(), State::kLookBack);
  }
  void to_arrived(std::uint32_t persons = 1) {
    to_look_back(persons);
    see(1.1, 0.0, 2);
    EXPECT_EQ(state(), State::kArrived);
  }
  /// Somebody is seen while the robot guides.
  void to_revisit() {
    to_guide(2);
    wait(1500);
    robot.pose = Pose2{6.0, 5.0, 3.0};
    see({face_at({4.5, 6.5})}, 4);
    EXPECT_EQ(meeting.people().remembered().size(), 1U);
    arrive();
    see(1.1, 0.0, 2);
    EXPECT_EQ(state(), State::kArrived);
    wait(3000);
    EXPECT_EQ(state(), State::kRevisit);
  }

  void note(const Actions& actions) {
    for (const auto& request : actions.motion.requests) {
      const char* const names[] = {"start", "go", "end", "stop", "on"};
      add(names[static_cast<int>(request.kind)]);
      if (!obeys) continue;
      if (request.kind == RequestKind::kNavigationGo) robot.supervisor = Supervisor::kNavigation;
      if (request.kind == RequestKind::kNavigationEnd) robot.supervisor = Supervisor::kAvailable;
    }
    if (actions.motion.cancel) add("cancel");
    if (actions.motion.stop_exploring) add("stop exploring");
    if (actions.motion.goal) {
      goal = actions.motion.goal->id;
      goal_pose = actions.motion.goal->pose;
      goal_location = actions.motion.goal->location;
      add("goal:" + actions.motion.goal->location);
      if (obeys) robot.navigation = GoalReport{goal, GoalState::kActive, {}};
    }
    if (actions.motion.explore) {
      exploration = actions.motion.explore->id;
      add(actions.motion.explore->anew ? "explore anew" : "explore");
      if (obeys) robot.exploration = GoalReport{exploration, GoalState::kActive, {}};
    }
    if (actions.report) reports.push_back(*actions.report);
    const auto& screen = meeting.screen();
    if (screen.spoken_id != spoken_) {
      spoken_ = screen.spoken_id;
      if (!screen.spoken.empty()) said.push_back(screen.spoken);
    }
  }

 private:
  void add(const std::string& action) { done += (done.empty() ? "" : " ") + action; }
  std::uint64_t last_request_ = 0;
  std::uint64_t spoken_ = 0;
};

}  // namespace usher::meeting
