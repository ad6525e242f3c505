#include "sensing/depth_pipeline/core/thesis_method.hpp"

#include <gtest/gtest.h>

#include "sensing/depth_pipeline/test/synthetic.hpp"

namespace usher::depth_pipeline {
namespace {

TEST(ThesisMethod, RemovesFloorAndKeepsTheBox) {
  SyntheticScene scene;
  scene.boxes = {{-0.3, 0.3, 0.6, 2.0, 2.4}};
  const CameraPose pose{.height = 0.9, .forward = 0.2, .down = 0.09};
  const auto depth = scene.draw(pose);
  ThesisMethod thesis({});
  thesis.process(ThesisMethod::narrow(view_of(scene.camera, depth), 12.0), pose);
  const double ahead = thesis.scan().ranges[256];
  EXPECT_NEAR(ahead, 2.0, 0.06);  // one value is 47 mm
  int floor = 0;
  for (int row = 330; row < 424; ++row)
    floor += thesis.processed().at<std::uint8_t>(row, 100) < 255;
  EXPECT_EQ(floor, 0);
}

TEST(ThesisMethod, CeilingIsCutWhereTheRobotEnds) {
  const CameraPose pose{.height = 0.9, .forward = 0.2, .down = -0.15};
  ThesisMethod thesis({});
  thesis.process(cv::Mat(424, 512, CV_8U, cv::Scalar(100)), pose);
  const double depth = thesis.ceiling()[0] / 255.0 * 12.0;
  const double rise = std::sin(0.15) + std::tan(0.5 * 1.0471975511965976) * std::cos(0.15);
  EXPECT_NEAR(depth, 1.1 / rise, 0.01);
}

}  // namespace
}  // namespace usher::depth_pipeline
