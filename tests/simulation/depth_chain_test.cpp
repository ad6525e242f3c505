// The simulated depth cameras with the depth pipeline behind them: rendered pixels, the model that
// is fitted to them, calibration.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "operations/experiments/depth_stage.hpp"
#include "operations/experiments/scan_judgement.hpp"
#include "sensing/depth_pipeline/core/calibration.hpp"
#include "sensing/depth_pipeline/core/depth_pipeline.hpp"
#include "simulation/world/core/depth_scan_model.hpp"

namespace usher::world {
namespace {

using depth_pipeline::DepthPipeline;
using geometry::radians;

constexpr const char* kOffice = USHER_SOURCE_DIR "/config/sites/office/world.yaml";

/// A Kinect in a world, with the pipeline that knows where it is.
class Chain {
 public:
  Chain(World& world, std::uint64_t seed, const depth_pipeline::PipelineConfig& config,
        const DepthCameraConfig& camera = {})
      : world_(world),
        camera_(camera, seed),
        pipeline_(
            DepthPipeline::make(rendering::intrinsics_of(camera.sensor.lens), config).value()) {
    camera_.set_tilt(radians(-5.0));
    for (int i = 0; i < 50; ++i) camera_.step(world.base().truth());
  }

  void step() {
    world_.step();
    camera_.step(world_.base().truth());
  }
  depth_pipeline::DepthImage image() {
    EXPECT_TRUE(renderer_.update(world_).ok());
    camera_.measure(camera_.exposure(world_), renderer_.renderer(), millimeters_);
    const auto& lens = camera_.config().sensor.lens;
    return {lens.width, lens.height, millimeters_};
  }
  depth_pipeline::DepthView see(double pitch) {
    const auto pose = depth_pipeline::camera_pose({}, camera_.tilt(), pitch);
    return pipeline_.process(image(), pose).value();
  }
  DepthCamera& camera() { return camera_; }
  const DepthPipeline& pipeline() const { return pipeline_; }

 private:
  World& world_;
  DepthCamera camera_;
  WorldRenderer renderer_;
  DepthPipeline pipeline_;
  std::vector<std::uint16_t> millimeters_;
};

TEST(DepthScanModel, AgreesWithTheRenderedChain) {
  const auto building = load_building(kOffice).value();
  const std::vector<PersonPlan> people{{.name = "a", .start = {5.5, 5.0}, .yaw = 3.0},
                                       {.name = "b", .start = {6.5, 6.2}, .yaw = 1.0}};
  Random random(2);
  int same = 0, both = 0, model_only = 0, pixels_only = 0, bearings = 0;
  int all = 0, model_unknown = 0, pixels_unknown = 0;
  double worst_bias = 0.0;
  const std::vector<Pose2> places{{3.0, 5.0, 0.2},   {12.0, 10.0, 0.0}, {26.0, 4.5, 0.5},
                                  {27.9, 14.0, 1.6}, {14.0, 14.0, 2.0}, {20.0, 7.0, -0.7}};
  for (const Pose2& place : places) {
    World world({}, building, people, place, 7);
    depth_pipeline::PipelineConfig config;
    config.confidence_frames = 1;
    Chain chain(world, 3, config);
    DepthScanModel model({}, 5);
    DepthScanResult result;
    double bias = 0.0;
    int counted = 0;
    for (int i = 0; i < 4; ++i) {
      for (int k = 0; k < 5; ++k) chain.step();
      const auto view = chain.see(world.base().truth().pitch);
      model.scan(world, chain.camera(), result);
      ASSERT_EQ(result.ranges.size(), view.scan->ranges.size());
      EXPECT_NEAR(result.angle_min, chain.pipeline().geometry().angle_min, 1e-9);
      for (std::size_t b = 30; b + 30 < result.ranges.size(); ++b) {
        const float modelled = result.ranges[b], rendered = view.scan->ranges[b];
        ++all;
        model_unknown += std::isnan(modelled);
        pixels_unknown += std::isnan(rendered);
        if (std::isnan(modelled) || std::isnan(rendered)) continue;
        ++bearings;
        const bool a = std::isfinite(modelled), c = std::isfinite(rendered);
        model_only += a && !c;
        pixels_only += c && !a;
        if (!a && !c) ++same;
        if (!a || !c) continue;
        ++both;
        const double off = static_cast<double>(modelled - rendered);
        same += std::abs(off) < 0.12;
        if (std::abs(off) < 0.12) bias += off, ++counted;
      }
    }
    if (counted > 0) worst_bias = std::max(worst_bias, std::abs(bias / counted));
  }
  EXPECT_GT(both, 2000);
  EXPECT_GT(same, 93 * bearings / 100) << "of " << bearings << ", only in the model " << model_only
                                       << ", only in the pixels " << pixels_only;
  EXPECT_LT(worst_bias, 0.03);
  EXPECT_NEAR(model_unknown, pixels_unknown, 0.005 * all) << "of " << all << " bearings not known";
}

/// Somebody nearer than the camera measures fills the image: what is behind him is not known.
TEST(DepthScanModel, KnowsNothingBehindWhatIsTooNearLikeThePixels) {
  const auto building = load_building(kOffice).value();
  const std::vector<PersonPlan> people{{.name = "a", .start = {3.65, 5.0}, .yaw = 1.5708}};
  World world({}, building, people, {3.0, 5.0, 0.0}, 7);
  depth_pipeline::PipelineConfig config;
  config.confidence_frames = 1;
  Chain chain(world, 3, config);
  DepthScanModel model({}, 5);
  DepthScanResult result;
  for (int k = 0; k < 5; ++k) chain.step();
  const auto view = chain.see(world.base().truth().pitch);
  model.scan(world, chain.camera(), result);
  const std::size_t middle = result.ranges.size() / 2;
  int modelled = 0, rendered = 0, bearings = 0;
  for (std::size_t b = middle - 20; b <= middle + 20; ++b, ++bearings) {
    modelled += std::isnan(result.ranges[b]) && std::isnan(result.low[b]);
    rendered += std::isnan(view.scan->ranges[b]);
  }
  EXPECT_GT(modelled, 35) << "of " << bearings;
  EXPECT_GT(rendered, 35) << "of " << bearings;
  EXPECT_TRUE(std::isfinite(result.ranges[5]) || std::isinf(result.ranges[5])) << "beside him";
}

TEST(ScanJudgement, CountsWhatIsNotKnownWhereSomethingIs) {
  constexpr float kFree = std::numeric_limits<float>::infinity();
  const std::vector<float> truth{2, 2, 2, 2, 2, 2, kFree, kFree, kFree, kFree};
  operations::ScanJudgement blind, sighted;
  blind.take(truth, std::vector<float>(truth.size(), std::nanf("")));
  sighted.take(truth, truth);
  EXPECT_EQ(blind.unknown_share(), 1.0);
  EXPECT_EQ(blind.missed_share(), 0.0);
  EXPECT_EQ(sighted.unknown_share() + sighted.missed_share() + sighted.false_share(), 0.0);
}

TEST(DepthScanModel, SeesDropsAndLowThingsLikeThePixels) {
  const auto building = parse_building(R"(name: hall
walls:
  - {name: outer, thickness: 0.2, points: [[-6, -6], [12, -6], [12, 6], [-6, 6], [-6, -6]]}
furniture:
  - {name: stairs, box: [3.6, 1.2, 0, 1.6, 1.4], height: [-0.6, 0]}
  - {name: box, box: [2.6, -0.9, 0, 0.5, 0.35], height: [0, 0.3]}
)",
                                       "hall.yaml");
  ASSERT_TRUE(building.ok()) << building.error();
  World world({}, *building, {}, {0, 0, 0}, 1);
  depth_pipeline::PipelineConfig config;
  config.confidence_frames = 1;
  Chain chain(world, 3, config);
  for (int i = 0; i < 20; ++i) chain.step();
  const auto view = chain.see(world.base().truth().pitch);
  DepthScanModel model({}, 5);
  DepthScanResult result;
  model.scan(world, chain.camera(), result);
  const auto at = [&](const std::vector<float>& ranges, double x, double y) {
    const double bearing = std::atan2(y, x - 0.2);
    return ranges[static_cast<std::size_t>((bearing - result.angle_min) / result.increment)];
  };
  EXPECT_GT(view.drops, 50);
  EXPECT_NEAR(at(view.low->ranges, 2.8, 1.0), std::hypot(2.6, 1.0), 0.12);  // the edge
  EXPECT_NEAR(at(result.low, 2.8, 1.0), std::hypot(2.6, 1.0), 0.12);
  EXPECT_NEAR(at(view.low->ranges, 2.35, -0.9), std::hypot(2.15, 0.9), 0.06);  // the box
  EXPECT_NEAR(at(result.low, 2.35, -0.9), std::hypot(2.15, 0.9), 0.06);
}

/// A Kinect whose images the pipeline gets, and what may become of the bearings.
struct Kind {
  const char* name;
  rendering::DepthSensorConfig (*camera)();
  bool refit;
  double missed, unknown, false_ones;  ///< [%] at most
  double error;                        ///< [m] of 95 % of the ranges
};

class KinectInTheOffice : public testing::TestWithParam<Kind> {};

TEST_P(KinectInTheOffice, ShowsWhatIsThereWhileItLeans) {
  const Kind& kind = GetParam();
  auto stage = operations::DepthStage::make(kOffice, kind.camera(), 3);
  ASSERT_TRUE(stage.ok()) << stage.error();
  depth_pipeline::PipelineConfig config;
  config.confidence_frames = 1;
  config.origin = operations::kScanOrigin;
  config.refit = kind.refit;
  if (kind.camera().noise == rendering::DepthSensorConfig::Noise::kStructuredLight)
    config.refitted = depth_pipeline::for_structured_light(config.refitted);
  auto pipeline = DepthPipeline::make(stage->camera(), config).value();
  operations::ScanJudgement judgement;
  for (const Pose2& place : {Pose2{24.9, 1.6, 0.55}, Pose2{12.0, 10.0, 0.0}, Pose2{14.0, 3.0, 1.2},
                             Pose2{30.0, 20.0, 0.4}}) {
    for (const double degrees : {-10.0, -5.0, 0.0, 5.0, 10.0}) {
      const auto image = stage->look(place, radians(degrees), 0.0);
      const auto view = pipeline.process(image, stage->pose()).value();
      judgement.take(stage->nearest(pipeline.geometry()), view.scan->ranges);
    }
  }
  std::printf(
      "%s: %d bearings with something, missed %.2f %%, unknown %.2f %%, false %.2f %%, "
      "error %.3f m\n",
      kind.name, judgement.obstacles, 100.0 * judgement.missed_share(),
      100.0 * judgement.unknown_share(), 100.0 * judgement.false_share(), judgement.error(0.95));
  EXPECT_GT(judgement.obstacles, 3000);
  EXPECT_LE(100.0 * judgement.missed_share(), kind.missed);
  EXPECT_LE(100.0 * judgement.unknown_share(), kind.unknown);
  EXPECT_LE(100.0 * judgement.false_share(), kind.false_ones);
  EXPECT_LE(judgement.error(0.95), kind.error);
}

INSTANTIATE_TEST_SUITE_P(
    EachKind, KinectInTheOffice,
    testing::Values(Kind{"v2", rendering::kinect_v2, false, 3.0, 1.0, 0.5, 0.03},
                    Kind{"v2Fitted", rendering::kinect_v2, true, 3.0, 1.0, 0.5, 0.03},
                    Kind{"v1", rendering::kinect_v1, false, 3.0, 2.5, 0.5, 0.06},
                    Kind{"v1Fitted", rendering::kinect_v1, true, 3.0, 2.5, 0.5, 0.06}),
    [](const auto& kind) { return std::string(kind.param.name); });

constexpr const char* kEmptyHall = R"(name: hall
walls:
  - {name: outer, thickness: 0.2, points: [[-20, -20], [40, -20], [40, 20], [-20, 20], [-20, -20]]}
)";

class DepthPipelineInTheWorld : public testing::TestWithParam<bool> {};

TEST_P(DepthPipelineInTheWorld, FindsNoFloorWhileItDrivesAndLeans) {
  const auto building = parse_building(kEmptyHall, "hall.yaml");
  World world({}, *building, {}, {0, 0, 0}, 4);
  depth_pipeline::PipelineConfig config;
  config.refit = GetParam();
  Chain chain(world, 9, config);
  int frames = 0, false_bearings = 0, calm = 0, false_while_calm = 0;
  double steepest = 0.0;
  for (int step = 0; step < 700; ++step) {
    world.base().command({step < 350 ? 1.4 : 0.0, 0.0});
    chain.step();
    if (step % 10 != 0) continue;
    const double pitch = world.base().readings().pitch;
    steepest = std::max(steepest, std::abs(pitch));
    const auto view = chain.see(pitch);
    EXPECT_EQ(view.refitted, GetParam());
    ++frames;
    calm = chain.camera().burst() > 0.0 ? 0 : calm + 1;
    for (const float range : view.scan->ranges) {
      false_bearings += std::isfinite(range);
      false_while_calm += std::isfinite(range) && calm > 3;
    }
  }
  EXPECT_GT(steepest, radians(9.0));
  EXPECT_EQ(frames, 70);
  EXPECT_LE(false_while_calm, GetParam() ? 4 : 0);
  EXPECT_LE(false_bearings, 120);  // of 38 000, while bursts of noise spoil the images
}

INSTANTIATE_TEST_SUITE_P(PredictedAndFittedFloor, DepthPipelineInTheWorld, testing::Bool());

/// Shares of the bearings ahead at which a bar of 10 mm is found in the pixels and by the model.
std::pair<double, double> bar_found(double ahead) {
  const auto building =
      parse_building(std::string(kEmptyHall) + "furniture:\n  - {name: bar, box: [" +
                         std::to_string(ahead) + ", 0, 1.5708, 2.5, 0.06], height: [0, 0.01]}\n",
                     "hall.yaml");
  World world({}, *building, {}, {0, 0, 0}, 4);
  depth_pipeline::PipelineConfig config;
  config.refit = true;
  config.confidence_frames = 1;
  Chain chain(world, 9, config);
  DepthScanModel model(with_fitted_floor({}), 5);
  DepthScanResult modelled;
  int rendered_hits = 0, modelled_hits = 0, bearings = 0;
  for (int frame = 0; frame < 6; ++frame) {
    for (int i = 0; i < 3; ++i) chain.step();
    const auto view = chain.see(world.base().readings().pitch);
    model.scan(world, chain.camera(), modelled);
    for (std::size_t i = 0; i < modelled.ranges.size(); ++i) {
      const double bearing = modelled.angle_min + modelled.increment * static_cast<double>(i);
      if (std::abs(bearing) > 0.4) continue;
      const auto hits = [&](float range) {
        return std::abs(0.2 + static_cast<double>(range) * std::cos(bearing) - ahead) < 0.1;
      };
      rendered_hits += hits(view.scan->ranges[i]);
      modelled_hits += hits(modelled.ranges[i]);
      ++bearings;
    }
  }
  return {static_cast<double>(rendered_hits) / bearings,
          static_cast<double>(modelled_hits) / bearings};
}

TEST(FittedFloor, ShowsABarOf10MillimetresInTheModelAsFarAsInThePixels) {
  for (const double ahead : {1.75, 2.0}) {
    const auto [pixels, model] = bar_found(ahead);
    EXPECT_GT(pixels, 0.9) << ahead;
    EXPECT_GT(model, 0.9) << ahead;
  }
  const auto [pixels, model] = bar_found(2.8);
  EXPECT_LT(pixels, 0.1);
  EXPECT_LT(model, 0.1);
}

/// Of the bearings at which pixels or model see somebody, how many show him alike.
struct Alike {
  int bearings = 0, same = 0;
  double share() const { return static_cast<double>(same) / bearings; }
};

/// Alone in an empty hall, at several distances, turned in eight ways.
Alike scans_of(rendering::Posture posture) {
  const auto building = parse_building(kEmptyHall, "hall.yaml");
  Alike alike;
  for (const double ahead : {1.8, 2.6, 3.6}) {
    for (int turn = 0; turn < 8; ++turn) {
      PersonPlan person{.name = "somebody", .start = {ahead, 0.1}, .yaw = turn * geometry::kPi / 4};
      person.height = 1.75;
      person.posture = posture;
      World world({.moves_people = false}, *building, std::span(&person, 1), {0, 0, 0}, 4);
      depth_pipeline::PipelineConfig config;
      config.confidence_frames = 1;
      Chain chain(world, 9, config);
      for (int i = 0; i < 3; ++i) chain.step();
      const auto view = chain.see(world.base().truth().pitch);
      DepthScanModel model({}, 5);
      DepthScanResult modelled;
      model.scan(world, chain.camera(), modelled);
      for (std::size_t i = 0; i < modelled.ranges.size(); ++i) {
        const float ours = modelled.ranges[i], theirs = view.scan->ranges[i];
        if (std::isnan(ours) || std::isnan(theirs)) continue;
        if (!std::isfinite(ours) && !std::isfinite(theirs)) continue;
        ++alike.bearings;
        alike.same += std::abs(ours - theirs) < 0.12F;
      }
    }
  }
  return alike;
}

TEST(DepthScanModel, ShowsPeopleOfEveryPostureLikeThePixels) {
  using rendering::Posture;
  for (const auto& [name, posture, least] : {std::tuple{"standing", Posture::kStanding, 0.64},
                                             {"sitting", Posture::kSitting, 0.44},
                                             {"squatting", Posture::kSquatting, 0.61},
                                             {"bending", Posture::kBending, 0.75},
                                             {"arms out", Posture::kArmsOut, 0.79}}) {
    const Alike alike = scans_of(posture);
    std::printf("%s: %.3f of %d bearings alike\n", name, alike.share(), alike.bearings);
    EXPECT_GT(alike.share(), least) << name;
  }
}

struct MountErrors {
  double height, angle, gain;
};

TEST(KinectCalibration, FindsTheMountWithin5MillimetresAnd0Point2Degrees) {
  const auto building = parse_building(R"(name: hall
walls:
  - {name: outer, thickness: 0.2, points: [[-8, -8], [12, -8], [12, 8], [-8, 8], [-8, -8]]}
)",
                                       "hall.yaml");
  std::uint64_t seed = 11;
  for (const MountErrors& errors :
       {MountErrors{0.02, radians(1.5), 0.95}, MountErrors{-0.03, radians(-2.0), 1.06}}) {
    World world({}, *building, {}, {0, 0, 0}, ++seed);
    DepthCameraConfig camera;
    camera.mount.z += errors.height;
    camera.servo_gain = errors.gain;
    camera.servo_offset = errors.angle;
    Chain chain(world, seed, {}, camera);
    depth_pipeline::TiltSweep::Config config;
    config.images = config.settling = 6;
    depth_pipeline::TiltSweep sweep(rendering::intrinsics_of(camera.sensor.lens), config);
    for (int frame = 0; frame < 1200 && !sweep.done(); ++frame) {
      chain.camera().set_tilt(sweep.wanted());
      for (int i = 0; i < 3; ++i) chain.step();
      sweep.take(chain.image(), chain.camera().tilt(), world.base().readings().pitch);
    }
    ASSERT_TRUE(sweep.done());
    EXPECT_EQ(sweep.complaint(), "");
    const auto found = depth_pipeline::fit_calibration(sweep.samples());
    ASSERT_TRUE(found.ok()) << found.error();
    EXPECT_NEAR(found->mount_z, camera.mount.z, 0.005);
    for (const double servo : {-0.3, 0.0, 0.3}) {
      EXPECT_NEAR(found->servo.angle_of(servo), errors.gain * servo + errors.angle, radians(0.2));
    }
  }
}

TEST(KinectCalibration, RefusesARoomWithoutFloor) {
  const auto building = parse_building(R"(name: closet
walls:
  - {name: outer, thickness: 0.2, points: [[-1, -1], [1.1, -1], [1.1, 1], [-1, 1], [-1, -1]]}
)",
                                       "closet.yaml");
  World world({}, *building, {}, {0, 0, 0}, 2);
  Chain chain(world, 5, {});
  depth_pipeline::TiltSweep::Config config;
  config.patience = 15;
  config.positions = 5;
  depth_pipeline::TiltSweep sweep(rendering::intrinsics_of(rendering::kinect_v2().lens), config);
  for (int frame = 0; frame < 400 && !sweep.done(); ++frame) {
    chain.camera().set_tilt(sweep.wanted());
    for (int i = 0; i < 3; ++i) chain.step();
    sweep.take(chain.image(), chain.camera().tilt(), world.base().readings().pitch);
  }
  EXPECT_TRUE(sweep.done());
  EXPECT_FALSE(depth_pipeline::fit_calibration(sweep.samples()).ok());
  EXPECT_NE(sweep.complaint(), "");
}

}  // namespace
}  // namespace usher::world
