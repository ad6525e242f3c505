#include "interaction/tablet/core/tablet.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "foundation/random/random.hpp"
#include "interaction/tablet/core/floor_plan.hpp"
#include "interaction/tablet/core/theme.hpp"

namespace usher::tablet {
namespace {

using std::chrono::milliseconds;

Tablet make() {
  auto book = phrases::PhraseBook::load(USHER_SOURCE_DIR "/config/dialogue",
                                        {"en", "mi", "de", "fr"}, "tablet", kTextKeys);
  EXPECT_TRUE(book.ok()) << (book.ok() ? "" : book.error());
  Tablet tablet(std::move(book).value());
  tablet.hear(true, true, {});
  return tablet;
}

/// When the buttons of time 0 may be touched.
constexpr Time kSettled = Tablet::kSettles;

Screen screen(std::uint64_t id, const char* state, const std::vector<std::string>& options) {
  Screen screen;
  screen.id = id;
  screen.state = state;
  screen.language = "en";
  screen.title = "Title";
  for (const auto& option : options) screen.options.push_back({option, option + "!"});
  return screen;
}

TEST(Tablet, SaysInTheVisitorsLanguageThatTheRobotIsAway) {
  Tablet tablet = make();
  Screen german = screen(1, "guide_ask", {"yes", "no"});
  german.language = "de";
  static_cast<void>(tablet.take(german, {}));
  tablet.hear(false, false, {});
  const View away = tablet.view({});
  EXPECT_EQ(away.page, Page::kAway);
  EXPECT_EQ(away.title, "MARVIN ist nicht erreichbar.");
  EXPECT_TRUE(away.primary.empty());
  EXPECT_TRUE(away.stop_offered) << "Stop is always there";
  EXPECT_FALSE(tablet.touch("yes", kSettled).answer) << "an answer would hit nobody";
  tablet.hear(true, false, {});
  EXPECT_EQ(tablet.view({}).page, Page::kStarting);
  tablet.hear(true, true, {});
  EXPECT_EQ(tablet.view({}).page, Page::kButtons);
}

TEST(Tablet, SortsButtonsIntoPanels) {
  Tablet tablet = make();
  Screen shown = screen(1, "guide_ask", {"yes", "where_is", "repeat", "languages", "stay"});
  shown.options[0].kind = 1;
  shown.options[1].panel = 1;
  for (std::size_t i = 2; i < 5; ++i) shown.options[i].panel = 2;
  shown.options[4].kind = 1;
  static_cast<void>(tablet.take(shown, {}));
  View view = tablet.view({});
  EXPECT_EQ(view.primary, (std::vector<Button>{{"yes", "yes!", Kind::kYes}}));
  EXPECT_EQ(view.secondary, (std::vector<Button>{{"where_is", "where_is!", Kind::kOption}}));
  EXPECT_EQ(view.service.size(), 3U);
  EXPECT_EQ(view.service[0].kind, Kind::kService);
  shown.time_left = 12.0;
  static_cast<void>(tablet.take(shown, {}));
  view = tablet.view({});
  EXPECT_EQ(view.service, (std::vector<Button>{{"stay", "stay!", Kind::kYes}}));
  EXPECT_EQ(view.time_left, 12.0);
}

TEST(Tablet, ShowsWhatIsLeftOfTheTimeThatWasAnnounced) {
  Tablet tablet = make();
  Screen shown = screen(1, "guide_ask", {"yes", "stay"});
  const auto share = [&](double time_left) {
    shown.time_left = time_left;
    static_cast<void>(tablet.take(shown, {}));
    return tablet.view({}).time_left_share;
  };
  EXPECT_EQ(share(NAN), 0.0);
  EXPECT_EQ(share(60.0), 1.0) << "whatever the guide's warning_time";
  EXPECT_EQ(share(45.0), 0.75);
  EXPECT_EQ(share(0.0), 0.0);
  EXPECT_EQ(share(NAN), 0.0) << "he asked for more time";
  EXPECT_EQ(share(20.0), 1.0);
  EXPECT_EQ(share(5.0), 0.25);
  shown.id = 2;
  EXPECT_EQ(share(5.0), 1.0) << "another question";
}

TEST(Tablet, AnswersOnceUntilTheReply) {
  Tablet tablet = make();
  static_cast<void>(tablet.take(screen(7, "guide_ask", {"yes", "no"}), {}));
  EXPECT_EQ(tablet.touch("yes", kSettled).answer, (Answer{7, "yes", ""}));
  EXPECT_EQ(tablet.view(kSettled).pending_id, "yes");
  EXPECT_FALSE(tablet.touch("no", milliseconds(500)).answer) << "a second finger";
  EXPECT_FALSE(tablet.touch("else", kSettled).answer) << "not on the screen";
  EXPECT_TRUE(tablet.touch("no", milliseconds(2500)).answer) << "nobody replied";
  tablet.replied();
  EXPECT_FALSE(tablet.view(milliseconds(2600)).pending);
  EXPECT_TRUE(tablet.touch("yes", milliseconds(2600)).answer);
  static_cast<void>(tablet.take(screen(8, "guide_options", {"lab"}), milliseconds(2700)));
  EXPECT_TRUE(tablet.touch("lab", milliseconds(3100)).answer);
}

TEST(Tablet, StopGoesToDialogueAndSupervisorAtOnce) {
  Tablet tablet = make();
  static_cast<void>(tablet.take(screen(7, "guide_active", {"stop", "cancel"}), {}));
  EXPECT_FALSE(tablet.view({}).stop_offered) << "the dialogue offers it, large";
  EXPECT_TRUE(tablet.touch("cancel", kSettled).answer);
  const Touched stop = tablet.touch("stop", kSettled);
  EXPECT_TRUE(stop.stop);
  EXPECT_EQ(stop.answer, (Answer{7, "stop", ""})) << "even while another answer is under way";
  EXPECT_TRUE(tablet.holds());
}

TEST(Tablet, TakesNoSecondTapForTheNextQuestion) {
  Tablet tablet = make();
  static_cast<void>(tablet.take(screen(7, "guide_ask", {"yes", "no"}), milliseconds(1000)));
  EXPECT_FALSE(tablet.touch("yes", milliseconds(1399)).answer);
  EXPECT_TRUE(tablet.touch("yes", milliseconds(1400)).answer);
  tablet.replied();
  Screen asks = screen(8, "guide_error", {"yes", "no"});
  static_cast<void>(tablet.take(asks, milliseconds(1500)));
  EXPECT_FALSE(tablet.touch("yes", milliseconds(1550)).answer)
      << "the same place, another question";
  asks.text = "Are you still there?";
  static_cast<void>(tablet.take(asks, milliseconds(1800)));
  EXPECT_TRUE(tablet.touch("no", milliseconds(1900)).answer) << "the same buttons";
  tablet.replied();
  asks.options.push_back({"stay", "stay!", 1, 2});
  static_cast<void>(tablet.take(asks, milliseconds(2000)));
  EXPECT_FALSE(tablet.touch("stay", milliseconds(2100)).answer) << "one more button";
  tablet.hear(false, false, milliseconds(3000));
  tablet.hear(true, true, milliseconds(3100));
  EXPECT_FALSE(tablet.touch("yes", milliseconds(3200)).answer) << "the robot has come back";
  EXPECT_TRUE(tablet.touch(Tablet::kStop, milliseconds(3200)).stop) << "a stop is never too soon";
  EXPECT_FALSE(tablet.touch(Tablet::kStart, milliseconds(3250)).move) << "Start came under it";
  EXPECT_TRUE(tablet.touch(Tablet::kStop, milliseconds(3260)).stop);
  EXPECT_TRUE(tablet.touch(Tablet::kStart, milliseconds(4800)).move);
}

TEST(Tablet, WhoTapsStopAgainAndAgainDoesNotStartTheRobot) {
  Tablet tablet = make();
  static_cast<void>(tablet.take(screen(7, "guide_active", {"stop"}), {}));
  static_cast<void>(tablet.touch("stop", milliseconds(1000)));
  static_cast<void>(
      tablet.take(screen(8, "guide_paused", {"continue", "cancel"}), milliseconds(1100)));
  for (int at = 1500; at <= 5000; at += 500) {
    const Touched touched = tablet.touch("continue", milliseconds(at));
    ASSERT_FALSE(touched.move || touched.answer) << at;
    EXPECT_FALSE(tablet.view(milliseconds(at)).primary[0].active) << "and it is seen";
  }
  EXPECT_TRUE(tablet.view(milliseconds(5000)).primary[1].active) << "who cancels moves nothing";
  EXPECT_FALSE(tablet.touch("continue", milliseconds(6499)).move);
  EXPECT_TRUE(tablet.view(milliseconds(7999)).primary[0].active);
  EXPECT_TRUE(tablet.touch("continue", milliseconds(7999)).move) << "1.5 s after the last touch";

  Tablet asks = make();
  static_cast<void>(asks.take(screen(7, "guide_ask", {"yes"}), {}));
  for (int at = 1000; at <= 5000; at += 500) {
    const bool stops = asks.view(milliseconds(at)).stop_offered;
    EXPECT_FALSE(asks.touch(stops ? Tablet::kStop : Tablet::kStart, milliseconds(at)).move);
    EXPECT_FALSE(asks.view(milliseconds(at)).start_active);
  }
  EXPECT_TRUE(asks.touch(Tablet::kStart, milliseconds(6500)).move);
}

TEST(Tablet, HoldsTheRobotWhenTheJourneyEndsUnderItsStop) {
  for (const bool taken_over : {false, true}) {
    Tablet tablet = make();
    static_cast<void>(tablet.take(screen(7, "guide_active", {"stop"}), {}));
    static_cast<void>(tablet.touch("stop", {}));
    if (taken_over) {
      EXPECT_FALSE(tablet.take(screen(8, "guide_paused", {"continue"}), {}).move);
    }
    EXPECT_FALSE(tablet.take(screen(9, "guide_success", {}), {}).move) << "it would turn to him";
    EXPECT_TRUE(tablet.holds());
    EXPECT_TRUE(tablet.view(kSettled).start_offered);
    static_cast<void>(
        tablet.take(screen(10, "guide_start", {"start", "cancel"}), milliseconds(8000)));
    EXPECT_TRUE(tablet.touch("start", milliseconds(9000)).move);
  }
}

TEST(Tablet, AnAnswerThatSetsTheRobotOffLiftsItsStopUnlessItWasGivenBefore) {
  for (const char* state : {"guide_active", "follow_me"}) {
    Tablet tablet = make();
    static_cast<void>(tablet.take(screen(7, "guide_ask", {"yes", "follow_me"}), {}));
    static_cast<void>(tablet.touch(Tablet::kStop, milliseconds(1000)));
    EXPECT_FALSE(tablet.take(screen(8, "guide_start", {"start"}), milliseconds(2000)).move);
    const Touched spoken = tablet.take(screen(9, state, {"stop"}), milliseconds(2600));
    EXPECT_TRUE(spoken.move) << state;
    EXPECT_FALSE(tablet.holds());
  }
  Tablet late = make();
  static_cast<void>(late.take(screen(7, "guide_start", {"start"}), {}));
  static_cast<void>(late.touch("start", milliseconds(1000)));
  EXPECT_TRUE(late.touch(Tablet::kStop, milliseconds(1100)).stop);
  const Touched begun = late.take(screen(8, "guide_active", {"stop"}), milliseconds(1200));
  EXPECT_FALSE(begun.move);
  EXPECT_EQ(begun.answer, (Answer{8, "stop", ""})) << "the dialogue stops, too";
  EXPECT_TRUE(late.holds());

  Tablet restarted = make();
  restarted.hold_again();
  EXPECT_FALSE(restarted.take(screen(7, "guide_active", {"stop"}), milliseconds(9000)).move);
  EXPECT_TRUE(restarted.holds()) << "that was answered before";
}

TEST(Tablet, LiftsItsStopWhenTheDialogueGoesOn) {
  Tablet tablet = make();
  static_cast<void>(tablet.take(screen(7, "guide_active", {"stop"}), {}));
  static_cast<void>(tablet.touch("stop", {}));
  EXPECT_FALSE(tablet.take(screen(7, "guide_active", {"stop"}), {}).move) << "not taken over yet";
  EXPECT_FALSE(tablet.take(screen(8, "guide_paused", {"continue"}), {}).move);
  EXPECT_TRUE(tablet.take(screen(9, "guide_active", {"stop"}), {}).move) << "by voice, perhaps";
  EXPECT_FALSE(tablet.holds());
  // Continue on the screen.
  static_cast<void>(tablet.take(screen(11, "guide_active", {"stop"}), {}));
  static_cast<void>(tablet.touch("stop", {}));
  static_cast<void>(tablet.take(screen(12, "guide_paused", {"continue"}), {}));
  const Touched go = tablet.touch("continue", Tablet::kCalms);
  EXPECT_TRUE(go.move);
  EXPECT_TRUE(go.answer);
  // Behind a visitor, too, the robot drives: nothing but his answer lifts it.
  static_cast<void>(tablet.take(screen(13, "follow_me", {"done", "stop"}), {}));
  static_cast<void>(tablet.touch("stop", {}));
  EXPECT_FALSE(tablet.take(screen(13, "follow_me", {"done", "stop"}), {}).move);
  EXPECT_TRUE(tablet.holds());
  EXPECT_FALSE(tablet.take(screen(14, "end_ask", {"yes", "no"}), {}).move) << "nor does its end";
}

TEST(Tablet, KeepsItsOwnStopUntilStart) {
  Tablet tablet = make();
  Screen asks = screen(7, "guide_error", {"yes"});
  asks.text = "Would you like to try again?";
  static_cast<void>(tablet.take(asks, {}));
  const Touched stop = tablet.touch(Tablet::kStop, {});
  EXPECT_TRUE(stop.stop);
  EXPECT_FALSE(stop.answer);
  View view = tablet.view({});
  EXPECT_EQ(view.text, "Would you like to try again?") << "the question is still there";
  EXPECT_EQ(view.status, "Stopped. Touch Start to go on.");
  EXPECT_FALSE(tablet.take(screen(8, "guide_options", {"lab"}), {}).move);
  view = tablet.view({});
  EXPECT_TRUE(view.start_offered);
  EXPECT_FALSE(view.stop_offered);
  EXPECT_FALSE(tablet.touch("lab", kSettled).move) << "another answer is no leave to move";
  EXPECT_TRUE(tablet.touch(Tablet::kStart, milliseconds(1900)).move);
  EXPECT_FALSE(tablet.holds());
  EXPECT_FALSE(tablet.touch(Tablet::kStart, milliseconds(2900)).move);

  Tablet restarted = make();
  restarted.hold_again();
  EXPECT_TRUE(restarted.view({}).start_offered) << "a restart does not forget it";
}

TEST(Tablet, NamesTheButtonThatLiftsItsStop) {
  for (const char* language : {"en", "mi", "de", "fr"}) {
    Tablet tablet = make();
    Screen shown = screen(7, "guide_ask", {"yes"});
    shown.language = language;
    static_cast<void>(tablet.take(shown, {}));
    static_cast<void>(tablet.touch(Tablet::kStop, {}));
    const View view = tablet.view({});
    EXPECT_NE(view.status.find(view.start_label), std::string::npos) << view.status;
  }
}

TEST(Tablet, LiftsItsOwnStopWhenTheVisitorStartsOrIsStillHere) {
  for (const char* id : {"start", "stay"}) {
    Tablet tablet = make();
    static_cast<void>(tablet.take(screen(7, "guide_start", {id, "cancel"}), {}));
    static_cast<void>(tablet.touch(Tablet::kStop, {}));
    EXPECT_EQ(tablet.view({}).start_offered, std::string(id) != "start") << "one Start is enough";
    const Touched touched = tablet.touch(id, Tablet::kCalms);
    EXPECT_TRUE(touched.move) << id;
    EXPECT_TRUE(touched.answer) << id;
    EXPECT_FALSE(tablet.holds());
  }
}

TEST(Tablet, LiftsItsOwnStopAtTheEndOfTheVisit) {
  Tablet tablet = make();
  static_cast<void>(tablet.take(screen(7, "guide_ask", {"yes"}), {}));
  EXPECT_FALSE(tablet.hear_visit(true, false, {}).move);
  static_cast<void>(tablet.touch(Tablet::kStop, {}));
  EXPECT_FALSE(tablet.hear_visit(true, false, {}).move);
  EXPECT_TRUE(tablet.hear_visit(false, false, {}).move) << "the next visitor finds no held robot";
  EXPECT_FALSE(tablet.holds());
  static_cast<void>(tablet.touch(Tablet::kStop, {}));
  EXPECT_FALSE(tablet.hear_visit(false, false, {}).move)
      << "while nobody is served it is nobody's end";
  EXPECT_TRUE(tablet.holds());
}

TEST(Tablet, HoldsWhatStillNavigates) {
  Tablet tablet = make();
  static_cast<void>(tablet.hear_visit(true, true, {}));
  static_cast<void>(tablet.touch(Tablet::kStop, {}));
  EXPECT_FALSE(tablet.hear_visit(false, true, {}).move) << "the dialogue has forgotten its visit";
  EXPECT_TRUE(tablet.hear_visit(false, false, {}).move);
  static_cast<void>(tablet.touch(Tablet::kStop, {}));
  EXPECT_FALSE(tablet.hear_visit(false, true, {}).move);
  EXPECT_FALSE(tablet.hear_visit(false, false, {}).move) << "an operator's way is nobody's visit";
}

TEST(Tablet, StartOrStopIsOneTouchAwayWhateverHappens) {
  Random random(5);
  Tablet tablet = make();
  const std::vector<std::vector<std::string>> sets{
      {"stop", "cancel"}, {"continue", "cancel"}, {"yes", "no"}, {}, {"start", "cancel"}};
  const char* const states[] = {"guide_active", "guide_paused", "guide_ask", "guide_success",
                                "guide_start"};
  for (int i = 1; i < 5000; ++i) {
    const Time now = milliseconds(300 * i);
    const auto which = random.below(5);
    if (random.below(3) > 0) {
      static_cast<void>(
          tablet.take(screen(static_cast<std::uint64_t>(i), states[which], sets[which]), now));
    }
    tablet.hear(random.below(5) > 0, random.below(5) > 0, now);
    if (random.below(5) == 0)
      static_cast<void>(tablet.hear_visit(random.below(2) == 0, random.below(2) == 0, now));
    const char* const ids[] = {"stop", "continue", Tablet::kStart, Tablet::kStop, "yes", "start"};
    if (random.below(2) == 0) static_cast<void>(tablet.touch(ids[random.below(6)], now));
    const View view = tablet.view(now);
    int ways = (view.stop_offered ? 1 : 0) + (view.start_offered ? 1 : 0);
    bool starts = false;
    for (const Button& button : view.primary) {
      ways += button.id == "stop" || button.id == "continue";
      starts = starts || button.id == "start";
    }
    if (starts) ways += tablet.holds() ? 1 : 0;
    ASSERT_GE(ways, 1);
    ASSERT_LE(ways, 2);
  }
}

TEST(Tablet, SendsWhatIsTypedAndCutsItAtALetter) {
  Tablet tablet = make();
  Screen search = screen(3, "guide_options", {"query", "lab"});
  search.content = 3;
  search.options[0].takes_text = true;
  static_cast<void>(tablet.take(search, {}));
  EXPECT_EQ(tablet.type("kit").answer, (Answer{3, "query", "kit"}));
  EXPECT_EQ(tablet.view({}).page, Page::kSearch);
  EXPECT_EQ(tablet.view({}).query_id, "query");
  std::string many;
  for (int i = 0; i < 30; ++i) many += "ā";
  EXPECT_EQ(tablet.type(many).answer->text.size(), 40U);
  EXPECT_EQ(tablet.type("x" + many).answer->text.size(), 39U);
  static_cast<void>(tablet.take(screen(4, "guide_start", {"start"}), {}));
  EXPECT_FALSE(tablet.type("kit").answer);
}

TEST(WayText, SaysWhatIsKnown) {
  const double nan = std::nan("");
  EXPECT_EQ(way_text(34.4, 62.0), "35 m · 1 min");
  EXPECT_EQ(way_text(40.2, 87.0), "40 m · 1½ min");
  EXPECT_EQ(way_text(21.4, 50.0), "20 m · < 1 min") << "as the guide says it at the same moment";
  EXPECT_EQ(way_text(nan, 11.0), "< 1 min");
  EXPECT_EQ(way_text(3.0, nan), "3 m");
  EXPECT_EQ(way_text(nan, nan), "");
  EXPECT_EQ(way_text(-1.0, INFINITY), "");
}

// WCAG 2.2, 1.4.6 (AAA): 7:1 for text, also for the large one here; 1.4.11: 3:1 for controls.
TEST(Palette, HasTheContrastOfAaa) {
  EXPECT_NEAR(contrast({0, 0, 0}, {255, 255, 255}), 21.0, 1e-9);
  EXPECT_NEAR(contrast({0x77, 0x77, 0x77}, {255, 255, 255}), 4.478, 0.001) << "known value";
  const Palette p;
  for (const Color& text : {p.title, p.text, p.status})
    EXPECT_GE(contrast(text, p.background), 7.0);
  for (const Color& button : {p.yes, p.no, p.option, p.service, p.focus, p.robot}) {
    EXPECT_GE(contrast(p.ink, button), 7.0) << int{button.red};
    EXPECT_GE(contrast(button, p.background), 3.0) << int{button.red};
  }
  EXPECT_GE(contrast(p.title, p.surface), 7.0) << "keys";
  EXPECT_GE(contrast(p.wall, p.floor), 3.0);
  for (const Color& mark : {p.route, p.robot, p.goal}) EXPECT_GE(contrast(mark, p.floor), 3.0);
  EXPECT_LT(contrast(p.title, p.yes), 7.0) << "why there is dark text on the buttons";
}

TEST(FloorPlan, IsCutToWhatIsKnownAndNorthIsUp) {
  grid::OccupancyGrid map({40, 30, 0.5, -2.0, -1.0}, grid::kUnknown);
  map.at({10, 5}) = 100;
  map.at({12, 8}) = 0;
  const FloorPlan plan = draw_floor_plan(map, 1);
  ASSERT_EQ(plan.width, 5);
  ASSERT_EQ(plan.height, 6);
  const auto at = [&](int x, int y) {
    return plan.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(plan.width) +
                       static_cast<std::size_t>(x)];
  };
  EXPECT_EQ(at(1, 4), 0xffe6e8ecU) << "the wall, at the lower left";
  EXPECT_EQ(at(3, 1), 0xff454952U) << "the floor, at the upper right";
  const auto pixel = plan.to_pixels({-2.0 + 10 * 0.5, -1.0 + 5 * 0.5}, 2.0);
  EXPECT_DOUBLE_EQ(pixel.x(), 2.0);
  EXPECT_DOUBLE_EQ(pixel.y(), 10.0);
  EXPECT_TRUE(draw_floor_plan(grid::OccupancyGrid({4, 4, 0.1, 0, 0}, grid::kUnknown), 1).empty());
  EXPECT_TRUE(draw_floor_plan(grid::OccupancyGrid(), 1).empty());
}

TEST(Simplified, KeepsCornersAndStaysWithinTheTolerance) {
  std::vector<geometry::Point2> path;
  for (int i = 0; i <= 100; ++i) path.emplace_back(0.1 * i, 0.0);
  for (int i = 1; i <= 100; ++i) path.emplace_back(10.0, 0.1 * i);
  EXPECT_EQ(simplified(path, 0.05).size(), 3U);
  EXPECT_EQ(simplified({}, 0.05).size(), 0U);
  EXPECT_EQ(simplified({{1, 1}}, 0.05).size(), 1U);
}

}  // namespace
}  // namespace usher::tablet
