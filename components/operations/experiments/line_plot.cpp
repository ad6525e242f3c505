#include "operations/experiments/line_plot.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "operations/command_line/table.hpp"

namespace usher::operations {

namespace {

const cv::Scalar kInk(50, 44, 40), kGrid(225, 223, 220);
constexpr int kWidth = 1600, kHeight = 700;                      // [px]
constexpr int kLeft = 90, kRight = 30, kTop = 60, kBottom = 90;  // [px] around the axes
constexpr int kShift = 4;  // fractional bits of OpenCV's coordinates

/// 1, 2 or 5 times a power of ten, about a tenth of the span.
double tick(double span) {
  const double power = std::pow(10.0, std::floor(std::log10(span / 10.0)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (span / (factor * power) <= 10.0) return factor * power;
  }
  return 10.0 * power;
}

struct Axis {
  double low = 0.0, high = 0.0, step = 1.0;

  void cover(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void finish() {
    if (high <= low) high = low + 1.0;
    step = tick(high - low);
    low = std::floor(low / step) * step;
    high = std::ceil(high / step) * step;
  }
  double share(double value) const { return (value - low) / (high - low); }
};

class Plot {
 public:
  Plot(const Axis& x, const Axis& y)
      : x_(x), y_(y), image_(kHeight, kWidth, CV_8UC3, cv::Scalar(255, 255, 255)) {}

  void axes(const std::string& title, const std::string& x_label, const std::string& y_label) {
    for (double x = x_.low; x <= x_.high + x_.step / 2; x += x_.step) {
      const auto at = pixel(x, y_.low);
      cv::line(image_, at, pixel(x, y_.high), kGrid, 1);
      text(format("%g", std::round(x / x_.step) * x_.step), at.x - 14, at.y + 24, 0.5);
    }
    for (double y = y_.low; y <= y_.high + y_.step / 2; y += y_.step) {
      const auto at = pixel(x_.low, y);
      cv::line(image_, at, pixel(x_.high, y), kGrid, 1);
      text(format("%g", std::round(y / y_.step) * y_.step), at.x - 60, at.y + 5, 0.5);
    }
    cv::rectangle(image_, pixel(x_.low, y_.high), pixel(x_.high, y_.low), kInk, 1);
    text(title, 12, 26, 0.75);
    text(y_label, 12, kTop - 14, 0.55);
    text(x_label, kWidth - kRight - 9 * static_cast<int>(x_label.size()), kHeight - kBottom + 46,
         0.55);
  }

  void curve(const Curve& curve) {
    const cv::Scalar color(curve.blue, curve.green, curve.red);
    std::vector<cv::Point> line;  // what is not finite interrupts it
    const auto end_line = [&] {
      cv::polylines(image_, line, false, color, 1, cv::LINE_AA, kShift);
      line.clear();
    };
    for (const auto& [x, y] : curve.points) {
      if (std::isfinite(x) && std::isfinite(y)) {
        line.push_back(fixed(x, y));
      } else {
        end_line();
      }
    }
    end_line();
    if (curve.label.empty()) return;
    const int x = kLeft + entries_++ * 260, y = kHeight - 20;
    cv::line(image_, {x, y - 5}, {x + 30, y - 5}, color, 3, cv::LINE_AA);
    text(curve.label, x + 38, y, 0.55);
  }

  Status save(const std::string& path) const {
    if (!cv::imwrite(path, image_)) return Error{"cannot write " + path};
    return {};
  }

 private:
  cv::Point2d place(double x, double y) const {
    return {kLeft + x_.share(x) * (kWidth - kLeft - kRight),
            kTop + (1.0 - y_.share(y)) * (kHeight - kTop - kBottom)};
  }
  cv::Point pixel(double x, double y) const {
    const auto p = place(x, y);
    return {static_cast<int>(p.x), static_cast<int>(p.y)};
  }
  cv::Point fixed(double x, double y) const {
    const auto p = place(x, y);
    return {static_cast<int>(p.x * (1 << kShift)), static_cast<int>(p.y * (1 << kShift))};
  }
  void text(const std::string& words, int x, int y, double size) {
    cv::putText(image_, words, {x, y}, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
  }

  Axis x_, y_;
  cv::Mat image_;
  int entries_ = 0;  // of the legend
};

}  // namespace

Status draw_plot(const std::vector<Curve>& curves, const std::string& title,
                 const std::string& x_label, const std::string& y_label, const std::string& path) {
  Axis x, y;
  for (const auto& curve : curves) {
    for (const auto& [px, py] : curve.points) {
      if (std::isfinite(px)) x.cover(px);
      if (std::isfinite(py)) y.cover(py);
    }
  }
  x.finish();
  y.finish();
  Plot plot(x, y);
  plot.axes(title, x_label, y_label);
  for (const auto& curve : curves) plot.curve(curve);
  return plot.save(path);
}

}  // namespace usher::operations
