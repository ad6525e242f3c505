#pragma once

#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace usher::estimation {

/// Low-variance (systematic) resampling [thrun2005, table 4.4]: fills `picked` with indices in
/// rising order so that index i occurs floor or ceil of picked.size() * weight_i / sum times, its
/// mean over `offset` uniform in [0, 1) being exactly that product. Weights are finite and at least
/// 0, their sum is positive. O(weights + picked).
inline void low_variance_resample(std::span<const double> weights, double offset,
                                  std::span<std::uint32_t> picked) {
  double total = 0.0;
  for (const double weight : weights) total += weight;
  assert(total > 0.0 && std::isfinite(total) && offset >= 0.0 && offset < 1.0);
  const double step = total / static_cast<double>(picked.size());
  std::size_t index = 0;
  std::size_t last = weights.size() - 1;  // rounding at the end must not pick a weight of zero
  while (weights[last] <= 0.0) --last;
  double reached = weights[0];
  for (std::size_t i = 0; i < picked.size(); ++i) {
    const double target = (static_cast<double>(i) + offset) * step;
    while (reached <= target && index < last) reached += weights[++index];
    picked[i] = static_cast<std::uint32_t>(index);
  }
}

/// How many samples keep the Kullback-Leibler distance between the sampled and the true
/// distribution over `bins` occupied bins below `epsilon`, with the probability whose standard
/// normal quantile is `quantile` (2.326 for 99 %): the chi-square bound in the Wilson-Hilferty form
/// [fox2003kld, equation 7]. 1 for less than two bins.
inline double kld_sample_bound(std::size_t bins, double epsilon, double quantile) {
  assert(epsilon > 0.0);
  if (bins < 2) return 1.0;
  const double degrees = static_cast<double>(bins - 1);
  const double a = 2.0 / (9.0 * degrees);
  const double b = 1.0 - a + std::sqrt(a) * quantile;
  return std::ceil(degrees / (2.0 * epsilon) * b * b * b);
}

}  // namespace usher::estimation
