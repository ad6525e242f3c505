// Faces: milliseconds for a 640 x 480 image with depth, on one core; the cascade over the whole
// image beside it.
#include <opencv2/imgproc.hpp>

#include "operations/face_study/annotated.hpp"
#include "operations/face_study/stage.hpp"
#include "support/bench.hpp"

namespace {

using namespace usher;
using face_detector::FaceDetector;
using face_study::Stage;

constexpr int kWidth = 640, kHeight = 480;

/// A photograph at the Kinect's size; its faces have heads and shoulders before a wall at 3 m.
struct Photograph {
  std::vector<std::uint8_t> rgb = std::vector<std::uint8_t>(std::size_t{3} * kWidth * kHeight, 128);
  std::vector<std::uint16_t> millimeters =
      std::vector<std::uint16_t>(std::size_t{kWidth} * kHeight, 3000);
  imaging::ColorImage color() const { return {kWidth, kHeight, rgb}; }
  imaging::DepthImage depth() const { return {kWidth, kHeight, millimeters}; }

  explicit Photograph(const std::string& folder, const std::string& name) {
    if (folder.empty()) return;
    const auto pictures = face_study::read_annotated(folder);
    if (!pictures) return;
    for (const auto& picture : *pictures) {
      if (picture.name == name) take(picture);
    }
  }
  void take(const face_study::AnnotatedPicture& picture) {
    const double scale = std::max(static_cast<double>(kWidth) / picture.rgb.cols,
                                  static_cast<double>(kHeight) / picture.rgb.rows);
    cv::Mat sized;
    cv::resize(picture.rgb, sized, {}, scale, scale, cv::INTER_AREA);
    sized = sized(cv::Rect(0, 0, kWidth, kHeight)).clone();
    rgb.assign(sized.data, sized.data + rgb.size());
    for (const cv::Rect2d& face : picture.faces) {
      stand(face.x * scale + 0.5 * face.width * scale, face.y * scale + 0.5 * face.height * scale,
            face.width * scale);
    }
  }
  void stand(double column, double row, double size) {
    const double depth = 1e3 * face_detector::SizeModel().depth(size);
    for (int r = 0; r < kHeight; ++r) {
      for (int c = 0; c < kWidth; ++c) {
        const double u = (c - column) / size, v = (r - row) / size;
        auto& pixel =
            millimeters[static_cast<std::size_t>(r) * kWidth + static_cast<std::size_t>(c)];
        if (std::hypot(u, 0.8 * v) < 0.65 || (v > 0.8 && std::abs(u) < 1.3))
          pixel = static_cast<std::uint16_t>(std::min<double>(pixel, depth));
      }
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  using bench::Bound;
  bench::Bench bench(
      "faces",
      "640 x 480 with depth, cascade alt: a rendered room with two people, photographs "
      "with 1 and 11 faces before a wall");
  auto loaded = FaceDetector::make(face_detector::cascade_file("alt", ""), {});
  if (!loaded) {
    std::fprintf(stderr, "usher bench faces: %s\n", loaded.error().c_str());
    return 1;
  }
  FaceDetector detector = std::move(loaded).value();
  Stage stage = Stage::make(11, 1).value();
  const Stage::Shot room =
      stage.shoot({face_study::standing(1.6, 0.35, 1.7), face_study::standing(2.6, -0.5, 1.8)});
  const std::string folder = bench.data("faces");
  const Photograph one(folder, "dart4"), eleven(folder, "dart5");

  const auto add = [&](const std::string& key, const auto& pair) {
    bench.time(key + "_ms", 1e-3, [&] { (void)detector.find(pair.color(), pair.depth()); });
    bench.instructions(key + "_instructions",
                       [&] { (void)detector.find(pair.color(), pair.depth()); });
    bench.metric(key + "_faces", [&] {
      return static_cast<double>(detector.find(pair.color(), pair.depth())->size());
    });
    bench.metric(key + "_searched_share", [&] {
      (void)detector.find(pair.color(), pair.depth());
      return detector.searched();
    });
    bench.time(key + "_whole_image_ms", 1e-3, [&] { (void)detector.find_anywhere(pair.color()); });
  };
  add("room", room);
  add("one", one);
  add("eleven", eleven);
  for (const char* key : {"room_ms", "one_ms", "eleven_ms"}) {
    bench.published(key, 350, "meeting report, 300 to 400");
    bench.published(key, 143, "the cascade over the whole image, from 40 pixels on");
  }
  bench.target("room_ms", Bound::kAtMost, 30);
  bench.target("one_ms", Bound::kAtMost, 30);
  bench.target("room_faces", Bound::kAtLeast, 2);
  return bench.run(argc, argv);
}
