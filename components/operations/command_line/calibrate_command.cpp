#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>

#include "foundation/estimation/pitch_history.hpp"
#include "idl/topics.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/table.hpp"
#include "operations/command_line/usage.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/manifest/robot_file.hpp"
#include "runtime/dds/observer.hpp"
#include "runtime/parameters/parameter_set.hpp"
#include "sensing/depth_pipeline/core/calibration.hpp"
#include "sensing/depth_pipeline/shell/parameters.hpp"
#include "wire/conversions.hpp"
#include "wire/images.hpp"

namespace usher::operations {

namespace {

using depth_pipeline::KinectCalibration;
using depth_pipeline::TiltSample;
using depth_pipeline::TiltSweep;
using runtime::Observer;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr auto kRepeat = milliseconds(500);
constexpr auto kSilence = std::chrono::seconds(5);
constexpr double kFar = 12.0;  // [m] of an 8-bit image
constexpr double kDegree = geometry::kPi / 180.0;

struct Settings {
  std::optional<std::uint32_t> domain;
  std::string robot = Installation::of_this_program().share + "/config/robots/marvin.yaml";
  bool write = false;
  std::string plot = "kinect_calibration.png";
};

/// Where the robot's file has the camera and the axle; equations 4.26 and 4.27 need both.
Result<depth_pipeline::Mount> read_mount(const std::string& path) {
  auto values = runtime::flatten_file(path);
  if (!values) return Error{values.error()};
  for (auto& value : *values) value.name = "robot." + value.name;
  runtime::ParameterSet parameters(std::move(values).value(), path);
  const auto mount =
      depth_pipeline::read_kinect_mount(parameters, depth_pipeline::read_axle(parameters));
  if (const auto status = parameters.finish(false); !status) return Error{status.error()};
  return mount;
}

/// Everything that the sweep reads and writes of a running robot.
struct Robot {
  std::unique_ptr<Observer> observer;
  std::optional<Observer::Reader<sensor_msgs::msg::Image>> images;
  std::optional<Observer::Reader<sensor_msgs::msg::CameraInfo>> info;
  std::optional<Observer::Reader<usher_msgs::msg::CameraTilt>> tilt;
  std::optional<Observer::Reader<usher_msgs::msg::BaseStatus>> base;
  std::optional<Observer::Writer<usher_msgs::msg::CameraTilt>> request;

  static Result<Robot> find(std::uint32_t domain) {
    Robot robot;
    auto observer = Observer::create(reach_robot("operator", domain));
    if (!observer) return Error{observer.error()};
    robot.observer = std::move(observer).value();
    Status status;
    const auto keep = [&](auto made, auto& port) {
      if (made) {
        port = std::move(made).value();
      } else {
        status = Error{made.error()};
      }
    };
    keep(robot.observer->reader(topics::kKinectDepth), robot.images);
    keep(robot.observer->reader(topics::kKinectInfo), robot.info);
    keep(robot.observer->reader(topics::kKinectTilt), robot.tilt);
    keep(robot.observer->reader(topics::kBaseStatus), robot.base);
    keep(robot.observer->writer(topics::kKinectTiltRequest), robot.request);
    if (!status) return Error{status.error()};
    return robot;
  }
};

Result<std::vector<TiltSample>> sweep_servo(Robot& robot, const depth_pipeline::Mount& mount) {
  const auto info = robot.info->take(std::chrono::seconds(5));
  if (!info) return Error{"no Kinect: nothing on kinect/depth/camera_info in this domain"};
  const auto intrinsics = wire::from_message(*info);
  if (!intrinsics) return Error{intrinsics.error()};
  TiltSweep::Config config;
  config.mount_x = mount.x;
  config.axle = mount.axle;
  TiltSweep sweep(*intrinsics, config);

  estimation::PitchHistory pitch(milliseconds(50));
  double servo = std::nan("");
  std::vector<std::uint16_t> millimeters;
  std::string complaint;
  auto asked = steady_clock::time_point{};
  auto heard = steady_clock::now();
  while (!sweep.done()) {
    if (steady_clock::now() - asked > kRepeat) {
      usher_msgs::msg::CameraTilt request;
      request.header(wire::header(robot.observer->now(), "base_link"));
      request.servo(sweep.wanted());
      robot.request->write(request);
      asked = steady_clock::now();
    }
    if (const auto tilt = robot.tilt->take(milliseconds(0))) servo = tilt->servo();
    const auto image = robot.images->take(milliseconds(20));
    while (const auto status = robot.base->take(milliseconds(0))) {
      const auto stamp = wire::from_message(status->header().stamp()).time_since_epoch();
      if (!pitch.add(stamp, {status->pitch(), status->pitch_rate()})) continue;
    }
    if (!image) {
      if (steady_clock::now() - heard > kSilence)
        return Error{"no depth images or no pitch for 5 s"};
      continue;
    }
    const auto lean = pitch.at(wire::from_message(image->header().stamp()).time_since_epoch());
    const auto depth = wire::depth_image(*image, kFar, millimeters);
    if (!depth) return Error{depth.error()};
    if (!lean) continue;
    heard = steady_clock::now();
    sweep.take(*depth, servo, lean->angle);
    if (!sweep.complaint().empty() && sweep.complaint() != complaint) {
      complaint = sweep.complaint();
      std::cerr << "\n" << complaint << "\n";
    }
    std::cerr << "\r" << format("%3.0f", 100.0 * sweep.progress()) << " %  " << std::flush;
  }
  std::cerr << "\n";
  return sweep.samples();
}

FileValues values_of(const KinectCalibration& found) {
  return {{"mount_z", format("%.4f m", found.mount_z)},
          {"mount_z_per_angle", format("%.4f", found.mount_z_slope)},
          {"servo_gain", format("%.5f", found.servo.gain)},
          {"servo_offset", format("%.5f rad", found.servo.offset)}};
}

Status plot_residuals(const std::vector<TiltSample>& samples, const KinectCalibration& found,
                      const std::string& path) {
  Curve angle{"angle [0.01 deg]", 200, 60, 40, {}}, height{"height [mm]", 40, 90, 200, {}};
  for (const TiltSample& s : samples) {
    const double servo = s.servo / kDegree;
    angle.points.emplace_back(servo, 100.0 * (s.angle - found.servo.angle_of(s.servo)) / kDegree);
    height.points.emplace_back(servo,
                               1e3 * (s.mount_z - found.mount_z - found.mount_z_slope * s.angle));
  }
  return draw_plot({angle, height}, "Kinect calibration: residuals of each tilt position",
                   "servo [deg]", "residual", path);
}

int calibrate(const Settings& settings) {
  const auto mount = read_mount(settings.robot);
  if (!mount) return fail(mount.error());
  std::cout << settings.robot << ": Kinect " << format("%.4f", mount->x)
            << " m ahead of the axle, axle " << format("%.4f", mount->axle)
            << " m above the floor; so far the Kinect " << format("%.4f", mount->z)
            << " m above the axle\n";
  auto robot = Robot::find(meant_domain(settings.domain));
  if (!robot) return fail(robot.error());
  const auto samples = sweep_servo(*robot, *mount);
  if (!samples) return fail(samples.error());
  const auto found = depth_pipeline::fit_calibration(*samples);
  if (!found) return fail("refused: " + found.error());
  for (std::size_t i = 0; i < samples->size(); ++i) {
    const TiltSample& s = (*samples)[i];
    std::cout << "servo " << format("%6.2f", s.servo / kDegree) << " deg: camera "
              << format("%6.2f", s.angle / kDegree) << " deg, " << format("%.4f", s.mount_z)
              << " m above the axle, floor to " << format("%.1f", 1e3 * s.residual) << " mm"
              << (found->used[i] ? "" : "  left out") << "\n";
  }
  std::cout << "residuals " << format("%.3f", found->angle_residual / kDegree) << " deg, "
            << format("%.1f", 1e3 * found->mount_residual) << " mm, plotted in " << settings.plot
            << "\nkinect:\n";
  for (const auto& [key, value] : values_of(*found))
    std::cout << "  " << key << ": " << value << "\n";
  if (const auto status = plot_residuals(*samples, *found, settings.plot); !status)
    return fail(status.error());
  if (!settings.write) {
    std::cout << "nothing written: --write puts these into " << settings.robot << "\n";
    return 0;
  }
  if (const auto status = set_values(settings.robot, "kinect", values_of(*found)); !status)
    return fail(status.error());
  std::cout << "written to " << settings.robot << "\n";
  return 0;
}

}  // namespace

void add_calibrate_command(CLI::App& app, int& exit_code) {
  auto settings = std::make_shared<Settings>();
  auto* command =
      app.add_subcommand("calibrate", "Measures mounts and models: usher calibrate kinect | faces");
  auto* kinect = command->add_subcommand(
      "kinect",
      "Sweeps the tilt servo of a standing robot over free floor, fits mount height and angle");
  add_calibrate_faces(*command, exit_code);
  command->require_subcommand(1);
  add_domain_option(*kinect, settings->domain);
  kinect
      ->add_option("--robot", settings->robot,
                   "The robot's file: kinect.mount_x and wheel_radius are taken from it")
      ->capture_default_str();
  kinect->add_flag("--write", settings->write,
                   "Puts the result into the robot's file; its comments and other keys stay");
  kinect->add_option("--plot", settings->plot, "Picture of the residuals")->capture_default_str();
  kinect->callback([=, &exit_code] { exit_code = calibrate(*settings); });
}

}  // namespace usher::operations
