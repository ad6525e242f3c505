#include "simulation/world/core/world_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace usher::world {
namespace {

using testing::HasSubstr;

constexpr const char* kHouse = R"(name: house
ceiling: 2.5
rooms:
  - {name: hall, title: Hall, area: [0, 0, 4, 3]}
walls:
  - {name: north, thickness: 0.1, points: [[0, 3], [4, 3]]}
glass:
  - {name: window, thickness: 0.02, points: [[0, 0], [0, 3]]}
openings:
  - {at: [3.0, 3.0], width: 1.0}
doors:
  - {name: front, at: [1.0, 3.0], width: 0.8}
  - {name: back, at: [0.0, 1.5], width: 0.9, open: false}
furniture:
  - {name: desk, box: [2, 1, 0.5, 1.6, 0.8], height: [0, 0.75]}
  - {name: bin, disc: [3, 1, 0.2], height: [0, 0.7]}
)";

TEST(WorldFile, ReadsABuilding) {
  const auto building = parse_building(kHouse, "house.yaml");
  ASSERT_TRUE(building) << building.error();
  EXPECT_EQ(building->name, "house");
  EXPECT_EQ(building->rooms.size(), 1U);
  EXPECT_EQ(building->walls.size(), 2U);
  EXPECT_EQ(building->gaps.size(), 3U);
  EXPECT_EQ(building->furniture.size(), 2U);
}

TEST(WorldFile, KeepsObstaclesApartFromFurnitureAndConstructsBoth) {
  const auto building = parse_building(
      std::string(kHouse) + "obstacles:\n  - {name: box, disc: [1, 1, 0.2], height: [0, 0.3]}\n",
      "house.yaml");
  ASSERT_TRUE(building) << building.error();
  EXPECT_EQ(building->furniture.size(), 2U);
  ASSERT_EQ(building->obstacles.size(), 1U);
  EXPECT_EQ(construct(*building).back().name, "box");
  const auto doubled = parse_building(
      std::string(kHouse) + "obstacles:\n  - {name: bin, disc: [1, 1, 0.2], height: [0, 0.3]}\n",
      "house.yaml");
  EXPECT_FALSE(doubled.ok()) << "the name is in use";
}

TEST(WorldFile, CutsDoorsOfTheirExactWidth) {
  const auto building = parse_building(kHouse, "house.yaml");
  ASSERT_TRUE(building);
  const Scene scene(construct(*building), building->ceiling);
  const auto gap_at = [&](double x) { return scene.nearest(Point2(x, 3.0), 1.8, 1.0).distance; };
  EXPECT_NEAR(gap_at(1.0), 0.4, 1e-6);
  EXPECT_NEAR(gap_at(3.0), 0.5, 1e-6);
  EXPECT_LE(gap_at(2.0), 0.05 + 1e-6);
  EXPECT_NEAR(scene.nearest(Point2(1.0, 3.0), 2.5, 1.0).distance, 0.0, 1e-6) << "the lintel";
  EXPECT_NEAR(scene.nearest(Point2(0.0, 1.5), 1.8, 1.0).distance, 0.025, 1e-6)
      << "the closed leaf of 0.05 m";
}

struct Refused {
  const char* text;
  const char* because;
};

class WorldFileRefuses : public testing::TestWithParam<Refused> {};

TEST_P(WorldFileRefuses, WithFileAndLine) {
  const auto building = parse_building(GetParam().text, "bad.yaml");
  ASSERT_FALSE(building.ok());
  EXPECT_THAT(building.error(), HasSubstr("bad.yaml:"));
  EXPECT_THAT(building.error(), HasSubstr(GetParam().because));
}

INSTANTIATE_TEST_SUITE_P(
    All, WorldFileRefuses,
    testing::Values(
        Refused{"", "must be a map"}, Refused{"[1, 2]", "must be a map"},
        Refused{"name: [", "not valid YAML"}, Refused{"ceiling: 2.5", "needs the key 'name'"},
        Refused{"name: x\ncolour: red", ":2: unknown key 'colour'"},
        Refused{"name: x\nname: y", "twice"},
        Refused{"name: x\nceiling: high", ":2: world.ceiling must be a number in [2.2, 30]"},
        Refused{"name: x\nceiling: .nan", "must be a number"},
        Refused{"name: x\nceiling: 1e9", "must be a number"},
        Refused{"name: x\nwalls: 5", "must be a list"},
        Refused{"name: x\nwalls:\n  - {name: a, thickness: 0.1, points: [[0, 0]]}", "at least 2"},
        Refused{"name: x\nwalls:\n  - {name: a, thickness: 0.1, points: [[0, 0], [0, 0]]}",
                "two equal points"},
        Refused{"name: x\nwalls:\n  - {name: a, thickness: -1, points: [[0, 0], [1, 0]]}",
                ":3: wall.thickness"},
        Refused{"name: x\nwalls:\n  - {name: a, thickness: 0.1, points: [[0, 0], [1, .inf]]}",
                "point of wall.points"},
        Refused{"name: x\nwalls:\n  - {name: a, thickness: 0.1, points: [[0, 0], [9, 0]]}\n"
                "doors:\n  - {name: d, at: [4, 1], width: 0.8}",
                ":5: 'at' must lie on the middle line of a wall"},
        Refused{"name: x\nwalls:\n  - {name: a, thickness: 0.1, points: [[0, 0], [9, 0]]}\n"
                "doors:\n  - {name: d, at: [0.2, 0], width: 0.8}",
                "half of the width"},
        Refused{"name: x\nfurniture:\n  - {name: a, height: [0, 1]}",
                "one of 'box', 'disc', 'table', 'chair'"},
        Refused{"name: x\nfurniture:\n  - {name: a, disc: [0, 0, 0], height: [0, 1]}", "radius"},
        Refused{"name: x\nfurniture:\n  - {name: a, disc: [0, 0, 1], height: [1, 0]}", "bottom"},
        Refused{"name: x\nfurniture:\n  - {name: a, disc: [0, 0, 1], height: [0, 1]}\n"
                "  - {name: a, disc: [0, 0, 1], height: [0, 1]}",
                ":4: the name 'a' is used twice"},
        Refused{"name: x\nrooms:\n  - {name: a, title: A, area: [4, 0, 0, 3]}", "area"}));

TEST(WorldFile, RefusesAFileThatIsNotThere) {
  EXPECT_THAT(load_building("/nowhere/world.yaml").error(), HasSubstr("cannot be opened"));
}

TEST(PeopleFile, ReadsWalkersAndThoseWhoStand) {
  const auto people = parse_people(
      "people:\n  - {name: a, at: [1, 2], yaw: 0.5}\n"
      "  - {name: b, speed: 1.1, pause: 2, loop: [[0, 0], [4, 0]]}\n",
      "people.yaml");
  ASSERT_TRUE(people) << people.error();
  EXPECT_TRUE((*people)[0].loop.empty());
  EXPECT_EQ((*people)[1].loop.size(), 2U);
  EXPECT_EQ((*people)[1].speed, 1.1);
}

TEST(PeopleFile, RefusesNonsense) {
  const auto error = [](const char* text) { return parse_people(text, "p.yaml").error(); };
  EXPECT_THAT(error("people:\n  - {name: a}"), HasSubstr("p.yaml:2: person needs either"));
  EXPECT_THAT(error("people:\n  - {name: a, at: [1, 2], speed: 99}"), HasSubstr("person.speed"));
  EXPECT_THAT(error("people:\n  - {name: a, loop: [[1, 2]]}"), HasSubstr("at least 2"));
  EXPECT_THAT(error("{}"), HasSubstr("needs the key 'people'"));
}

}  // namespace
}  // namespace usher::world
