#include "operations/experiments/depth_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "operations/command_line/table.hpp"
#include "operations/experiments/depth_pictures.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/results/result_sheet.hpp"
#include "sensing/depth_pipeline/core/row_limits.hpp"

namespace usher::operations {

namespace {

using depth_pipeline::DepthPipeline;
using depth_pipeline::ThesisMethod;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr geometry::Pose2 kPlace{24.9, 1.6, 0.55};  // in the robotics lab
constexpr double kFarthestDrawn = 8.0;              // [m] of figures 4.15 and 4.19

const cv::Scalar kGrey(130, 130, 130), kOrange(80, 170, 240), kWhite(240, 240, 240),
    kBlueGreen(190, 180, 40), kGreen(120, 230, 120);

/// What table 4.1 is of this place.
struct Interest {
  const char* what;
  Eigen::Vector3d in_world;
};
const std::array<Interest, 6>& interests() {
  static const std::array<Interest, 6> all{{{"Person.", {27.8, 3.2, 1.2}},
                                            {"Chair.", {28.0, 1.6, 0.5}},
                                            {"Island in the middle of the lab.", {28.9, 4.8, 0.5}},
                                            {"Bench along the wall.", {26.6, 0.95, 0.8}},
                                            {"Cabinet beside MARVIN.", {24.7, 4.0, 1.0}},
                                            {"MARVIN's location.", {24.9, 1.6, 0.0}}}};
  return all;
}

/// Everything that the figures show of one image.
struct Shot {
  imaging::DepthImage image;
  DepthPipeline& ours;
  ThesisMethod& thesis;
  depth_pipeline::DepthView view;
};

Status draw_images(const DepthStage& stage, const Shot& shot, const std::string& out) {
  const ThesisMethod& thesis = shot.thesis;
  Status status = save_row({{"4.11 raw depth image", gray_depth(shot.image, kThesisFar)},
                            {"4.12 after threshold and opening", thesis.opened()}},
                           out + "/fig_4_11_4_12.png");
  if (!status) return status;
  const imaging::DepthImage kept{stage.camera().width, stage.camera().height, shot.view.processed};
  return save_row(
      {{"4.17a floor and ceiling", colored_planes(thesis.opened(), thesis.associated())},
       {"4.17b removed, as the thesis does", thesis.processed()},
       {"removed, Usher (16 bit)", gray_depth(kept, kThesisFar)}},
      out + "/fig_4_17.png");
}

Status draw_threshold(const ThesisMethod& thesis, const std::string& out) {
  Curve curve{"threshold t(v) of the thesis' method", 200, 60, 40, {}};
  for (int v = 0; v < 256; ++v) curve.points.emplace_back(v, thesis.threshold(v));
  return draw_plot({curve}, "4.16 distance dependent threshold (our values)", "pixel value",
                   "threshold [values]", out + "/fig_4_16.png");
}

/// Values of the thesis' images in metres.
double depth_of(double value) { return value / 255.0 * kThesisFar; }

/// The ends of what the thesis takes for ground along the ray of a row [m].
std::pair<double, double> ground_band(const ThesisMethod& thesis, std::size_t row) {
  double low = kNone, high = kNone;
  for (int value = 2; value < 255; ++value) {
    if (std::abs(value - thesis.ground()[row]) >= thesis.threshold(value)) continue;
    if (!std::isfinite(low)) low = depth_of(value);
    high = depth_of(value);
  }
  return {low, high};
}

/// Figure 4.15 with the pixels of the column that shows the first point of interest: planes in the
/// camera's frame, what counts as ground and ceiling, and where Usher's obstacles end.
Status draw_column(const DepthStage& stage, const Shot& shot, const std::string& out) {
  const auto lens = stage.camera();
  const auto place = stage.pixel(interests()[0].in_world);
  if (!place) return Error{"the first point of interest is not before the camera"};
  const int column = std::clamp(static_cast<int>(place->x), 0, lens.width - 1);
  depth_pipeline::FloorPrediction limits(lens, shot.ours.config().floor, kFarthestDrawn);
  limits.predict(stage.pose());
  Curve pixels{"pixels", 40, 44, 50, {}}, ground{"ground", 40, 140, 60, {}},
      nearer{"ground, with t(v)", 130, 200, 140, {}}, farther{"", 130, 200, 140, {}},
      ceiling{"ceiling", 40, 90, 200, {}}, ours{"nearer is kept, Usher", 220, 120, 40, {}};
  const auto add = [](Curve& curve, double z, double slope) {
    const bool drawn = z > 0.0 && z <= kFarthestDrawn;
    curve.points.emplace_back(drawn ? z : kNone, drawn ? -slope * z : kNone);
  };
  for (int row = 0; row < lens.height; ++row) {
    const auto index = static_cast<std::size_t>(row);
    const double slope = (row - lens.cy) / lens.fy;
    const auto [low, high] = ground_band(shot.thesis, index);
    add(ground, depth_of(shot.thesis.ground()[index]), slope);
    add(nearer, low, slope);
    add(farther, high, slope);
    add(ceiling, depth_of(shot.thesis.ceiling()[index]), slope);
    add(ours, 1e-3 * limits.rows(0)[row].obstacle, slope);
    const double z = 1e-3 * shot.image.millimeters[static_cast<std::size_t>(row) *
                                                       static_cast<std::size_t>(lens.width) +
                                                   static_cast<std::size_t>(column)];
    if (z <= 0.0 || z > kFarthestDrawn) continue;
    for (const double side : {-0.012, 0.012}) pixels.points.emplace_back(z + side, -slope * z);
    pixels.points.emplace_back(kNone, kNone);
  }
  return draw_plot({nearer, farther, ground, ceiling, ours, pixels},
                   "4.15 ground and ceiling over one column of a rendered image, column " +
                       std::to_string(column) + " (point of interest 1)",
                   "depth z [m]", "y, up [m]", out + "/fig_4_15.png");
}

/// Figure 4.19: a column's smallest value is a depth, a scan tells ranges.
Status draw_ranges(const DepthStage& stage, const Shot& shot, const std::string& out) {
  const auto lens = stage.camera();
  Curve depths{"smallest depth", 40, 90, 200, {}}, ranges{"range of it (4.22)", 40, 140, 60, {}},
      ours{"scan, Usher", 220, 120, 40, {}};
  const auto& scan = shot.thesis.scan();
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double bearing = geometry::degrees(-scan.bearings[i]);
    const bool there = scan.ranges[i] < kFarthestDrawn;
    depths.points.emplace_back(bearing,
                               there ? scan.ranges[i] * std::cos(scan.bearings[i]) : kNone);
    ranges.points.emplace_back(bearing, there ? scan.ranges[i] : kNone);
  }
  const auto& geometry = shot.ours.geometry();
  for (std::size_t i = 0; i < geometry.count; ++i) {
    ours.points.emplace_back(
        geometry::degrees(geometry.angle_min + geometry.increment * static_cast<double>(i)),
        static_cast<double>(shot.view.scan->ranges[i]));
  }
  return draw_plot({depths, ranges, ours},
                   "4.19 from the " + std::to_string(lens.width) + " columns of an image to a scan",
                   "bearing, to the left [deg]", "[m]", out + "/fig_4_19.png");
}

/// Figure 4.20 and table 4.1.
Status draw_output(const DepthStage& stage, const Shot& shot, const std::string& out) {
  std::vector<std::uint8_t> rgb;
  rendering::paint(stage.truth(), rgb);
  cv::Mat color(shot.image.height, shot.image.width, CV_8UC3, rgb.data());
  cv::cvtColor(color, color, cv::COLOR_RGB2BGR);
  const auto& geometry = shot.ours.geometry();
  cv::Mat scans = draw_scans(
      {{"what is there", kGrey, points_of(geometry, stage.nearest(geometry))},
       {"Kinect, as the thesis does", kOrange, points_of(shot.thesis.scan(), 0.99 * kThesisFar)},
       {"laser", kBlueGreen, stage.laser(kPlace)},
       {"Kinect, Usher", kWhite, points_of(geometry, shot.view.scan->ranges)}},
      "grid of 1 m");
  std::vector<Mark> in_picture, in_scans;
  Table table({"", "point of interest"});
  for (const Interest& interest : interests()) {
    const std::string number = std::to_string(in_scans.size() + 1);
    table.add({number, interest.what});
    const geometry::Point2 place = geometry::inverse(kPlace) * interest.in_world.head<2>();
    in_scans.push_back({number, {place.x() - kScanOrigin, place.y()}});
    const auto pixel = stage.pixel(interest.in_world);
    const cv::Rect2d whole(0.0, 0.0, color.cols, color.rows);
    if (pixel && whole.contains(*pixel)) in_picture.push_back({number, *pixel});
  }
  mark_picture(color, in_picture);
  mark_scans(scans, in_scans);
  const Status status =
      save_row({{"4.20a colour image", color}, {"4.20b scans", scans}}, out + "/fig_4_20.png");
  return status ? write_file(out + "/table-4.1.md", table.markdown()) : status;
}

/// Figure 4.21: the pitch jumps, and the fifth and sixth frame are spoilt.
Status draw_filter(DepthStage& stage, const std::string& out) {
  DepthPipeline rated = pipeline_of(stage, 3), plain = pipeline_of(stage, 1);
  for (int frame = 0; frame < 6; ++frame) {
    const bool spoilt = frame >= 4;
    const auto burst = stage.look(kPlace, spoilt ? 0.06 : 0.0, spoilt ? 1.0 : 0.0);
    const auto raw = plain.process(burst, stage.pose()).value();
    const auto filtered = rated.process(burst, stage.pose()).value();
    if (frame < 5) continue;
    const auto& geometry = plain.geometry();
    const auto draw = [&](const char* title, const depth_pipeline::DepthView& shown) {
      return draw_scans(
          {{"what is there", {190, 190, 190}, points_of(geometry, stage.nearest(geometry))},
           {"scan", kGreen, points_of(geometry, shown.scan->ranges)}},
          title);
    };
    return save_row({{"4.21a without", draw("every measurement", raw)},
                     {"4.21b with the confidence filter", draw("confidence from 0.2", filtered)}},
                    out + "/fig_4_21.png");
  }
  return {};
}

}  // namespace

DepthPipeline pipeline_of(const DepthStage& stage, int confidence_frames) {
  depth_pipeline::PipelineConfig config;
  config.origin = kScanOrigin;
  config.confidence_frames = confidence_frames;
  return DepthPipeline::make(stage.camera(), config).value();
}

Status draw_depth_figures(DepthStage& stage, const std::string& out) {
  const auto image = stage.look(kPlace, 0.0, 0.0);
  DepthPipeline ours = pipeline_of(stage, 1);
  ThesisMethod thesis({});
  thesis.process(ThesisMethod::narrow(image, kThesisFar), stage.pose());
  const Shot shot{image, ours, thesis, ours.process(image, stage.pose()).value()};
  Status status = draw_images(stage, shot, out);
  if (status) status = draw_column(stage, shot, out);
  if (status) status = draw_threshold(thesis, out);
  if (status) status = draw_ranges(stage, shot, out);
  if (status) status = draw_output(stage, shot, out);
  return status ? draw_filter(stage, out) : status;
}

}  // namespace usher::operations
