#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>

#include "foundation/estimation/pitch_history.hpp"
#include "idl/topics.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/results/result_sheet.hpp"
#include "runtime/dds/observer.hpp"
#include "sensing/depth_pipeline/core/calibration.hpp"
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
  std::uint32_t domain = 0;
  double mount_x = 0.2, axle = 0.235;
  std::string out = "kinect_calibration.yaml";
};

int fail(const std::string& message) {
  std::cerr << "usher calibrate: " << message << "\n";
  return 1;
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
    auto observer = Observer::create({.name = "operator", .domain = domain});
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

Result<std::vector<TiltSample>> sweep_servo(Robot& robot, const Settings& settings) {
  const auto info = robot.info->take(std::chrono::seconds(5));
  if (!info) return Error{"no Kinect: nothing on kinect/depth/camera_info in this domain"};
  const auto intrinsics = wire::from_message(*info);
  if (!intrinsics) return Error{intrinsics.error()};
  TiltSweep::Config config;
  config.mount_x = settings.mount_x;
  config.axle = settings.axle;
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

std::string as_yaml(const KinectCalibration& found) {
  return "# Found by `usher calibrate kinect`; belongs into the robot's file, below `kinect:`.\n"
         "kinect:\n  mount_z: " +
         format("%.4f", found.mount_z) +
         " m\n  mount_z_per_angle: " + format("%.4f", found.mount_z_slope) +
         "\n  servo_gain: " + format("%.5f", found.servo.gain) +
         "\n  servo_offset: " + format("%.5f", found.servo.offset) + " rad\n";
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
  auto robot = Robot::find(settings.domain);
  if (!robot) return fail(robot.error());
  const auto samples = sweep_servo(*robot, settings);
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
            << format("%.1f", 1e3 * found->mount_residual) << " mm\n"
            << as_yaml(*found);
  if (const auto status = write_file(settings.out, as_yaml(*found)); !status)
    return fail(status.error());
  const std::string picture = settings.out + ".png";
  if (const auto status = plot_residuals(*samples, *found, picture); !status)
    return fail(status.error());
  std::cout << "in " << settings.out << ", residuals in " << picture << "\n";
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
  kinect->add_option("--domain", settings->domain, "DDS domain of the robot");
  kinect->add_option("--mount-x", settings->mount_x, "Kinect ahead of the axle [m], by ruler");
  kinect->add_option("--axle", settings->axle, "Height of the axle [m]");
  kinect->add_option("--out", settings->out, "File for the robot's values; FILE.png for the plot");
  kinect->callback([=, &exit_code] { exit_code = calibrate(*settings); });
}

}  // namespace usher::operations
