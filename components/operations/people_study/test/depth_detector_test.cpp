#include "perception/people_detector/core/depth_detector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "operations/people_study/scoring.hpp"
#include "perception/people_detector/core/camera_view.hpp"
#include "support/counted_new.hpp"

namespace usher::people_detector {
namespace {

using people_study::Score;
using people_study::Studio;

DepthDetector detector_for(const imaging::Intrinsics& intrinsics) {
  return DepthDetector::make(intrinsics, {}).value();
}

TEST(DepthDetector, RefusesOtherImagesAndImpossibleViews) {
  DepthDetector detector = detector_for({});
  const std::vector<std::uint16_t> small(100);
  EXPECT_NE(detector.find({10, 10, small}, {}).error().find("expected an image of 512 x 424"),
            std::string::npos);
  const std::vector<std::uint16_t> image(std::size_t{512} * 424);
  EXPECT_FALSE(detector.find({512, 424, image}, {.height = -1.0}));
  EXPECT_FALSE(
      detector.find({512, 424, image}, {.down = std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_TRUE(detector.find({512, 424, image}, {}).value().empty());
  EXPECT_FALSE(DepthDetector::make({.width = 5}, {}));
  EXPECT_NE(DepthDetector::make({}, {.threshold = 99.0}).error().find("threshold must be in"),
            std::string::npos);
}

TEST(DepthDetector, SurvivesAnyImage) {
  DepthDetector detector = detector_for({});
  Random random(5);
  std::vector<std::uint16_t> image(std::size_t{512} * 424);
  for (int i = 0; i < 10; ++i) {
    for (std::uint16_t& pixel : image) pixel = static_cast<std::uint16_t>(random.next());
    const View view{random.uniform(0.05, 3.0), random.uniform(-1.2, 1.2), random.uniform(-1, 1)};
    const auto found = detector.find({512, 424, image}, view);
    ASSERT_TRUE(found);
    for (const Sighting& one : *found) {
      EXPECT_TRUE(std::isfinite(one.forward) && std::isfinite(one.left));
      EXPECT_GE(one.height, 0.0);
    }
  }
}

TEST(DepthDetector, AllocatesNothingFromImageToTrackInTheLongRun) {
  Studio studio;
  DepthDetector detector = detector_for(studio.intrinsics());
  Tracker tracker({});
  std::vector<Observation> observations;
  const auto scenes = people_study::thesis_scenes();
  const auto group = std::find_if(scenes.begin(), scenes.end(),
                                  [](const auto& scene) { return scene.bodies.size() == 3; });
  const auto shot = studio.take(*group, 3).value();
  double time = 1.0;
  const auto look = [&] {
    const auto found = detector.find(shot.processed, shot.view);
    place_sightings(*found, {1.0, 2.0, 0.3}, {}, observations);
    tracker.update(time += 0.066, Source::kKinect, observations);
  };
  for (int i = 0; i < 30; ++i) look();
  ASSERT_EQ(tracker.people().size(), 3U);
  const std::uint64_t before = test::allocation_count();
  for (int i = 0; i < 30; ++i) look();
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(Windows, MirrorsLeftAndRightOfACellAndKeepsWhatIsNoCell) {
  Windows::Inputs inputs{}, mirrored{}, again{};
  for (std::size_t i = 0; i < inputs.size(); ++i) inputs[i] = static_cast<std::int16_t>(i);
  Windows::mirror(inputs, mirrored);
  constexpr int kLast = Windows::kChannels * (Windows::kAcross - 1);
  EXPECT_EQ(mirrored[1], inputs[kLast + 1]);
  EXPECT_EQ(mirrored.back(), inputs.back());
  Windows::mirror(mirrored, again);
  EXPECT_EQ(again, inputs);
}

Score score_of(const std::vector<people_study::Scene>& scenes) {
  Studio studio;
  DepthDetector detector = detector_for(studio.intrinsics());
  Score total;
  for (const auto& scene : scenes) {
    const auto shot = studio.take(scene, 3).value();
    const Score one = judge(detector.find(shot.processed, shot.view).value(), shot.truths);
    if (one.missed + one.false_alarms > 0)
      std::printf("%s: %d missed, %d false\n", scene.name.c_str(), one.missed, one.false_alarms);
    total += one;
  }
  std::printf("recall %.4f, precision %.4f, error %.3f m of %d people\n", total.recall(),
              total.precision(), total.error / std::max(1, total.found),
              total.found + total.missed);
  return total;
}

TEST(DepthDetector, HeightOfWhoseHeadLeavesTheImageIsNotKnown) {
  Studio studio;
  DepthDetector detector = detector_for(studio.intrinsics());
  const auto height_at = [&](const char* name) {
    const auto scenes = people_study::thesis_scenes();
    const auto scene = std::find_if(scenes.begin(), scenes.end(),
                                    [&](const auto& each) { return each.name == name; });
    const auto shot = studio.take(*scene, 3).value();
    const auto found = detector.find(shot.processed, shot.view).value();
    return found.empty() ? -1.0 : found.front().height;
  };
  EXPECT_NEAR(height_at("at 300 cm, camera 5 deg down"), 1.7, 0.1);
  EXPECT_EQ(height_at("at 100 cm, camera 5 deg down"), 0.0);
}

TEST(DepthDetector, SaysWhoseHeadSomebodyNearerHides) {
  Studio studio;
  DepthDetector detector = detector_for(studio.intrinsics());
  const auto farther_one = [&](double left) {
    people_study::Scene scene = people_study::thesis_scenes().front();
    scene.bodies.resize(1);
    rendering::Body& nearer = scene.bodies.front();
    nearer.pose = {2.0, 0.0, geometry::kPi};
    scene.bodies.push_back(nearer);
    scene.bodies.back().pose = {4.0, left, geometry::kPi};
    const auto shot = studio.take(scene, 3).value();
    const auto found = detector.find(shot.processed, shot.view).value();
    EXPECT_EQ(found.size(), 2U) << left;
    EXPECT_FALSE(found.front().head_hidden) << left;
    return found.back();
  };
  const Sighting beside = farther_one(0.9), behind = farther_one(0.45);
  EXPECT_FALSE(beside.head_hidden);
  EXPECT_NEAR(beside.height, 1.7, 0.1);
  EXPECT_TRUE(behind.head_hidden);
  EXPECT_LT(behind.height, 1.65);
}

TEST(DepthDetector, FindsThePeopleOfTheThesisAndNoneOfItsThings) {
  const Score score = score_of(people_study::thesis_scenes());
  EXPECT_GE(score.recall(), 0.98);
  EXPECT_GE(score.precision(), 0.98);
}

TEST(DepthDetector, FindsWhoSitsInAWheelchairOrIsPartlyOutOfTheImage) {
  Studio studio;
  DepthDetector detector = detector_for(studio.intrinsics());
  int scenes = 0;
  for (const auto& scene : people_study::thesis_scenes()) {
    if (scene.name.find("wheelchair") == std::string::npos &&
        scene.name.find(" m away, ") == std::string::npos)
      continue;
    ++scenes;
    const auto shot = studio.take(scene, 3).value();
    const auto found = detector.find(shot.processed, shot.view).value();
    ASSERT_EQ(found.size(), 1U) << scene.name;
    const auto& body = scene.bodies.front().pose;
    EXPECT_LT(std::hypot(found[0].forward - body.x, found[0].left - body.y), 0.25) << scene.name;
  }
  EXPECT_EQ(scenes, 8 + 18);
}

TEST(DepthDetector, FindsPeopleInAnyRoom) {
  std::vector<people_study::Scene> scenes;
  for (std::uint64_t seed = 1; seed <= 60; ++seed)
    scenes.push_back(people_study::random_scene(seed));
  const Score score = score_of(scenes);
  EXPECT_GE(score.recall(), 0.96);
  EXPECT_GE(score.precision(), 0.96);
  EXPECT_LE(score.error / score.found, 0.08);
}

}  // namespace
}  // namespace usher::people_detector
