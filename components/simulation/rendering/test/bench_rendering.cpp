// Images of a furnished room with five people, and what MARVIN's cameras take of a core.
#include "simulation/rendering/core/depth_sensor.hpp"
#include "simulation/rendering/core/painter.hpp"
#include "support/bench.hpp"

int main(int argc, char** argv) {
  using namespace usher::rendering;
  using usher::bench::Bound;
  Model model;
  const auto slab = [](double x0, double y0, double x1, double y1, double bottom, double top) {
    return Prism{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, bottom, top, Material::kMatte};
  };
  for (int i = 0; i < 40; ++i) {
    const int row = i / 8;
    const double x = 1.5 + 0.7 * (i % 8), y = -2.5 + 1.0 * row;
    model.prisms.push_back(slab(x, y, x + 0.4, y + 0.1, 0.7, 0.74));
    for (const double leg : {0.0, 0.36})
      model.prisms.push_back(slab(x + leg, y, x + leg + 0.04, y + 0.04, 0.0, 0.7));
  }
  model.prisms.push_back(slab(7.0, -5.0, 7.1, 5.0, 0.0, 2.7));
  Renderer renderer = Renderer::make(model).value();
  std::vector<Body> people;
  people.reserve(5);
  for (int i = 0; i < 5; ++i) people.push_back({.pose = {2.0 + 0.5 * i, -1.0 + 0.5 * i, 1.0 * i}});
  DepthSensor v2(kinect_v2(), 1), v1(kinect_v1(), 1), rear(rear_camera(), 1);
  std::vector<std::uint16_t> image;
  const usher::geometry::Pose3 camera{{0, 0, 0.9},
                                      usher::geometry::from_roll_pitch_yaw(0, 0.09, 0)};
  Hits hits;
  Painter painter({drawn_face(0), drawn_face(1), drawn_face(2)});
  const std::vector<Gains> gains(people.size());
  std::vector<std::uint8_t> rgb;
  renderer.place(people);
  Hits front_hits, rear_hits;
  renderer.render(kinect_v2().lens, camera, 9.0, front_hits);
  renderer.render(rear_camera().lens, camera, 9.0, rear_hits);
  const auto paint = [&](const DepthSensor& sensor, const Hits& seen) {
    painter.paint(seen, sensor.config().lens, camera, people, gains, rgb);
  };

  usher::bench::Bench bench("rendering", "40 tables, 5 people, Kinect v2 and v1, rear camera");
  bench.time("place_people_us", 1e-6, [&] { renderer.place(people); });
  bench.time("kinect_v2_rays_ms", 1e-3, [&] { renderer.render({}, camera, 9.0, hits); });
  bench.time("kinect_v2_image_ms", 1e-3, [&] { v2.measure(renderer, camera, 0.0, image); });
  bench.time("kinect_v1_image_ms", 1e-3, [&] { v1.measure(renderer, camera, 0.0, image); });
  bench.time("rear_image_ms", 1e-3, [&] { rear.measure(renderer, camera, 0.0, image); });
  bench.time("kinect_v2_color_ms", 1e-3, [&] { paint(v2, front_hits); });
  bench.time("rear_color_ms", 1e-3, [&] { paint(rear, rear_hits); });
  // Of one core, as deploy/marvin-pixels.yaml has them: depths of the Kinect at 30 Hz and of the
  // rear camera at 15 Hz, colors of both at 5 Hz; and the same with the Kinect's colors at 30 Hz.
  const auto share = [&](double colors) {
    const auto& ms = bench.metrics();
    return 0.1 * (30.0 * ms.at("kinect_v2_image_ms") + 15.0 * ms.at("rear_image_ms") +
                  colors * ms.at("kinect_v2_color_ms") + 5.0 * ms.at("rear_color_ms"));
  };
  bench.metric("marvin_cameras_core_percent", [&] { return share(5.0); });
  bench.metric("all_colors_core_percent", [&] { return share(30.0); });
  bench.instructions("kinect_v2_image_instructions",
                     [&] { v2.measure(renderer, camera, 0.0, image); });
  bench.target("kinect_v2_image_ms", Bound::kAtMost, 33);
  bench.target("marvin_cameras_core_percent", Bound::kAtMost, 75);  // a quarter is margin
  return bench.run(argc, argv);
}
