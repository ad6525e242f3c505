// Every edge of fig. 4, one mission each or more; the coverage is counted and printed.
#include <cstdio>

#include "meeting_rig.hpp"

namespace usher::meeting {
namespace {

struct Step {
  void (*act)(Rig&);
  State state;
};
struct Case {
  const char* name;
  std::vector<Step> steps;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> kCases{
      {"one person is brought",
       {{[](Rig& r) { r.to_arrived(); }, State::kArrived},
        {[](Rig& r) { r.wait(3000); }, State::kDone},
        {[](Rig& r) { r.wait(5000); }, State::kIdle}}},
      {"two are wanted, one is there",
       {{[](Rig& r) { r.to_arrived(2); }, State::kArrived},
        {[](Rig& r) { r.wait(3000); }, State::kExplore}}},
      {"is not ready, then is",
       {{[](Rig& r) { r.robot.pose.reset(), r.wait(100); }, State::kInitialise},
        {[](Rig& r) { r.robot.pose = Pose2{}, r.wait(100); }, State::kIdle}}},
      {"no way to the first room",
       {{[](Rig& r) { r.to_room(); }, State::kToRoom},
        {[](Rig& r) { r.no_way(); }, State::kToRoom}}},
      {"cannot turn in the first room",
       {{[](Rig& r) { r.to_scan(); }, State::kScanRoom},
        {[](Rig& r) { r.wait(60000); }, State::kToRoom}}},
      {"somebody in the first room",
       {{[](Rig& r) { r.to_check_room(); }, State::kCheckRoom},
        {[](Rig& r) { r.see(1.5, 0.1, 2); }, State::kToRoom}}},
      {"it was nobody",
       {{[](Rig& r) { r.to_check_room(); }, State::kCheckRoom},
        {[](Rig& r) { r.wait(2500); }, State::kScanRoom}}},
      {"a face that is none",
       {{[](Rig& r) { r.to_check_face(); }, State::kCheckFace},
        {[](Rig& r) { r.wait(2500); }, State::kExplore}}},
      {"a person close by",
       {{[](Rig& r) { r.to_explore(); }, State::kExplore},
        {[](Rig& r) { r.see(1.2, 0.0, 3); }, State::kInvite}}},
      {"the exploration fails",
       {{[](Rig& r) { r.to_explore(); }, State::kExplore},
        {[](Rig& r) { r.explorer(GoalState::kFailed); }, State::kExplore}}},
      {"the person cannot be reached",
       {{[](Rig& r) { r.to_approach(); }, State::kApproach},
        {[](Rig& r) { r.no_way(); }, State::kExplore}}},
      {"says no",
       {{[](Rig& r) { r.to_invite(); }, State::kInvite},
        {[](Rig& r) { r.press("no"); }, State::kExplore}}},
      {"says nothing",
       {{[](Rig& r) { r.to_invite(); }, State::kInvite},
        {[](Rig& r) { r.wait(14900); }, State::kInvite},
        {[](Rig& r) { r.wait(100); }, State::kExplore}}},
      {"leaves on the way",
       {{[](Rig& r) { r.to_guide(); }, State::kGuide},
        {[](Rig& r) { r.press("leave"); }, State::kExplore}}},
      {"the way back is blocked, twice",
       {{[](Rig& r) { r.to_guide(); }, State::kGuide},
        {[](Rig& r) { r.wait(1000), r.no_way(); }, State::kGuide},
        {[](Rig& r) { r.wait(1000), r.no_way(); }, State::kExplore}}},
      {"is looked for on the way, and follows",
       {{[](Rig& r) { r.to_guide(); }, State::kGuide},
        {[](Rig& r) { r.wait(1500), r.robot.pose->y += 2.5, r.wait(20000); }, State::kLookBack},
        {[](Rig& r) { r.see(1.1, 0.0, 2); }, State::kGuide}}},
      {"is looked for on the way where there is no room to turn",
       {{[](Rig& r) { r.to_guide(); }, State::kGuide},
        {[](Rig& r) { r.wait(1500), r.robot.pose->y += 2.5, r.wait(20000); }, State::kLookBack},
        {[](Rig& r) { r.robot.pose->yaw += 0.3, r.wait(5000); }, State::kGuide}}},
      {"does not follow on the way",
       {{[](Rig& r) { r.to_guide(); }, State::kGuide},
        {[](Rig& r) { r.wait(1500), r.robot.pose->y += 2.5, r.wait(18500); }, State::kLookBack},
        {[](Rig& r) {  // all round, past where it looked at first
           for (int i = 0; i < 280; ++i) r.robot.pose->yaw += 0.04, r.wait(100);
         },
         State::kExplore}}},
      {"does not follow",
       {{[](Rig& r) { r.to_look_back(); }, State::kLookBack},
        {[](Rig& r) { r.wait(26900); }, State::kLookBack},
        {[](Rig& r) { r.wait(200); }, State::kExplore}}},
      {"leaves when it is looked for",
       {{[](Rig& r) { r.to_look_back(); }, State::kLookBack},
        {[](Rig& r) { r.press("leave"); }, State::kExplore}}},
      {"was seen on the way and is still there",
       {{[](Rig& r) { r.to_revisit(); }, State::kRevisit},
        {[](Rig& r) {
           r.depart(), r.see({r.face_at({4.5, 6.5})}, 2);
         },
         State::kCheckFace}}},
      {"was seen on the way and has gone",
       {{[](Rig& r) { r.to_revisit(); }, State::kRevisit},
        {[](Rig& r) { r.arrive(); }, State::kRevisit},
        {[](Rig& r) { r.wait(2000); }, State::kExplore}}},
      {"was seen on the way and cannot be reached",
       {{[](Rig& r) { r.to_revisit(); }, State::kRevisit},
        {[](Rig& r) { r.no_way(); }, State::kExplore}}},
  };
  return kCases;
}

/// What another robot says, and where that leads; then it falls silent.
struct FleetCase {
  State from;
  void (*to)(Rig&);
  void (*says)(const Rig&, TeamReport&);
  State after, silent;
};

void seeks_nearby(const Rig& /*rig*/, TeamReport& report) {
  report.state = State::kToRoom;
  report.room_way = 0.1;
}
void has_a_room(const Rig& /*rig*/, TeamReport& report) {
  report.state = State::kExplore;
  report.room = "east";
}
void asks_the_same(const Rig& rig, TeamReport& report) {
  report.state = State::kGuide;
  const auto own = rig.meeting.tell(rig.now()).people;
  for (const Encounter& each : own) {
    if (each.kind == Met::kClaimed)
      report.people.push_back({Met::kClaimed, "iris", 0, each.at, {}, {}});
  }
}
void has_brought_all(const Rig& rig, TeamReport& report) {
  report.state = State::kExplore;
  for (std::uint32_t i = 0; i < rig.meeting.report().wanted; ++i) {
    report.people.push_back(
        {Met::kBrought, "iris", i + 1, Point2(i, 9.0), Time::max(), rig.meeting.report().room});
  }
}

const std::vector<FleetCase>& fleet_cases() {
  using enum State;
  constexpr auto to_room = [](Rig& r) { r.to_room(); };
  constexpr auto to_scan = [](Rig& r) { r.to_scan(); };
  constexpr auto to_check_room = [](Rig& r) { r.to_check_room(); };
  constexpr auto to_explore = [](Rig& r) { r.to_explore(); };
  constexpr auto to_check_face = [](Rig& r) { r.to_check_face(); };
  constexpr auto to_revisit = [](Rig& r) { r.to_revisit(); };
  constexpr auto to_approach = [](Rig& r) { r.to_approach(); };
  constexpr auto to_invite = [](Rig& r) { r.to_invite(); };
  static const std::vector<FleetCase> kCases{
      {kToRoom, to_room, seeks_nearby, kExplore, kToRoom},
      {kScanRoom, to_scan, has_a_room, kExplore, kExplore},
      {kCheckRoom, to_check_room, has_a_room, kExplore, kExplore},
      {kCheckFace, to_check_face, asks_the_same, kExplore, kExplore},
      {kRevisit, to_revisit, asks_the_same, kExplore, kExplore},
      {kApproach, to_approach, asks_the_same, kExplore, kExplore},
      {kInvite, to_invite, asks_the_same, kExplore, kExplore},
      {kExplore, to_explore, has_brought_all, kDone, kDone},
      {kCheckFace, to_check_face, has_brought_all, kDone, kDone},
      {kRevisit, to_revisit, has_brought_all, kDone, kDone},
      {kApproach, to_approach, has_brought_all, kDone, kDone},
      {kInvite, to_invite, has_brought_all, kDone, kDone},
  };
  return kCases;
}

struct Begin {
  State state;
  void (*to)(Rig&);
};
/// A way into each state of a mission.
const std::vector<Begin> kBegins{{State::kToRoom, [](Rig& r) { r.to_room(); }},
                                 {State::kScanRoom, [](Rig& r) { r.to_scan(); }},
                                 {State::kCheckRoom, [](Rig& r) { r.to_check_room(); }},
                                 {State::kExplore, [](Rig& r) { r.to_explore(); }},
                                 {State::kCheckFace, [](Rig& r) { r.to_check_face(); }},
                                 {State::kRevisit, [](Rig& r) { r.to_revisit(); }},
                                 {State::kApproach, [](Rig& r) { r.to_approach(); }},
                                 {State::kInvite, [](Rig& r) { r.to_invite(); }},
                                 {State::kGuide, [](Rig& r) { r.to_guide(); }},
                                 {State::kLookBack, [](Rig& r) { r.to_look_back(2); }},
                                 {State::kArrived, [](Rig& r) { r.to_arrived(2); }}};

TEST(Edges, AreAllTakenAndLeadWhereTheTableSays) {
  std::array<std::uint64_t, kEdges.size()> taken{};
  const auto count = [&](const Rig& rig) {
    for (std::size_t i = 0; i < taken.size(); ++i) taken[i] += rig.meeting.edges_taken()[i];
  };
  for (const Case& test : cases()) {
    Rig rig;
    int number = 0;
    for (const Step& step : test.steps) {
      SCOPED_TRACE(std::string(test.name) + ", step " + std::to_string(number++));
      step.act(rig);
      ASSERT_EQ(text(rig.state()), text(step.state));
    }
    count(rig);
  }
  for (const FleetCase& test : fleet_cases()) {
    SCOPED_TRACE(std::string(text(test.from)) + ", of a fleet");
    Parameters parameters;
    parameters.robot = "otto";
    Rig rig(parameters);
    test.to(rig);
    ASSERT_EQ(text(rig.state()), text(test.from));
    TeamReport report;
    report.robot = "iris";
    report.sequence = 1;
    report.id = rig.meeting.report().id;
    report.client = rig.meeting.report().client;
    test.says(rig, report);
    rig.meeting.hear(report);
    rig.robot.team = {"iris"};
    rig.wait(100);
    EXPECT_EQ(text(rig.state()), text(test.after));
    if (test.silent != test.after) {
      rig.robot.team.clear();
      rig.wait(100);
      EXPECT_EQ(text(rig.state()), text(test.silent));
    }
    count(rig);
  }
  ASSERT_EQ(kBegins.size(), edges::kActive);
  for (const Begin& begin : kBegins) {
    SCOPED_TRACE(text(begin.state));
    Parameters hurried;
    hurried.limit = std::chrono::seconds(30);
    Rig limited(hurried), broken, cancelled;
    begin.to(limited);
    ASSERT_EQ(limited.state(), begin.state);
    limited.now_ms = 40000;
    limited.wait(100);
    EXPECT_EQ(limited.meeting.report().outcome, Outcome::kTimeOver);
    begin.to(broken);
    broken.robot.supervisor =  // an operator takes over, or something breaks
        begin.state == State::kExplore ? Supervisor::kManual : Supervisor::kFault;
    broken.wait(100);
    EXPECT_EQ(broken.meeting.report().outcome, Outcome::kFailed);
    begin.to(cancelled);
    cancelled.note(cancelled.meeting.cancel(0, cancelled.now()));
    EXPECT_EQ(cancelled.meeting.report().outcome, Outcome::kCancelled);
    for (Rig* rig : {&limited, &broken, &cancelled}) {
      EXPECT_EQ(rig->state(), State::kEnded);
      ASSERT_EQ(rig->reports.size(), 1U);
      EXPECT_FALSE(rig->reports.back().reason.empty());
      rig->robot.supervisor = Supervisor::kAvailable;
      rig->wait(5100);
      EXPECT_EQ(rig->state(), State::kIdle);
      count(*rig);
    }
  }
  std::size_t covered = 0;
  for (std::size_t i = 0; i < kEdges.size(); ++i) {
    const Edge& edge = kEdges[i];
    std::printf("%4llu  %-12s -> %-12s %s\n", static_cast<unsigned long long>(taken[i]),
                std::string(text(edge.from)).c_str(), std::string(text(edge.to)).c_str(),
                std::string(text(edge.cause)).c_str());
    covered += taken[i] > 0 ? 1 : 0;
  }
  std::printf("edges covered: %zu of %zu\n", covered, kEdges.size());
  EXPECT_EQ(covered, kEdges.size());
}

TEST(Edges, LeaveNoStateWithoutAWayOut) {
  for (std::size_t i = 0; i < kStates; ++i) {
    const auto state = static_cast<State>(i);
    // Beside what ends a mission from anywhere.
    EXPECT_TRUE(std::any_of(edges::kWay.begin(), edges::kWay.end(), [&](const Edge& edge) {
      return edge.from == state && edge.to != state;
    })) << text(state);
  }
}

}  // namespace
}  // namespace usher::meeting
