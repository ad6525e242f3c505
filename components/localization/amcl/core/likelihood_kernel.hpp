#pragma once

#include <cstddef>
#include <cstdint>

#include "foundation/cpu/cpu.hpp"

namespace usher::amcl {

/// The field as the inner loop sees it: values of whole cells with a border of one cell around the
/// map that stands for everything outside, so that a point is clamped and never tested. One more
/// value must be readable at the end.
struct FieldView {
  const std::uint16_t* values = nullptr;
  std::int32_t stride = 0;  ///< columns, border included
  std::int32_t rows = 0;    ///< border included
};

/// Particles in cells of that field: cell (1,1) is the map's first, so coordinates inside the map
/// are above 1.
struct KernelParticles {
  const float* x = nullptr;
  const float* y = nullptr;
  const float* cosine = nullptr;
  const float* sine = nullptr;
  std::size_t count = 0;  ///< a multiple of kKernelLanes (pad with copies)
};

inline constexpr std::size_t kKernelLanes = 16;

/// sums[i] = sum over beams of the field's value where particle i sees the beam's end point
/// (beam_x, beam_y [cells] in base). Integers: the same on every instruction set. At most 32768
/// beams. About 2.5 instructions per particle and beam with AVX2.
void sum_field(const FieldView& field, const KernelParticles& particles, const float* beam_x,
               const float* beam_y, std::size_t beams, std::uint32_t* sums, cpu::Simd simd);

/// cosine[i], sine[i] of yaw[i] in [-pi, pi], good to 1e-7; the same bits on every instruction set.
void cosine_sine(const double* yaw, std::size_t count, float* cosine, float* sine, cpu::Simd simd);

}  // namespace usher::amcl
