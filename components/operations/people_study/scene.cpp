#include "operations/people_study/scene.hpp"

#include <algorithm>
#include <cmath>

#include "operations/people_study/furniture.hpp"

namespace usher::people_study {

namespace {

using geometry::Point2;
using geometry::radians;
using rendering::Body;
using rendering::Posture;

depth_pipeline::CameraPose camera(double down_degrees, double height = 0.9) {
  return {.height = height, .forward = 0.0, .down = radians(down_degrees)};
}

Body body(double forward, double left, double yaw_degrees, Posture posture = Posture::kStanding,
          double height = 1.75) {
  return {{forward, left, radians(yaw_degrees)}, height, 1.0, posture, 0.6};
}

Posture any_posture(Random& random, Crowd crowd) {
  const double dice = random.uniform(crowd == Crowd::kHard ? 0.55 : 0.0, 1.0);
  if (dice < 0.38) return Posture::kStanding;
  if (dice < 0.66) return Posture::kWalking;
  if (dice < 0.80) return Posture::kSitting;
  if (dice < 0.87) return Posture::kSquatting;
  if (dice < 0.93) return Posture::kBending;
  return Posture::kArmsOut;
}

bool is_free(const std::vector<Point2>& taken, const Point2& place, double gap) {
  return std::none_of(taken.begin(), taken.end(),
                      [&](const Point2& other) { return (other - place).norm() < gap; });
}

void add_person(Scene& scene, Random& random, const Point2& place, Crowd crowd,
                std::vector<Point2>& taken) {
  Body one = body(place.x(), place.y(), random.uniform(-180.0, 180.0), any_posture(random, crowd),
                  std::clamp(random.gaussian(1.72, 0.12), 1.1, 2.0));
  one.width = random.uniform(0.8, 1.25);
  one.phase = random.uniform(0.0, 6.28);
  taken.push_back(place);
  scene.bodies.push_back(one);
  if (one.posture == Posture::kSitting) {
    random.uniform() < 0.3 ? add_wheelchair(scene.model, one.pose)
                           : add_chair(scene.model, one.pose, random.uniform(0.4, 0.6));
  }
  if (one.posture == Posture::kSitting || random.uniform() > 0.25) return;
  // Somebody beside, shoulder to shoulder.
  const double across = random.uniform(-180.0, 180.0);
  const Point2 beside = place + random.uniform(0.46, 0.6) *
                                    Point2(std::cos(radians(across)), std::sin(radians(across)));
  if (!is_free({taken.begin(), taken.end() - 1}, beside, 0.55) || beside.x() < 0.7) return;
  Body other = one;
  other.pose = {beside.x(), beside.y(), random.uniform(-3.14, 3.14)};
  other.posture = random.uniform() < 0.7 ? Posture::kStanding : Posture::kWalking;
  other.height = std::clamp(random.gaussian(1.72, 0.1), 1.3, 2.0);
  taken.push_back(beside);
  scene.bodies.push_back(other);
}

Scene named(const std::string& name, std::vector<Body> bodies, double down_degrees = -10.0) {
  Scene scene{name, empty_room(), std::move(bodies), camera(down_degrees)};
  for (const Body& one : scene.bodies) {
    if (one.posture == Posture::kSitting) add_chair(scene.model, one.pose, 0.5);
  }
  return scene;
}

void add_poses(std::vector<Scene>& scenes) {
  const std::pair<const char*, Posture> poses[] = {
      {"standing", Posture::kStanding},    {"walking", Posture::kWalking},
      {"sitting", Posture::kSitting},      {"squatting", Posture::kSquatting},
      {"bending over", Posture::kBending}, {"arms out", Posture::kArmsOut}};
  for (const auto& [name, posture] : poses) {
    for (const double yaw : {180.0, 90.0, 0.0})
      scenes.push_back(named(std::string("8.17 ") + name +
                                 (yaw > 100.0  ? ", from the front"
                                  : yaw > 10.0 ? ", from the side"
                                               : ", from behind"),
                             {body(1.8, 0.1, yaw, posture)}));
  }
  for (int yaw = 0; yaw < 360; yaw += 45)
    scenes.push_back(named("8.18 sitting, turned by " + std::to_string(yaw) + " deg",
                           {body(1.9, 0.0, yaw, Posture::kSitting)}));
}

void add_wheelchairs(std::vector<Scene>& scenes) {
  for (int yaw = 0; yaw < 360; yaw += 45) {
    const Body sitting = body(1.9, 0.0, yaw, Posture::kSitting);
    scenes.push_back({"in a wheelchair, turned by " + std::to_string(yaw) + " deg",
                      empty_room(),
                      {sitting},
                      camera(-10.0)});
    add_wheelchair(scenes.back().model, sitting.pose);
  }
}

void add_groups(std::vector<Scene>& scenes) {
  for (const double apart : {1.0, 0.7, 0.5, 0.46}) {
    scenes.push_back(named(
        "8.19 two people, " + std::to_string(static_cast<int>(100 * apart)) + " cm apart",
        {body(2.0, 0.5 * apart, 180), body(2.0, -0.5 * apart, 170, Posture::kStanding, 1.65)}));
  }
  scenes.push_back(named("8.19 three in a row",
                         {body(2.6, 0.5, 180), body(2.6, 0.0, 160, Posture::kStanding, 1.6),
                          body(2.7, -0.5, 190, Posture::kStanding, 1.85)}));
  scenes.push_back(named("one half behind another", {body(1.8, 0.2, 180), body(2.6, -0.25, 180)}));
}

void add_distances(std::vector<Scene>& scenes) {
  for (const double forward : {0.5, 0.6, 0.8, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 5.9}) {
    for (const double down : {5.0, -10.0}) {
      scenes.push_back(named("at " + std::to_string(static_cast<int>(100 * forward)) +
                                 " cm, camera " + (down > 0 ? "5 deg down" : "10 deg up"),
                             {body(forward, 0.05, 180)}, down));
      if (forward > 5.0) scenes.back().model = empty_room(7.5);
    }
  }
  for (const double pitch : {-12.0, -5.0, 8.0, 15.0})
    scenes.push_back(named("leaning by " + std::to_string(static_cast<int>(pitch)) + " deg",
                           {body(2.5, 0.3, 180), body(3.4, -0.6, 90, Posture::kWalking)},
                           5.0 + pitch));
}

/// Somebody whose hips are on the image's border, or 10 cm inside or outside of it.
void add_borders(std::vector<Scene>& scenes) {
  constexpr double kEdge = 255.5 / 365.0;  // tangent of the border's bearing
  constexpr const char* kOut[] = {"a third", "half", "two thirds"};
  for (const int forward : {1, 2, 4}) {
    for (const int out : {0, 1, 2}) {
      for (const double side : {1.0, -1.0}) {
        const double left = side * (kEdge * forward + 0.1 * (out - 1));
        scenes.push_back(named(std::string(kOut[out]) + " out, " + std::to_string(forward) +
                                   " m away, " + (side > 0 ? "left" : "right"),
                               {body(forward, left, 180)}));
      }
    }
  }
}

void add_things(std::vector<Scene>& scenes) {
  const auto with = [&](const char* name, auto add) {
    Scene scene = named(name, {});
    add(scene.model);
    scenes.push_back(std::move(scene));
  };
  using rendering::Model;
  with("8.16 nobody", [](Model&) {});
  with("8.20 office chair", [](Model& m) { add_chair(m, {1.6, 0.0, 2.5}, 0.5); });
  with("8.20 stool", [](Model& m) {
    add_box(m, {1.5, 0.1, 0.3}, 0.35, 0.35, 0.4, 0.45);
    add_pole(m, {1.5, 0.1}, 0.03, 0.4);
  });
  with("8.20 table", [](Model& m) { add_table(m, {1.8, 0.0, 0.4}, 1.4, 0.7); });
  with("8.20 large flat surface", [](Model& m) {
    add_box(m, {1.8, 0.0, 0.0}, 0.1, 2.2, 0.0, 2.2);
  });
  with("8.20 pole", [](Model& m) { add_pole(m, {1.5, 0.1}, 0.05, 2.4); });
  with("8.20 railing", [](Model& m) { add_railing(m, {1.8, 0.0, 0.5}, 2.0); });
  with("8.20 rubbish bin", [](Model& m) { add_pole(m, {1.4, -0.1}, 0.2, 0.75); });
  with("8.21 angled surface, left", [](Model& m) {
    add_box(m, {1.7, 0.0, 0.9}, 0.05, 0.9, 0.0, 1.9);
  });
  with("8.21 angled surface, right", [](Model& m) {
    add_box(m, {1.7, 0.0, -1.1}, 0.05, 0.9, 0.0, 1.9);
  });
  with("8.21 narrow flat surface", [](Model& m) {
    add_box(m, {1.5, 0.0, 0.0}, 0.05, 0.45, 0.0, 1.8);
  });
  with("8.21 surface partly in the image", [](Model& m) {
    add_box(m, {1.5, 1.15, 0.0}, 0.05, 0.8, 0.0, 1.9);
  });
  with("bookcase", [](Model& m) { add_box(m, {2.2, 0.2, 0.3}, 0.35, 0.9, 0.0, 1.9); });
  with("pillar", [](Model& m) { add_pole(m, {2.0, 0.0}, 0.22, 2.7); });
  with("open door", [](Model& m) { add_box(m, {2.4, -0.3, 0.7}, 0.04, 0.85, 0.0, 2.05); });
  with("lamp", [](Model& m) { add_lamp(m, {2.0, 0.2}); });
}

}  // namespace

Scene random_scene(std::uint64_t seed, Crowd crowd) {
  Random random(stream_seed(seed, "scene"));
  Scene scene{"random " + std::to_string(seed), random_room(random), {}, {}};
  scene.camera =
      camera(random.uniform() < 0.5 ? random.gaussian(5.0, 4.0) : random.gaussian(-10.0, 4.0),
             random.uniform(0.85, 1.1));
  std::vector<Point2> taken;
  const auto place = [&](double nearest) {
    const double forward = nearest + (6.0 - nearest) * std::pow(random.uniform(), 0.8);
    return Point2(forward, random.uniform(-0.68, 0.68) * forward);
  };
  const auto people = random.below(5);
  for (std::uint64_t i = 0; i < people; ++i) {
    const Point2 where = place(0.6);
    if (is_free(taken, where, 0.75)) add_person(scene, random, where, crowd, taken);
  }
  const auto things = random.below(crowd == Crowd::kHard ? 17 : 9);
  for (std::uint64_t i = 0; i < things; ++i) {
    const Point2 where = place(1.0);
    if (is_free(taken, where, 0.95)) add_any(scene.model, random, where);
  }
  return scene;
}

Scene rear_scene(std::uint64_t seed, Crowd crowd) {
  const depth_pipeline::Mount mount{.x = -0.2, .z = 0.9, .backward = true};
  Scene scene = random_scene(seed, crowd);
  // The base leans a little while it drives.
  Random random(stream_seed(seed, "lean"));
  scene.camera = depth_pipeline::camera_pose(mount, radians(-15.0), radians(random.gaussian(0, 2)));
  scene.camera.forward = 0.0;
  return scene;
}

std::vector<Scene> thesis_scenes() {
  std::vector<Scene> scenes;
  add_poses(scenes);
  add_wheelchairs(scenes);
  add_groups(scenes);
  add_distances(scenes);
  add_borders(scenes);
  add_things(scenes);
  return scenes;
}

Studio::Studio(const rendering::DepthSensorConfig& sensor)
    : sensor_(sensor),
      intrinsics_(rendering::intrinsics_of(sensor.lens)),
      pipeline_(depth_pipeline::DepthPipeline::make(intrinsics_, {.origin = 0.0}).value()) {}

std::vector<Truth> Studio::truths_of(const Scene& scene) const {
  std::vector<Truth> truths(scene.bodies.size());
  for (std::size_t i = 0; i < truths.size(); ++i) {
    truths[i].forward = scene.bodies[i].pose.x;
    truths[i].left = scene.bodies[i].pose.y;
  }
  for (std::size_t pixel = 0; pixel < hits_.body.size(); ++pixel) {
    if (hits_.body[pixel] < 0) continue;
    const double side = static_cast<double>(hits_.depth[pixel]) / intrinsics_.fx;
    truths[static_cast<std::size_t>(hits_.body[pixel])].area += side * side;
  }
  return truths;
}

Result<Studio::Shot> Studio::take(const Scene& scene, std::uint64_t seed) {
  auto renderer = rendering::Renderer::make(scene.model);
  if (!renderer) return Error{scene.name + ": " + renderer.error()};
  renderer->place(scene.bodies);
  rendering::DepthSensor sensor(sensor_, seed);
  const geometry::Pose3 pose{{0.0, 0.0, scene.camera.height},
                             geometry::from_roll_pitch_yaw(0.0, scene.camera.down, 0.0)};
  sensor.measure(*renderer, pose, 0.0, raw_);
  hits_ = sensor.truth();
  const imaging::DepthImage raw{intrinsics_.width, intrinsics_.height, raw_};
  const auto view = pipeline_.process(raw, scene.camera);
  if (!view) return Error{scene.name + ": " + view.error()};
  processed_.assign(view->processed.begin(), view->processed.end());
  return Shot{raw,
              {intrinsics_.width, intrinsics_.height, processed_},
              {scene.camera.height, scene.camera.down, 0.0},
              truths_of(scene)};
}

}  // namespace usher::people_study
