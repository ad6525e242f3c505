#include "perception/people_detector/core/camera_view.hpp"

#include <gtest/gtest.h>

namespace usher::people_detector {
namespace {

/// An optical frame as depth_pipeline writes it.
geometry::Pose3 optical(const geometry::Point2& place, double height, double yaw, double down,
                        double roll) {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {{place.x(), place.y(), height},
          geometry::from_roll_pitch_yaw(roll, down, yaw) * Eigen::Quaterniond(axes)};
}

TEST(PlaceCamera, FindsTheViewWhereverTheCameraLooks) {
  for (const double yaw : {0.0, 3.1, -1.2}) {
    for (const double down : {-0.3, 0.0, 0.5}) {
      for (const double roll : {-0.1, 0.0, 0.2}) {
        const PlacedCamera camera = place_camera(optical({0.2, -0.1}, 0.9, yaw, down, roll));
        EXPECT_NEAR(camera.view.height, 0.9, 1e-9);
        EXPECT_NEAR(camera.view.down, down, 1e-9);
        EXPECT_NEAR(camera.view.roll, roll, 1e-9);
        EXPECT_NEAR(camera.base_T_foot.x, 0.2, 1e-9);
        EXPECT_NEAR(camera.base_T_foot.y, -0.1, 1e-9);
        EXPECT_NEAR(camera.base_T_foot.yaw, yaw, 1e-9);
      }
    }
  }
}

TEST(PlaceSightings, TurnsPlaceAndUncertaintyIntoOdom) {
  const std::vector<Sighting> seen{{2.0, 0.0, 1.7, 3.0}, {3.0, 3.0, 0.0, 3.0}};
  std::vector<Observation> placed{{}, {}, {}};
  const SightingErrors errors{
      .along = 0.1, .along_growth = 0.05, .across = 0.02, .across_growth = 0.0};
  place_sightings(seen, {1.0, 1.0, geometry::kPi / 2}, errors, placed);
  ASSERT_EQ(placed.size(), 2U);
  EXPECT_TRUE(placed[0].position.isApprox(geometry::Point2(1.0, 3.0), 1e-9));
  EXPECT_NEAR(placed[0].covariance(1, 1), 0.2 * 0.2, 1e-9) << "along the line of sight";
  EXPECT_NEAR(placed[0].covariance(0, 0), 0.02 * 0.02, 1e-9);
  EXPECT_NEAR(placed[0].height, 1.7, 1e-9);
  EXPECT_TRUE(placed[1].position.isApprox(geometry::Point2(-2.0, 4.0), 1e-9));
  EXPECT_LT(placed[1].covariance(0, 1), 0.0) << "seen to the upper left";
}

TEST(PlaceSightings, MeasureNobodyCloseBehindAnotherOne) {
  imaging::Appearance red;
  red.upper = {{50.0, 40.0, 20.0}, 1};
  const std::vector<Sighting> seen{{2.0, 0.0, 1.6, 3.0, red},        // before the others
                                   {4.0, 0.1, 1.4, 3.0, red, true},  // behind him
                                   {2.5, 0.2, 1.5, 3.0, red},        // close behind him
                                   {4.0, 1.5, 1.7, 3.0, red}};       // beside them
  std::vector<Observation> placed;
  place_sightings(seen, {}, {}, placed);
  ASSERT_EQ(placed.size(), 4U);
  EXPECT_EQ(placed[0].height, 1.6);
  EXPECT_FALSE(placed[0].head_hidden);
  EXPECT_EQ(placed[1].height, 1.4);
  EXPECT_TRUE(placed[1].head_hidden);
  EXPECT_TRUE(placed[1].appearance.known()) << "by what is seen beside him";
  EXPECT_EQ(placed[2].height, 0.0);
  EXPECT_FALSE(placed[2].appearance.known());
  EXPECT_EQ(placed[3].height, 1.7);
}

}  // namespace
}  // namespace usher::people_detector
