#include "localization/amcl/core/likelihood_field.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "localization/amcl/core/likelihood_kernel.hpp"

namespace usher::amcl {

double LikelihoodField::beam_likelihood(double distance) const {
  const double deviation = distance / parameters_.sigma_hit;
  return parameters_.z_hit * std::exp(-0.5 * deviation * deviation) +
         parameters_.z_rand / parameters_.max_range;
}

void LikelihoodField::build(const grid::OccupancyGrid& map, const SensorParameters& parameters,
                            cpu::Simd simd) {
  parameters_ = parameters;
  distances_.build(map, parameters.field_radius, grid::kOccupied, simd);
  if (map.empty()) return;

  lowest_ = std::log(beam_likelihood(distances_.radius()));
  unit_ = (std::log(beam_likelihood(0.0)) - lowest_) / 65535.0;
  const int radius = distances_.radius_cells();
  by_square_.resize(static_cast<std::size_t>(radius * radius) + 1);
  for (std::size_t i = 0; i < by_square_.size(); ++i) {
    const double distance = std::sqrt(static_cast<double>(i)) * map.resolution();
    by_square_[i] = static_cast<std::uint16_t>(
        std::lround((std::log(beam_likelihood(distance)) - lowest_) / unit_));
  }
  const auto width = static_cast<std::size_t>(map.width());
  const std::size_t stride = width + 2;
  const std::size_t rows = static_cast<std::size_t>(map.height()) + 2;
  field_.resize(stride * rows + 1);
  const std::uint16_t outside = by_square_.back();
  std::fill_n(field_.begin(), stride + 1, outside);
  std::fill(field_.end() - static_cast<std::ptrdiff_t>(stride + 2), field_.end(), outside);
  for (int y = 0; y < map.height(); ++y) {
    const std::uint16_t* square = distances_.squared_cells().row(y);
    std::uint16_t* out = field_.data() + (static_cast<std::size_t>(y) + 1) * stride + 1;
    for (std::size_t x = 0; x < width; ++x) out[x] = by_square_[square[x]];
    out[width] = out[width + 1] = outside;  // this row's right border and the next one's left
  }
}

void LikelihoodField::log_likelihood(const Particles& particles, std::span<const Beam> beams,
                                     std::span<double> log_likelihood, cpu::Simd simd) {
  assert(!empty() && log_likelihood.size() == particles.size());
  if (beams.empty() || particles.size() == 0) {
    std::fill(log_likelihood.begin(), log_likelihood.end(), 0.0);
    return;
  }
  const std::size_t count = particles.size();
  const std::size_t padded = (count + kKernelLanes - 1) / kKernelLanes * kKernelLanes;
  for (auto* lane : {&x_, &y_, &cosine_, &sine_}) lane->resize(padded);
  yaw_.resize(padded);
  sums_.resize(padded);
  const grid::GridGeometry& g = distances_.geometry();
  const double scale = 1.0 / g.resolution;
  for (std::size_t i = 0; i < count; ++i) {
    x_[i] = static_cast<float>((particles.x[i] - g.origin_x) * scale + 1.0);
    y_[i] = static_cast<float>((particles.y[i] - g.origin_y) * scale + 1.0);
  }
  std::copy_n(particles.yaw.begin(), count, yaw_.begin());
  for (std::size_t i = count; i < padded; ++i) x_[i] = y_[i] = 0.0F, yaw_[i] = 0.0;
  cosine_sine(yaw_.data(), padded, cosine_.data(), sine_.data(), simd);
  beam_x_.resize(beams.size());
  beam_y_.resize(beams.size());
  for (std::size_t k = 0; k < beams.size(); ++k) {
    beam_x_[k] = static_cast<float>(beams[k].x * scale);
    beam_y_[k] = static_cast<float>(beams[k].y * scale);
  }

  sum_field({field_.data(), g.width + 2, g.height + 2},
            {x_.data(), y_.data(), cosine_.data(), sine_.data(), padded}, beam_x_.data(),
            beam_y_.data(), beams.size(), sums_.data(), simd);
  const double share = unit_ / static_cast<double>(beams.size());
  for (std::size_t i = 0; i < count; ++i) log_likelihood[i] = lowest_ + sums_[i] * share;
}

}  // namespace usher::amcl
