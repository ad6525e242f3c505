// The shipped sites with obstacles that came after their maps: a map is what stood there before,
// and start and goal are free. USHER_WRITE_SITE=1 writes the maps anew.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstdlib>
#include <string>

#include "foundation/grid/map_file.hpp"
#include "simulation/world/core/map_drawing.hpp"
#include "simulation/world/core/world_file.hpp"

namespace usher::world {
namespace {

constexpr double kHalfDiagonal = 0.45;  // [m] of MARVIN's outline
constexpr double kHeight = 1.8;         // [m] of MARVIN

class UnmappedObstacles : public testing::TestWithParam<const char*> {
 protected:
  const std::string site_ = std::string(USHER_SOURCE_DIR) + "/config/sites/" + GetParam() + "/";
  const Building building_ = load_building(site_ + "world.yaml").value();
};

TEST_P(UnmappedObstacles, AreNotOnTheMap) {
  Building mapped = building_;
  EXPECT_FALSE(mapped.obstacles.empty());
  mapped.obstacles.clear();
  const auto drawn =
      draw_map(Scene(construct(mapped), mapped.ceiling), {.start = Point2(1.0, 1.3)});
  if (std::getenv("USHER_WRITE_SITE") != nullptr) {
    ASSERT_TRUE(grid::save_map(drawn, site_ + "map.yaml"));
  }
  const auto map = grid::load_map(site_ + "map.yaml");
  ASSERT_TRUE(map) << map.error();
  EXPECT_EQ(map->values(), drawn.values());
}

TEST_P(UnmappedObstacles, LeaveRoomAtStartAndGoal) {
  const Scene scene(construct(building_), building_.ceiling);
  const auto site = YAML::LoadFile(site_ + "site.yaml");
  for (const YAML::Node& node : site["locations"]) {
    const Point2 place(node["x"].as<double>(), node["y"].as<double>());
    EXPECT_GT(scene.nearest(place, kHeight, 3.0).distance, kHalfDiagonal + 0.2)
        << node["name"].as<std::string>();
  }
}

INSTANTIATE_TEST_SUITE_P(Sites, UnmappedObstacles,
                         testing::Values("obstacle_course", "glass_corridor"));

TEST(ObstacleCourse, HasTheObjectsOfTable8Point2) {
  const auto course =
      load_building(std::string(USHER_SOURCE_DIR) + "/config/sites/obstacle_course/world.yaml");
  ASSERT_TRUE(course.ok()) << course.error();
  const auto top_of = [&](const std::string& name) {
    double top = 0.0;
    for (const Thing& thing : course->obstacles) {
      if (thing.name.starts_with(name)) top = std::max(top, thing.top);
    }
    return top;
  };
  const std::pair<const char*, double> heights[] = {
      {"1_", 0.9}, {"2_", 0.9}, {"3_", 0.01}, {"4_", 0.7}, {"5_", 0.2}, {"6_", 0.9}, {"7_", 0.3}};
  for (const auto& [name, height] : heights) EXPECT_NEAR(top_of(name), height, 1e-9) << name;
}

}  // namespace
}  // namespace usher::world
