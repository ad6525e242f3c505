#include "perception/face_detector/core/depth_model.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>

namespace usher::face_detector {

namespace {

constexpr std::size_t kLeastSamples = 30;
constexpr double kLeastSpan = 2.5;
constexpr double kMostOff = 1.0 / 3.0;
constexpr double kMostResidual = 0.08;
constexpr double kFirstGate = 0.25;  // relative error of depth around the hyperbola
constexpr double kGate = 3.0;        // [standard deviations]
constexpr double kLeastGate = 0.06;
constexpr int kRounds = 5;
constexpr double kBeyond = 1.25;  // sizes that a model holds for, beyond those it was fitted to

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

/// Least squares of the relative error: depth (a + b s + c s^2) = 1.
SizeModel least_squares(std::span<const FaceSample> samples, const std::vector<bool>& used) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  constexpr double kScale = 0.01;  // sizes of about one
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!used[i]) continue;
    const double s = samples[i].size * kScale;
    const Eigen::Vector3d row = samples[i].depth * Eigen::Vector3d(1.0, s, s * s);
    normal += row * row.transpose();
    right += row;
  }
  const Eigen::Vector3d found = normal.ldlt().solve(right);
  SizeModel model;
  model.a = found[0];
  model.b = found[1] * kScale;
  model.c = found[2] * kScale * kScale;
  return model;
}

double relative_error(const SizeModel& model, const FaceSample& sample) {
  return sample.depth * (model.a + sample.size * (model.b + sample.size * model.c)) - 1.0;
}

double root_mean_square(const SizeModel& model, std::span<const FaceSample> samples,
                        const std::vector<bool>& used) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!used[i]) continue;
    sum += std::pow(relative_error(model, samples[i]), 2);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

/// The hyperbola depth = k / size that most samples lie near: robust against half of them.
SizeModel median_hyperbola(std::span<const FaceSample> samples) {
  std::vector<double> products;
  for (const FaceSample& sample : samples) products.push_back(sample.size * sample.depth);
  const auto middle = products.begin() + static_cast<std::ptrdiff_t>(products.size() / 2);
  std::nth_element(products.begin(), middle, products.end());
  SizeModel model;
  model.b = 1.0 / *middle;
  return model;
}

/// Calls visit for each depth [mm] of the middle of a box, `share` of its side; returns how many.
template <class Visit>
std::size_t each_of_middle(const imaging::DepthImage& depth, const Box& box, double share,
                           const Visit& visit) {
  const double half = std::max(0.5, 0.5 * share * box.width);
  const auto within = [](double value, int size) {
    return static_cast<int>(std::clamp(std::floor(value), 0.0, static_cast<double>(size)));
  };
  const int left = within(box.column() - half, depth.width);
  const int right = within(box.column() + half, depth.width - 1);
  const int top = within(box.row() - half, depth.height);
  const int bottom = within(box.row() + half, depth.height - 1);
  std::size_t pixels = 0;
  for (int row = top; row <= bottom; ++row) {
    const std::uint16_t* line =
        depth.millimeters.data() + static_cast<std::ptrdiff_t>(row) * depth.width;
    for (int column = left; column <= right; ++column, ++pixels) visit(line[column]);
  }
  return pixels;
}

}  // namespace

Status check(const SizeModel& model) {
  if (!(model.least >= 1.0 && model.least < model.most && model.most <= 10'000.0)) {
    return Error{"the sizes of a face must be a range within [1, 10000] pixels, got " +
                 number(model.least) + " to " + number(model.most)};
  }
  if (!std::isfinite(model.a) || !std::isfinite(model.b) || !std::isfinite(model.c))
    return Error{"the model of a face's size must be finite"};
  for (const double size : {model.least, model.most}) {
    const double inverse = model.a + size * (model.b + size * model.c);
    if (!(inverse > 0.0)) {
      return Error{"a face of " + number(size) + " pixels must have a positive distance, got " +
                   number(1.0 / inverse) + " m"};
    }
    if (!(model.b + 2.0 * model.c * size > 0.0)) {
      return Error{"larger faces must be nearer, at " + number(size) +
                   " pixels they are farther away"};
    }
  }
  return {};
}

bool DepthModel::is_center(double column, int image_width) const {
  return std::abs(column - 0.5 * image_width) <= 0.5 * middle * image_width;
}

std::optional<double> middle_depth(const imaging::DepthImage& depth, const Box& box,
                                   const Plausibility& rules, std::vector<std::uint16_t>& scratch) {
  scratch.clear();
  const std::size_t pixels =
      each_of_middle(depth, box, rules.middle, [&scratch](std::uint16_t measured) {
        if (measured > 0) scratch.push_back(measured);
      });
  if (scratch.empty() ||
      static_cast<double>(scratch.size()) < rules.measured * static_cast<double>(pixels)) {
    return std::nullopt;
  }
  const auto median = scratch.begin() + static_cast<std::ptrdiff_t>((scratch.size() - 1) / 2);
  std::nth_element(scratch.begin(), median, scratch.end());
  return 1e-3 * *median;
}

double share_at(const imaging::DepthImage& depth, const Box& box, double at) {
  constexpr double kHalf = 0.5, kThick = 150.0;  // of the box, [mm]
  std::size_t there = 0;
  const std::size_t pixels = each_of_middle(depth, box, kHalf, [&](std::uint16_t measured) {
    there += measured > 0 && std::abs(measured - 1e3 * at) <= kThick ? 1 : 0;
  });
  return pixels > 0 ? static_cast<double>(there) / static_cast<double>(pixels) : 0.0;
}

bool plausible(const Box& box, double depth, int image_width, const DepthModel& model,
               const Plausibility& rules) {
  if (!(depth >= rules.near && depth <= rules.far)) return false;
  const SizeModel& sizes = model.at(box.column(), image_width);
  if (!sizes.holds(box.width)) return false;
  const double expected = sizes.depth(box.width);
  return std::abs(depth - expected) <= rules.tolerance * expected;
}

Result<FittedModel> fit_size_model(std::span<const FaceSample> samples) {
  for (const FaceSample& sample : samples) {
    if (!(sample.size > 0.0 && sample.depth > 0.0 && std::isfinite(sample.size * sample.depth))) {
      return Error{"a face must have a size and a depth, got " + number(sample.size) +
                   " pixels and " + number(sample.depth) + " m"};
    }
  }
  if (samples.size() < kLeastSamples) {
    return Error{"expected at least " + std::to_string(kLeastSamples) + " faces, found " +
                 std::to_string(samples.size())};
  }
  FittedModel fit;
  fit.used.assign(samples.size(), true);
  fit.model = median_hyperbola(samples);
  double gate = kFirstGate;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < samples.size(); ++i)
      fit.used[i] = std::abs(relative_error(fit.model, samples[i])) <= gate;
    fit.model = least_squares(samples, fit.used);
    fit.residual = root_mean_square(fit.model, samples, fit.used);
    gate = std::clamp(kGate * fit.residual, kLeastGate, kFirstGate);
  }
  std::size_t count = 0;
  double nearest = 1e9, farthest = 0.0, smallest = 1e9, largest = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!fit.used[i]) continue;
    ++count;
    nearest = std::min(nearest, samples[i].depth), farthest = std::max(farthest, samples[i].depth);
    smallest = std::min(smallest, samples[i].size), largest = std::max(largest, samples[i].size);
    fit.worst = std::max(fit.worst, std::abs(relative_error(fit.model, samples[i])));
  }
  const auto off = static_cast<double>(samples.size() - count);
  if (off > kMostOff * static_cast<double>(samples.size())) {
    return Error{std::to_string(samples.size() - count) + " of " + std::to_string(samples.size()) +
                 " detections lie off any curve, expected at most a third: are they faces?"};
  }
  if (!(farthest >= kLeastSpan * nearest)) {
    return Error{"the faces are " + number(nearest) + " to " + number(farthest) +
                 " m away, expected distances that differ by a factor of at least " +
                 number(kLeastSpan)};
  }
  if (fit.residual > kMostResidual) {
    return Error{"the depths differ from the curve by " + number(100.0 * fit.residual) +
                 " %, expected at most " + number(100.0 * kMostResidual) + " %"};
  }
  fit.model.least = smallest / kBeyond;
  fit.model.most = largest * kBeyond;
  if (const auto status = check(fit.model); !status) return Error{status.error()};
  return fit;
}

}  // namespace usher::face_detector
