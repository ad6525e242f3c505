#include "operations/face_study/calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "operations/face_study/stage.hpp"
#include "support/folder.hpp"

namespace usher::face_study {
namespace {

using testing::HasSubstr;

face_detector::FaceDetector anywhere() {
  return face_detector::FaceDetector::make(face_detector::cascade_file("lbp", ""), {}).value();
}

/// Somebody steps back, in the middle of the image and at a side, as libfreenect would record it.
void record(const test::Folder& folder, double from, double to, int images) {
  Stage stage = Stage::make(0, 1).value();
  std::string index;
  for (int i = 0; i < images; ++i) {
    const double ahead = from + (to - from) * i / (images - 1);
    const double left = ahead * (i % 2 == 0 ? 0.0 : 0.33);
    const auto& shot = stage.shoot({standing(ahead, left, 1.6)});
    const std::string name = "-" + std::to_string(1 + i) + ".000000-" + std::to_string(i);
    std::string depth = "P5 640 480 65535\n", color = "P6 640 480 255\n";
    for (const std::uint16_t value : shot.millimeters) {
      depth += static_cast<char>(value & 0xff);
      depth += static_cast<char>(value >> 8);
    }
    color.append(shot.rgb.begin(), shot.rgb.end());
    folder.file("d" + name + ".pgm", depth);
    folder.file("r" + name + ".ppm", color);
    index += "d" + name + ".pgm\nr" + name + ".ppm\n";
  }
  folder.file("INDEX.txt", index);
}

TEST(FaceCalibration, FindsTheModelsInARecording) {
  const test::Folder folder;
  record(folder, 1.0, 3.4, 80);
  const auto recording = kinect::Recording::open(folder.path(), kinect::Values::kMillimeters);
  ASSERT_TRUE(recording.ok()) << recording.error();
  auto detector = anywhere();
  FaceSamples samples;
  const auto status = add_samples(*recording, detector, samples, [](std::size_t) {});
  ASSERT_TRUE(status.ok()) << status.error();
  EXPECT_EQ(samples.images, 80);
  const auto found = fit_models(samples);
  ASSERT_TRUE(found.ok()) << found.error();
  EXPECT_LT(found->center.residual, 0.06);
  EXPECT_LT(found->side.residual, 0.06);
  EXPECT_THAT(as_yaml(*found), HasSubstr("center_model: ["));
}

TEST(FaceCalibration, RefusesBadDataWithTheReason) {
  const test::Folder folder;
  record(folder, 1.5, 1.8, 10);
  const auto recording = kinect::Recording::open(folder.path(), kinect::Values::kMillimeters);
  auto detector = anywhere();
  FaceSamples samples;
  ASSERT_TRUE(add_samples(*recording, detector, samples, [](std::size_t) {}).ok());
  EXPECT_THAT(fit_models(samples).error(), HasSubstr("in the middle of the image: expected"));
  folder.file("r-3.000000-2.ppm", "P6 640 480 255\nshort");
  EXPECT_THAT(add_samples(*recording, detector, samples, [](std::size_t) {}).error(),
              HasSubstr("r-3.000000-2.ppm: the PPM image ends early"));
  folder.file("INDEX.txt", "d-1.000000-0.pgm\n");
  const auto gray = kinect::Recording::open(folder.path(), kinect::Values::kMillimeters);
  EXPECT_THAT(add_samples(*gray, detector, samples, [](std::size_t) {}).error(),
              HasSubstr("no color image"));
}

}  // namespace
}  // namespace usher::face_study
