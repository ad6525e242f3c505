// One 512 x 424 frame of a Kinect v2 to scan and processed image, one thread.
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sensing/depth_pipeline/core/depth_pipeline.hpp"
#include "sensing/depth_pipeline/core/thesis_method.hpp"
#include "sensing/depth_pipeline/test/synthetic.hpp"
#include "support/bench.hpp"

int main(int argc, char** argv) {
  using namespace usher::depth_pipeline;
  using usher::bench::Bound;
  using usher::cpu::Simd;
  usher::bench::Bench bench("depth", "depth_512x424_seed42.pgm, camera 1 m high, 15 deg down");
  const SyntheticScene scene = peer_scene();
  const std::string file = bench.data("peers/depth_512x424_seed42.pgm");
  std::vector<std::uint16_t> depth;
  if (!file.empty()) {
    const cv::Mat image = cv::imread(file, cv::IMREAD_UNCHANGED);
    depth.assign(image.ptr<std::uint16_t>(), image.ptr<std::uint16_t>() + image.total());
  }
  const DepthImage image = view_of(scene.camera, depth);
  bool ok = true;
  const auto pipeline = [&](bool refit, Simd simd) {
    PipelineConfig config;
    config.refit = refit;
    config.simd = simd;
    return DepthPipeline::make(scene.camera, config).value();
  };
  DepthPipeline best = pipeline(false, usher::cpu::best_simd());
  DepthPipeline refit = pipeline(true, usher::cpu::best_simd());
  DepthPipeline sse = pipeline(false, std::min(Simd::kSse41, usher::cpu::best_simd()));
  DepthPipeline portable = pipeline(false, Simd::kPortable);
  ThesisMethod thesis({});
  const cv::Mat narrow = depth.empty() ? cv::Mat() : ThesisMethod::narrow(image, 12.0);
  const auto run = [&](DepthPipeline& one) { ok = one.process(image, kPeerPose).ok() && ok; };

  bench.time("frame_us", 1e-6, [&] { run(best); });
  bench.time("frame_refit_us", 1e-6, [&] { run(refit); });
  bench.time("frame_sse41_us", 1e-6, [&] { run(sse); });
  bench.time("frame_portable_us", 1e-6, [&] { run(portable); });
  bench.time("thesis_method_us", 1e-6, [&] {
    cv::setNumThreads(1);
    thesis.process(narrow, kPeerPose);
  });
  bench.instructions("frame_instructions", [&] { run(best); });
  bench.instructions("frame_refit_instructions", [&] { run(refit); });
  bench.published("frame_us", 42694, "PCL, plane by RANSAC");
  bench.published("frame_us", 18401, "PCL, voxels of 3 cm first");
  bench.published("frame_us", 1382, "PCL, height band from the known mount");
  bench.published("frame_us", 4789, "depthimage_to_laserscan, 424 rows");
  bench.published("frame_instructions", 148439320, "PCL, plane by RANSAC");
  bench.published("frame_instructions", 20599138, "PCL, height band from the known mount");
  bench.published("frame_instructions", 57123374, "depthimage_to_laserscan, 424 rows");
  bench.target("frame_us", Bound::kAtMost, 500);
  bench.target("frame_refit_us", Bound::kAtMost, 500);
  const int code = bench.run(argc, argv);
  return ok ? code : 1;
}
