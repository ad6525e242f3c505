#include "simulation/world/core/face_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace usher::world {
namespace {

/// A camera 1.15 m above the floor that looks ahead and 8 deg up, at the origin of a hall with a
/// wall of some height 2 m ahead; people where they are put.
struct Hall {
  explicit Hall(std::vector<PersonPlan> people, double wall_height = 0.0,
                const FaceModelConfig& config = {})
      : world(WorldConfig{}, building(wall_height), people, Pose2{0.0, 0.0, 0.0}, 7),
        camera({.sensor = rendering::kinect_v1(),
                .mount = {.x = 0.0, .z = 1.15 - 0.235, .pitch = -geometry::radians(8.0)}},
               1),
        model(config, 3) {}
  static Building building(double wall_height) {
    Building building;
    building.name = "hall";
    building.walls.push_back(
        {"outside", Material::kSolid, 0.2, {{-9, -9}, {9, -9}, {9, 9}, {-9, 9}, {-9, -9}}});
    if (wall_height > 0.0)
      building.furniture.push_back(box("screen", {1.5, 0.0, 0.0}, 0.1, 3.0, 0.0, wall_height));
    return building;
  }
  World world;
  DepthCamera camera;
  FaceModel model;
  std::vector<ModelledFace> faces;
  /// Share of images that have at least one face.
  double found(int images = 400) {
    int hits = 0;
    for (int i = 0; i < images; ++i) {
      model.find(world, camera, faces);
      hits += faces.empty() ? 0 : 1;
    }
    return hits / static_cast<double>(images);
  }
};

PersonPlan standing(double x, double y, double yaw, double height = 1.72) {
  PersonPlan plan;
  plan.name = "p" + std::to_string(x) + std::to_string(y);
  plan.start = {x, y};
  plan.yaw = yaw;
  plan.height = height;
  return plan;
}
FaceModelConfig silent() {
  FaceModelConfig config;
  config.false_alarms = 0.0;
  return config;
}

TEST(FaceModel, FindsWhoLooksAtTheCameraButForAShareOfImages) {
  Hall hall({standing(2.0, 0.3, geometry::kPi)}, 0.0, silent());
  EXPECT_NEAR(hall.found(2000), 0.97, 0.02);
}

TEST(FaceModel, TellsSizeAndPlaceOfAFace) {
  Hall hall({standing(2.0, 0.3, geometry::kPi)}, 0.0, silent());
  double range = 0.0, bearing = 0.0, elevation = 0.0, side = 0.0;
  int n = 0;
  for (int i = 0; i < 500; ++i) {
    hall.model.find(hall.world, hall.camera, hall.faces);
    for (const auto& face : hall.faces) {
      range += face.range, bearing += face.bearing, elevation += face.elevation, side += face.side;
      ++n;
    }
  }
  EXPECT_NEAR(range / n, std::hypot(1.9, 0.3), 0.01);
  EXPECT_NEAR(bearing / n, std::atan2(0.3, 1.9), 0.005);
  EXPECT_NEAR(elevation / n, 0.93 * 1.72, 0.01);
  EXPECT_NEAR(side / n, 92.0 / 1.94, 2.0) << "0.16 m at its depth";
}

TEST(FaceModel, FindsNobodyWhoLooksAwayIsTooFarBesideTheImageOrHidden) {
  const double to_camera = geometry::kPi;
  EXPECT_EQ(Hall({standing(2.0, 0.0, to_camera - 0.8)}, 0.0, silent()).found(), 0.0);
  EXPECT_GT(Hall({standing(2.0, 0.0, to_camera - 0.4)}, 0.0, silent()).found(), 0.9);
  EXPECT_EQ(Hall({standing(3.8, 0.0, to_camera)}, 0.0, silent()).found(), 0.0);
  EXPECT_EQ(Hall({standing(2.0, 1.4, to_camera + 0.6)}, 0.0, silent()).found(), 0.0);
  EXPECT_EQ(Hall({standing(2.5, 0.0, to_camera)}, 2.0, silent()).found(), 0.0);
  EXPECT_GT(Hall({standing(2.5, 0.0, to_camera)}, 0.8, silent()).found(), 0.9) << "over a table";
  EXPECT_EQ(
      Hall({standing(2.8, 0.0, to_camera), standing(1.4, 0.0, 0.0, 1.9)}, 0.0, silent()).found(),
      0.0)
      << "behind somebody's back";
}

TEST(FaceModel, HasFalseFacesAtTheirRateSomeOfThemAgain) {
  FaceModelConfig config;
  config.false_alarms = 0.1;
  config.again = 0.5;
  Hall hall({}, 0.0, config);
  // Each lasts two images on the mean; a fifth of them would not lie in the image.
  const double found = hall.found(5000);
  EXPECT_GT(found, 0.10);
  EXPECT_LT(found, 0.25);
}

TEST(FaceModel, IsDeterministic) {
  Hall a({standing(2.0, 0.3, geometry::kPi)}), b({standing(2.0, 0.3, geometry::kPi)});
  for (int i = 0; i < 200; ++i) {
    a.model.find(a.world, a.camera, a.faces);
    b.model.find(b.world, b.camera, b.faces);
    ASSERT_EQ(a.faces.size(), b.faces.size());
    for (std::size_t k = 0; k < a.faces.size(); ++k) EXPECT_EQ(a.faces[k].left, b.faces[k].left);
  }
}

TEST(Crowd, WhoWatchesTurnsToTheRobot) {
  PersonPlan watcher = standing(2.0, 0.0, 0.0), other = standing(0.0, 2.0, 0.0);
  watcher.watches = true;
  World world(WorldConfig{}, Hall::building(0.0), std::vector<PersonPlan>{watcher, other},
              Pose2{0.0, 0.0, 0.0}, 7);
  for (int i = 0; i < 200; ++i) world.step();
  EXPECT_NEAR(std::abs(world.people()[0].yaw), geometry::kPi, 0.05);
  EXPECT_NEAR(world.people()[1].yaw, 0.0, 0.05);
}

}  // namespace
}  // namespace usher::world
