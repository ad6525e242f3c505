#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "foundation/random/random.hpp"
#include "navigation/costmap/core/obstacle_layer.hpp"
#include "navigation/costmap/core/static_layer.hpp"

namespace usher::costmap {
namespace {

using geometry::Point2;
using geometry::Pose2;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// 100 x 80 cells of 0.05 m from the origin.
Raster raster() { return {0.0, 0.0, 0.05, 20.0, 0, 0, 100, 80}; }

ObstacleLayerConfig config() {
  ObstacleLayerConfig config;
  config.name = "laser";
  return config;
}

/// One beam along +x from (1.02, 1.02) m, so from cell (20, 20).
const std::vector<Point2> kAhead = {{1.0, 0.0}};
constexpr Pose2 kSensor{1.02, 1.02, 0.0};

CellRect see(ObstacleLayer& layer, float range, double stamp = 0.0) {
  const std::vector<float> ranges = {range};
  return layer.observe({kSensor, kAhead, ranges, stamp}, raster()).value();
}

std::uint8_t state(const ObstacleLayer& layer, int x, int y = 20) {
  return layer.states().at({x, y});
}

TEST(ObstacleLayer, ClearsUpToTheEchoAndMarksIt) {
  ObstacleLayer layer(config(), raster());
  const CellRect touched = see(layer, 1.0F);
  for (int x = 20; x < 40; ++x) EXPECT_EQ(state(layer, x), kSeenFree) << x;
  EXPECT_EQ(state(layer, 40), kSeenOccupied);
  EXPECT_EQ(state(layer, 41), kUnseen);
  EXPECT_EQ(state(layer, 19), kUnseen);
  EXPECT_EQ(touched, (CellRect{20, 20, 41, 21}));
}

TEST(ObstacleLayer, MarksWhatAThingHidesBehindItsNearEdge) {
  ObstacleLayerConfig thick = config();
  thick.thickness = 0.3;
  ObstacleLayer layer(thick, raster());
  const CellRect touched = see(layer, 1.0F);
  EXPECT_EQ(state(layer, 39), kSeenFree);
  for (int x = 40; x <= 46; ++x) EXPECT_EQ(state(layer, x), kSeenOccupied) << x;
  EXPECT_EQ(state(layer, 47), kUnseen);
  EXPECT_EQ(touched, (CellRect{20, 20, 47, 21}));
  see(layer, 2.0F);
  EXPECT_EQ(state(layer, 43), kSeenFree) << "it has gone";
  thick.thickness = 1.5;
  EXPECT_FALSE(ObstacleLayer::check(thick, 0.05).ok());
}

TEST(ObstacleLayer, HasNothingToForgetWhenTheWindowHasLeftAllThatItSaw) {
  for (const int away : {150, -150}) {
    ObstacleLayer layer(config(), raster());
    see(layer, 1.0F);
    layer.shift(away, 0);  // beside what it saw: the rows are the same
    EXPECT_TRUE(layer.forget().empty());
    EXPECT_TRUE(layer.replace({}, 0.0, raster())->empty());
  }
}

TEST(ObstacleLayer, ForgetsAnObstacleThatItSeesThrough) {
  ObstacleLayer layer(config(), raster());
  see(layer, 1.0F);
  see(layer, 1.5F);
  EXPECT_EQ(state(layer, 40), kSeenFree);
  EXPECT_EQ(state(layer, 50), kSeenOccupied);
}

TEST(ObstacleLayer, KeepsAnObstacleUntilTheBeamsBesideItPassToo) {
  const auto fan = beam_directions(-0.02, 0.02, 3);
  const auto look = [&](ObstacleLayer& layer, std::vector<float> ranges) {
    ASSERT_TRUE(layer.observe({kSensor, fan, ranges, 0.0}, raster()).ok());
  };
  for (const bool careful : {true, false}) {
    ObstacleLayerConfig settings = config();
    settings.clears_only_what_all_beams_pass = careful;
    ObstacleLayer layer(settings, raster());
    for (const float hidden : {kNan, 0.8F}) {  // too near to measure, or behind something
      for (const std::vector<float>& ranges :
           {std::vector{2.0F, 2.0F, hidden}, std::vector{2.0F, hidden, 2.0F}}) {
        look(layer, {kNan, 1.0F, kNan});
        look(layer, ranges);
        EXPECT_EQ(state(layer, 40), careful ? kSeenOccupied : kSeenFree) << hidden;
        EXPECT_EQ(state(layer, 39), kSeenFree);
      }
    }
    look(layer, {2.0F, 2.0F, 0.95F});
    EXPECT_EQ(state(layer, 40), kSeenFree) << "what that beam hits has marked its own cell";
  }
}

TEST(ObstacleLayer, KeepsAnObstacleWhoseCenterIsNearABlindBeam) {
  ObstacleLayerConfig settings = config();
  settings.clears_only_what_all_beams_pass = true;
  ObstacleLayer layer(settings, raster());
  see(layer, 1.0F);
  // The cell's center is 3 mm to the left of the middle beam, the beams are 3 mm apart there.
  const auto fan = beam_directions(-0.015, 0.003, 11);
  std::vector<float> ranges(11, 2.0F);
  ranges[8] = kNan;
  ASSERT_TRUE(layer.observe({{1.02, 1.022, 0.0}, fan, ranges, 0.0}, raster()).ok());
  EXPECT_EQ(state(layer, 40), kSeenOccupied) << "6 mm beside it";
  ranges[8] = 2.0F, ranges[0] = kNan;
  ASSERT_TRUE(layer.observe({{1.02, 1.022, 0.0}, fan, ranges, 0.0}, raster()).ok());
  EXPECT_EQ(state(layer, 40), kSeenFree) << "18 mm beside it";
}

TEST(ObstacleLayer, MarksAndClearsNothingWhereTheScanSaysSo) {
  ObstacleLayer layer(config(), raster());
  see(layer, 1.0F);
  const std::vector<float> ranges = {1.5F};
  const CellRect touched =
      layer
          .observe({.sensor = kSensor, .directions = kAhead, .ranges = ranges, .clears = false},
                   raster())
          .value();
  EXPECT_EQ(state(layer, 40), kSeenOccupied);
  EXPECT_EQ(state(layer, 45), kUnseen);
  EXPECT_EQ(state(layer, 50), kSeenOccupied);
  EXPECT_EQ(touched, (CellRect{50, 20, 51, 21}));
  EXPECT_EQ(layer.sensors_outside(), 0U);
}

TEST(ObstacleLayer, KeepsWhatLiesBehindAnEcho) {
  ObstacleLayer layer(config(), raster());
  see(layer, 1.5F);
  see(layer, 1.0F);
  EXPECT_EQ(state(layer, 50), kSeenOccupied);
}

TEST(ObstacleLayer, ClearsToTheRaytraceRangeWithoutEcho) {
  ObstacleLayer layer(config(), raster());
  see(layer, kInfinity);
  EXPECT_EQ(state(layer, 80), kSeenFree) << "3.0 m is cell 80";
  EXPECT_EQ(state(layer, 81), kUnseen);
}

TEST(ObstacleLayer, KeepsItsRanges) {
  ObstacleLayerConfig ranges = config();
  ranges.max_obstacle_range = 2.0;
  ranges.min_raytrace_range = 0.3;
  ranges.max_raytrace_range = 2.5;
  ObstacleLayer layer(ranges, raster());
  see(layer, 0.4F);
  EXPECT_EQ(state(layer, 25), kUnseen) << "too near to clear";
  EXPECT_EQ(state(layer, 26), kSeenFree);
  see(layer, 2.2F);
  EXPECT_EQ(state(layer, 63), kSeenFree);
  EXPECT_EQ(state(layer, 64), kUnseen) << "an echo too far to mark does not clear its own cell";
  see(layer, 9.0F);
  EXPECT_EQ(state(layer, 70), kSeenFree);
  EXPECT_EQ(state(layer, 71), kUnseen);
}

TEST(ObstacleLayer, ANegativeRangeClearsWhereTheLayerSaysSoAndMarksNowhere) {
  ObstacleLayerConfig low = config();
  for (const bool clears : {false, true}) {
    low.negative_clears = clears;
    ObstacleLayer layer(low, raster());
    see(layer, 0.4F);
    ASSERT_EQ(state(layer, 28), kSeenOccupied);
    see(layer, -1.0F);
    EXPECT_EQ(state(layer, 28), clears ? kSeenFree : kSeenOccupied);
    EXPECT_EQ(state(layer, 39), clears ? kSeenFree : kUnseen);
    EXPECT_EQ(state(layer, 40), kUnseen) << "what is there is not known";
    see(layer, -kInfinity);
    EXPECT_EQ(state(layer, 60), kUnseen);
    EXPECT_EQ(layer.invalid_ranges(), clears ? 1U : 2U);
  }
}

TEST(ObstacleLayer, MarksBeyondTheRaytraceRange) {
  ObstacleLayerConfig far = config();
  far.max_obstacle_range = 3.5;
  far.max_raytrace_range = 1.0;
  ObstacleLayer layer(far, raster());
  see(layer, 3.0F);
  EXPECT_EQ(state(layer, 40), kSeenFree);
  EXPECT_EQ(state(layer, 41), kUnseen);
  EXPECT_EQ(state(layer, 80), kSeenOccupied);
}

TEST(ObstacleLayer, CountsAndSkipsRangesThatMeasureNothing) {
  ObstacleLayer layer(config(), raster());
  for (const float range : {kNan, -kInfinity, -1.0F, 0.0F}) EXPECT_TRUE(see(layer, range).empty());
  EXPECT_EQ(layer.invalid_ranges(), 3U) << "NaN says that nothing is known";
  EXPECT_TRUE(layer.seen().empty());
}

TEST(ObstacleLayer, MarksAnEchoThatAnotherBeamOfTheScanPasses) {
  // The second beam clears the cell of the first echo: marks come after all clearing.
  ObstacleLayer layer(config(), raster());
  const std::vector<Point2> two = {{1.0, 0.0}, {1.0, 0.0}};
  const std::vector<float> ranges = {1.0F, 2.0F};
  ASSERT_TRUE(layer.observe({kSensor, two, ranges, 0.0}, raster()).ok());
  EXPECT_EQ(state(layer, 40), kSeenOccupied);
  EXPECT_EQ(state(layer, 60), kSeenOccupied);
}

TEST(ObstacleLayer, ClearsTheLastCellOfABeamThatPassesNextToOneThatEndsThere) {
  ObstacleLayer layer(config(), raster());
  const std::vector<Point2> two = {{1.0, 0.0}, {1.0, 0.0}};
  const std::vector<float> ranges = {2.99F, 3.05F};  // both rays end in cell 80
  ASSERT_TRUE(layer.observe({kSensor, two, ranges, 0.0}, raster()).ok());
  EXPECT_EQ(state(layer, 80), kSeenFree);
}

TEST(ObstacleLayer, RefusesWhatIsNoScan) {
  ObstacleLayer layer(config(), raster());
  const std::vector<float> two = {1.0F, 1.0F};
  const std::vector<float> one = {1.0F};
  EXPECT_EQ(layer.observe({kSensor, kAhead, two, 0.0}, raster()).error(),
            "layer laser: a scan must have one range per beam and at most 16384, got 2 ranges for "
            "1 beams");
  const std::vector<Point2> directions(20000, Point2{1.0, 0.0});
  const std::vector<float> huge(20000, 1.0F);
  EXPECT_FALSE(layer.observe({kSensor, directions, huge, 0.0}, raster()).ok());
  const double nan = std::nan("");
  EXPECT_FALSE(layer.observe({{nan, 0.0, 0.0}, kAhead, one, 0.0}, raster()).ok());
  EXPECT_FALSE(layer
                   .observe({{0.0, 0.0, std::numeric_limits<double>::infinity()}, kAhead, one, 0.0},
                            raster())
                   .ok());
  EXPECT_FALSE(layer.observe({{1e7, 0.0, 0.0}, kAhead, one, 0.0}, raster()).ok());
  EXPECT_FALSE(layer.observe({kSensor, kAhead, one, nan}, raster()).ok());
  EXPECT_TRUE(layer.seen().empty());
  EXPECT_TRUE(layer.observe({kSensor, {}, {}, 0.0}, raster()).value().empty())
      << "an empty scan says nothing";
}

TEST(ObstacleLayer, SkipsADirectionThatIsNone) {
  ObstacleLayer layer(config(), raster());
  const std::vector<Point2> wrong = {{std::nan(""), 0.0}, {1e30, 0.0}};
  const std::vector<float> ranges = {1.0F, 1.0F};
  EXPECT_TRUE(layer.observe({kSensor, wrong, ranges, 0.0}, raster()).value().empty());
  EXPECT_EQ(layer.invalid_ranges(), 2U);
}

TEST(ObstacleLayer, MarksButDoesNotClearFromOutsideTheWindow) {
  ObstacleLayer layer(config(), raster());
  const std::vector<float> ranges = {2.0F};
  ASSERT_TRUE(layer.observe({{-1.0, 1.02, 0.0}, kAhead, ranges, 0.0}, raster()).ok());
  EXPECT_EQ(layer.sensors_outside(), 1U);
  EXPECT_EQ(state(layer, 20), kSeenOccupied);
  EXPECT_EQ(state(layer, 10), kUnseen);
}

// Rays of every direction and length against the integer definition of the line, cut at the
// window's border.
TEST(ObstacleLayer, TracesBresenhamsLine) {
  Random random(5);
  ObstacleLayerConfig far = config();
  far.max_raytrace_range = 400.0;
  far.max_obstacle_range = 0.0;
  for (int round = 0; round < 4000; ++round) {
    ObstacleLayer layer(far, raster());
    const Pose2 sensor{random.uniform(0.0, 5.0), random.uniform(0.0, 4.0), 0.0};
    const double angle = round % 4 == 0
                             ? 0.25 * geometry::kPi * static_cast<double>(random.below(8))
                             : random.uniform(-4.0, 4.0);
    const std::vector<Point2> direction = {{std::cos(angle), std::sin(angle)}};
    const double longest = round % 2 == 0 ? 3.0 : 390.0;
    const std::vector<float> range = {static_cast<float>(random.uniform(0.001, longest))};
    ASSERT_TRUE(layer.observe({sensor, direction, range, 0.0}, raster()).ok());

    const double length = static_cast<double>(range[0]) * 20.0;
    const std::int64_t x0 = static_cast<int>(sensor.x * 20.0);
    const std::int64_t y0 = static_cast<int>(sensor.y * 20.0);
    const auto dx =
        static_cast<std::int64_t>(std::floor(sensor.x * 20.0 + length * direction[0].x())) - x0;
    const auto dy =
        static_cast<std::int64_t>(std::floor(sensor.y * 20.0 + length * direction[0].y())) - y0;
    const bool steep = std::abs(dy) > std::abs(dx);
    const std::int64_t major = steep ? std::abs(dy) : std::abs(dx);
    const std::int64_t minor = steep ? std::abs(dx) : std::abs(dy);
    std::set<std::pair<std::int64_t, std::int64_t>> line;
    for (std::int64_t i = 0; i < major; ++i) {
      const std::int64_t side = (2 * i * minor + major - 1) / (2 * major);
      const std::int64_t x = x0 + (dx < 0 ? -1 : 1) * (steep ? side : i);
      const std::int64_t y = y0 + (dy < 0 ? -1 : 1) * (steep ? i : side);
      if (x < 0 || y < 0 || x >= 100 || y >= 80) break;
      line.emplace(x, y);
    }
    std::set<std::pair<std::int64_t, std::int64_t>> cleared;
    for (std::size_t i = 0; i < layer.states().size(); ++i) {
      const grid::Cell cell = layer.states().geometry().cell(i);
      if (layer.states()[i] != kUnseen) cleared.emplace(cell.x, cell.y);
    }
    ASSERT_EQ(cleared, line) << "round " << round;
  }
}

TEST(ObstacleLayer, ForgetsAfterItsPersistence) {
  ObstacleLayerConfig brief = config();
  brief.persistence = 0.5;
  ObstacleLayer layer(brief, raster());
  see(layer, 2.0F, 10.0);
  see(layer, 1.0F, 10.25);
  EXPECT_TRUE(layer.expire(10.4).empty());
  EXPECT_EQ(layer.expire(10.5), (CellRect{60, 20, 61, 21}));
  EXPECT_EQ(state(layer, 60), kUnseen);
  EXPECT_EQ(state(layer, 40), kSeenOccupied);
  EXPECT_EQ(state(layer, 30), kSeenFree) << "free cells stay";
  see(layer, 1.0F, 10.7);
  EXPECT_TRUE(layer.expire(10.8).empty()) << "seen again";
  EXPECT_EQ(layer.expire(11.2), (CellRect{40, 20, 41, 21}));
  EXPECT_TRUE(layer.expire(1e6).empty());
}

TEST(ObstacleLayer, ReplacesItsMarks) {
  ObstacleLayer layer(config(), raster());
  const std::vector<Point2> corners = {{1.0, 1.0}, {2.0, 1.5}, {-4.0, 0.0}, {std::nan(""), 0.0}};
  EXPECT_EQ(layer.replace(corners, 0.0, raster()).value(), (CellRect{20, 20, 41, 31}));
  EXPECT_EQ(state(layer, 20), kSeenOccupied);
  EXPECT_EQ(state(layer, 40, 30), kSeenOccupied);
  EXPECT_EQ(layer.invalid_ranges(), 1U);
  EXPECT_EQ(layer.replace({}, 0.1, raster()).value(), (CellRect{20, 20, 41, 31}));
  for (const std::uint8_t each : layer.states()) EXPECT_EQ(each, kUnseen);
  EXPECT_FALSE(layer.replace(corners, std::nan(""), raster()).ok());
}

TEST(ObstacleLayer, RefusesAConfigThatCannotBe) {
  const auto error_of = [](auto change) {
    ObstacleLayerConfig wrong = config();
    change(wrong);
    const Status status = ObstacleLayer::check(wrong, 0.05);
    return status.ok() ? std::string() : status.error();
  };
  EXPECT_EQ(error_of([](auto&) {}), "");
  EXPECT_NE(error_of([](auto& c) { c.max_obstacle_range = -1.0; }), "");
  EXPECT_NE(error_of([](auto& c) { c.max_raytrace_range = std::nan(""); }), "");
  EXPECT_NE(error_of([](auto& c) { c.max_raytrace_range = 2000.0; }), "")
      << "longer than 32767 cells";
  EXPECT_NE(error_of([](auto& c) { c.min_raytrace_range = -0.1; }), "");
  EXPECT_NE(error_of([](auto& c) { c.kept_range = -0.1; }), "");
  EXPECT_NE(error_of([](auto& c) { c.kept_range = std::nan(""); }), "");
  EXPECT_NE(error_of([](auto& c) { c.kept_range = 1e6; }), "");
  EXPECT_EQ(error_of([](auto& c) { c.persistence = -1.0; }),
            "layer laser: persistence must be in [0, 86400] s, got -1.000000 s");
}

TEST(ShiftCells, MovesContentAndFillsWhatComesIn) {
  Random random(11);
  for (int round = 0; round < 500; ++round) {
    const int width = 1 + static_cast<int>(random.below(12));
    const int height = 1 + static_cast<int>(random.below(12));
    const int dx = static_cast<int>(random.below(27)) - 13;
    const int dy = static_cast<int>(random.below(27)) - 13;
    grid::Grid<int> cells({width, height, 1.0, 0.0, 0.0});
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = static_cast<int>(i) + 1;
    grid::Grid<int> moved = cells;
    shift_cells(moved.values(), width, height, dx, dy, -5);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const grid::Cell cell = cells.geometry().cell(i);
      ASSERT_EQ(moved[i], cells.value_or({cell.x + dx, cell.y + dy}, -5));
    }
  }
}

grid::OccupancyGrid random_map(Random& random, const grid::GridGeometry& geometry) {
  grid::OccupancyGrid map(geometry);
  for (std::int8_t& cell : map)
    cell = static_cast<std::int8_t>(random.below(3) == 0 ? -1 : 50 * random.below(3));
  return map;
}

TEST(StaticLayer, SamplesTheMapAtCellCentersThroughTheTransform) {
  Random random(9);
  for (int round = 0; round < 60; ++round) {
    const grid::OccupancyGrid map =
        random_map(random, {83, 61, 0.05 * (1 + round % 2), random.uniform(-3, 3), -1.3});
    const Pose2 map_T_window{random.uniform(-3, 3), random.uniform(-3, 3),
                             round % 5 == 0 ? 0.0 : random.uniform(-4, 4)};
    const Raster window{0.013, -0.4, 0.05, 20.0, static_cast<int>(random.below(90)) - 45,
                        -30,   97,   64};
    grid::Grid<std::uint8_t> expected({97, 64, 0.05, 0.0, 0.0}, kUnseen);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const grid::Cell cell = expected.geometry().cell(i);
      const Point2 center{window.anchor_x + (window.first_x + cell.x + 0.5) * 0.05,
                          window.anchor_y + (window.first_y + cell.y + 0.5) * 0.05};
      const int occupancy =
          map.value_or(map.geometry().cell_at(map_T_window * center), grid::kUnknown);
      expected[i] = occupancy < 0 ? kUnseen : occupancy >= 65 ? kSeenOccupied : kSeenFree;
    }
    for (const cpu::Simd simd : {cpu::Simd::kPortable, cpu::best_simd()}) {
      StaticLayer layer(simd);
      ASSERT_TRUE(layer.set_map(map, 65, 0.05).ok());
      grid::Grid<std::uint8_t> states({97, 64, 0.05, 0.0, 0.0}, 9);
      layer.sample(map_T_window, window, window.all(), states);
      ASSERT_EQ(states.values(), expected.values()) << "round " << round;
    }
  }
}

TEST(StaticLayer, LosesNoThinWallOfAFinerMap) {
  for (const double fine : {0.01, 0.02, 0.025, 0.03}) {
    for (int column = 0; column < 40; ++column) {
      grid::OccupancyGrid map({40, 40, fine, 0.0, 0.0}, grid::kFree);
      for (int y = 0; y < 40; ++y) map.at({column, y}) = grid::kOccupied;
      StaticLayer layer;
      ASSERT_TRUE(layer.set_map(map, 65, 0.05).ok());
      const int cells = static_cast<int>(std::floor(40 * fine / 0.05 + 1e-9));
      const Raster window{0.0, 0.0, 0.05, 20.0, 0, 0, cells, cells};
      grid::Grid<std::uint8_t> states({cells, cells, 0.05, 0.0, 0.0});
      layer.sample({}, window, window.all(), states);
      const int wall = static_cast<int>((column + 0.5) * fine / 0.05);
      EXPECT_EQ(states.value_or({wall, 1}, kSeenOccupied), kSeenOccupied)
          << fine << " column " << column;
    }
  }
}

TEST(StaticLayer, RefusesWhatIsNoMap) {
  StaticLayer layer;
  EXPECT_EQ(layer.set_map({}, 65, 0.05).error(), "static map must have 1 to 2^29 cells, got 0 x 0");
  EXPECT_FALSE(layer.set_map(grid::OccupancyGrid({3, 3, 0.0, 0.0, 0.0}), 65, 0.05).ok());
  EXPECT_FALSE(layer.set_map(grid::OccupancyGrid({3, 3, std::nan(""), 0.0, 0.0}), 65, 0.05).ok());
  EXPECT_FALSE(layer.set_map(grid::OccupancyGrid({3, 3, 0.05, std::nan(""), 0.0}), 65, 0.05).ok());
  EXPECT_FALSE(layer.has_map());
}

TEST(StaticLayer, TakesEveryByteForAnOccupancy) {
  grid::OccupancyGrid map({256, 1, 0.05, 0.0, 0.0});
  for (int i = 0; i < 256; ++i)
    map[static_cast<std::size_t>(i)] = static_cast<std::int8_t>(i - 128);
  StaticLayer layer;
  ASSERT_TRUE(layer.set_map(map, 65, 0.05).ok());
  const Raster window{0.0, 0.0, 0.05, 20.0, 0, 0, 256, 1};
  grid::Grid<std::uint8_t> states({256, 1, 0.05, 0.0, 0.0});
  layer.sample({}, window, window.all(), states);
  EXPECT_EQ(states[0], kUnseen);
  EXPECT_EQ(states[127], kUnseen);
  EXPECT_EQ(states[128], kSeenFree);
  EXPECT_EQ(states[128 + 64], kSeenFree);
  EXPECT_EQ(states[128 + 65], kSeenOccupied);
  EXPECT_EQ(states[255], kSeenOccupied);
}

}  // namespace
}  // namespace usher::costmap
