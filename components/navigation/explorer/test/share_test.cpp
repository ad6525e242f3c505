// How robots that look for people together divide the map, and what each does with its part.
#include "navigation/explorer/core/share.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "foundation/grid/test/rooms.hpp"
#include "navigation/explorer/core/explorer.hpp"

namespace usher::explorer {
namespace {

using testing::HasSubstr;

class Divided : public testing::Test {
 protected:
  Divided() : area(std::move(SeenArea::create({})).value()) {
    EXPECT_TRUE(ground.set_map(map, {}, 0.24, 0.35));
    area.set_map(map, {});
  }
  /// Shares of the wanted cells.
  std::vector<double> parts(const std::vector<Point2>& places) {
    const auto owner = divide(ground, area, places);
    std::vector<double> parts(places.size() + 1, 0.0);
    for (std::size_t i = 0; i < owner.size(); ++i) {
      if (!area.wanted(i)) continue;
      parts[std::min<std::size_t>(owner[i], places.size())] +=
          1.0 / static_cast<double>(area.wanted_cells());
    }
    return parts;
  }

  const grid::OccupancyGrid map = grid::two_rooms();
  Ground ground;
  SeenArea area;
};

TEST_F(Divided, GivesEverybodyAboutAsMuch) {
  const auto far_apart = parts({{2, 2}, {17, 8}});
  EXPECT_NEAR(far_apart[0], 0.5, 0.05);
  EXPECT_NEAR(far_apart[1], 0.5, 0.05);
  // Who stands side by side has the same way to the other room.
  for (const auto& places :
       std::vector<std::vector<Point2>>{{{2, 2}, {2.8, 2}}, {{2, 2}, {2, 3}, {17, 8}}}) {
    const auto all = parts(places);
    for (std::size_t i = 0; i < places.size(); ++i)
      EXPECT_NEAR(all[i], 1.0 / static_cast<double>(places.size()), 0.2) << i;
    EXPECT_EQ(all.back(), 0.0) << "nothing is left over";
  }
}

TEST_F(Divided, GivesEachWhatIsNearer) {
  const auto owner = divide(ground, area, std::vector<Point2>{{2, 2}, {17, 8}});
  const auto whose = [&](const Point2& at) {
    return owner[area.geometry().index(area.geometry().cell_at(at))];
  };
  EXPECT_EQ(whose({2.5, 2.5}), 0);
  EXPECT_EQ(whose({17.5, 8.5}), 1);
}

TEST_F(Divided, IsTheSameEachTime) {
  const std::vector<Point2> places{{2, 2}, {9, 8}, {17, 8}};
  const auto first = divide(ground, area, places);
  ground.start_from({12, 4});
  area.look({5, 5, 1});
  EXPECT_EQ(divide(ground, area, places), first);
}

TEST_F(Divided, GivesNothingToAPlaceThatIsNone) {
  const auto all = parts({{2, 2}, {-50, 0}});
  EXPECT_NEAR(all[0], 1.0, 1e-9);
  EXPECT_EQ(all[1], 0.0);
}

/// An explorer whose robot is at once where it is told.
class Sharing : public testing::Test {
 protected:
  Sharing() {
    ExplorerConfig config;
    config.strategy.candidate_spacing = 1.0;
    explorer.emplace(std::move(Explorer::create(config, 1, 100)).value());
  }
  void begin() {
    ASSERT_TRUE(explorer->set_map(grid::two_rooms()));
    explorer->request({.id = 5, .client = "meeting", .rounds = 1, .anew = true});
  }
  std::optional<Drive> step() {
    time += 0.1;
    explorer->request({.id = 5, .client = "meeting"});  // it is wanted still
    explorer->look(robot);
    const Decision decision =
        explorer->step({.time = time, .pose = robot, .navigation = report, .client = "explorer"});
    return decision.drive;
  }
  void arrive(const Drive& drive) {
    robot = drive.view;
    report = {drive.id, "explorer", GoalState::kSucceeded, ""};
  }

  std::optional<Explorer> explorer;
  Pose2 robot{2.0, 5.0, 0.0};
  DriveReport report;
  double time = 10.0;
};

TEST_F(Sharing, LooksAtItsOwnPartFirstThenAtTheRest) {
  begin();
  ASSERT_TRUE(explorer->set_share({{{2, 5}, {17, 8}}, 0}));
  EXPECT_TRUE(explorer->seen().has_aside());
  bool crossed = false;
  for (int i = 0; i < 400 && explorer->active(); ++i) {
    const auto drive = step();
    if (!drive) continue;
    if (drive->view.x > 12.0 && !crossed) {
      crossed = true;
      EXPECT_FALSE(explorer->seen().has_aside()) << "only once its own part is done";
      EXPECT_GT(explorer->seen().coverage(), 0.35);
    }
    arrive(*drive);
  }
  EXPECT_TRUE(crossed);
  EXPECT_GT(explorer->seen().coverage(), 0.9);
}

TEST_F(Sharing, GoesWhereItIsWantedThoughThatIsFar) {
  begin();
  ASSERT_TRUE(explorer->set_share({{{2, 5}, {17, 8}}, 1}));
  const auto drive = step();
  ASSERT_TRUE(drive);
  EXPECT_GT(drive->view.x, 7.0);
}

TEST_F(Sharing, NeedNotLookAtWhatAnotherSaw) {
  begin();
  ASSERT_TRUE(explorer->set_share({{{2, 5}, {17, 8}}, 0}));
  for (int x = 0; x < 24; ++x) {
    for (int y = 0; y < 24; ++y) {
      for (int turn = 0; turn < 7; ++turn)
        explorer->look({10.4 + 0.4 * x, 0.4 + 0.4 * y, 0.9 * turn});
    }
  }
  for (int i = 0; i < 400 && explorer->active(); ++i) {
    if (const auto drive = step()) {
      EXPECT_LT(drive->view.x, 13.0);
      arrive(*drive);
    }
  }
}

TEST_F(Sharing, TakesOverTheWholeWhenItIsAlone) {
  begin();
  ASSERT_TRUE(explorer->set_share({{{2, 5}, {17, 8}}, 0}));
  ASSERT_TRUE(explorer->set_share({}));
  EXPECT_FALSE(explorer->seen().has_aside());
}

TEST_F(Sharing, KeepsItsPartOverANewMapAndANewRound) {
  ASSERT_TRUE(explorer->set_share({{{2, 5}, {17, 8}}, 0}));
  begin();
  step();
  EXPECT_TRUE(explorer->seen().has_aside());
}

TEST_F(Sharing, RefusesSharesThatAreNone) {
  begin();
  EXPECT_THAT(explorer->set_share({{{2, 5}, {17, 8}}, 2}).error(), HasSubstr("got 2"));
  EXPECT_THAT(explorer->set_share({std::vector<Point2>(17, Point2(1, 1)), 0}).error(),
              HasSubstr("at most 16"));
  EXPECT_FALSE(explorer->seen().has_aside());
}

}  // namespace
}  // namespace usher::explorer
