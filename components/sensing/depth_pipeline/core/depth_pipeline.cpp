#include "sensing/depth_pipeline/core/depth_pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>

#include "foundation/result/bounds.hpp"
#include "sensing/depth_pipeline/core/kernels.hpp"

namespace usher::depth_pipeline {

namespace {

constexpr float kFree = std::numeric_limits<float>::infinity();
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr double kHalfMillimeter = 5e-4;  // [m] unit of the columns' distances
constexpr double kWidest = 0.85;          // least forward distance per depth that the scan covers
constexpr int kColumnArrays = 11;
constexpr int kBuffers = 8;
constexpr int kLeastValid = 10;     // a column with fewer than one in so many pixels is unknown
constexpr int kRowsAbove = 12;      // of pixels that tell whether anything was measured there
constexpr int kLeastFloor = 50;     // one in so many is enough where the floor began and ends
constexpr double kFallGap = 0.3;    // [m] between columns of one missing piece of floor
constexpr int kFootGap = 3;         // columns that a line of feet may leave out
constexpr double kHardlyAny = 0.1;  // of the pixels of what is looked at along it measure something
constexpr double kGrazing = 1.88;  // tan 62 deg: vinyl mirrors from 65 deg on, give or take a patch

enum ColumnArray { kHigh = 0, kLow = 4, kValid = 8, kFallBegin, kFall };

ScanGeometry geometry_for(const Intrinsics& camera) {
  const double right = (camera.width - 0.5 - camera.cx) / camera.fx / kWidest;
  const double left = (camera.cx + 0.5) / camera.fx / kWidest;
  ScanGeometry geometry;
  geometry.increment = std::atan(1.0 / camera.fx);  // the widest column is one bearing wide
  geometry.angle_min = -std::atan(right);
  geometry.count = static_cast<std::size_t>(
      std::ceil((std::atan(left) + std::atan(right)) / geometry.increment));
  return geometry;
}

std::uint16_t pixel(const DepthImage& image, int column, int row) {
  return image.millimeters[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                           static_cast<std::size_t>(column)];
}

std::uint16_t millimeters(double meters) {
  return static_cast<std::uint16_t>(std::lround(meters * 1e3));
}

}  // namespace

Status check(const PipelineConfig& config) {
  if (auto status = within({{"min_depth", config.min_depth, 0.05, 2.0},
                            {"max_depth", config.max_depth, 1.0, 16.0},
                            {"max_range", config.max_range, 0.5, 16.0},
                            {"origin", config.origin, -1.0, 1.0},
                            {"support", static_cast<double>(config.support), 1.0, 8.0},
                            {"support_gap", config.support_gap, 0.0, 5.0},
                            {"low_gap", config.low_gap, 0.0, 5.0},
                            {"low_width", config.low_width, 0.0, 0.5},
                            {"low_step", config.low_step, 0.0, 5.0},
                            {"drop_length", config.drop_length, 0.05, 2.0},
                            {"drop_width", config.drop_width, 0.0, 2.0},
                            {"grazing_drop_width", config.grazing_drop_width, 0.0, 2.0},
                            {"confidence_frames", static_cast<double>(config.confidence_frames),
                             1.0, Confidence::kMostFrames},
                            {"confidence_threshold", config.confidence_threshold, 0.01, 10.0},
                            {"least_confidence", config.least_confidence, 0.0, 1.0},
                            {"lasting_confidence", config.lasting_confidence, 0.0, 1.0},
                            {"low_from", config.low_from, 0.0, 8.0},
                            {"least_measured", config.least_measured, 0.0, 1.0}});
      !status)
    return status;
  if (auto status = check(config.floor); !status) return status;
  if (const auto status = check(config.refitted); !status)
    return Error{"refitted " + status.error()};
  return {};
}

Result<DepthPipeline> DepthPipeline::make(const Intrinsics& intrinsics,
                                          const PipelineConfig& config) {
  if (const auto status = imaging::check(intrinsics); !status) return Error{status.error()};
  if (const auto status = check(config); !status) return Error{status.error()};
  return DepthPipeline(intrinsics, config);
}

DepthPipeline::DepthPipeline(const Intrinsics& intrinsics, const PipelineConfig& config)
    : intrinsics_(intrinsics),
      config_(config),
      geometry_(geometry_for(intrinsics)),
      predicted_(intrinsics, config.floor, config.max_depth),
      refitted_(intrinsics, config.refitted, config.max_depth),
      confidence_(geometry_.count, config.confidence_frames, config.confidence_threshold,
                  config.max_range),
      low_confidence_(geometry_.count, config.confidence_frames, config.confidence_threshold,
                      config.max_range) {
  const auto width = static_cast<std::size_t>(intrinsics.width);
  column_stride_ = (width + 15) / 16 * 16;
  buffer_stride_ = column_stride_ + std::size_t{2} * kernels::kPad;
  processed_.resize(width * static_cast<std::size_t>(intrinsics.height));
  columns_.resize(kColumnArrays * column_stride_);
  buffers_.resize(kBuffers * buffer_stride_);
  for (DepthScan* scan : {&scan_, &low_}) {
    scan->ranges.resize(geometry_.count);
    scan->intensities.resize(geometry_.count);
  }
  seen_low_.resize(geometry_.count);
  tall_.resize(geometry_.count);
  fallen_.resize(geometry_.count);
  fallen_behind_floor_.resize(geometry_.count);
  behind_floor_.resize(column_stride_);
  floor_ends_.resize(column_stride_);
  low_drops_.resize(geometry_.count);
  looked_.resize(geometry_.count);
  spare_.resize(geometry_.count);
}

Result<DepthView> DepthPipeline::process(const DepthImage& image, const CameraPose& pose) {
  if (image.width != intrinsics_.width || image.height != intrinsics_.height ||
      image.millimeters.size() != processed_.size()) {
    return Error{"expected a depth image of " + std::to_string(intrinsics_.width) + " x " +
                 std::to_string(intrinsics_.height) + ", got " + std::to_string(image.width) +
                 " x " + std::to_string(image.height) + " with " +
                 std::to_string(image.millimeters.size()) + " values"};
  }
  if (!(pose.height >= 0.05 && pose.height <= 3.0) || !(std::abs(pose.down) <= 1.2) ||
      !(std::abs(pose.roll) <= 0.5) || !std::isfinite(pose.forward)) {
    return Error{"no camera stands " + std::to_string(pose.height) + " m high looking " +
                 std::to_string(pose.down) + " rad down with a roll of " +
                 std::to_string(pose.roll)};
  }
  DepthView view;
  view.pose = pose;
  if (config_.refit) {
    if (const auto fit = fit_floor(image, intrinsics_, pose, config_.fit)) {
      view.pose = fit->pose;
      view.refitted = true;
    }
  }
  FloorPrediction& floor = view.refitted ? refitted_ : predicted_;
  floor.predict(view.pose);
  sort_pixels(image, floor);
  view.measured = measured_share();

  shift_ = view.pose.forward - config_.origin;
  clear_bearings();
  mark_seen(view.pose);
  mark_obstacles(image, view.pose, floor);
  add_low();
  forget_blind_falls(floor);
  mark_feet(image, view.pose);
  drop_unsupported(scan_.ranges);
  drop_unsupported(low_.ranges);
  view.drops = mark_drops(image, view.pose);
  confidence_.rate(scan_.ranges, config_.least_confidence, scan_.intensities);
  low_confidence_.rate(low_.ranges, config_.lasting_confidence, low_.intensities);
  tell_drops();
  tell_where_nothing_low_is(view.pose);
  view.processed = processed_;
  view.scan = &scan_;
  view.low = &low_;
  view.low_drops = low_drops_;
  return view;
}

void DepthPipeline::forget_frames() {
  confidence_.forget();
  low_confidence_.forget();
}

void DepthPipeline::sort_pixels(const DepthImage& image, const FloorPrediction& floor) {
  const auto array = [&](int index) {
    return columns_.data() + static_cast<std::size_t>(index) * column_stride_;
  };
  std::fill(columns_.begin(), columns_.end(), kernels::kNothing);
  std::fill_n(array(kValid), column_stride_, std::uint16_t{0});
  kernels::Frame frame{};
  frame.depth = image.millimeters.data();
  frame.processed = processed_.data();
  frame.width = image.width;
  frame.height = image.height;
  frame.least = std::max<std::uint16_t>(1, millimeters(config_.min_depth));
  frame.fall_extent = millimeters(config_.drop_length);
  frame.missing_is_fall = config_.missing_is_drop;
  frame.open = config_.opening;
  frame.floor = &floor;
  frame.columns = {{array(kHigh), array(kHigh + 1), array(kHigh + 2), array(kHigh + 3)},
                   {array(kLow), array(kLow + 1), array(kLow + 2), array(kLow + 3)},
                   array(kValid),
                   array(kFallBegin),
                   array(kFall)};
  for (int i = 0; i < kBuffers; ++i) {
    frame.buffers[i] =
        buffers_.data() + static_cast<std::size_t>(i) * buffer_stride_ + kernels::kPad;
  }
  switch (config_.simd) {
#if defined(__x86_64__)
    case cpu::Simd::kAvx2:
      return kernels::process_avx2(frame);
    case cpu::Simd::kSse41:
      return kernels::process_sse41(frame);
#endif
    default:
      return kernels::process_portable(frame);
  }
}

double DepthPipeline::measured_share() const {
  const std::uint16_t* valid = columns_.data() + kValid * column_stride_;
  const auto sum = std::accumulate(valid, valid + intrinsics_.width, std::uint64_t{0});
  return static_cast<double>(sum) / static_cast<double>(processed_.size());
}

void DepthPipeline::clear_bearings() {
  std::fill(scan_.ranges.begin(), scan_.ranges.end(), kUnknown);
  std::fill(low_.ranges.begin(), low_.ranges.end(), kUnknown);
  std::fill(seen_low_.begin(), seen_low_.end(), kUnknown);
  std::fill(tall_.begin(), tall_.end(), kUnknown);
  std::fill(fallen_.begin(), fallen_.end(), kUnknown);
  std::fill(fallen_behind_floor_.begin(), fallen_behind_floor_.end(), kUnknown);
  std::fill(looked_.begin(), looked_.end(), std::uint8_t{0});
}

std::size_t DepthPipeline::bearing_of(double forward, double left) const {
  const double step = (std::atan2(left, forward) - geometry_.angle_min) / geometry_.increment;
  return static_cast<std::size_t>(
      std::clamp(step, 0.0, static_cast<double>(geometry_.count) - 1.0));
}

/// The first and last bearing of a column at a forward distance [m] from the camera's foot, where a
/// pixel is `side_per_pixel` [m] wide: neighbouring columns are less than two bearings apart.
std::pair<std::size_t, std::size_t> DepthPipeline::bearings_of(int column, double forward,
                                                               double side_per_pixel) const {
  const std::size_t first =
      bearing_of(forward + shift_, (intrinsics_.cx - column) * side_per_pixel);
  return {first, std::min(first + 1, geometry_.count - 1)};
}

/// A column whose pixels measured something is free up to what is marked later.
void DepthPipeline::mark_seen(const CameraPose& pose) {
  const std::uint16_t* valid = columns_.data() + kValid * column_stride_;
  const std::uint16_t* high = columns_.data() + (kHigh + 2) * column_stride_;
  const double level = std::cos(pose.down);
  for (int column = 0; column < intrinsics_.width; ++column) {
    if (valid[column] * kLeastValid < intrinsics_.height) continue;
    const double left = (intrinsics_.cx - column) / intrinsics_.fx * level;
    const std::size_t bearing = bearing_of(1.0, left);
    // Neighbouring columns are less than two bearings apart.
    const std::size_t last = std::min(bearing + 1, geometry_.count - 1);
    for (std::size_t i = bearing; i <= last; ++i) {
      scan_.ranges[i] = kFree;
      looked_[i] = 1;
      if (high[column] == kernels::kNothing) low_.ranges[i] = kFree;
    }
  }
}

/// Marks the bearings that a column covers at a forward distance [m] from the camera's foot;
/// `side_per_pixel` [m] is the width of a pixel there. Nearer marks stay.
void DepthPipeline::mark(std::vector<float>& ranges, int column, double forward,
                         double side_per_pixel) {
  const double ahead = std::max(0.01, forward + shift_);
  const double left = (intrinsics_.cx - column) * side_per_pixel;
  const double distance = std::hypot(ahead, left);
  const auto range = distance <= config_.max_range ? static_cast<float>(distance) : kFree;
  const std::size_t from = bearing_of(ahead, left - 0.5 * side_per_pixel);
  const std::size_t to = bearing_of(ahead, left + 0.5 * side_per_pixel);
  for (std::size_t i = from; i <= to; ++i) {
    if (!(ranges[i] <= range)) ranges[i] = range;
  }
}

/// The share {0..1} of a column's pixels between two rows that measured something; 1: there are
/// none.
double DepthPipeline::measured_between(const DepthImage& image, int column, double from,
                                       double to) const {
  const int begin = static_cast<int>(std::clamp<double>(from, 0.0, image.height));
  const int end = static_cast<int>(std::clamp<double>(to, 0.0, image.height));
  if (begin >= end) return 1.0;
  int seen = 0;
  for (int y = begin; y < end; ++y)
    seen += pixel(image, column, y) >= millimeters(config_.min_depth) ? 1 : 0;
  return static_cast<double>(seen) / (end - begin);
}

/// Whether most pixels right above a row measured something.
bool DepthPipeline::measured_over(const DepthImage& image, int column, double row) const {
  const double end = std::min<double>(row, image.height);
  return measured_between(image, column, end - kRowsAbove, end) >= 0.5;
}

/// Whether anything is measured right above a row, at the horizon or, in most rooms the ceiling, at
/// the top of the image. Where nothing is, an arm that is too near to be measured may hang down to
/// the row: over the foot of a wall, which looks like a low thing, or over floor, which looks like
/// a hole.
bool DepthPipeline::seen_above(const DepthImage& image, const CameraPose& pose, int column,
                               double row) const {
  return measured_over(image, column, row) || measured_over(image, column, row_of_horizon(pose)) ||
         measured_over(image, column, kRowsAbove);
}

/// The row where what is as far away as a pixel measured would be as high as something high.
double DepthPipeline::row_of_high(const CameraPose& pose, double depth) const {
  const double fall = (pose.height - config_.floor.low_height) / std::max(config_.min_depth, depth);
  return intrinsics_.cy + intrinsics_.fy * (fall - std::sin(pose.down)) / std::cos(pose.down);
}

double DepthPipeline::row_of_horizon(const CameraPose& pose) const {
  return intrinsics_.cy - intrinsics_.fy * std::tan(pose.down);
}

/// The row of the floor at a distance [m] from the camera's foot.
double DepthPipeline::row_of_floor(const CameraPose& pose, double forward) const {
  const double sine = std::sin(pose.down), cosine = std::cos(pose.down);
  return intrinsics_.cy + intrinsics_.fy * (pose.height * cosine - forward * sine) /
                              (forward * cosine + pose.height * sine);
}

void DepthPipeline::mark_obstacles(const DepthImage& image, const CameraPose& pose,
                                   const FloorPrediction& floor) {
  const auto array = [&](int index) {
    return columns_.data() + static_cast<std::size_t>(index) * column_stride_;
  };
  const std::uint16_t* high = array(kHigh + 2);
  const std::uint16_t* high_row = array(kHigh + 3);
  const std::uint16_t* low = array(kLow + 2);
  const std::uint16_t* low_row = array(kLow + 3);
  for (int column = 0; column < intrinsics_.width; ++column) {
    const auto place = [&](std::vector<float>& ranges, std::uint16_t distance, std::uint16_t row) {
      const double forward = kHalfMillimeter * distance;
      const double depth = forward * 32768.0 / std::max<int>(1, floor.scales()[row].forward);
      mark(ranges, column, forward, depth / intrinsics_.fx);
    };
    if (high[column] != kernels::kNothing) {
      place(scan_.ranges, high[column], high_row[column]);
      place(tall_, high[column], high_row[column]);
    }
    if (low[column] == kernels::kNothing) continue;
    place(seen_low_, low[column], low_row[column]);
    const double behind = kHalfMillimeter * (high[column] - low[column]);
    const bool foot = high[column] != kernels::kNothing && behind <= config_.low_gap;
    const std::uint16_t row = low_row[column];
    const double depth = 1e-3 * pixel(image, column, row);
    if (foot || !seen_above(image, pose, column, std::min<double>(row, row_of_high(pose, depth))))
      place(tall_, low[column], row);
  }
}

/// Low things into both scans, where they are wide enough; where not, what lies there is not known.
void DepthPipeline::add_low() {
  for (std::size_t begin = 0; begin < seen_low_.size();) {
    if (!std::isfinite(seen_low_[begin])) {
      ++begin;
      continue;
    }
    std::size_t end = begin;
    double width = 0.0;
    do {
      width += geometry_.increment * static_cast<double>(seen_low_[end]);
      ++end;
    } while (end < seen_low_.size() &&
             std::abs(seen_low_[end] - seen_low_[end - 1]) <= static_cast<float>(config_.low_step));
    for (; begin < end; ++begin) {
      const float range = seen_low_[begin];
      const float high = scan_.ranges[begin];
      const bool alone = !(tall_[begin] <= range + static_cast<float>(config_.low_gap));
      if (width >= config_.low_width) {
        if (!(high <= range)) scan_.ranges[begin] = range;
        if (alone) low_.ranges[begin] = range;
      } else {
        if (!std::isfinite(high)) scan_.ranges[begin] = kUnknown;
        low_.ranges[begin] = kUnknown;
        looked_[begin] = 0;
      }
    }
  }
}

/// Floor is missing only where the camera sees: a column that measured nearly nothing is not known,
/// unless it saw floor up to where it ends; and where something stands before that end, it hides
/// the floor: who is too near to be measured below the chest, for example. Floor that is missing
/// behind floor is hidden by nobody; but right before what is high, dark trousers may stand there.
void DepthPipeline::forget_blind_falls(const FloorPrediction& floor) {
  const std::uint16_t* valid = columns_.data() + kValid * column_stride_;
  const std::uint16_t* high = columns_.data() + (kHigh + 2) * column_stride_;
  std::uint16_t* fall = columns_.data() + kFall * column_stride_;
  for (int strip = 0; strip < floor.strips(); ++strip) {
    const std::uint16_t nearest = floor.rows(strip)[intrinsics_.height - 1].floor;
    const int end = std::min(floor.first_column(strip + 1), intrinsics_.width);
    for (int column = floor.first_column(strip); column < end; ++column) {
      const int enough = fall[column] > nearest ? kLeastFloor : kLeastValid;
      const bool hidden = kHalfMillimeter * high[column] < 1e-3 * fall[column];
      floor_ends_[column] = fall[column];
      if (hidden || valid[column] * enough < intrinsics_.height) fall[column] = kernels::kNothing;
      const bool floor_before =
          nearest > 0 && fall[column] >= nearest + millimeters(config_.drop_length);
      const bool before_somebody =
          high[column] != kernels::kNothing &&
          kHalfMillimeter * high[column] <= 1e-3 * fall[column] + config_.low_gap;
      behind_floor_[column] = floor_before && !before_somebody ? 1 : 0;
    }
  }
}

/// A wall that is looked at along it gives no measurement. All that the image shows of it is where
/// the floor ends, in line with where it ends before what stands in the columns beside, and nothing
/// from there up to the horizon. Behind a patch of floor that mirrors there is floor again. A roll
/// of the fitted floor is not heeded: at the image's edges such a wall may be missed.
void DepthPipeline::mark_feet(const DepthImage& image, const CameraPose& pose) {
  const std::uint16_t* high = columns_.data() + (kHigh + 2) * column_stride_;
  const std::uint16_t* fall = columns_.data() + kFall * column_stride_;
  const double level = std::cos(pose.down), sunk = pose.height * std::sin(pose.down);
  const double horizon = row_of_horizon(pose);
  const auto follow = [&](int column, int step) {
    std::optional<double> foot;  // [m] of the last column that shows one
    for (int gap = 0; column >= 0 && column < intrinsics_.width; column += step) {
      const double ends = 1e-3 * floor_ends_[column];
      if (high[column] != kernels::kNothing) {
        foot = floor_ends_[column] != kernels::kNothing ? ends : kHalfMillimeter * high[column];
        gap = 0;
      } else if (foot && fall[column] != kernels::kNothing && behind_floor_[column] != 0 &&
                 std::abs(ends - *foot) <= kFallGap &&
                 measured_between(image, column, horizon, row_of_floor(pose, ends)) <= kHardlyAny) {
        foot = ends;
        gap = 0;
        const double side = (ends * level + sunk) / intrinsics_.fx;
        mark(scan_.ranges, column, ends, side);
        const auto [first, last] = bearings_of(column, ends, side);
        for (std::size_t i = first; i <= last; ++i)  // it hides what is behind it
          if (std::isinf(low_.ranges[i])) low_.ranges[i] = kUnknown;
      } else if (++gap > kFootGap) {
        foot.reset();
      }
    }
  };
  follow(0, 1);
  follow(intrinsics_.width - 1, -1);
}

/// A piece of floor is missing where neighbouring columns say so over a width, where it is looked
/// at flatly over the width that no mirroring patch has. What may be somebody too near to be
/// measured as well is no low thing to be remembered.
int DepthPipeline::mark_drops(const DepthImage& image, const CameraPose& pose) {
  const std::uint16_t* fall = columns_.data() + kFall * column_stride_;
  const double grazing_from = kGrazing * pose.height;
  const double level = std::cos(pose.down), sunk = pose.height * std::sin(pose.down);
  const auto side_per_pixel = [&](double forward) {  // [m] on the floor
    return (forward * level + sunk) / intrinsics_.fx;
  };
  int count = 0;
  for (int begin = 0; begin < intrinsics_.width;) {
    if (fall[begin] == kernels::kNothing) {
      ++begin;
      continue;
    }
    int end = begin;
    double width = 0.0;
    double nearest = std::numeric_limits<double>::infinity();  // [m] from the camera's foot
    for (; end < intrinsics_.width && fall[end] != kernels::kNothing; ++end) {
      if (end > begin && std::abs(fall[end] - fall[end - 1]) > kFallGap * 1e3) break;
      const double forward = 1e-3 * fall[end];
      width += side_per_pixel(forward);
      nearest =
          std::min(nearest, std::hypot(forward, side_per_pixel(forward) * (intrinsics_.cx - end)));
    }
    const double needed = nearest < grazing_from
                              ? config_.drop_width
                              : std::max(config_.drop_width, config_.grazing_drop_width);
    if (width >= needed) {
      for (int column = begin; column < end; ++column) {
        const double forward = 1e-3 * fall[column];
        mark(scan_.ranges, column, forward, side_per_pixel(forward));
        const double row = row_of_floor(pose, forward);
        if (seen_above(image, pose, column, row)) {
          mark(low_.ranges, column, forward, side_per_pixel(forward));
          mark(fallen_, column, forward, side_per_pixel(forward));
          // An arm that is too near to be measured covers the floor as a dark pit does.
          if (behind_floor_[column] != 0 && measured_over(image, column, row))
            mark(fallen_behind_floor_, column, forward, side_per_pixel(forward));
        } else {
          const auto [first, last] = bearings_of(column, forward, side_per_pixel(forward));
          for (std::size_t i = first; i <= last; ++i) {
            low_.ranges[i] = fallen_[i] = fallen_behind_floor_[i] = kUnknown;
            looked_[i] = 0;
          }
        }
      }
      count += end - begin;
    }
    begin = end;
  }
  return count;
}

/// Where a thing stands before the missing floor, the range is that of the thing.
void DepthPipeline::tell_drops() {
  for (std::size_t i = 0; i < low_.ranges.size(); ++i) {
    const float range = low_.ranges[i];
    const bool falls = std::isfinite(range) && range == fallen_[i];
    low_drops_[i] = !falls                             ? Drop::kNone
                    : range == fallen_behind_floor_[i] ? Drop::kBehindFloor
                                                       : Drop::kMissing;
  }
}

/// [m] Ahead of the scan's origin, of the floor at the image's lower edge; infinity: it shows none.
double DepthPipeline::nearest_floor(const CameraPose& pose) const {
  const double below =
      pose.down + std::atan((intrinsics_.height - 1.0 - intrinsics_.cy) / intrinsics_.fy);
  return below > 0.0 ? pose.height / std::tan(below) + shift_ : INFINITY;
}

/// What stands high hides what is low behind it: up to there nothing low is. Where the image does
/// not show the floor from low_from on, it tells nothing of the kind.
void DepthPipeline::tell_where_nothing_low_is(const CameraPose& pose) {
  const double floor = nearest_floor(pose);
  for (std::size_t i = 0; i < low_.ranges.size(); ++i) {
    const float range = scan_.ranges[i];
    const double bearing = geometry_.angle_min + geometry_.increment * static_cast<double>(i);
    if (!(floor <= config_.low_from * std::cos(bearing))) {
      if (std::isinf(low_.ranges[i])) low_.ranges[i] = kUnknown;
    } else if (looked_[i] != 0 && std::isnan(low_.ranges[i]) && !std::isnan(range)) {
      low_.ranges[i] = std::isinf(range) ? kFree : -range;
    }
  }
}

/// An obstacle that no neighbouring bearing knows of is noise.
void DepthPipeline::drop_unsupported(std::vector<float>& ranges) const {
  if (config_.support < 2) return;
  std::copy(ranges.begin(), ranges.end(), spare_.begin());
  const auto gap = static_cast<float>(config_.support_gap);
  const auto count = static_cast<std::ptrdiff_t>(ranges.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const float range = spare_[static_cast<std::size_t>(i)];
    if (!std::isfinite(range)) continue;
    int run = 1;
    for (const std::ptrdiff_t step : {std::ptrdiff_t{-1}, std::ptrdiff_t{1}}) {
      for (std::ptrdiff_t k = i + step; k >= 0 && k < count && run < config_.support; k += step) {
        if (!(std::abs(spare_[static_cast<std::size_t>(k)] - range) <= gap)) break;
        ++run;
      }
    }
    if (run < config_.support) ranges[static_cast<std::size_t>(i)] = kUnknown;
  }
}

}  // namespace usher::depth_pipeline
