#include "localization/amcl/core/likelihood_kernel.hpp"

#include <cassert>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace usher::amcl {
namespace {

void sum_portable(const FieldView& field, const KernelParticles& particles, const float* beam_x,
                  const float* beam_y, std::size_t beams, std::uint32_t* sums) {
  const auto last_x = static_cast<float>(field.stride - 1);
  const auto last_y = static_cast<float>(field.rows - 1);
  for (std::size_t i = 0; i < particles.count; ++i) {
    const float px = particles.x[i], py = particles.y[i], c = particles.cosine[i],
                s = particles.sine[i];
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b < beams; ++b) {
      float x = px + (c * beam_x[b] - s * beam_y[b]);
      float y = py + (s * beam_x[b] + c * beam_y[b]);
      x = x > 0.0F ? x : 0.0F;
      y = y > 0.0F ? y : 0.0F;
      x = x < last_x ? x : last_x;
      y = y < last_y ? y : last_y;
      sum +=
          field.values[static_cast<std::int32_t>(y) * field.stride + static_cast<std::int32_t>(x)];
    }
    sums[i] = sum;
  }
}

/// Angles reduced to [-pi/4, pi/4] in double, then Taylor series that reach float's precision
/// there.
[[gnu::always_inline]] inline void cosine_sine_loop(const double* yaw, std::size_t count,
                                                    float* cosine, float* sine) {
  for (std::size_t i = 0; i < count; ++i) {
    constexpr double kRound =
        6755399441055744.0;  // 1.5 * 2^52: adding and taking away rounds to a whole number
    const double turns = (yaw[i] * 0.63661977236758134308 + kRound) - kRound;
    const auto r = static_cast<float>(yaw[i] - turns * 1.57079632679489661923);
    const float q = r * r;
    const float sin_r =
        r * (1.0F + q * (-1.0F / 6 + q * (1.0F / 120 + q * (-1.0F / 5040 + q * (1.0F / 362880)))));
    const float cos_r =
        1.0F + q * (-0.5F + q * (1.0F / 24 + q * (-1.0F / 720 + q * (1.0F / 40320))));
    const auto quarter = static_cast<std::int32_t>(turns);
    const bool odd = (quarter & 1) != 0;
    const float c = odd ? sin_r : cos_r;
    const float s = odd ? cos_r : sin_r;
    cosine[i] = ((quarter + 1) & 2) != 0 ? -c : c;
    sine[i] = (quarter & 2) != 0 ? -s : s;
  }
}

#if defined(__x86_64__)

/// Eight particles and their running sums.
struct Lanes {
  __m256 x, y, c, s;
  __m256i sum;
};

__attribute__((target("avx2"))) inline Lanes load(const KernelParticles& particles, std::size_t i) {
  return {_mm256_loadu_ps(particles.x + i), _mm256_loadu_ps(particles.y + i),
          _mm256_loadu_ps(particles.cosine + i), _mm256_loadu_ps(particles.sine + i),
          _mm256_setzero_si256()};
}

__attribute__((target("avx2"))) void sum_avx2(const FieldView& field,
                                              const KernelParticles& particles, const float* beam_x,
                                              const float* beam_y, std::size_t beams,
                                              std::uint32_t* sums) {
  const __m256 last_x = _mm256_set1_ps(static_cast<float>(field.stride - 1));
  const __m256 last_y = _mm256_set1_ps(static_cast<float>(field.rows - 1));
  const __m256 zero = _mm256_setzero_ps();
  const __m256i stride = _mm256_set1_epi32(field.stride);
  const __m256i low = _mm256_set1_epi32(0xffff);
  // No fused multiply-add: the portable path must round the same way.
  const auto add = [&](Lanes & lanes, __m256 bx, __m256 by)
      __attribute__((target("avx2"), always_inline)) {
    __m256 x = _mm256_add_ps(lanes.x,
                             _mm256_sub_ps(_mm256_mul_ps(lanes.c, bx), _mm256_mul_ps(lanes.s, by)));
    __m256 y = _mm256_add_ps(lanes.y,
                             _mm256_add_ps(_mm256_mul_ps(lanes.s, bx), _mm256_mul_ps(lanes.c, by)));
    x = _mm256_min_ps(_mm256_max_ps(x, zero), last_x);
    y = _mm256_min_ps(_mm256_max_ps(y, zero), last_y);
    const __m256i index = _mm256_add_epi32(_mm256_mullo_epi32(_mm256_cvttps_epi32(y), stride),
                                           _mm256_cvttps_epi32(x));
    const __m256i pair =
        _mm256_i32gather_epi32(reinterpret_cast<const int*>(field.values), index, 2);
    lanes.sum = _mm256_add_epi32(lanes.sum, _mm256_and_si256(pair, low));
  };
  for (std::size_t i = 0; i < particles.count; i += kKernelLanes) {
    Lanes a = load(particles, i);
    Lanes b = load(particles, i + 8);
    for (std::size_t k = 0; k < beams; ++k) {
      const __m256 bx = _mm256_set1_ps(beam_x[k]);
      const __m256 by = _mm256_set1_ps(beam_y[k]);
      add(a, bx, by);
      add(b, bx, by);
    }
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(sums + i), a.sum);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(sums + i + 8), b.sum);
  }
}

__attribute__((target("avx2"))) void cosine_sine_avx2(const double* yaw, std::size_t count,
                                                      float* cosine, float* sine) {
  cosine_sine_loop(yaw, count, cosine, sine);
}

#endif

}  // namespace

void sum_field(const FieldView& field, const KernelParticles& particles, const float* beam_x,
               const float* beam_y, std::size_t beams, std::uint32_t* sums,
               [[maybe_unused]] cpu::Simd simd) {
  assert(particles.count % kKernelLanes == 0 && beams <= 32768);
#if defined(__x86_64__)
  if (simd == cpu::Simd::kAvx2) return sum_avx2(field, particles, beam_x, beam_y, beams, sums);
#endif
  sum_portable(field, particles, beam_x, beam_y, beams, sums);
}

void cosine_sine(const double* yaw, std::size_t count, float* cosine, float* sine,
                 [[maybe_unused]] cpu::Simd simd) {
#if defined(__x86_64__)
  if (simd == cpu::Simd::kAvx2) return cosine_sine_avx2(yaw, count, cosine, sine);
#endif
  cosine_sine_loop(yaw, count, cosine, sine);
}

}  // namespace usher::amcl
