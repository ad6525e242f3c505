#include "perception/face_detector/core/face_detector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "drawn_scene.hpp"
#include "perception/face_detector/core/cascade.hpp"
#include "support/folder.hpp"

namespace usher::face_detector {
namespace {

using testing::HasSubstr;

FaceDetector detector(const std::string& cascade = "alt", const FaceDetectorConfig& config = {}) {
  return FaceDetector::make(cascade_file(cascade, ""), config).value();
}

TEST(Cascade, EachOneOfDebianIsRead) {
  for (const std::string& name : cascade_names()) {
    const auto cascade = Cascade::load(cascade_file(name, ""));
    ASSERT_TRUE(cascade.ok()) << cascade.error();
    EXPECT_GE(cascade->window(), 20) << name;
  }
}

TEST(Cascade, ThatIsNoneIsRefusedWithItsName) {
  const test::Folder folder;
  EXPECT_THAT(Cascade::load(folder.path() + "/none.xml").error(), HasSubstr("none.xml"));
  EXPECT_THAT(Cascade::load(folder.path() + "/none.xml").error(), HasSubstr("opencv-data"));
  for (const char* text :
       {"", "<a/>", "no xml", "<?xml version=\"1.0\"?><opencv_storage><cascade/>"})
    EXPECT_FALSE(Cascade::load(folder.file("bad.xml", text)).ok()) << text;
  const std::string whole = test::content_of(cascade_file("alt", ""));
  EXPECT_FALSE(Cascade::load(folder.file("cut.xml", whole.substr(0, whole.size() / 2))).ok());
}

TEST(FaceDetector, FindsADrawnFaceWhereTheDepthSaysThatItIsOne) {
  auto faces = detector();
  for (const double size : {30.0, 60.0, 110.0}) {
    DrawnScene scene(4000);
    const double depth = SizeModel().depth(size);
    scene.add_face(320, 240, size, static_cast<std::uint16_t>(1000 * depth));
    const auto found = faces.find(scene.color(), scene.depth());
    ASSERT_TRUE(found.ok()) << found.error();
    ASSERT_EQ(found->size(), 1U) << size;
    const Face& face = found->front();
    EXPECT_NEAR(face.depth, depth, 0.002);
    EXPECT_NEAR(face.box.column(), 320, 0.15 * size);
    EXPECT_NEAR(face.box.row(), 240, 0.25 * size);
    EXPECT_GE(face.neighbors, 3);
  }
}

TEST(FaceDetector, TakesNoFaceForOneWhoseSizeDoesNotFitItsDepth) {
  auto faces = detector();
  for (const std::uint16_t depth :
       std::initializer_list<std::uint16_t>{900, 3000, 3600}) {  // of one that would be 1.53 m away
    DrawnScene scene;
    scene.add_face(320, 240, 60.0, depth);
    EXPECT_EQ(faces.find_anywhere(scene.color()).size(), 1U);
    EXPECT_TRUE(faces.find(scene.color(), scene.depth())->empty()) << depth;
    EXPECT_TRUE(faces.find_as_printed(scene.color(), scene.depth())->empty()) << depth;
  }
}

TEST(FaceDetector, FindsWhatTheWholeImageSearchFindsAndLooksAtLess) {
  auto faces = detector();
  Random random(11);
  int printed = 0, same = 0;
  double searched = 0.0;
  constexpr int kScenes = 12;
  for (int i = 0; i < kScenes; ++i) {
    DrawnScene scene(2800);
    for (int k = 0; k < 4; ++k) {
      const double size = random.uniform(36, 90);
      const bool fits = random.below(4) > 0;
      const double depth =
          1000 * SizeModel().depth(size) * (fits ? random.uniform(0.95, 1.05) : 0.7);
      scene.add_face(90 + 150 * k, static_cast<int>(random.uniform(80, 400)), size,
                     static_cast<std::uint16_t>(depth), random.next());
    }
    const auto as_printed = faces.find_as_printed(scene.color(), scene.depth());
    const std::vector<Face> expected(as_printed->begin(), as_printed->end());
    const auto found = faces.find(scene.color(), scene.depth());
    searched += faces.searched() / kScenes;
    printed += static_cast<int>(expected.size());
    for (const Face& one : expected) {
      same += std::any_of(found->begin(), found->end(), [&](const Face& other) {
        return std::abs(one.box.column() - other.box.column()) < 0.2 * one.box.width &&
               std::abs(one.box.width - other.box.width) < 0.2 * one.box.width;
      });
    }
  }
  EXPECT_GE(printed, 2 * kScenes);
  EXPECT_EQ(same, printed);
  EXPECT_LT(searched, 0.3);
}

TEST(FaceDetector, TellsTheNearestFirstAndTheSameEachTime) {
  auto one = detector(), other = detector();
  DrawnScene scene;
  scene.add_face(150, 240, 40, 2300, 3);
  scene.add_face(450, 200, 70, 1314, 4);
  const auto first = one.find(scene.color(), scene.depth());
  const auto second = other.find(scene.color(), scene.depth());
  ASSERT_EQ(first->size(), 2U);
  EXPECT_LT((*first)[0].depth, (*first)[1].depth);
  ASSERT_EQ(second->size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*first)[i].box.left, (*second)[i].box.left);
    EXPECT_EQ((*first)[i].box.width, (*second)[i].box.width);
    EXPECT_EQ((*first)[i].neighbors, (*second)[i].neighbors);
  }
}

TEST(FaceDetector, TakesNoPictureOnAWallForAFace) {
  auto faces = detector();
  DrawnScene scene(1533);
  scene.add_face(320, 240, 60.0, 1533);
  EXPECT_EQ(faces.find_as_printed(scene.color(), scene.depth())->size(), 1U);
  EXPECT_TRUE(faces.find(scene.color(), scene.depth())->empty());
  FaceDetectorConfig config;
  config.rules.relief = 0.0;
  EXPECT_EQ(detector("alt", config).find(scene.color(), scene.depth())->size(), 1U);
}

TEST(FaceDetector, TakesNoPictureThatAShoulderHalfHidesForAFace) {
  DrawnScene scene;
  scene.add_face(320, 240, 60.0, 1533);
  for (std::size_t row = 180; row < 300; ++row) {
    for (std::size_t column = 260; column < 320; ++column)
      scene.millimeters()[row * DrawnScene::kWidth + column] = 4500;
  }
  EXPECT_TRUE(detector().find(scene.color(), scene.depth())->empty());
  FaceDetectorConfig config;
  config.rules.whole = 0.0;
  EXPECT_EQ(detector("alt", config).find(scene.color(), scene.depth())->size(), 1U);
}

TEST(FaceDetector, WithoutDepthThereIsNoFace) {
  auto faces = detector();
  DrawnScene scene(0);
  scene.add_face(320, 240, 60, 0);
  EXPECT_TRUE(faces.find(scene.color(), scene.depth())->empty());
  EXPECT_EQ(faces.searched(), 0.0);
}

TEST(FaceDetector, RefusesImagesThatAreNoPair) {
  auto faces = detector();
  DrawnScene scene;
  const auto color = scene.color();
  const auto depth = scene.depth();
  EXPECT_THAT(faces.find(color, {320, 480, depth.millimeters}).error(), HasSubstr("320 x 480"));
  EXPECT_FALSE(faces.find({640, 480, color.rgb.first(99)}, depth).ok());
  EXPECT_FALSE(faces.find({}, {}).ok());
  EXPECT_FALSE(faces.find(color, {640, 480, depth.millimeters.first(7)}).ok());
}

TEST(FaceDetector, SurvivesAnyImage) {
  auto faces = detector("lbp");
  Random random(3);
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 300}, {33, 33}, {160, 120}}) {
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::vector<std::uint8_t> rgb(3 * pixels);
    std::vector<std::uint16_t> depth(pixels);
    for (auto& value : rgb) value = static_cast<std::uint8_t>(random.next());
    for (auto& value : depth) value = static_cast<std::uint16_t>(random.next());
    EXPECT_TRUE(faces.find({width, height, rgb}, {width, height, depth}).ok());
  }
}

TEST(FaceDetector, RefusesValuesThatCannotBe) {
  const auto refused = [](const FaceDetectorConfig& config) {
    auto made = FaceDetector::make(cascade_file("alt", ""), config);
    return made.ok() ? "" : made.error();
  };
  EXPECT_EQ(refused({}), "");
  FaceDetectorConfig config;
  config.model.side.b = -0.01;
  EXPECT_THAT(refused(config), HasSubstr("positive"));
  config = {};
  config.rules.far = config.rules.near;
  EXPECT_THAT(refused(config), HasSubstr("distances"));
  config = {};
  config.step = 1.0;
  EXPECT_THAT(refused(config), HasSubstr("step"));
  config.step = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refused(config), HasSubstr("step"));
}

}  // namespace
}  // namespace usher::face_detector
