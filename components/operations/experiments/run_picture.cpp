#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "operations/experiments/run_record.hpp"

namespace usher::operations {

namespace {

const cv::Scalar kWall(70, 62, 58), kFloor(250, 250, 248), kOutside(228, 226, 224),
    kText(50, 44, 40);
const cv::Scalar kPlan(214, 140, 40), kDriven(70, 150, 30), kPeople(90, 150, 240),
    kStart(160, 120, 40), kGoal(50, 40, 210);
constexpr int kLegend = 56;      // [px] below the map
constexpr int kTitle = 44;       // [px] above it
constexpr double kWidth = 1600;  // [px] aimed at
constexpr int kShift = 4;        // fractional bits of OpenCV's coordinates

class Picture {
 public:
  Picture(const grid::OccupancyGrid& map, const std::string& title) : map_(map) {
    find_crop();
    scale_ = std::clamp(kWidth / (x1_ - x0_), 1.0, 16.0);
    const int width = std::max(640, static_cast<int>((x1_ - x0_) * scale_));
    const int height = static_cast<int>((y1_ - y0_) * scale_);
    image_ = cv::Mat(height + kTitle + kLegend, width, CV_8UC3, cv::Scalar(255, 255, 255));
    draw_map();
    text(title, 12, 30, 0.8, kText);
  }

  void way(const std::vector<geometry::Point2>& points, const cv::Scalar& color, int thickness) {
    std::vector<cv::Point> line;
    line.reserve(points.size());
    for (const auto& point : points) line.push_back(fixed(point));
    cv::polylines(image_, line, false, color, thickness, cv::LINE_AA, kShift);
  }

  void heat(const grid::Grid<std::uint32_t>& looks) {
    std::vector<std::uint32_t> counts;
    for (const std::uint32_t count : looks) {
      if (count > 0) counts.push_back(count);
    }
    if (counts.empty()) return;
    const auto most = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() * 19 / 20);
    std::nth_element(counts.begin(), most, counts.end());
    const int rows = y1_ - y0_, columns = x1_ - x0_;
    cv::Mat warmth(rows, columns, CV_8U), colors;
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x)
        warmth.at<uchar>(rows - 1 - y, x) =
            cv::saturate_cast<uchar>(255.0 * looks.at({x0_ + x, y0_ + y}) / *most);
    }
    cv::applyColorMap(warmth, colors, cv::COLORMAP_JET);
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        if (looks.at({x0_ + x, y0_ + y}) == 0) continue;
        const geometry::Point2 low(map_.geometry().origin_x + (x0_ + x) * map_.resolution(),
                                   map_.geometry().origin_y + (y0_ + y) * map_.resolution());
        const cv::Point a = pixel(low);
        const cv::Point b = pixel({low.x() + map_.resolution(), low.y() + map_.resolution()});
        cv::rectangle(image_, cv::Rect(a.x, b.y, b.x - a.x, a.y - b.y),
                      cv::Scalar(colors.at<cv::Vec3b>(rows - 1 - y, x)), cv::FILLED);
      }
    }
  }

  void mark(const geometry::Pose2& pose, const cv::Scalar& color, const std::string& label) {
    const double length = 0.5;
    const geometry::Point2 tip = pose * geometry::Point2(length, 0.0);
    cv::circle(image_, fixed(pose.position()),
               static_cast<int>(0.22 / map_.resolution() * scale_ * (1 << kShift)), color,
               cv::FILLED, cv::LINE_AA, kShift);
    cv::line(image_, fixed(pose.position()), fixed(tip), color, 3, cv::LINE_AA, kShift);
    const cv::Point at = pixel(pose.position());
    text(label, at.x + 12, at.y - 10, 0.6, color);
  }

  void dot(const geometry::Point2& point, const cv::Scalar& color) {
    cv::circle(image_, fixed(point),
               static_cast<int>(0.2 / map_.resolution() * scale_ * (1 << kShift)), color,
               cv::FILLED, cv::LINE_AA, kShift);
  }

  void legend(const std::vector<std::pair<std::string, cv::Scalar>>& entries) {
    int x = 12;
    const int y = image_.rows - 22;
    for (const auto& [label, color] : entries) {
      cv::line(image_, {x, y - 5}, {x + 30, y - 5}, color, 4, cv::LINE_AA);
      text(label, x + 38, y, 0.55, kText);
      x += 62 + 10 * static_cast<int>(label.size());
    }
    const int bar = static_cast<int>(5.0 / map_.resolution() * scale_);
    cv::line(image_, {image_.cols - bar - 20, y - 5}, {image_.cols - 20, y - 5}, kText, 2,
             cv::LINE_AA);
    text("5 m", image_.cols - bar - 70, y, 0.55, kText);
  }

  Status save(const std::string& path) const {
    if (!cv::imwrite(path, image_)) return Error{"cannot write " + path};
    return {};
  }

 private:
  /// The part of the map that is not unknown, and a margin.
  void find_crop() {
    int left = map_.width(), right = 0, bottom = map_.height(), top = 0;
    for (int y = 0; y < map_.height(); ++y) {
      for (int x = 0; x < map_.width(); ++x) {
        if (map_.at({x, y}) == grid::kUnknown) continue;
        left = std::min(left, x), right = std::max(right, x + 1);
        bottom = std::min(bottom, y), top = std::max(top, y + 1);
      }
    }
    if (right <= left) left = 0, right = map_.width(), bottom = 0, top = map_.height();
    x0_ = std::max(0, left - 8), x1_ = std::min(map_.width(), right + 8);
    y0_ = std::max(0, bottom - 8), y1_ = std::min(map_.height(), top + 8);
  }

  void draw_map() {
    const int rows = y1_ - y0_;
    cv::Mat cells(rows, x1_ - x0_, CV_8UC3);
    for (int y = 0; y < rows; ++y) {
      for (int x = x0_; x < x1_; ++x) {
        const auto value = map_.at({x, y0_ + y});
        const auto& color = value == grid::kUnknown ? kOutside : value >= 65 ? kWall : kFloor;
        cells.at<cv::Vec3b>(rows - 1 - y, x - x0_) =
            cv::Vec3b(cv::saturate_cast<uchar>(color[0]), cv::saturate_cast<uchar>(color[1]),
                      cv::saturate_cast<uchar>(color[2]));
      }
    }
    cv::Mat scaled;
    cv::resize(cells, scaled,
               {static_cast<int>(cells.cols * scale_), static_cast<int>(cells.rows * scale_)}, 0, 0,
               cv::INTER_NEAREST);
    scaled.copyTo(image_(cv::Rect(0, kTitle, std::min(scaled.cols, image_.cols),
                                  std::min(scaled.rows, image_.rows - kTitle))));
  }

  cv::Point2d place(const geometry::Point2& point) const {
    const auto& g = map_.geometry();
    return {((point.x() - g.origin_x) / g.resolution - x0_) * scale_,
            kTitle + (y1_ - (point.y() - g.origin_y) / g.resolution) * scale_};
  }
  cv::Point pixel(const geometry::Point2& point) const {
    const auto p = place(point);
    return {static_cast<int>(p.x), static_cast<int>(p.y)};
  }
  cv::Point fixed(const geometry::Point2& point) const {
    const auto p = place(point);
    return {static_cast<int>(p.x * (1 << kShift)), static_cast<int>(p.y * (1 << kShift))};
  }
  void text(const std::string& words, int x, int y, double size, const cv::Scalar& color) {
    cv::putText(image_, words, {x, y}, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar(255, 255, 255), 4,
                cv::LINE_AA);
    cv::putText(image_, words, {x, y}, cv::FONT_HERSHEY_SIMPLEX, size, color, 1, cv::LINE_AA);
  }

  const grid::OccupancyGrid& map_;
  int x0_ = 0, x1_ = 0, y0_ = 0, y1_ = 0;  // [cells] shown
  double scale_ = 1.0;                     // [px] per cell
  cv::Mat image_;
};

}  // namespace

Status draw_run(const RunRecord& record, const grid::OccupancyGrid& map, const std::string& title,
                const std::string& path) {
  Picture picture(map, title);
  for (const auto& [id, way] : record.people()) {
    picture.way(way, kPeople, 1);
    if (!way.empty()) picture.dot(way.back(), kPeople);
  }
  for (const auto& plan : record.plans()) picture.way(plan, kPlan, 2);
  std::vector<geometry::Point2> driven;
  for (const auto& sample : record.samples()) driven.push_back(sample.truth.position());
  picture.way(driven, kDriven, 3);
  if (!record.samples().empty()) picture.mark(record.samples().front().truth, kStart, "start");
  if (record.navigation() && !record.navigation()->location().empty()) {
    const auto& goal = record.navigation()->goal().pose().position();
    picture.mark({goal.x(), goal.y(), record.truth() ? record.truth()->yaw : 0.0}, kGoal,
                 record.navigation()->location());
  }
  picture.legend({{"planned", kPlan}, {"driven", kDriven}, {"people", kPeople}});
  return picture.save(path);
}

Status draw_runs(const std::vector<RunRecord>& runs, const grid::OccupancyGrid& map,
                 const std::string& title, const std::string& path) {
  using namespace usher_msgs::msg::GoalStatus_Constants;
  Picture picture(map, title);
  for (const auto& run : runs) {
    for (const auto& plan : run.plans()) picture.way(plan, kPlan, 1);
  }
  for (const auto& run : runs) {
    std::vector<geometry::Point2> driven;
    for (const auto& sample : run.samples()) driven.push_back(sample.truth.position());
    picture.way(driven, kDriven, 2);
  }
  if (!runs.empty() && !runs.front().samples().empty())
    picture.mark(runs.front().samples().front().truth, kStart, "start");
  for (const auto& run : runs) {
    if (!run.navigation()) continue;
    const auto& status = *run.navigation();
    const auto& goal = status.goal().pose().position();
    const bool reached = status.state() == STATE_SUCCEEDED;
    picture.mark({goal.x(), goal.y(), run.truth() ? run.truth()->yaw : 0.0},
                 reached ? kDriven : kGoal, status.location() + (reached ? "" : " not reached"));
  }
  picture.legend({{"planned", kPlan}, {"driven", kDriven}, {"not reached", kGoal}});
  return picture.save(path);
}

void DrawnWay::paint(std::uint64_t number) {
  constexpr std::array<std::array<int, 3>, 6> kColors{{{40, 100, 190},
                                                       {200, 60, 50},
                                                       {60, 150, 80},
                                                       {150, 90, 170},
                                                       {210, 150, 40},
                                                       {40, 150, 160}}};
  const auto& color = kColors[number % kColors.size()];
  red = color[0], green = color[1], blue = color[2];
}

Status draw_ways(const std::vector<DrawnWay>& ways, const grid::OccupancyGrid& map,
                 const std::string& title, const std::string& path) {
  Picture picture(map, title);
  std::vector<std::pair<std::string, cv::Scalar>> entries;
  for (const auto& way : ways) {
    const cv::Scalar color(way.blue, way.green, way.red);
    picture.way(way.points, color, way.thickness);
    if (!way.label.empty()) entries.emplace_back(way.label, color);
  }
  picture.legend(entries);
  return picture.save(path);
}

Status draw_heat_map(const grid::OccupancyGrid& map, const grid::Grid<std::uint32_t>& looks,
                     const std::vector<geometry::Point2>& way, const std::string& title,
                     const std::string& path) {
  const cv::Scalar pink(200, 90, 255), black(0, 0, 0);
  Picture picture(map, title);
  picture.heat(looks);
  picture.way(way, black, 2);
  if (!way.empty()) picture.dot(way.front(), pink);
  picture.legend({{"start", pink},
                  {"driven", black},
                  {"seldom", cv::Scalar(255, 60, 0)},
                  {"often", cv::Scalar(0, 0, 200)}});
  return picture.save(path);
}

}  // namespace usher::operations
