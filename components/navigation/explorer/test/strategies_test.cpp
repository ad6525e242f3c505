#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "foundation/grid/test/rooms.hpp"
#include "navigation/explorer/core/strategy.hpp"

namespace usher::explorer {
namespace {

constexpr StrategyKind kAll[] = {StrategyKind::kInformationGain, StrategyKind::kFrontier,
                                 StrategyKind::kCell, StrategyKind::kGrid};
const Rectangle kEast{{10.1, 0.0}, {20.0, 10.0}};

/// A robot that is where it wants to be at once, and looks there.
class Teleporter {
 public:
  Teleporter(const StrategyConfig& config, const grid::OccupancyGrid& map, std::uint64_t seed = 1,
             const std::vector<Rectangle>& leave_out = {})
      : seen_(std::move(SeenArea::create({})).value()),
        strategy_(std::move(make_strategy(config, seed)).value()) {
    seen_.set_map(map, leave_out);
    EXPECT_TRUE(ground_.set_map(map, leave_out, 0.24, 0.35));
    strategy_->begin_round();
    seen_.look(robot_);
  }
  std::optional<Pose2> next() {
    if (!ground_.start_from(robot_.position())) return std::nullopt;
    return strategy_->next({seen_, ground_, robot_, given_up_});
  }
  bool go() {
    const auto view = next();
    if (!view) return false;
    EXPECT_TRUE(ground_.standing().free(view->position()));
    EXPECT_TRUE(std::isfinite(ground_.way_to(view->position())));
    robot_ = *view;
    seen_.look(robot_);
    views_.push_back(*view);
    return true;
  }
  void explore(int most) {
    while (static_cast<int>(views_.size()) < most && go()) {
    }
  }

  SeenArea seen_;
  Ground ground_;
  std::unique_ptr<Strategy> strategy_;
  Pose2 robot_{2.0, 5.0, 0.0};
  std::vector<Point2> given_up_;
  std::vector<Pose2> views_;
};

class Strategies : public testing::TestWithParam<StrategyKind> {};
INSTANTIATE_TEST_SUITE_P(All, Strategies, testing::ValuesIn(kAll));

TEST_P(Strategies, EndTheirRound) {
  Teleporter robot({.kind = GetParam()}, grid::two_rooms());
  robot.explore(2000);
  EXPECT_LT(robot.views_.size(), 2000U);
  EXPECT_GT(robot.seen_.coverage(), 0.6);
}

TEST_P(Strategies, AreTheSameForTheSameSeed) {
  Teleporter one({.kind = GetParam()}, grid::two_rooms(), 7);
  Teleporter other({.kind = GetParam()}, grid::two_rooms(), 7);
  one.explore(40);
  other.explore(40);
  EXPECT_EQ(one.views_, other.views_);
}

TEST_P(Strategies, ChooseNothingInWhatIsLeftOut) {
  Teleporter robot({.kind = GetParam()}, grid::two_rooms(), 2, {kEast});
  robot.explore(2000);
  EXPECT_GT(robot.views_.size(), 5U);
  for (const Pose2& view : robot.views_) EXPECT_FALSE(kEast.contains(view.position()));
}

TEST_P(Strategies, LeaveAPlaceThatIsLeftOut) {
  const Rectangle west{{0.0, 0.0}, {10.0, 10.0}};
  Teleporter robot({.kind = GetParam()}, grid::two_rooms(), 2, {west});
  ASSERT_EQ(robot.seen_.seen_cells(), 0U);
  ASSERT_TRUE(robot.go());
  EXPECT_GT(robot.robot_.x, 10.0);
}

TEST_P(Strategies, AvoidWhereItCouldNotGetTo) {
  Teleporter robot({.kind = GetParam()}, grid::two_rooms(), 3);
  const auto first = robot.next();
  ASSERT_TRUE(first);
  robot.given_up_.push_back(first->position());
  for (int i = 0; i < 30 && robot.go(); ++i) {
    const bool stays = (robot.robot_.position() - Point2(2.0, 5.0)).norm() < 1e-9;
    EXPECT_TRUE(stays || (robot.robot_.position() - first->position()).norm() > 0.4);
  }
}

TEST_P(Strategies, ChooseNothingWhereNothingIsReachable) {
  auto map = grid::two_rooms();
  grid::block(map, 0.0, 0.0, 4.0, 10.0);
  Teleporter robot({.kind = GetParam()}, map);
  EXPECT_FALSE(robot.next()) << "the robot stands inside of a wall";
}

TEST(Frontiers, SeeAllThatIsWorthAView) {
  for (const auto kind : {StrategyKind::kInformationGain, StrategyKind::kFrontier}) {
    Teleporter robot({.kind = kind}, grid::two_rooms());
    robot.explore(500);
    EXPECT_GT(robot.seen_.coverage(), 0.97) << static_cast<int>(kind);
  }
}

TEST(Frontiers, GoToTheNearest) {
  Teleporter robot({.kind = StrategyKind::kFrontier}, grid::hall());
  ASSERT_TRUE(robot.go());
  EXPECT_LT((robot.robot_.position() - Point2(2.0, 5.0)).norm(), 2.5)
      << "the sides of the first view are nearer than its end";
}

TEST(InformationGainView, LooksAroundWhereItStandsBeforeItGoesFar) {
  // A dead end of 2 m that the robot looks out of backward: what is worth most is a turn.
  auto map = grid::hall();
  Teleporter robot({.kind = StrategyKind::kInformationGain}, map);
  robot.robot_ = {10.0, 5.0, 0.0};
  robot.seen_.forget();
  robot.seen_.look(robot.robot_);
  ASSERT_TRUE(robot.go());
  EXPECT_LT((robot.robot_.position() - Point2(10.0, 5.0)).norm(), 2.0);
  EXPECT_GT(robot.seen_.seen_cells(), 3000U);
}

TEST(InformationGainView, IsWorthNothingOnceAllWasSeenFromTheWay) {
  Teleporter robot({.kind = StrategyKind::kInformationGain}, grid::hall());
  const auto view = robot.next();
  ASSERT_TRUE(view);
  EXPECT_TRUE(robot.strategy_->worth(*view, robot.seen_));
  robot.seen_.look(*view);
  EXPECT_FALSE(robot.strategy_->worth(*view, robot.seen_));
}

TEST(SampledViews, HaveAPointInEachSquareOfEachLevel) {
  Teleporter robot({.kind = StrategyKind::kCell, .levels = {5.0, 2.5}}, grid::hall());
  robot.explore(2000);
  EXPECT_EQ(robot.views_.size(), 8U + 32U);
  std::vector<int> squares(8, 0);
  for (std::size_t i = 0; i < 8; ++i) {
    const auto column = static_cast<std::size_t>(robot.views_[i].x / 5.0);
    const auto row = static_cast<std::size_t>(robot.views_[i].y / 5.0);
    ++squares[4 * row + column];
  }
  EXPECT_EQ(std::count(squares.begin(), squares.end(), 1), 8);
}

TEST(SampledViews, GoToTheNearestPointAndLookToTheNext) {
  Teleporter robot({.kind = StrategyKind::kGrid, .levels = {2.0}}, grid::hall());
  robot.explore(1000);
  ASSERT_EQ(robot.views_.size(), 50U);
  EXPECT_LT((robot.views_[0].position() - Point2(2.0, 5.0)).norm(), 1.5);
  for (std::size_t i = 0; i + 1 < robot.views_.size(); ++i) {
    const Point2 way = robot.views_[i + 1].position() - robot.views_[i].position();
    EXPECT_NEAR(geometry::shortest_turn(robot.views_[i].yaw, std::atan2(way.y(), way.x())), 0.0,
                1e-9);
    for (std::size_t k = i + 2; k < robot.views_.size(); ++k)
      EXPECT_LE(way.norm(),
                (robot.views_[k].position() - robot.views_[i].position()).norm() + 1e-9);
  }
}

TEST(MakeStrategy, NamesWhatIsOutOfRange) {
  const auto made = make_strategy({.levels = {4.0, 0.0}}, 1);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error(), "levels must be in [0.2, 50] m, got 0");
  EXPECT_FALSE(make_strategy({.levels = {}}, 1));
  EXPECT_FALSE(make_strategy({.least_gain = 0.0}, 1));
}

TEST(Ground, MeasuresWaysAroundWalls) {
  Ground ground;
  ASSERT_TRUE(ground.set_map(grid::two_rooms(), {}, 0.24, 0.35));
  ASSERT_TRUE(ground.start_from({8.0, 1.0}));
  EXPECT_NEAR(ground.way_to({8.0, 3.0}), 2.0, 0.1);
  // Through the door at (10, 5).
  EXPECT_NEAR(ground.way_to({12.0, 1.0}), 2.0 * std::hypot(2.0, 4.0), 0.9);
  EXPECT_TRUE(std::isinf(ground.way_to({10.0, 2.0}))) << "in the wall";
  EXPECT_TRUE(std::isinf(ground.way_to({-5.0, 2.0})));
  std::vector<Point2> way;
  ground.trace({12.0, 1.0}, way);
  ASSERT_GT(way.size(), 100U);
  EXPECT_LT((way.front() - Point2(8.0, 1.0)).norm(), 0.05);
  EXPECT_LT((way.back() - Point2(12.0, 1.0)).norm(), 0.05);
  for (std::size_t i = 1; i < way.size(); ++i) EXPECT_LT((way[i] - way[i - 1]).norm(), 0.08);
  EXPECT_FALSE(ground.start_from({std::nan(""), 1.0}));
  EXPECT_TRUE(std::isinf(ground.way_to({8.0, 3.0})));
}

TEST(Ground, RefusesMapsThatAreNoneOrTooLarge) {
  Ground ground;
  EXPECT_FALSE(ground.set_map({}, {}, 0.24, 0.35));
  const grid::OccupancyGrid large({.width = 4001, .height = 3, .resolution = 0.05}, grid::kFree);
  const auto status = ground.set_map(large, {}, 0.24, 0.35);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error(), "the map may have 4000 cells a side, it has 4001");
}

}  // namespace
}  // namespace usher::explorer
