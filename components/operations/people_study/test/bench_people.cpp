// People in depth images: how fast, how many are found, how many false alarms; the blob detector of
// the thesis, with and without what it proposes to add, on the same images.
#include <opencv2/imgcodecs.hpp>

#include "operations/people_study/blob_baseline.hpp"
#include "operations/people_study/point_cloud.hpp"
#include "operations/people_study/scoring.hpp"
#include "support/bench.hpp"

namespace {

using namespace usher;
using namespace usher::people_study;
using people_detector::DepthDetector;
using people_detector::Sighting;

constexpr int kScenes = 500;

struct Figures {
  Score thesis, random;
};

template <class Find>
Figures measure(Find&& find) {
  Studio studio;
  Figures figures;
  for (const Scene& scene : thesis_scenes()) {
    const auto shot = studio.take(scene, 3).value();
    figures.thesis += judge(find(shot), shot.truths);
  }
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    const auto shot = studio.take(random_scene(seed), seed).value();
    figures.random += judge(find(shot), shot.truths);
  }
  return figures;
}

/// The rooms as MARVIN's rear camera sees them, people up to `farthest` [m].
Score measure_rear(double farthest) {
  Studio studio(rendering::rear_camera());
  auto detector = DepthDetector::make(studio.intrinsics(), {}).value();
  Score score;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    const auto shot = studio.take(rear_scene(seed), seed).value();
    score += judge(detector.find(shot.processed, shot.view).value(), shot.truths, farthest);
  }
  return score;
}

/// PCL's frame: its camera and where its five people stand, as PCL's own test says.
struct FivePeople {
  static constexpr imaging::Intrinsics kCamera{640, 480, 525.0, 525.0, 319.5, 239.5};
  static constexpr depth_pipeline::CameraPose kPose{1.266, 0.0, 0.0766, -0.0104};
  static constexpr double kPlaces[5][2] = {
      {2.88, -0.12}, {2.64, -0.47}, {2.17, 0.92}, {2.42, 0.60}, {1.93, -0.76}};

  std::vector<std::uint16_t> processed;
  people_detector::View view{kPose.height, kPose.down, kPose.roll};
  imaging::DepthImage image() const { return {kCamera.width, kCamera.height, processed}; }

  explicit FivePeople(const std::string& file) {
    processed.resize(307'200);  // 640 x 480
    if (file.empty()) return;
    const auto cloud = read_point_cloud(file);
    auto pipeline = depth_pipeline::DepthPipeline::make(kCamera, {.origin = 0.0}).value();
    if (!cloud || cloud->millimeters.size() != processed.size()) return;
    const auto shown = pipeline.process({640, 480, cloud->millimeters}, kPose);
    if (shown) processed.assign(shown->processed.begin(), shown->processed.end());
  }
  static Score judge(std::span<const Sighting> found) {
    std::vector<Truth> truths;
    for (const auto& [forward, left] : kPlaces) truths.push_back({forward, left, 1.0});
    return people_study::judge(found, truths);
  }
};

}  // namespace

int main(int argc, char** argv) {
  using bench::Bound;
  bench::Bench bench(
      "people", "thesis figures 8.17 to 8.21 and 500 random rooms, rendered; PCL's five people");
  Studio studio;
  const auto shot = studio.take(random_scene(12), 12).value();
  auto detector = DepthDetector::make(studio.intrinsics(), {}).value();
  auto pipeline = depth_pipeline::DepthPipeline::make(studio.intrinsics(), {.origin = 0.0}).value();
  BlobBaseline blobs(studio.intrinsics(), {});
  const FivePeople five(bench.data("depth/pcl_five_people/five_people.pcd"));
  auto wide = DepthDetector::make(FivePeople::kCamera, {}).value();
  const depth_pipeline::CameraPose pose{shot.view.height, 0.0, shot.view.down, 0.0};

  bench.time("frame_us", 1e-6, [&] { (void)detector.find(shot.processed, shot.view); });
  bench.time("frame_with_pipeline_us", 1e-6, [&] {
    const auto view = pipeline.process(shot.raw, pose);
    (void)detector.find({512, 424, view->processed}, shot.view);
  });
  bench.time("five_people_us", 1e-6, [&] { (void)wide.find(five.image(), five.view); });
  bench.time("thesis_blobs_us", 1e-6, [&] { (void)blobs.find(shot.processed, shot.view); });
  bench.instructions("frame_instructions", [&] { (void)detector.find(shot.processed, shot.view); });

  const auto add = [&](const std::string& key, const Figures& figures) {
    bench.metric(key + "thesis_recall", [=] { return figures.thesis.recall(); });
    bench.metric(key + "thesis_precision", [=] { return figures.thesis.precision(); });
    bench.metric(key + "random_recall", [=] { return figures.random.recall(); });
    bench.metric(key + "random_precision", [=] { return figures.random.precision(); });
  };
  add("", measure([&](const Studio::Shot& one) {
        return detector.find(one.processed, one.view).value();
      }));
  constexpr double kFollows = 4.0;  // [m] farther behind the guide waits for the visitor
  const Score rear = measure_rear(6.0), behind = measure_rear(kFollows);
  bench.metric("rear_near_recall", [=] { return behind.recall(); });
  bench.metric("rear_random_recall", [=] { return rear.recall(); });
  bench.metric("rear_random_precision", [=] { return rear.precision(); });
  const auto add_blobs = [&](const std::string& key, const BlobBaseline::Config& config) {
    BlobBaseline baseline(studio.intrinsics(), config);
    add(key,
        measure([&](const Studio::Shot& one) { return baseline.find(one.processed, one.view); }));
  };
  add_blobs("blobs_", {});
  add_blobs("blobs_regions_", {.regions = true});
  add_blobs("blobs_deviation_", {.deviation = true});
  add_blobs("blobs_area_by_depth_", {.area_by_depth = true});
  add_blobs("blobs_all_", {.regions = true, .deviation = true, .area_by_depth = true});
  const Score real = FivePeople::judge(wide.find(five.image(), five.view).value());
  bench.metric("five_people_found", [=] { return double(real.found); });
  bench.metric("five_people_false_alarms", [=] { return double(real.false_alarms); });

  bench.published("five_people_us", 25000, "PCL ground based people detector");
  bench.published("five_people_found", 5, "PCL ground based people detector");
  bench.published("frame_us", 5600, "blob detector alone");
  bench.target("frame_with_pipeline_us", Bound::kAtMost, 4000);
  bench.target("five_people_us", Bound::kAtMost, 5000);
  bench.target("five_people_found", Bound::kAtLeast, 5);
  for (const char* key : {"thesis_recall", "thesis_precision", "random_recall", "random_precision",
                          "rear_random_recall", "rear_random_precision"})
    bench.target(key, Bound::kAtLeast, 0.98);
  return bench.run(argc, argv);
}
