// Whom the people detector finds in rendered images of the office, and whom the model says that it
// would find there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "perception/people_detector/core/depth_detector.hpp"
#include "sensing/depth_pipeline/core/depth_pipeline.hpp"
#include "simulation/world/core/people_model.hpp"

namespace usher::world {
namespace {

using depth_pipeline::DepthPipeline;
using geometry::radians;
using people_detector::DepthDetector;

constexpr const char* kOffice = USHER_SOURCE_DIR "/config/sites/office/world.yaml";
constexpr double kSame = 0.5;   // [m]
constexpr double kReach = 6.0;  // [m]
constexpr int kPlaces = 60;
constexpr int kImages = 4;  // at each

/// Counts of one way to find people.
struct Found {
  int people = 0, found = 0, false_alarms = 0;
  double along = 0.0, along_squares = 0.0, across_squares = 0.0;
  double recall() const { return static_cast<double>(found) / people; }
  double bias() const { return along / found; }
  double along_sigma() const { return std::sqrt(along_squares / found - bias() * bias()); }
  double across_sigma() const { return std::sqrt(across_squares / found); }

  /// True positions against findings, both from the camera's place.
  void take(const std::vector<Point2>& truths, const std::vector<Point2>& others,
            std::vector<Point2> findings, std::vector<bool>& who) {
    who.assign(truths.size(), false);
    for (std::size_t i = 0; i < truths.size(); ++i) {
      std::size_t best = findings.size();
      double nearest = kSame;
      for (std::size_t k = 0; k < findings.size(); ++k) {
        const double away = (findings[k] - truths[i]).norm();
        if (away < nearest) nearest = away, best = k;
      }
      if (best == findings.size()) continue;
      const Point2 sight = truths[i].normalized();
      const Point2 off = findings[best] - truths[i];
      const double away = off.dot(sight), aside = off.dot(Point2(-sight.y(), sight.x()));
      along += away, along_squares += away * away, across_squares += aside * aside;
      who[i] = true;
      ++found;
      findings.erase(findings.begin() + static_cast<std::ptrdiff_t>(best));
    }
    std::erase_if(findings, [&](const Point2& finding) {
      return std::any_of(others.begin(), others.end(),
                         [&](const Point2& other) { return (other - finding).norm() < kSame; });
    });
    false_alarms += static_cast<int>(findings.size());
  }
};

/// A robot somewhere in the office, people around it.
std::optional<World> somewhere(Random& random, const Building& building, bool behind) {
  const std::vector<Pose2> places{{3.0, 5.0, 0.2},   {12.0, 10.0, 0.0}, {26.0, 4.5, 0.5},
                                  {27.9, 14.0, 1.6}, {14.0, 14.0, 2.0}, {20.0, 7.0, -0.7}};
  Pose2 robot = places[random.below(places.size())];
  robot.yaw += random.uniform(-0.7, 0.7);
  std::vector<PersonPlan> people;
  const auto count = 1 + random.below(4);
  for (std::uint64_t i = 0; i < count; ++i) {
    const double forward = random.uniform(0.8, 6.0);
    const Pose2 looking = behind ? robot * Pose2{0.0, 0.0, geometry::kPi} : robot;
    const Point2 place = looking * Point2(forward, random.uniform(-0.7, 0.7) * forward);
    PersonPlan plan{.name = std::string(1, static_cast<char>('a' + i)),
                    .start = place,
                    .yaw = random.uniform(-3.1, 3.1)};
    plan.height = random.uniform(1.5, 1.95);
    people.push_back(plan);
  }
  World world({}, building, people, robot, random.next());
  for (const Person& person : world.people()) {
    if (world.scene().nearest(person.position, 1.7, 0.3).distance < 0.25) return std::nullopt;
  }
  return world;
}

TEST(PeopleModel, AgreesWithTheRenderedChain) {
  const auto building = load_building(kOffice).value();
  for (const bool backward : {false, true}) {
    DepthCameraConfig config;
    if (backward) {
      config.sensor = rendering::rear_camera();
      config.mount = {.x = -0.2, .z = 0.9, .yaw = geometry::kPi, .pitch = radians(15.0)};
    }
    const auto& lens = config.sensor.lens;
    const imaging::Intrinsics intrinsics{lens.width, lens.height, lens.fx,
                                         lens.fy,    lens.cx,     lens.cy};
    auto pipeline = DepthPipeline::make(intrinsics, {.origin = 0.2}).value();
    auto detector = DepthDetector::make(intrinsics, {}).value();
    Random random(7);
    Found pixels, modelled;
    int images = 0, same = 0, either = 0;
    for (int place = 0; place < kPlaces;) {
      auto world = somewhere(random, building, backward);
      if (!world) continue;
      ++place;
      DepthCamera camera(config, random.next());
      WorldRenderer renderer;
      PeopleModelConfig model_config;
      model_config.lens = lens;
      PeopleModel model(model_config, random.next());
      camera.set_tilt(backward ? 0.0 : radians(-5.0));
      std::vector<std::uint16_t> millimeters;
      std::vector<ModelledSighting> sightings;
      for (int step = 0; step < 30 + 7 * kImages; ++step) {
        world->step();
        camera.step(world->base().truth());
        if (step < 30 || step % 7 != 0) continue;
        ++images;
        ASSERT_TRUE(renderer.update(*world));
        camera.measure(*world, renderer.renderer(), millimeters);
        depth_pipeline::Mount mount{.x = config.mount.x, .z = config.mount.z, .backward = backward};
        const auto pose = depth_pipeline::camera_pose(
            mount, backward ? radians(-15.0) : camera.tilt(), world->base().truth().pitch);
        const auto view = pipeline.process({lens.width, lens.height, millimeters}, pose).value();
        const auto found =
            detector.find({lens.width, lens.height, view.processed}, {pose.height, pose.down, 0.0})
                .value();
        model.find(*world, camera, sightings);
        const Pose2 base = world->base().truth().pose;
        const Pose2 origin = Pose2{base.x, base.y, backward ? base.yaw + geometry::kPi : base.yaw} *
                             Pose2{0.2, 0.0, 0.0};
        std::vector<Point2> truths, others, seen, said;
        for (const Person& person : world->people()) {
          const Point2 where = inverse(origin) * person.position;
          const bool inside =
              where.x() > 0.8 && where.x() < kReach && std::abs(where.y()) < 0.62 * where.x();
          (inside ? truths : others).push_back(where);
        }
        for (const auto& one : found) seen.emplace_back(one.forward + pose.forward - 0.2, one.left);
        for (const auto& one : sightings) said.emplace_back(one.forward, one.left);
        std::vector<bool> by_pixels, by_model;
        pixels.people += static_cast<int>(truths.size());
        modelled.people += static_cast<int>(truths.size());
        pixels.take(truths, others, seen, by_pixels);
        modelled.take(truths, others, said, by_model);
        for (std::size_t i = 0; i < truths.size(); ++i) {
          either += by_pixels[i] || by_model[i];
          same += by_pixels[i] && by_model[i];
        }
      }
    }
    for (const Found* one : {&pixels, &modelled})
      std::printf(
          "%s %s: %d people, recall %.3f, %d false in %d images, along %.3f +- %.3f, across %.3f "
          "m\n",
          backward ? "rear" : "front", one == &pixels ? "pixels" : "model", one->people,
          one->recall(), one->false_alarms, images, one->bias(), one->along_sigma(),
          one->across_sigma());
    std::printf("same %d of %d\n", same, either);
    EXPECT_NEAR(modelled.recall(), pixels.recall(), 0.05);
    EXPECT_GT(same, 85 * either / 100);
    EXPECT_NEAR(modelled.bias(), pixels.bias(), 0.05);
    EXPECT_NEAR(modelled.along_sigma(), pixels.along_sigma(), 0.04);
    EXPECT_NEAR(modelled.across_sigma(), pixels.across_sigma(), 0.03);
  }
}

}  // namespace
}  // namespace usher::world
