#include <algorithm>
#include <iostream>
#include <limits>
#include <memory>

#include "operations/command_line/commands.hpp"
#include "operations/command_line/table.hpp"
#include "operations/command_line/usage.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/face_study/calibration.hpp"
#include "operations/results/result_sheet.hpp"

namespace usher::operations {

namespace {

using face_detector::FaceDetector;
using face_detector::FaceSample;
using face_detector::FittedModel;
using face_study::FaceCalibration;
using face_study::FaceSamples;

struct Settings {
  std::vector<std::string> recordings;
  std::string cascade = "alt", cascades;
  bool raw = false;
  std::string out = "face_models.yaml";
};

/// Crosses where faces were seen: left-out ones apart.
void add_crosses(const std::vector<FaceSample>& samples, const FittedModel& fit, Curve& used,
                 Curve& left_out) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kWide = 0.8, kHigh = 0.02;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double x = samples[i].size, y = samples[i].depth;
    auto& points = (fit.used[i] ? used : left_out).points;
    points.insert(points.end(), {{x - kWide, y},
                                 {x + kWide, y},
                                 {kNan, kNan},
                                 {x, y - kHigh},
                                 {x, y + kHigh},
                                 {kNan, kNan}});
  }
}

/// Figure 3 of the meeting report.
Status plot(const FaceSamples& samples, const FaceCalibration& found, const std::string& path) {
  Curve center{"middle of the image", 200, 60, 40, {}}, side{"sides", 40, 90, 200, {}};
  Curve center_seen{"faces there", 235, 150, 130, {}}, side_seen{"faces there", 140, 170, 230, {}};
  Curve left_out{"left out", 160, 160, 160, {}};
  add_crosses(samples.center, found.center, center_seen, left_out);
  add_crosses(samples.side, found.side, side_seen, left_out);
  for (auto [model, curve] :
       {std::pair{&found.center.model, &center}, std::pair{&found.side.model, &side}}) {
    const int steps = static_cast<int>(2.0 * (model->most - model->least));
    for (int i = 0; i <= steps; ++i) {
      const double size = model->least + 0.5 * i;
      curve->points.emplace_back(size, model->depth(size));
    }
  }
  return draw_plot({center_seen, side_seen, left_out, center, side},
                   "Depth model: how far away a face of some size is", "size of the face [pixels]",
                   "depth [m]", path);
}

void print(const char* where, const std::vector<FaceSample>& samples, const FittedModel& fit) {
  std::cout << where << ": " << std::count(fit.used.begin(), fit.used.end(), true) << " of "
            << samples.size() << " faces used, " << format("%.0f", fit.model.least) << " to "
            << format("%.0f", fit.model.most) << " pixels, depth to "
            << format("%.1f", 100.0 * fit.residual) << " % (at worst "
            << format("%.1f", 100.0 * fit.worst) << " %)\n";
}

int calibrate(const Settings& settings) {
  auto anywhere =
      FaceDetector::make(face_detector::cascade_file(settings.cascade, settings.cascades), {});
  if (!anywhere) return fail(anywhere.error());
  FaceSamples samples;
  for (const std::string& folder : settings.recordings) {
    const auto recording = kinect::Recording::open(
        folder, settings.raw ? kinect::Values::kRaw11 : kinect::Values::kMillimeters);
    if (!recording) return fail(recording.error());
    const auto status = add_samples(*recording, *anywhere, samples, [&](std::size_t i) {
      std::cerr << "\r" << folder << ": " << i + 1 << " of " << recording->size() << std::flush;
    });
    std::cerr << "\n";
    if (!status) return fail(status.error());
  }
  const auto found = fit_models(samples);
  if (!found) return fail("refused: " + found.error());
  print("middle of the image", samples.center, found->center);
  print("sides", samples.side, found->side);
  std::cout << as_yaml(*found);
  if (const auto status = write_file(settings.out, as_yaml(*found)); !status)
    return fail(status.error());
  const std::string picture = settings.out + ".png";
  if (const auto status = plot(samples, *found, picture); !status) return fail(status.error());
  std::cout << "in " << settings.out << ", curves in " << picture << "\n";
  return 0;
}

}  // namespace

void add_calibrate_faces(CLI::App& calibrate_command, int& exit_code) {
  auto settings = std::make_shared<Settings>();
  auto* faces = calibrate_command.add_subcommand(
      "faces",
      "Fits how far away a face of some size is, from recordings of people who step back from "
      "0.3 to 3.5 m, in the middle of the image and at its sides");
  faces
      ->add_option(
          "recordings", settings->recordings,
          "Folders of libfreenect's fakenect-record (with --raw), or NAME.pgm with NAME.ppm")
      ->required();
  faces->add_option("--cascade", settings->cascade, "The one that the robot uses")
      ->check(CLI::IsMember(face_detector::cascade_names()));
  faces->add_option("--cascades", settings->cascades, "Folder with haarcascades and lbpcascades");
  faces->add_flag(
      "--raw", settings->raw,
      "The depth images hold 11-bit values of the device, as fakenect-record writes them");
  faces->add_option("--out", settings->out, "File for the robot's values; FILE.png for the plot");
  faces->callback([=, &exit_code] { exit_code = calibrate(*settings); });
}

}  // namespace usher::operations
