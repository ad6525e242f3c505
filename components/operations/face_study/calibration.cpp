#include "operations/face_study/calibration.hpp"

#include <algorithm>
#include <cstdio>

namespace usher::face_study {

namespace {

std::string numbers(const face_detector::SizeModel& model) {
  char text[160];
  std::snprintf(text, sizeof(text), "[%.6g, %.6g, %.6g, %.1f, %.1f]", model.a, model.b, model.c,
                model.least, model.most);
  return text;
}

}  // namespace

Status add_samples(const kinect::Recording& recording, face_detector::FaceDetector& anywhere,
                   FaceSamples& samples, const std::function<void(std::size_t)>& progress) {
  const auto& config = anywhere.config();
  std::vector<std::uint16_t> scratch;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    progress(i);
    const auto depth = recording.read(i);
    if (!depth) return Error{depth.error()};
    const auto color = recording.read_color(i);
    if (!color) return Error{color.error()};
    if (color->width != depth->width || color->height != depth->height)
      return Error{"a color image has another size than the depth image of the same moment"};
    ++samples.images;
    const auto hits = anywhere.find_anywhere(color->view());
    const auto best = std::max_element(hits.begin(), hits.end(), [](const auto& a, const auto& b) {
      return a.neighbors < b.neighbors;
    });
    if (best == hits.end()) continue;
    const auto measured =
        face_detector::middle_depth(depth->view(), best->box, config.rules, scratch);
    if (!measured || *measured > config.rules.far) continue;
    auto& part =
        config.model.is_center(best->box.column(), color->width) ? samples.center : samples.side;
    part.push_back({best->box.width, *measured});
  }
  return {};
}

Result<FaceCalibration> fit_models(const FaceSamples& samples) {
  auto center = face_detector::fit_size_model(samples.center);
  if (!center) return Error{"in the middle of the image: " + center.error()};
  auto side = face_detector::fit_size_model(samples.side);
  if (!side) return Error{"at the sides of the image: " + side.error()};
  return FaceCalibration{std::move(center).value(), std::move(side).value()};
}

std::string as_yaml(const FaceCalibration& found) {
  return "# Found by `usher calibrate faces`; belongs into the robot's file.\n"
         "components:\n  face_detector:\n    center_model: " +
         numbers(found.center.model) + "\n    side_model: " + numbers(found.side.model) + "\n";
}

}  // namespace usher::face_study
