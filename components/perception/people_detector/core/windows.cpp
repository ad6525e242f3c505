#include "perception/people_detector/core/windows.hpp"

#include <algorithm>
#include <cmath>

namespace usher::people_detector {

namespace {

constexpr int kThinned = 256;      // columns of the thinned image, about
constexpr int kStrip = 2;          // of its columns share a histogram
constexpr float kBin = 0.1F;       // [m] of a histogram
constexpr int kTogether = 4;       // bins that a body fills
constexpr int kMostOfStrip = 3;    // surfaces behind each other
constexpr double kAtLeast = 0.1;   // [m] nothing is nearer to a camera
constexpr double kTopDepth = 0.4;  // [m]

}  // namespace

Windows::Windows(const imaging::Intrinsics& intrinsics, const Config& config)
    : intrinsics_(intrinsics), config_(config) {
  step_ = std::max(1, static_cast<int>(std::lround(intrinsics.width / double{kThinned})));
  width_ = intrinsics.width / step_;
  height_ = intrinsics.height / step_;
  strips_ = (width_ + kStrip - 1) / kStrip;
  bins_ = static_cast<int>((config.farthest + Windows::kDepth) / static_cast<double>(kBin)) + 1;
  thinned_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  histograms_.resize(static_cast<std::size_t>(strips_) * static_cast<std::size_t>(bins_));
  candidates_.reserve(static_cast<std::size_t>(strips_) * kMostOfStrip);
}

/// One pixel of each block, the first that measured something.
void Windows::thin(const imaging::DepthImage& image) {
  const auto wide = static_cast<std::size_t>(image.width);
  for (int row = 0; row < height_; ++row) {
    const std::uint16_t* from =
        image.millimeters.data() + static_cast<std::size_t>(row * step_) * wide;
    const std::uint16_t* below = step_ > 1 ? from + wide : from;
    std::uint16_t* to =
        thinned_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
    for (int column = 0; column < width_; ++column) {
      const int at = column * step_;
      to[column] = from[at] != 0 ? from[at] : below[at];
    }
  }
}

/// How much surface stands above each other at each distance, strip by strip of the image.
void Windows::fill_histograms() {
  std::fill(histograms_.begin(), histograms_.end(), 0.0F);
  const auto extent = static_cast<float>(1e-3 * step_ / intrinsics_.fy / kStrip);  // [m per mm]
  for (int row = 0; row < height_; ++row) {
    const double y = (row * step_ - intrinsics_.cy) / intrinsics_.fy;
    const auto bins = static_cast<float>((cos_down_ - y * sin_down_) * 1e-3) / kBin;
    const std::uint16_t* line =
        thinned_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
    for (int column = 0; column < width_; ++column) {
      const auto depth = static_cast<float>(line[column]);
      const int bin = static_cast<int>(depth * bins);
      if (bin <= 0 || bin >= bins_) continue;
      histograms_[static_cast<std::size_t>(column / kStrip) * static_cast<std::size_t>(bins_) +
                  static_cast<std::size_t>(bin)] += depth * extent;
    }
  }
}

void Windows::find_candidates() {
  candidates_.clear();
  const int nearest = std::max(1, static_cast<int>(config_.nearest / static_cast<double>(kBin)));
  for (int strip = 0; strip < strips_; ++strip) {
    float* bins = histograms_.data() + static_cast<std::size_t>(strip * bins_);
    for (int found = 0; found < kMostOfStrip; ++found) {
      int best = -1;
      float most = static_cast<float>(config_.least_extent);
      for (int bin = nearest; bin + kTogether <= bins_; ++bin) {
        const float sum = bins[bin] + bins[bin + 1] + bins[bin + 2] + bins[bin + 3];
        if (sum > most) most = sum, best = bin;
      }
      if (best < 0) break;
      float moment = 0.0F;
      for (int i = 0; i < kTogether; ++i)
        moment += bins[best + i] * (static_cast<float>(best + i) + 0.5F);
      const float forward = kBin * moment / most;
      std::fill(bins + std::max(0, best - 1), bins + std::min(bins_, best + kTogether + 1), 0.0F);
      if (forward > static_cast<float>(config_.farthest)) continue;
      const double per_strip = static_cast<double>(forward) * kStrip * step_ / intrinsics_.fx;
      const int stride = std::max(1, static_cast<int>(config_.step / per_strip));
      if (strip % stride != 0) continue;
      const double column = (strip + 0.5) * kStrip * step_;
      const double depth = static_cast<double>(forward) * cos_down_ +
                           (view_.height - 1.0) * sin_down_;  // of something 1 m high
      candidates_.push_back(
          {forward, static_cast<float>((intrinsics_.cx - column) / intrinsics_.fx * depth), most});
    }
  }
}

void Windows::take(const imaging::DepthImage& image, const View& view) {
  view_ = view;
  cos_down_ = std::cos(view.down), sin_down_ = std::sin(view.down);
  cos_roll_ = std::cos(view.roll), sin_roll_ = std::sin(view.roll);
  thin(image);
  fill_histograms();
  find_candidates();
}

void Windows::describe(const Candidate& candidate, Inputs& inputs) const {
  inputs.fill(0);
  const auto forward = static_cast<double>(candidate.forward);
  const auto left = static_cast<double>(candidate.left);
  const double scale_x = intrinsics_.fx / step_, scale_y = intrinsics_.fy / step_;
  for (int up = 0; up < kUp; ++up) {
    const double below = view_.height - (kLowest + kCellHeight * up);
    const double depth = forward * cos_down_ + below * sin_down_;
    if (depth < kAtLeast) continue;
    const double y = (below * cos_down_ - forward * sin_down_) / depth;
    // One row of cells is a line in the image.
    const double first = -(left - 0.5 * (kAcross - 1) * kCellWidth) / depth;
    const double column = intrinsics_.cx / step_ + scale_x * (first * cos_roll_ + y * sin_roll_);
    const double row = intrinsics_.cy / step_ + scale_y * (y * cos_roll_ - first * sin_roll_);
    const double aside = -kCellWidth / depth;
    const double column_step = scale_x * aside * cos_roll_, row_step = -scale_y * aside * sin_roll_;
    std::int16_t* cell = inputs.data() + std::ptrdiff_t{kChannels} * kAcross * up;
    for (int across = 0; across < kAcross; ++across, cell += kChannels) {
      const double c = column + across * column_step, r = row + across * row_step;
      if (c < 0.0 || r < 0.0 || c >= width_ || r >= height_) continue;
      const std::uint16_t seen =
          thinned_[static_cast<std::size_t>(r) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(c)];
      const double behind = seen == 0 ? kDepth : 1e-3 * seen - depth;
      if (behind <= -kDepth) {
        cell[1] = -kOne;
      } else if (behind >= kDepth) {
        cell[2] = kOne;
      } else {
        cell[0] = kOne;
        cell[1] = static_cast<std::int16_t>(std::lround(behind / kDepth * kOne));
      }
    }
  }
  std::int16_t* others = inputs.data() + std::ptrdiff_t{kAcross} * kUp * kChannels;
  others[0] = kOne;
  others[1] = static_cast<std::int16_t>(std::lround(std::min(8.0, forward) / 8.0 * kOne));
  others[2] = static_cast<std::int16_t>(std::lround(0.5 / std::max(0.5, forward) * kOne));
}

void Windows::mirror(const Inputs& inputs, Inputs& mirrored) {
  mirrored = inputs;
  constexpr int kRow = kAcross * kChannels;
  for (int up = 0; up < kUp; ++up) {
    const std::int16_t* from = inputs.data() + std::ptrdiff_t{up} * kRow + kRow - kChannels;
    std::int16_t* to = mirrored.data() + std::ptrdiff_t{up} * kRow;
    for (int across = 0; across < kAcross; ++across, from -= kChannels, to += kChannels)
      std::copy_n(from, kChannels, to);
  }
}

Windows::Top Windows::top(const Candidate& candidate) const {
  const auto forward = static_cast<double>(candidate.forward);
  const auto left = static_cast<double>(candidate.left);
  constexpr double kHighest = kLowest + kCellHeight * kUp, kRowStep = 0.02;  // [m]
  constexpr double kBeside = 0.24, kColumnStep = 0.04;                       // [m]
  constexpr double kHalfHead = 0.12, kHead = 0.35;                           // [m]
  bool above = false;                    // nothing, as the image shows
  double hidden = kHighest + 2 * kHead;  // [m] the lowest place of a head before which something is
  for (int row_number = 0; row_number * kRowStep < kHighest; ++row_number) {
    const double height = kHighest - row_number * kRowStep;
    const double below = view_.height - height;
    const double depth = forward * cos_down_ + below * sin_down_;
    if (depth < kAtLeast) continue;
    const double y = (below * cos_down_ - forward * sin_down_) / depth;
    int seen = 0, looked = 0, nearer = 0;
    for (int column_number = 0; column_number <= 12; ++column_number) {
      const double aside = column_number * kColumnStep - kBeside;
      const double x = -(left + aside) / depth;
      const double column =
          (intrinsics_.cx + intrinsics_.fx * (x * cos_roll_ + y * sin_roll_)) / step_;
      const double row =
          (intrinsics_.cy + intrinsics_.fy * (y * cos_roll_ - x * sin_roll_)) / step_;
      if (column < 0.0 || row < 0.0 || column >= width_ || row >= height_) continue;
      const std::uint16_t pixel =
          thinned_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(column)];
      ++looked;
      if (pixel == 0) continue;
      const double behind = 1e-3 * pixel - depth;
      seen += std::abs(behind) < kTopDepth;
      nearer += behind <= -kTopDepth && std::abs(aside) < kHalfHead;
    }
    if (seen >= 2) return above ? Top{height, hidden - height < kHead} : Top{};
    above = above || looked >= 2;
    if (nearer >= 2) hidden = height;
  }
  return {};
}

}  // namespace usher::people_detector
