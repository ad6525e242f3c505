#include "sensing/depth_pipeline/core/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "foundation/random/random.hpp"

namespace usher::depth_pipeline {

namespace {

constexpr int kHalfBand = 24;  // columns on either side of the middle
constexpr int kColumnStep = 4;
constexpr int kRansacTries = 200;
constexpr double kFloorBand = 0.03;  // [m] of height, RANSAC
constexpr double kFineBand = 0.012;  // [m] of height, least squares
constexpr double kReach = 5.0;       // [m] floor farther away is not used
constexpr int kLeastSamples = 400;
constexpr double kLeastShare = 0.15;
constexpr double kMostResidual = 0.012;  // [m]
constexpr double kNearFloor = 0.15;      // [m] of height; what is higher or lower is none
constexpr double kSteepest = 0.5;        // slope of a floor; what is steeper is a wall's foot
constexpr std::size_t kSlopeRows = 3;    // to either side, for the slope
constexpr std::size_t kLeastPositions = 5;
constexpr double kLeastSweep = 0.1745;  // [rad] 10 deg
constexpr double kAngleBand = 0.006;    // [rad] off the line of angles
constexpr double kHeightBand = 0.012;   // [m] off the line of heights
constexpr double kServoStill = 0.004;   // [rad]

struct Line {
  double a = 0.0, b = 0.0;  // y = a + b x
};

struct Point {
  double x, y;
};

std::optional<Line> least_squares(const std::vector<Point>& points) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const Point& p : points) n += 1, x += p.x, y += p.y, xx += p.x * p.x, xy += p.x * p.y;
  const double determinant = n * xx - x * x;
  if (points.size() < 2 || determinant < 1e-12) return std::nullopt;
  const double b = (n * xy - x * y) / determinant;
  return Line{(y - b * x) / n, b};
}

/// The line that most points lie on; `off(line, point)` is how far one lies off it, in bands.
template <class Off>
std::optional<Line> ransac(const std::vector<Point>& points, Off&& off) {
  if (points.size() < 2) return std::nullopt;
  Random random(17);
  std::optional<Line> best;
  std::size_t most = 0;
  for (int i = 0; i < kRansacTries; ++i) {
    const Point& p = points[random.below(points.size())];
    const Point& q = points[random.below(points.size())];
    if (std::abs(p.x - q.x) < 1e-9) continue;
    const double b = (q.y - p.y) / (q.x - p.x);
    const Line line{p.y - b * p.x, b};
    const auto on = static_cast<std::size_t>(std::count_if(
        points.begin(), points.end(), [&](const Point& r) { return off(line, r) <= 1.0; }));
    if (on > most) most = on, best = line;
  }
  return best;
}

template <class Off>
std::vector<Point> points_on(const Line& line, const std::vector<Point>& points, Off&& off) {
  std::vector<Point> on;
  std::copy_if(points.begin(), points.end(), std::back_inserter(on),
               [&](const Point& p) { return off(line, p) <= 1.0; });
  return on;
}

/// The floor's line as inverse depth over the tangent of the row: 1/z = a + b y'.
FloorLine floor_of(const Line& line) {
  FloorLine floor;
  const double m = -line.a / line.b;
  floor.down = -std::atan(m);
  floor.height = std::cos(floor.down) / line.b;  // c = 1 / b
  return floor;
}

/// Height over the floor's line of a pixel (y', 1/z).
double height_over(const Line& line, const Point& p) {
  return (p.y - line.a - line.b * p.x) / (p.y * std::hypot(line.a, line.b));
}

/// Way along the floor's line to below or above that pixel.
double way_along(const Line& line, const Point& p) {
  return (line.b - line.a * p.x) / (p.y * std::hypot(line.a, line.b));
}

/// [m] Root mean square height of all that could be floor: near the line, and not as steep as the
/// foot of a wall. What the line was fitted to is even by choice. Of each row the middle pixel
/// counts, so that neither noise nor the leg of a chair does. `points` come row by row from the
/// top.
double unevenness(const Line& line, std::vector<Point> points) {
  std::vector<Point> profile;  // way along the floor, height over it
  for (auto row = points.begin(); row != points.end();) {
    const auto end =
        std::find_if(row, points.end(), [y = row->x](const Point& p) { return p.x != y; });
    const auto middle = row + (end - row) / 2;
    std::nth_element(row, middle, end, [](const Point& p, const Point& q) { return p.y < q.y; });
    profile.push_back({way_along(line, *middle), height_over(line, *middle)});
    row = end;
  }
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t i = kSlopeRows; i + kSlopeRows < profile.size(); ++i) {
    const Point& beyond = profile[i - kSlopeRows];
    const Point& before = profile[i + kSlopeRows];
    const double height = profile[i].y;
    const bool steep = std::abs(beyond.y - before.y) > kSteepest * (beyond.x - before.x);
    if (steep || std::abs(height) > kNearFloor) continue;
    squares += height * height;
    ++count;
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
}

std::string degrees(double angle) { return std::to_string(angle * 180.0 / geometry::kPi) + " deg"; }

}  // namespace

Result<FloorLine> find_floor_line(const DepthImage& image, const Intrinsics& intrinsics) {
  if (image.width != intrinsics.width || image.height != intrinsics.height)
    return Error{"the image's size is not the camera's"};
  std::vector<Point> points;
  const int middle = static_cast<int>(intrinsics.cx);
  for (int row = 0; row < image.height; ++row) {
    const auto* line = image.millimeters.data() + static_cast<std::ptrdiff_t>(row) * image.width;
    for (int column = std::max(0, middle - kHalfBand);
         column <= std::min(image.width - 1, middle + kHalfBand); column += kColumnStep) {
      if (line[column] == 0 || 1e-3 * line[column] > kReach) continue;
      points.push_back({(row - intrinsics.cy) / intrinsics.fy, 1e3 / line[column]});
    }
  }
  if (points.size() < kLeastSamples)
    return Error{"only " + std::to_string(points.size()) +
                 " pixels of the central columns measured"};
  const auto within = [](double band) {
    return [band](const Line& line, const Point& p) {
      // A floor lies below the camera: inverse depth rises with the row.
      if (line.b <= 0.2) return 2.0;
      return std::abs(height_over(line, p)) / band;
    };
  };
  auto line = ransac(points, within(kFloorBand));
  if (!line || line->b <= 0.2) return Error{"no floor in the central columns"};
  std::vector<Point> on;
  for (const double band : {kFloorBand, kFineBand, kFineBand}) {
    on = points_on(*line, points, within(band));
    line = least_squares(on);
    if (!line || line->b <= 0.2) return Error{"no floor in the central columns"};
  }
  FloorLine floor = floor_of(*line);
  floor.samples = static_cast<int>(on.size());
  floor.share = static_cast<double>(on.size()) / static_cast<double>(points.size());
  if (floor.samples < kLeastSamples || floor.share < kLeastShare) {
    return Error{"only " + std::to_string(floor.samples) + " of " + std::to_string(points.size()) +
                 " pixels lie on one floor: clear the space before the robot"};
  }
  floor.residual = unevenness(*line, std::move(points));
  if (floor.residual > kMostResidual)
    return Error{"the floor is uneven by " + std::to_string(floor.residual) + " m"};
  return floor;
}

Result<KinectCalibration> fit_calibration(const std::vector<TiltSample>& samples) {
  if (samples.size() < kLeastPositions) {
    return Error{"the floor was measured at " + std::to_string(samples.size()) +
                 " tilt positions, expected at least " + std::to_string(kLeastPositions)};
  }
  std::vector<Point> angles, heights;
  double low = 1e9, high = -1e9;
  for (const TiltSample& s : samples) {
    angles.push_back({s.angle, s.servo});
    heights.push_back({s.angle, s.mount_z});
    low = std::min(low, s.servo);
    high = std::max(high, s.servo);
  }
  if (high - low < kLeastSweep)
    return Error{"the servo moved by " + degrees(high - low) + ", expected at least 10 deg"};
  const auto off_angle = [](const Line& line, const Point& p) {
    return std::abs(p.y - line.a - line.b * p.x) / kAngleBand;
  };
  const auto off_height = [](const Line& line, const Point& p) {
    return std::abs(p.y - line.a - line.b * p.x) / kHeightBand;
  };
  auto angle_line = ransac(angles, off_angle);
  if (angle_line) angle_line = least_squares(points_on(*angle_line, angles, off_angle));
  // A position whose angle is wrong says nothing of the height over the angle.
  std::vector<Point> trusted;
  for (std::size_t i = 0; angle_line && i < samples.size(); ++i) {
    if (off_angle(*angle_line, angles[i]) <= 1.0) trusted.push_back(heights[i]);
  }
  auto height_line = ransac(trusted, off_height);
  if (height_line) height_line = least_squares(points_on(*height_line, trusted, off_height));
  if (!angle_line || !height_line) return Error{"the positions lie on no line"};

  KinectCalibration calibration;
  calibration.servo = {angle_line->b, angle_line->a};
  calibration.mount_z = height_line->a;
  calibration.mount_z_slope = height_line->b;
  std::size_t count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double angle = angles[i].y - angle_line->a - angle_line->b * angles[i].x;
    const double height = heights[i].y - height_line->a - height_line->b * heights[i].x;
    const bool used = std::abs(angle) <= kAngleBand && std::abs(height) <= kHeightBand;
    calibration.used.push_back(used);
    if (!used) continue;
    ++count;
    calibration.angle_residual += angle * angle;
    calibration.mount_residual += height * height;
  }
  if (3 * count < 2 * samples.size()) {
    return Error{
        "only " + std::to_string(count) + " of " + std::to_string(samples.size()) +
        " tilt positions lie on one line: does the servo slip, does the robot stand still?"};
  }
  calibration.angle_residual = std::sqrt(calibration.angle_residual / static_cast<double>(count));
  calibration.mount_residual = std::sqrt(calibration.mount_residual / static_cast<double>(count));
  using Servo = kinematics::TiltServo;
  if (!(calibration.servo.gain >= Servo::kLeastGain &&
        calibration.servo.gain <= Servo::kMostGain) ||
      !(std::abs(calibration.servo.offset) <= Servo::kMostOffset)) {
    return Error{"no servo has a gain of " + std::to_string(calibration.servo.gain) +
                 " and an offset of " + degrees(calibration.servo.offset)};
  }
  if (!(calibration.mount_z > 0.05 && calibration.mount_z < 2.5) ||
      !(std::abs(calibration.mount_z_slope) <= 0.3)) {
    return Error{"no camera sits " + std::to_string(calibration.mount_z) + " m above the axle"};
  }
  return calibration;
}

TiltSweep::TiltSweep(const Intrinsics& intrinsics, const Config& config)
    : intrinsics_(intrinsics), config_(config) {}

double TiltSweep::wanted() const {
  const int position = std::min(position_, config_.positions - 1);
  return config_.first + (config_.last - config_.first) * position / (config_.positions - 1);
}

double TiltSweep::progress() const {
  return static_cast<double>(position_) / static_cast<double>(config_.positions);
}

void TiltSweep::take(const DepthImage& image, double servo, double pitch) {
  if (done() || !std::isfinite(pitch)) return;
  if (!(std::abs(servo - wanted()) <= kServoStill)) {
    waited_ = 0;
    if (++tried_ >= config_.patience) {
      complaint_ =
          "the servo does not reach " + degrees(wanted()) + ", it stands at " + degrees(servo);
      finish_position();
    }
    return;
  }
  if (++waited_ <= config_.settling) return;
  const auto floor = find_floor_line(image, intrinsics_);
  if (!floor) {
    if (++tried_ >= config_.patience) {
      complaint_ = "at " + degrees(wanted()) + ": " + floor.error();
      finish_position();
    }
    return;
  }
  TiltSample sample;
  sample.servo = servo;
  sample.angle = pitch - floor->down;                                 // 4.25
  sample.mount_z = std::tan(pitch) * config_.mount_x +                // 4.26
                   (floor->height - config_.axle) / std::cos(pitch);  // 4.27
  sample.residual = floor->residual;
  single_.push_back(sample);
  if (single_.size() == static_cast<std::size_t>(config_.images)) finish_position();
}

/// The median of the position's images.
void TiltSweep::finish_position() {
  if (single_.size() == static_cast<std::size_t>(config_.images)) {
    const auto median = [&](auto&& value) {
      std::vector<double> values;
      for (const TiltSample& s : single_) values.push_back(value(s));
      std::nth_element(values.begin(),
                       values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                       values.end());
      return values[values.size() / 2];
    };
    TiltSample sample;
    sample.servo = median([](const TiltSample& s) { return s.servo; });
    sample.angle = median([](const TiltSample& s) { return s.angle; });
    sample.mount_z = median([](const TiltSample& s) { return s.mount_z; });
    sample.residual = median([](const TiltSample& s) { return s.residual; });
    sample.images = config_.images;
    samples_.push_back(sample);
  }
  single_.clear();
  waited_ = tried_ = 0;
  ++position_;
}

}  // namespace usher::depth_pipeline
