#include "sensing/depth_pipeline/core/depth_pipeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "sensing/depth_pipeline/test/synthetic.hpp"
#include "support/data.hpp"

namespace usher::depth_pipeline {
namespace {

using testing::HasSubstr;

constexpr CameraPose kPose{.height = 0.9, .forward = 0.2, .down = 0.0872664626};

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kPixels = std::size_t{512} * 424;

std::size_t pixel(int row, int column) {
  return std::size_t{512} * static_cast<std::size_t>(row) + static_cast<std::size_t>(column);
}

PipelineConfig trusting() {
  PipelineConfig config;
  config.confidence_frames = 1;
  return config;
}

DepthPipeline make(const SyntheticScene& scene, const PipelineConfig& config = trusting()) {
  return DepthPipeline::make(scene.camera, config).value();
}

/// Range at a bearing [rad], counter-clockwise.
float at(const DepthPipeline& pipeline, const std::vector<float>& ranges, double bearing) {
  const ScanGeometry& g = pipeline.geometry();
  return ranges[static_cast<std::size_t>((bearing - g.angle_min) / g.increment)];
}

std::size_t finite(const std::vector<float>& ranges) {
  return static_cast<std::size_t>(
      std::count_if(ranges.begin(), ranges.end(), [](float r) { return std::isfinite(r); }));
}

std::size_t positive(const std::vector<float>& ranges) {
  return static_cast<std::size_t>(std::count_if(
      ranges.begin(), ranges.end(), [](float r) { return std::isfinite(r) && r > 0.0F; }));
}

TEST(DepthPipeline, FindsNoObstacleOnAnEmptyFloorHoweverItLeans) {
  SyntheticScene scene;
  scene.half_width = scene.end = 30.0;
  scene.noise = 0.0005;
  scene.dropouts = 0.02;
  DepthPipeline pipeline = make(scene);
  const Mount mount;
  for (int degrees = -20; degrees <= 22; degrees += 3) {
    const CameraPose pose = camera_pose(mount, -0.0873, degrees * 0.0174533);
    const auto image = scene.draw(pose, static_cast<std::uint64_t>(degrees) + 100);
    const auto view = pipeline.process(view_of(scene.camera, image), pose);
    ASSERT_TRUE(view.ok()) << view.error();
    EXPECT_EQ(finite(view->scan->ranges), 0U) << degrees;
    EXPECT_EQ(finite(view->low->ranges), 0U) << degrees;
    EXPECT_EQ(view->drops, 0) << degrees;
  }
}

TEST(DepthPipeline, RangesAreHorizontalWhateverThePitch) {
  SyntheticScene scene;
  scene.boxes = {{-0.4, 0.2, 1.5, 2.5, 2.8}, {1.0, 1.4, 0.3, 2.2, 2.6}};
  DepthPipeline pipeline = make(scene);
  const Mount mount;
  for (const double pitch : {-0.1, 0.0, 0.1, 0.17}) {
    const CameraPose pose = camera_pose(mount, -0.0873, pitch);
    SyntheticScene moved = scene;  // the boxes stay, the camera moves with the body
    const double ahead = pose.forward - 0.2;
    for (SyntheticBox& box : moved.boxes) box.z0 -= ahead, box.z1 -= ahead;
    const auto image = moved.draw(pose);
    const auto view = pipeline.process(view_of(scene.camera, image), pose).value();
    for (const double x : {-0.3, 0.0, 0.15}) {
      const float range = at(pipeline, view.scan->ranges, std::atan2(-x, 2.5));
      EXPECT_NEAR(range, std::hypot(2.5, x), 0.015) << pitch << " " << x;
    }
    const float low = at(pipeline, view.scan->ranges, std::atan2(-1.2, 2.2));
    EXPECT_NEAR(low, std::hypot(2.2, 1.2), 0.03) << pitch;
  }
}

TEST(DepthPipeline, LowScanHasOnlyWhatIsLow) {
  SyntheticScene scene;
  scene.boxes = {{-0.8, -0.4, 1.2, 2.5, 2.8}, {0.4, 0.8, 0.3, 2.0, 2.4}};
  DepthPipeline pipeline = make(scene);
  const auto image = scene.draw(kPose);
  const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
  const double tall = std::atan2(0.6, 2.5), low = std::atan2(-0.6, 2.0);
  EXPECT_NEAR(at(pipeline, view.scan->ranges, tall), std::hypot(2.5, 0.6), 0.02);
  EXPECT_NEAR(at(pipeline, view.low->ranges, tall), -std::hypot(2.5, 0.6), 0.02)
      << "nothing low up to there";
  EXPECT_NEAR(at(pipeline, view.low->ranges, low), std::hypot(2.0, 0.6), 0.02);
  // The far wall is in the scan, and hides from the low one what is low behind it.
  EXPECT_NEAR(at(pipeline, view.scan->ranges, 0.0), 5.0, 0.02);
  EXPECT_NEAR(at(pipeline, view.low->ranges, 0.0), -5.0, 0.02);
}

// A camera that looks down sees the foot of what is at the image's edge and not what stands on it.
TEST(DepthPipeline, NothingLowIsTheFootOfWhatStandsHighAtTheImagesEdge) {
  const Mount mount;
  for (const double pitch : {-0.1, 0.0, 0.1, 0.2}) {
    const CameraPose pose = camera_pose(mount, -0.0873, pitch);
    for (const double aside : {0.5, 0.7, 1.0, 1.4}) {
      SyntheticScene scene;
      scene.half_width = aside;  // walls beside it
      DepthPipeline pipeline = make(scene);
      const auto walls = scene.draw(pose);
      auto view = pipeline.process(view_of(scene.camera, walls), pose).value();
      EXPECT_EQ(positive(view.low->ranges), 0U) << pitch << " " << aside;

      scene.half_width = 5.0;  // or who stands there
      scene.boxes = {{aside, aside + 0.3, 1.7, 1.6 * aside, 1.6 * aside + 0.3}};
      const auto person = scene.draw(pose);
      view = pipeline.process(view_of(scene.camera, person), pose).value();
      EXPECT_EQ(positive(view.low->ranges), 0U) << pitch << " " << aside;
    }
  }
}

TEST(DepthPipeline, NothingLowIsTheFootOfAWallUnderAnArmThatIsTooNearToBeMeasured) {
  SyntheticScene scene;
  scene.half_width = 0.7;
  const auto wall = scene.draw(kPose);
  for (std::size_t end = 200; end <= 420; end += 10) {
    DepthPipeline pipeline = make(scene);
    auto image = wall;
    for (std::size_t row = 0; row < end; ++row)
      std::fill_n(image.begin() + static_cast<std::ptrdiff_t>(512 * row + 40), 60, 0);
    const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
    EXPECT_EQ(positive(view.low->ranges), 0U) << end;
  }
}

TEST(DepthPipeline, WhatIsLowAndNarrowAsPixelsAtAnEdgeIsNotKnown) {
  for (const double width : {0.02, 0.08}) {
    SyntheticScene scene;
    scene.boxes = {{-width / 2, width / 2, 0.3, 2.0, 2.1}};
    DepthPipeline pipeline = make(scene);
    const auto image = scene.draw(kPose);
    const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
    const float low = at(pipeline, view.low->ranges, 0.0);
    const float any = at(pipeline, view.scan->ranges, 0.0);
    if (width < 0.03) {
      EXPECT_TRUE(std::isnan(low));
      EXPECT_NEAR(any, 5.0, 0.02) << "the wall behind it";
    } else {
      EXPECT_NEAR(low, 2.0, 0.02);
      EXPECT_NEAR(any, 2.0, 0.02);
    }
  }
}

// Nearer than 2.0 m ahead, but looked at flatter than vinyl must be to mirror: it lies aside.
// What a jump of the pitch makes of the floor stands elsewhere in each of its frames. The robot
// heeds it; remembered, it would bar the way for minutes.
TEST(DepthPipeline, NothingLowIsRememberedThatStandsElsewhereInEachFrame) {
  SyntheticScene scene;
  DepthPipeline pipeline = make(scene, {});
  const double ahead = pipeline.geometry().increment;  // beside the middle of the image
  const auto look = [&](std::optional<double> box) {
    scene.boxes.clear();
    if (box) scene.boxes.push_back({-0.3, 0.3, 0.2, *box, *box + 0.3});
    const auto image = scene.draw(kPose);
    return pipeline.process(view_of(scene.camera, image), kPose).value();
  };
  look({});
  look({});
  for (const double box : {2.0, 1.7, 1.4}) {
    const auto view = look(box);
    EXPECT_EQ(positive(view.low->ranges), 0U) << box;
    if (box < 1.5) {
      EXPECT_NEAR(at(pipeline, view.scan->ranges, ahead), box, 0.02);
    }
  }
  // Two frames later it has stood still for three, and counts.
  look(1.4);
  EXPECT_NEAR(at(pipeline, look(1.4).low->ranges, ahead), 1.4, 0.02);
}

TEST(DepthPipeline, AMirroringPatchAsideIsNoDrop) {
  for (const bool aside : {true, false}) {
    SyntheticScene scene;
    scene.half_width = scene.end = 30.0;
    DepthPipeline pipeline = make(scene);
    auto image = scene.draw(kPose);
    const double from = aside ? 1.6 : 1.32;
    const double middle = aside ? 0.595 : 0.0;  // side over depth
    for (int row = 0; row < 424; ++row) {
      const double y = (row - scene.camera.cy) / scene.camera.fy;
      const double floor = kPose.height / (std::sin(kPose.down) + y * std::cos(kPose.down));
      const double forward = floor * (std::cos(kPose.down) - y * std::sin(kPose.down));
      if (!(forward > from && forward < from + 0.36)) continue;
      for (int column = 0; column < 512; ++column) {
        const double side = (scene.camera.cx - column) / scene.camera.fx;
        if (std::abs(side - middle) < 0.085) image[pixel(row, column)] = 4000;
      }
    }
    const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
    if (aside) {
      EXPECT_EQ(view.drops, 0);
    } else {
      EXPECT_GT(view.drops, 20);
    }
  }
}

TEST(DepthPipeline, WhatTheRobotPassesUnderIsNoObstacle) {
  SyntheticScene scene;
  scene.ceiling = 2.1;
  scene.half_width = scene.end = 30.0;
  DepthPipeline pipeline = make(scene);
  CameraPose pose = kPose;
  pose.down = -0.17;
  const auto image = scene.draw(pose);
  const auto view = pipeline.process(view_of(scene.camera, image), pose).value();
  EXPECT_EQ(finite(view.scan->ranges), 0U);
  const auto obstacles = std::count_if(view.processed.begin(), view.processed.end(),
                                       [](std::uint16_t v) { return v != 0; });
  EXPECT_EQ(obstacles, 0);
}

TEST(DepthPipeline, MissingFloorIsAnObstacleWhereItEnds) {
  for (const double pit : {0.17, 1.0, 6.0}) {  // a step, a stairway, nothing measured
    SyntheticScene scene;
    scene.half_width = scene.end = 30.0;
    scene.noise = 0.0005;
    scene.edge = 2.4;
    scene.pit = pit;
    scene.ceiling = 3.0;
    DepthPipeline pipeline = make(scene);
    const auto image = scene.draw(kPose);
    const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
    EXPECT_GT(view.drops, 450) << pit;
    for (const double bearing : {-0.4, 0.0, 0.4}) {
      const double range = 2.4 / std::cos(bearing);
      EXPECT_NEAR(at(pipeline, view.scan->ranges, bearing), range, 0.08) << pit;
      EXPECT_NEAR(at(pipeline, view.low->ranges, bearing), range, 0.08) << pit;
    }
  }
}

TEST(DepthPipeline, TellsADropFromALowThing) {
  for (const double pit : {0.17, 1.0, 6.0}) {
    SyntheticScene scene;
    scene.half_width = scene.end = 30.0;
    scene.ceiling = 3.0;
    scene.edge = 2.4;
    scene.pit = pit;
    scene.boxes = {{0.4, 0.8, 0.3, 1.8, 2.0}};  // before the edge
    DepthPipeline pipeline = make(scene);
    const auto image = scene.draw(kPose);
    const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
    const auto& ranges = view.low->ranges;
    ASSERT_EQ(view.low_drops.size(), ranges.size());
    std::size_t things = 0, drops = 0;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const double bearing =
          pipeline.geometry().angle_min + pipeline.geometry().increment * static_cast<double>(i);
      const auto forward = static_cast<double>(ranges[i]) * std::cos(bearing);
      if (!std::isfinite(ranges[i]) || ranges[i] < 0.0F) {
        EXPECT_EQ(view.low_drops[i], Drop::kNone) << pit << " " << bearing;
      } else if (view.low_drops[i] != Drop::kNone) {
        // Nothing is measured in the deepest: something too near to be measured looks like that.
        EXPECT_EQ(view.low_drops[i], pit < 2.0 ? Drop::kBehindFloor : Drop::kMissing)
            << pit << " " << bearing;
        EXPECT_NEAR(forward, 2.4, 0.1) << pit << " " << bearing;
        ++drops;
      } else {
        EXPECT_NEAR(forward, 1.9, 0.12) << pit << " " << bearing;
        ++things;
      }
    }
    EXPECT_GT(things, 60U) << pit;
    EXPECT_GT(drops, 300U) << pit;

    scene.edge = std::numeric_limits<double>::infinity();  // and no view keeps those of the last
    const auto whole = scene.draw(kPose);
    const auto next = pipeline.process(view_of(scene.camera, whole), kPose).value();
    EXPECT_EQ(std::ranges::count(next.low_drops, Drop::kNone),
              static_cast<std::ptrdiff_t>(next.low_drops.size()))
        << pit;
  }
}

TEST(DepthPipeline, FloorThatDarkTrousersHideIsNotMissingBehindFloor) {
  SyntheticScene scene;
  scene.half_width = scene.end = 30.0;
  scene.boxes = {{-0.3, 0.3, 1.8, 1.9, 2.1}};
  DepthPipeline pipeline = make(scene);
  auto image = scene.draw(kPose);
  for (int row = 240; row < 424; ++row) {  // what of him is lower than 0.8 m measures nothing
    for (int column = 0; column < 512; ++column) {
      auto& depth = image[pixel(row, column)];
      if (std::abs(column - 256) < 56 && depth > 1850) depth = 0;
    }
  }
  const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
  EXPECT_GT(view.drops, 50);
  EXPECT_EQ(std::ranges::count(view.low_drops, Drop::kBehindFloor), 0);
}

TEST(DepthPipeline, FloorUnderAnArmHeldLevelIsNotMissingBehindFloor) {
  SyntheticScene scene;
  scene.half_width = scene.end = 4.0;
  DepthPipeline pipeline = make(scene);
  auto image = scene.draw(kPose);
  for (int row = 260; row < 340; ++row)  // floor below it, the room above it
    std::fill_n(image.begin() + static_cast<std::ptrdiff_t>(pixel(row, 200)), 112,
                std::uint16_t{0});
  const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
  EXPECT_GT(view.drops, 50);
  EXPECT_EQ(std::ranges::count(view.low_drops, Drop::kBehindFloor), 0);
}

TEST(DepthPipeline, TellsNothingOfLowThingsWhereItDoesNotLook) {
  for (const double end : {30.0, 4.0}) {  // free, and a wall that would hide what is low
    SyntheticScene scene;
    scene.half_width = scene.end = end;
    scene.boxes = {{0.3, 0.7, 0.3, 3.0, 3.2}};
    DepthPipeline pipeline = make(scene);
    for (const bool up : {false, true}) {
      CameraPose pose = kPose;
      pose.down = up ? -0.17 : kPose.down;  // the floor is in the image from 2.5 m on, from 1.3 m
      const auto image = scene.draw(pose);
      const auto view = pipeline.process(view_of(scene.camera, image), pose).value();
      const auto told = [](float range) { return range < 0.0F || std::isinf(range); };
      const auto count = std::ranges::count_if(view.low->ranges, told);
      EXPECT_EQ(count > 300, !up) << end << " " << count;
      EXPECT_EQ(count == 0, up) << end;
      EXPECT_NEAR(at(pipeline, view.low->ranges, -0.17), 3.05, 0.1) << "what it sees, it tells";
    }
  }
}

TEST(DepthPipeline, AHoleIsAsWideAsItIsThoughTheCameraLooksDown) {
  SyntheticScene scene;
  scene.half_width = scene.end = 30.0;
  DepthPipeline pipeline = make(scene);
  CameraPose pose = kPose;
  pose.down = 0.26;
  auto image = scene.draw(pose);
  constexpr double kNear = 1.3, kFar = 1.8;  // [m] of the hole
  constexpr int kHalf = 100;                 // [px]
  double half_width = 0.0;                   // [m] where it begins
  const double c = std::cos(pose.down), s = std::sin(pose.down);
  for (int row = 0; row < scene.camera.height; ++row) {
    const double y = (row - scene.camera.cy) / scene.camera.fy;
    const double sinks = s + y * c;
    if (sinks <= 0.0) continue;
    const double depth = pose.height / sinks, forward = depth * (c - y * s);
    if (forward < kNear || forward > kFar) continue;
    half_width = kHalf * depth / scene.camera.fx;
    for (int column = 256 - kHalf; column < 256 + kHalf; ++column) image[pixel(row, column)] = 5000;
  }
  EXPECT_NEAR(half_width, 0.41, 0.01);
  const auto view = pipeline.process(view_of(scene.camera, image), pose).value();
  const auto ends_at = [&](double left) {
    return at(pipeline, view.scan->ranges, std::atan2(left, kNear + 0.02));
  };
  for (const double side : {-1.0, 1.0}) {
    EXPECT_LT(ends_at(side * (half_width - 0.02)), 1.5F) << side;
    EXPECT_FALSE(ends_at(side * (half_width + 0.04)) < 1.5F) << side;
  }
}

/// A wall 0.7 m beside the camera's way: from 2 m on it is looked at so flatly that it gives no
/// measurement.
class AlongAWall : public testing::TestWithParam<double> {
 protected:
  enum class Beyond { kNothing, kFloor, kNoFloorAtAll };
  static constexpr double kWall = 0.7;  // [m] beside

  /// The range at the bearing where the wall is 2.5 m ahead; it begins `from` m ahead, is measured
  /// up to 2 m, and nearer by `step` there.
  float look(Beyond beyond, bool before = true, double step = 0.0) {
    const double sense = GetParam();
    SyntheticScene scene;
    scene.half_width = scene.end = 30.0;
    const SyntheticScene bare = scene;
    const auto box = [&](double beside) {
      return SyntheticBox{sense > 0.0 ? -2.0 : beside, sense > 0.0 ? -beside : 2.0, 2.5, 0.3, 3.2};
    };
    scene.boxes = {box(kWall)};
    auto image = scene.draw(kPose);
    const auto floor = bare.draw(kPose);
    scene.boxes = {box(kWall - step)};
    const auto nearer = scene.draw(kPose);
    for (int column = 0; column < 512; ++column) {
      const double side = sense * (scene.camera.cx - column) / scene.camera.fx;
      for (int row = 0; row < 424; ++row) {
        auto& depth = image[pixel(row, column)];
        const std::uint16_t bare_floor = floor[pixel(row, column)];
        const bool wall = depth != bare_floor;
        if (side > kWall / 2.0) {
          depth = before ? nearer[pixel(row, column)] : bare_floor;
        } else if (side > kWall / 3.2 && beyond == Beyond::kNoFloorAtAll) {
          if (row > 150) depth = 0;
        } else if (wall) {
          const double behind = 1e-3 * bare_floor - kWall / side;
          depth = beyond == Beyond::kFloor && behind > 0.4 ? bare_floor : std::uint16_t{0};
        }
      }
    }
    DepthPipeline pipeline = make(scene);
    const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
    EXPECT_EQ(positive(view.low->ranges), 0U);
    const double bearing = sense * std::atan(kWall / 2.5);
    low = at(pipeline, view.low->ranges, bearing);
    return at(pipeline, view.scan->ranges, bearing);
  }
  float low = 0.0F;
};

TEST_P(AlongAWall, ItStandsWhereTheFloorEnds) {
  const double range = std::hypot(2.5, kWall);
  EXPECT_NEAR(look(Beyond::kNothing), range, 0.1);
  EXPECT_NEAR(low, -range, 0.1) << "it hides what is low behind it";
  EXPECT_EQ(look(Beyond::kFloor), kInfinity) << "a patch that mirrors: floor is seen behind it";
  EXPECT_EQ(look(Beyond::kNothing, false), kInfinity) << "nothing stands beside it";
  EXPECT_EQ(look(Beyond::kNothing, true, 0.3), kInfinity) << "not in line with what stands there";
  const float hand = look(Beyond::kNoFloorAtAll);
  EXPECT_FALSE(hand > 0.0F && hand < 2.0F) << "what hides the floor has no foot: " << hand;
}

INSTANTIATE_TEST_SUITE_P(OnBothSides, AlongAWall, testing::Values(1.0, -1.0));

TEST(DepthPipeline, SmallReflectionsBelowTheFloorAreNoDrops) {
  SyntheticScene scene;
  scene.half_width = scene.end = 30.0;
  DepthPipeline pipeline = make(scene);
  auto image = scene.draw(kPose);
  for (int row = 330; row < 342; ++row) {
    for (int column = 250; column < 270; ++column) image[pixel(row, column)] = 4200;
  }
  const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
  EXPECT_EQ(view.drops, 0);
  EXPECT_EQ(finite(view.scan->ranges), 0U);
}

TEST(DepthPipeline, ReflectionsOfVinylFarAwayAreNoDropsButHolesAre) {
  SyntheticScene scene;
  scene.half_width = scene.end = 30.0;
  DepthPipeline pipeline = make(scene);
  const auto with_hole = [&](double near, double far, double width) {
    auto image = scene.draw(kPose);
    for (int row = 0; row < scene.camera.height; ++row) {
      const double y = (row - scene.camera.cy) / scene.camera.fy;
      const double fall = std::sin(kPose.down) + y * std::cos(kPose.down);
      if (fall <= 0.0) continue;
      const double depth = kPose.height / fall;
      const double distance = depth * (std::cos(kPose.down) - y * std::sin(kPose.down));
      if (distance < near || distance > far) continue;
      const auto half = static_cast<int>(0.5 * width / depth * scene.camera.fx);
      for (int column = 256 - half; column < 256 + half; ++column) image[pixel(row, column)] = 5000;
    }
    return pipeline.process(view_of(scene.camera, image), kPose).value().drops;
  };
  EXPECT_EQ(with_hole(2.2, 2.9, 0.3), 0);
  EXPECT_GT(with_hole(2.2, 2.9, 0.6), 30);
  EXPECT_GT(with_hole(1.4, 1.85, 0.3), 30) << "steeper than vinyl mirrors";
}

TEST(DepthPipeline, SinglePixelsAndSingleColumnsAreNoise) {
  SyntheticScene scene;
  scene.half_width = scene.end = 30.0;
  auto image = scene.draw(kPose);
  Random random(5);
  for (int i = 0; i < 150; ++i) image[random.below(image.size())] = 1200;
  for (std::size_t row = 0; row < 424; ++row) image[512 * row + 100] = 1500;
  for (const bool opening : {false, true}) {
    PipelineConfig config = trusting();
    config.opening = opening;
    DepthPipeline pipeline = make(scene, config);
    const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
    EXPECT_EQ(finite(view.scan->ranges), 0U) << opening;
  }
}

TEST(DepthPipeline, ThinThingsAreFoundWhenTheFloorIsFitted) {
  SyntheticScene scene;
  scene.half_width = scene.end = 30.0;
  scene.noise = 0.0004;
  scene.dropouts = 0.02;
  scene.boxes = {{-1.25, 1.25, 0.010, 1.9, 1.96}};
  PipelineConfig config = trusting();
  config.refit = true;
  DepthPipeline pipeline = make(scene, config);
  int found = 0, bearings = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    CameraPose wrong = kPose;
    wrong.down += 0.004;
    wrong.height -= 0.004;
    const auto image = scene.draw(kPose, seed);
    const auto view = pipeline.process(view_of(scene.camera, image), wrong).value();
    ASSERT_TRUE(view.refitted);
    for (int step = -50; step <= 50; ++step, ++bearings) {
      const double bearing = 0.01 * step;
      const float range = at(pipeline, view.low->ranges, bearing);
      found += std::abs(range - 1.93 / std::cos(bearing)) < 0.08;
    }
  }
  EXPECT_GT(found, 8 * bearings / 10);

  SyntheticScene empty = scene;
  empty.boxes.clear();
  std::size_t false_ones = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto image = empty.draw(kPose, seed);
    false_ones +=
        finite(pipeline.process(view_of(scene.camera, image), kPose).value().scan->ranges);
  }
  EXPECT_EQ(false_ones, 0U);
}

TEST(DepthPipeline, AllInstructionSetsGiveTheSameBits) {
  Random random(9);
  for (const int width : {512, 640, 100}) {
    SyntheticScene scene = peer_scene();
    scene.camera.width = width;
    scene.camera.height = width == 512 ? 424 : 240;
    scene.camera.fx = scene.camera.fy = 0.7 * width;
    scene.camera.cx = 0.5 * width;
    scene.camera.cy = 0.5 * scene.camera.height;
    auto image = scene.draw(kPeerPose);
    for (int i = 0; i < 3000; ++i)
      image[random.below(image.size())] = static_cast<std::uint16_t>(random.next());
    CameraPose pose = kPeerPose;
    for (const double roll : {0.0, 0.03}) {
      for (const bool opening : {true, false}) {
        pose.roll = roll;
        PipelineConfig config = trusting();
        config.opening = opening;
        config.simd = cpu::Simd::kPortable;
        DepthPipeline reference = make(scene, config);
        const auto expected = reference.process(view_of(scene.camera, image), pose).value();
        for (const auto simd : {cpu::Simd::kSse41, cpu::Simd::kAvx2}) {
          if (simd > cpu::best_simd()) continue;
          config.simd = simd;
          DepthPipeline other = make(scene, config);
          const auto view = other.process(view_of(scene.camera, image), pose).value();
          EXPECT_TRUE(std::equal(expected.processed.begin(), expected.processed.end(),
                                 view.processed.begin()));
          EXPECT_EQ(expected.drops, view.drops);
          for (std::size_t i = 0; i < view.scan->ranges.size(); ++i) {
            const float a = expected.scan->ranges[i], b = view.scan->ranges[i];
            EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << width << " " << i;
          }
        }
      }
    }
  }
}

TEST(DepthPipeline, AnyImageGivesRangesOrNone) {
  SyntheticScene scene;
  DepthPipeline pipeline = make(scene, {});
  Random random(11);
  std::vector<std::uint16_t> image(kPixels);
  for (int round = 0; round < 12; ++round) {
    for (auto& v : image) v = static_cast<std::uint16_t>(random.next() >> (round % 3));
    const CameraPose pose{random.uniform(0.05, 3.0), random.uniform(-1, 1),
                          random.uniform(-1.2, 1.2), random.uniform(-0.5, 0.5)};
    const auto view = pipeline.process(view_of(scene.camera, image), pose);
    ASSERT_TRUE(view.ok());
    for (const DepthScan* scan : {view->scan, view->low}) {
      for (std::size_t i = 0; i < scan->ranges.size(); ++i) {
        const float range = scan->ranges[i];
        EXPECT_FALSE(range == 0.0F || range == -kInfinity || (range < 0.0F && scan == view->scan));
        EXPECT_GE(scan->intensities[i], 0.0F);
        EXPECT_LE(scan->intensities[i], 1.0F);
      }
    }
  }
}

TEST(DepthPipeline, NothingMeasuredIsNothingKnown) {
  SyntheticScene scene;
  for (const bool missing_is_drop : {true, false}) {
    PipelineConfig config;
    config.missing_is_drop = missing_is_drop;
    DepthPipeline pipeline = make(scene, config);
    for (const double roll : {0.0, 0.03}) {
      CameraPose pose = kPose;
      pose.roll = roll;
      for (const int covered : {0, 300}) {  // black, or nearer than is measured
        const std::vector<std::uint16_t> image(kPixels, static_cast<std::uint16_t>(covered));
        for (int frame = 0; frame < 4; ++frame) {
          const auto view = pipeline.process(view_of(scene.camera, image), pose).value();
          EXPECT_EQ(view.drops, 0);
          for (const float range : view.scan->ranges) EXPECT_TRUE(std::isnan(range));
          for (const float range : view.low->ranges) EXPECT_TRUE(std::isnan(range));
          for (const std::uint16_t v : view.processed) EXPECT_EQ(v, 0);
        }
      }
    }
  }
}

TEST(DepthPipeline, WhoCoversHalfTheImageIsNoDropAndTheOtherHalfIsSeen) {
  SyntheticScene scene;
  scene.boxes = {{-2.0, -0.3, 1.0, 1.8, 2.0}};
  DepthPipeline pipeline = make(scene);
  auto image = scene.draw(kPose);
  Random random(3);
  for (std::size_t row = 0; row < 424; ++row) {
    for (std::size_t column = 256; column < 512; ++column) {
      // One pixel in a hundred still measures something.
      if (random.uniform() > 0.01) image[512 * row + column] = 0;
    }
  }
  const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
  EXPECT_EQ(view.drops, 0);
  EXPECT_TRUE(std::isnan(at(pipeline, view.low->ranges, -0.3)));
  EXPECT_NEAR(at(pipeline, view.scan->ranges, 0.3), 1.8 / std::cos(0.3), 0.03);
}

TEST(DepthPipeline, FloorThatIsMissingRightBeforeTheRobotIsAnObstacle) {
  for (const double edge : {0.0, 1.35, 1.45}) {  // nearer than the image begins, and just beyond
    for (const double pit : {1.0, 20.0}) {       // a stairway, and one that measures nothing
      SyntheticScene scene;
      scene.half_width = scene.end = edge > 0.0 ? 30.0 : 5.0;  // a wall behind it, or nothing
      scene.edge = edge;
      scene.pit = pit;
      DepthPipeline pipeline = make(scene);
      const auto image = scene.draw(kPose);
      const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
      EXPECT_GT(view.drops, 450) << edge << " " << pit;
      // Where nothing is measured beyond, either, it may be somebody too near to be measured.
      const bool remembered = edge == 0.0 || pit == 1.0;
      for (const double bearing : {-0.3, 0.0, 0.3}) {
        EXPECT_LT(at(pipeline, view.scan->ranges, bearing), 1.7) << edge << " " << pit;
        EXPECT_EQ(at(pipeline, view.low->ranges, bearing) < 1.7, remembered) << edge << " " << pit;
      }
    }
  }
}

TEST(DepthPipeline, WhoIsTooNearToBeMeasuredStopsTheRobotAndIsNotRemembered) {
  SyntheticScene scene;
  DepthPipeline pipeline = make(scene);
  auto image = scene.draw(kPose);
  for (std::size_t row = 0; row < 400; ++row)  // floor between the feet is left
    std::fill_n(image.begin() + static_cast<std::ptrdiff_t>(512 * row + 200), 112, 0);
  const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
  EXPECT_GT(view.drops, 50);
  EXPECT_LT(at(pipeline, view.scan->ranges, 0.0), 1.7);
  EXPECT_FALSE(std::isfinite(at(pipeline, view.low->ranges, 0.0)));
}

TEST(DepthPipeline, FloorUnderAnArmThatIsTooNearToBeMeasuredIsNothingLow) {
  SyntheticScene scene;
  for (const std::size_t end : {330, 360, 390}) {
    DepthPipeline pipeline = make(scene);
    auto image = scene.draw(kPose);
    for (std::size_t row = 0; row < end; ++row)
      std::fill_n(image.begin() + static_cast<std::ptrdiff_t>(512 * row + 200), 90, 0);
    const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
    EXPECT_EQ(positive(view.low->ranges), 0U) << end;
    for (int step = -8; step <= 8; ++step) {
      EXPECT_TRUE(std::isnan(at(pipeline, view.low->ranges, 0.03 + 0.005 * step)))
          << "nor is it known to be free";
    }
  }
}

TEST(DepthPipeline, WhoIsTooNearToBeMeasuredBelowTheChestIsNoDrop) {
  SyntheticScene scene;
  DepthPipeline pipeline = make(scene);
  auto image = scene.draw(kPose);
  for (std::size_t row = 0; row < 400; ++row)
    std::fill_n(image.begin() + static_cast<std::ptrdiff_t>(512 * row + 200), 112,
                row < 212 ? 550 : 0);
  const auto view = pipeline.process(view_of(scene.camera, image), kPose).value();
  EXPECT_EQ(view.drops, 0);
  EXPECT_LT(at(pipeline, view.scan->ranges, 0.0), 0.9);
}

TEST(DepthPipeline, RefusesOtherImagesAndImpossiblePoses) {
  SyntheticScene scene;
  DepthPipeline pipeline = make(scene);
  const std::vector<std::uint16_t> image(kPixels, 1000);
  EXPECT_THAT(pipeline.process({640, 480, image}, kPose).error(), HasSubstr("512 x 424"));
  EXPECT_THAT(pipeline.process({512, 424, std::span(image).first(100)}, kPose).error(),
              HasSubstr("with 100 values"));
  CameraPose pose = kPose;
  pose.down = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(pipeline.process({512, 424, image}, pose).ok());
  pose = kPose;
  pose.height = -1.0;
  EXPECT_FALSE(pipeline.process({512, 424, image}, pose).ok());
  PipelineConfig config;
  config.max_range = 0.0;
  EXPECT_THAT(DepthPipeline::make(scene.camera, config).error(), HasSubstr("max_range"));
}

// Kinect v1 frames of a living room and rendered ones: the camera's pose is not in the data, so the
// floor is what a fit from a rough guess finds.
TEST(DepthPipeline, RealFramesGiveScansInsideTheirDepths) {
  const std::string folder = test_data("depth/slambook2_rgbd/depth_1.pgm");
  if (folder.empty()) GTEST_SKIP() << "no USHER_TEST_DATA/depth/slambook2_rgbd";
  const cv::Mat depth = cv::imread(folder, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(depth.type(), CV_16U);
  const Intrinsics camera{640, 480, 518.0, 519.0, 325.5, 253.5};
  PipelineConfig config = trusting();
  config.missing_is_drop = false;
  DepthPipeline pipeline = DepthPipeline::make(camera, config).value();
  const DepthImage image{640, 480, {depth.ptr<std::uint16_t>(), depth.total()}};
  const auto view = pipeline.process(image, {.height = 1.2, .forward = 0.2, .down = 0.0}).value();
  double nearest = 1e9;
  for (const std::uint16_t v : image.millimeters) {
    if (v >= 400) nearest = std::min(nearest, 1e-3 * v);
  }
  EXPECT_GT(finite(view.scan->ranges), 200U);
  for (const float range : view.scan->ranges) EXPECT_FALSE(range < 0.8 * nearest);
}

}  // namespace
}  // namespace usher::depth_pipeline
