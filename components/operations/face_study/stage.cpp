#include "operations/face_study/stage.hpp"

#include <cmath>

namespace usher::face_study {

namespace {

using rendering::Poster;
using rendering::Prism;

constexpr double kHeight = 1.15, kUp = 8.0 * geometry::kPi / 180.0;  // of the Pioneer's Kinect
constexpr std::uint64_t kPeople = 12, kPictures = 4;

Prism block(double ahead, double left, double depth, double width, double top) {
  const double x = 0.5 * depth, y = 0.5 * width;
  Prism prism;
  prism.outline = {
      {ahead - x, left - y}, {ahead + x, left - y}, {ahead + x, left + y}, {ahead - x, left + y}};
  prism.top = top;
  return prism;
}

rendering::Model room() {
  rendering::Model model;
  model.ceiling = 3.0;
  model.prisms = {block(4.6, 0.0, 0.2, 7.0, 3.0),   // the wall ahead
                  block(2.0, 3.1, 6.0, 0.2, 3.0),   // left
                  block(2.0, -3.1, 6.0, 0.2, 3.0),  // right
                  block(3.2, 1.35, 0.5, 0.7, 1.9),  // cabinets
                  block(3.0, -1.3, 0.5, 0.8, 1.5), block(2.2, -0.72, 0.3, 0.35, 0.95)};
  return model;
}

/// What looks like a face and has the size of none: on the wall large or small, on fronts of
/// cabinets, on a shelf.
std::vector<Poster> things() {
  const auto at = [](double ahead, double left, double up, double side, std::size_t picture) {
    return Poster{{ahead, left, up}, geometry::kPi, side, picture};
  };
  return {
      at(4.5, 0.55, 1.75, 0.75, 0),   at(4.5, -0.45, 2.25, 0.60, 1), at(4.5, -0.35, 1.30, 0.42, 2),
      at(4.5, 0.35, 2.60, 0.50, 3),   at(2.95, 1.35, 1.55, 0.50, 1), at(2.95, 1.35, 0.95, 0.42, 3),
      at(2.75, -1.15, 1.22, 0.45, 0), at(4.5, -1.60, 2.10, 0.80, 2), at(4.5, 1.75, 2.45, 0.70, 0),
      at(2.05, -0.72, 0.86, 0.13, 2), at(4.5, -1.05, 2.75, 0.40, 1)};
}

}  // namespace

Stage::Stage(rendering::Renderer renderer, std::uint64_t seed,
             std::vector<rendering::Texture> faces)
    : renderer_(std::move(renderer)),
      sensor_(rendering::kinect_v1(), seed),
      painter_(std::move(faces)),
      room_T_camera_{{0.0, 0.0, kHeight}, geometry::from_roll_pitch_yaw(0.0, -kUp, 0.0)} {}

Result<Stage> Stage::make(std::size_t features, std::uint64_t seed,
                          std::vector<rendering::Texture> faces) {
  auto renderer = rendering::Renderer::make(room());
  if (!renderer) return Error{renderer.error()};
  for (std::uint64_t i = faces.empty() ? 0 : kPeople; i < kPeople; ++i)
    faces.push_back(rendering::drawn_face(i));
  Stage stage(std::move(renderer).value(), seed, std::move(faces));
  auto posters = things();
  posters.resize(std::min(features, posters.size()));
  std::vector<rendering::Texture> pictures;
  for (std::uint64_t i = 0; i < kPictures; ++i) pictures.push_back(rendering::drawn_face(100 + i));
  for (const Poster& poster : posters) stage.features_.push_back(poster.middle);
  stage.painter_.hang(std::move(posters), std::move(pictures));
  return stage;
}

const Stage::Shot& Stage::shoot(const std::vector<rendering::Body>& bodies) {
  renderer_.place(bodies);
  sensor_.measure(renderer_, room_T_camera_, 0.0, shot_.millimeters);
  const rendering::Lens& lens = sensor_.config().lens;
  painter_.paint(sensor_.truth(), lens, room_T_camera_, bodies, {}, shot_.rgb);
  shot_.width = lens.width;
  shot_.height = lens.height;
  return shot_;
}

face_detector::Box Stage::pixel_of(const Eigen::Vector3d& point) const {
  const rendering::Lens& lens = sensor_.config().lens;
  const Eigen::Vector3d seen = geometry::inverse(room_T_camera_) * point;
  return {lens.cx - lens.fx * seen.y() / seen.x(), lens.cy - lens.fy * seen.z() / seen.x(), 0.0,
          0.0};
}

rendering::Body standing(double ahead, double left, double height) {
  return {.pose = {ahead, left, std::atan2(-left, -ahead)}, .height = height};
}

}  // namespace usher::face_study
