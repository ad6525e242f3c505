// The shipped office: what it promises about doors, corridors, places and people.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "foundation/grid/map_file.hpp"
#include "simulation/world/core/map_drawing.hpp"
#include "simulation/world/core/shapes.hpp"
#include "simulation/world/core/world.hpp"

namespace usher::world {
namespace {

const std::string kSite = std::string(USHER_SOURCE_DIR) + "/config/sites/office/";

struct Location {
  std::string name;
  Pose2 pose;
};

const Building& office() {
  static const Building building = [] {
    auto loaded = load_building(kSite + "world.yaml");
    EXPECT_TRUE(loaded.ok()) << loaded.error();
    return std::move(loaded).value();
  }();
  return building;
}

const Scene& scene() {
  static const Scene built(construct(office()), office().ceiling);
  return built;
}

std::vector<PersonPlan> people() {
  auto loaded = load_people(kSite + "people.yaml");
  EXPECT_TRUE(loaded.ok()) << loaded.error();
  return std::move(loaded).value();
}

std::vector<Location> locations() {
  std::vector<Location> result;
  for (const YAML::Node& node : YAML::LoadFile(kSite + "site.yaml")["locations"]) {
    result.push_back({node["name"].as<std::string>(),
                      {node["x"].as<double>(), node["y"].as<double>(), node["yaw"].as<double>()}});
  }
  return result;
}

grid::OccupancyGrid drawn_map() {
  return draw_map(scene(), {.start = locations().front().pose.position()});
}

double clearance(const Point2& p) { return scene().nearest(p, 1.8, 3.0).distance; }

TEST(Office, HasAtLeastEightNamedRooms) {
  EXPECT_GE(office().rooms.size(), 8U);
  EXPECT_NEAR((scene().upper() - scene().lower()).x(), 35.0, 0.5);
  EXPECT_NEAR((scene().upper() - scene().lower()).y(), 25.0, 0.5);
}

TEST(Office, HasCorridorsOf1Point2And1Point4Metres) {
  EXPECT_NEAR(2.0 * clearance({20.0, 10.0}), 1.4, 1e-3);
  EXPECT_NEAR(2.0 * clearance({11.0, 14.0}), 1.4, 1e-3);
  EXPECT_NEAR(2.0 * clearance({15.5, 18.0}), 1.4, 1e-3);
  EXPECT_NEAR(2.0 * clearance({28.0, 13.0}), 1.2, 1e-3);
}

TEST(Office, HasDoorsOf0Point8Metres) {
  int narrow = 0;
  for (const Gap& gap : office().gaps) {
    if (!gap.open) continue;
    EXPECT_NEAR(clearance(gap.at), 0.5 * gap.width, 1e-3) << gap.name;
    narrow += gap.width == 0.8 ? 1 : 0;
  }
  EXPECT_GE(narrow, 8);
}

TEST(Office, EveryLocationIsInItsRoomAndRoomyEnoughToTurn) {
  const auto places = locations();
  EXPECT_GE(places.size(), 8U);
  const double reach = shapes::Polygon(RobotConfig{}.footprint).radius();
  for (const Location& place : places) {
    const auto room = std::find_if(office().rooms.begin(), office().rooms.end(),
                                   [&](const Room& r) { return r.name == place.name; });
    ASSERT_NE(room, office().rooms.end()) << place.name;
    const Point2 p = place.pose.position();
    EXPECT_TRUE((p.array() > room->lower.array()).all() && (p.array() < room->upper.array()).all())
        << place.name;
    EXPECT_GT(clearance(p), reach + 0.15) << place.name;
  }
}

TEST(Office, EveryLocationIsReachableFromTheFirst) {
  const grid::OccupancyGrid map = drawn_map();
  constexpr double kRobotRadius = 0.35;
  const auto& g = map.geometry();
  grid::Grid<std::uint8_t> reached(g, 0);
  std::vector<grid::Cell> open{g.cell_at(locations().front().pose.position())};
  while (!open.empty()) {
    const grid::Cell c = open.back();
    open.pop_back();
    if (!g.contains(c) || reached.at(c) != 0) continue;
    if (map.at(c) != grid::kFree || clearance(g.center(c)) < kRobotRadius) continue;
    reached.at(c) = 1;
    for (const auto& next : {grid::Cell{c.x + 1, c.y}, grid::Cell{c.x - 1, c.y},
                             grid::Cell{c.x, c.y + 1}, grid::Cell{c.x, c.y - 1}}) {
      open.push_back(next);
    }
  }
  for (const Location& place : locations()) {
    EXPECT_EQ(reached.value_or(g.cell_at(place.pose.position()), 0), 1) << place.name;
  }
}

TEST(Office, PeoplesWaysAreFree) {
  for (const PersonPlan& person : people()) {
    const auto& loop = person.loop;
    EXPECT_GT(clearance(person.start), 0.3) << person.name;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Point2 to = loop[(i + 1) % loop.size()];
      for (double s = 0.0; s <= 1.0; s += 0.02) {
        EXPECT_GT(clearance(loop[i] + s * (to - loop[i])), 0.27) << person.name << " leg " << i;
      }
    }
  }
}

TEST(Office, PeopleWalkTheirLoopsForTenMinutes) {
  WorldConfig config;
  World world(config, office(), people(), locations().front().pose, 1);
  std::vector<double> walked(world.people().size(), 0.0);
  for (int i = 0; i < 60000; ++i) {
    world.step();
    for (std::size_t k = 0; k < walked.size(); ++k) {
      walked[k] += world.people()[k].velocity.norm() * kStep;
    }
  }
  for (std::size_t k = 0; k < walked.size(); ++k) {
    const Person& person = world.people()[k];
    if (person.scripted) {
      EXPECT_LT(walked[k], 5.0) << person.name;
    } else {
      EXPECT_GT(walked[k], 100.0) << person.name;
    }
  }
  EXPECT_EQ(world.truth().contacts + world.truth().touches, 0U);
}

// USHER_WRITE_SITE=1 writes the map anew after a change of world.yaml.
TEST(Office, ShippedMapIsTheDrawnOne) {
  const grid::OccupancyGrid map = drawn_map();
  if (std::getenv("USHER_WRITE_SITE") != nullptr) {
    const Status saved = grid::save_map(map, kSite + "map.yaml");
    ASSERT_TRUE(saved.ok()) << saved.error();
  }
  const auto shipped = grid::load_map(kSite + "map.yaml");
  ASSERT_TRUE(shipped.ok()) << shipped.error();
  EXPECT_EQ(shipped->width(), map.width());
  EXPECT_EQ(shipped->height(), map.height());
  EXPECT_NEAR(shipped->geometry().origin_x, map.geometry().origin_x, 1e-6);
  EXPECT_NEAR(shipped->geometry().origin_y, map.geometry().origin_y, 1e-6);
  EXPECT_EQ(shipped->values(), map.values());
}

TEST(Office, MapShowsGlassAndLeavesDoorsOpen) {
  const grid::OccupancyGrid map = drawn_map();
  const auto at = [&](double x, double y) { return map.at(map.geometry().cell_at(x, y)); };
  EXPECT_EQ(at(2.0, 9.25), grid::kOccupied) << "glass";
  EXPECT_EQ(at(5.0, 9.25), grid::kFree) << "opening";
  for (double x = 15.63; x < 16.37; x += 0.05) EXPECT_EQ(at(x, 9.25), grid::kFree) << x;
  EXPECT_EQ(at(-0.4, 5.0), grid::kUnknown) << "outside";
}

}  // namespace
}  // namespace usher::world
