// The shipped arena: its map is what the world looks like, its places are free, its corridor is
// narrow. USHER_WRITE_SITE=1 writes the map anew.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstdlib>
#include <string>

#include "foundation/grid/map_file.hpp"
#include "simulation/world/core/map_drawing.hpp"
#include "simulation/world/core/world_file.hpp"

namespace usher::world {
namespace {

const std::string kSite = std::string(USHER_SOURCE_DIR) + "/config/sites/arena/";
constexpr double kHalfDiagonal = 0.297;  // [m] of the Pioneer's outline
constexpr double kHeight = 1.2;          // [m] of the Pioneer with its tripod

const Scene& scene() {
  static const Scene built = [] {
    const auto building = load_building(kSite + "world.yaml");
    EXPECT_TRUE(building.ok()) << building.error();
    return Scene(construct(*building), building->ceiling);
  }();
  return built;
}

TEST(Arena, ItsMapIsWhatTheWorldLooksLike) {
  const auto drawn = draw_map(scene(), {.start = {1.5, 1.5}});
  if (std::getenv("USHER_WRITE_SITE") != nullptr) {
    ASSERT_TRUE(grid::save_map(drawn, kSite + "map.yaml"));
  }
  const auto map = grid::load_map(kSite + "map.yaml");
  ASSERT_TRUE(map) << map.error();
  EXPECT_EQ(map->values(), drawn.values());
}

TEST(Arena, ItsPlacesHaveRoomToTurn) {
  const auto site = YAML::LoadFile(kSite + "site.yaml");
  EXPECT_GE(site["locations"].size(), 4U);
  for (const YAML::Node& node : site["locations"]) {
    const Point2 place(node["x"].as<double>(), node["y"].as<double>());
    EXPECT_GT(scene().nearest(place, kHeight, 3.0).distance, kHalfDiagonal + 0.05)
        << node["name"].as<std::string>();
  }
}

TEST(Arena, HasTwoMeetingRoomsAndANarrowCorridor) {
  const auto building = load_building(kSite + "world.yaml");
  int meeting_rooms = 0;
  for (const auto& room : building->rooms)
    meeting_rooms += room.name.starts_with("meeting_room") ? 1 : 0;
  EXPECT_EQ(meeting_rooms, 2);
  EXPECT_NEAR(2.0 * scene().nearest({15.0, 11.05}, kHeight, 3.0).distance, 0.8, 0.01);
}

}  // namespace
}  // namespace usher::world
