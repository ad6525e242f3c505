#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "operations/face_study/annotated.hpp"
#include "support/data.hpp"
#include "support/folder.hpp"

namespace usher::face_study {
namespace {

TEST(Portraits, OfPhotographsHaveTheirEyesWhereDrawnFacesHaveThem) {
  USHER_REQUIRE_DATA(folder, "faces");
  const auto portraits = read_portraits(folder, 60.0);
  ASSERT_TRUE(portraits.ok()) << portraits.error();
  ASSERT_GE(portraits->size(), 8U);
  auto detector = face_detector::FaceDetector::make(face_detector::cascade_file("alt", ""), {});
  ASSERT_TRUE(detector.ok());
  int found = 0;
  for (const cv::Mat& portrait : *portraits) {
    ASSERT_EQ(portrait.size(), cv::Size(128, 128));
    for (const auto& hit :
         detector->find_anywhere({128, 128, {portrait.data, 3 * portrait.total()}})) {
      EXPECT_NEAR(hit.box.column(), 64.0, 12.0);
      EXPECT_NEAR(hit.box.row(), 64.0, 20.0);
      ++found;
    }
  }
  EXPECT_GE(found, static_cast<int>(portraits->size()) - 2);
  EXPECT_FALSE(read_portraits(folder, 1000.0).ok()) << "none is that large";
}

TEST(Portraits, AreExposedByTheFace) {
  USHER_REQUIRE_DATA(folder, "faces");
  const auto portraits = read_portraits(folder, 60.0);
  ASSERT_TRUE(portraits.ok()) << portraits.error();
  for (const cv::Mat& portrait : *portraits) {
    cv::Mat gray;
    cv::cvtColor(portrait(cv::Rect(32, 32, 64, 80)), gray, cv::COLOR_RGB2GRAY);
    EXPECT_NEAR(cv::mean(gray)[0], 135.0, 10.0);
  }
}

TEST(Portraits, SayWhichFileIsMissing) {
  const test::Folder empty;
  EXPECT_THAT(read_portraits(empty.path(), 60.0).error(),
              testing::HasSubstr("training_with_face_landmarks.xml"));
}

}  // namespace
}  // namespace usher::face_study
