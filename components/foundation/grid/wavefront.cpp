#include "foundation/grid/wavefront.hpp"

#include <algorithm>
#include <cassert>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace usher::grid {
namespace {

constexpr std::uint16_t kStraight = 5;
constexpr std::uint16_t kDiagonal = 7;

/// row = min(row, shortest way through the row before); returns the bits that changed. Lengths are
/// at most kUnreachable, so the sums cannot wrap.
[[gnu::always_inline]] inline std::uint16_t advance_row(std::uint16_t* __restrict row,
                                                        const std::uint16_t* __restrict closed,
                                                        const std::uint16_t* __restrict before,
                                                        std::size_t width) {
  std::uint16_t changed = 0;
  for (std::size_t x = 0; x < width; ++x) {
    const std::uint16_t left = before[x];
    const std::uint16_t middle = before[x + 1];
    const std::uint16_t right = before[x + 2];
    const std::uint16_t beside = left < right ? left : right;
    const auto diagonal = static_cast<std::uint16_t>(beside + kDiagonal);
    const auto straight = static_cast<std::uint16_t>(middle + kStraight);
    const std::uint16_t shortest = diagonal < straight ? diagonal : straight;
    const auto open = static_cast<std::uint16_t>(shortest | closed[x]);
    const std::uint16_t old = row[x];
    const std::uint16_t now = open < old ? open : old;
    changed = static_cast<std::uint16_t>(changed | (now ^ old));
    row[x] = now;
  }
  return changed;
}

/// Once downward and once upward. `first` is column 0 of row 0, a row of rim lies before and after.
[[gnu::always_inline]] inline bool sweep_both(std::uint16_t* lengths, const std::uint16_t* closed,
                                              std::size_t stride, std::size_t width, int height) {
  std::uint16_t changed = 0;
  for (int y = 1; y < height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * stride;
    changed = static_cast<std::uint16_t>(
        changed | advance_row(lengths + row, closed + row, lengths + row - stride - 1, width));
  }
  for (int y = height - 2; y >= 0; --y) {
    const std::size_t row = static_cast<std::size_t>(y) * stride;
    changed = static_cast<std::uint16_t>(
        changed | advance_row(lengths + row, closed + row, lengths + row + stride - 1, width));
  }
  return changed != 0;
}

bool sweep_portable(std::uint16_t* lengths, const std::uint16_t* closed, std::size_t stride,
                    std::size_t width, int height) {
  return sweep_both(lengths, closed, stride, width, height);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) bool sweep_avx2(std::uint16_t* lengths, const std::uint16_t* closed,
                                                std::size_t stride, std::size_t width, int height) {
  return sweep_both(lengths, closed, stride, width, height);
}
#else
constexpr auto sweep_avx2 = sweep_portable;
#endif

/// An 8 x 8 block of `from` (rows `from_stride` apart) transposed into `to`.
void transpose_block(const std::uint16_t* from, std::size_t from_stride, std::uint16_t* to,
                     std::size_t to_stride) {
#if defined(__SSE2__)
  __m128i r[8];
  for (std::size_t i = 0; i < 8; ++i)
    r[i] = _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + i * from_stride));
  __m128i a[8];
  for (int i = 0; i < 4; ++i) {
    a[2 * i] = _mm_unpacklo_epi16(r[2 * i], r[2 * i + 1]);
    a[2 * i + 1] = _mm_unpackhi_epi16(r[2 * i], r[2 * i + 1]);
  }
  __m128i b[8];
  for (int i = 0; i < 2; ++i) {
    b[4 * i] = _mm_unpacklo_epi32(a[4 * i], a[4 * i + 2]);
    b[4 * i + 1] = _mm_unpackhi_epi32(a[4 * i], a[4 * i + 2]);
    b[4 * i + 2] = _mm_unpacklo_epi32(a[4 * i + 1], a[4 * i + 3]);
    b[4 * i + 3] = _mm_unpackhi_epi32(a[4 * i + 1], a[4 * i + 3]);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + 2 * i * to_stride),
                     _mm_unpacklo_epi64(b[i], b[i + 4]));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + (2 * i + 1) * to_stride),
                     _mm_unpackhi_epi64(b[i], b[i + 4]));
  }
#else
  for (std::size_t y = 0; y < 8; ++y) {
    for (std::size_t x = 0; x < 8; ++x) to[x * to_stride + y] = from[y * from_stride + x];
  }
#endif
}

}  // namespace

void Wavefront::Plane::resize(int w, int h) {
  width = w, height = h;
  // Room for whole blocks of eight beyond the last column and row, which stay closed.
  stride = kLeft + static_cast<std::size_t>((w + 15) / 16 * 16) + 16;
  const std::size_t size = stride * static_cast<std::size_t>(h + 2 + 8);
  closed.assign(size, 0xffff);
  lengths.assign(size, kUnreachable);
}

namespace {

/// All of a plane's lengths (or closed flags) into the transposed plane, in blocks.
void transpose(const std::uint16_t* from, std::size_t from_stride, int width, int height,
               std::uint16_t* to, std::size_t to_stride) {
  for (int y = 0; y < height; y += 8) {
    for (int x = 0; x < width; x += 8) {
      const auto sx = static_cast<std::size_t>(x);
      const auto sy = static_cast<std::size_t>(y);
      transpose_block(from + sy * from_stride + sx, from_stride, to + sx * to_stride + sy,
                      to_stride);
    }
  }
}

}  // namespace

void Wavefront::set_obstacles(const Grid<std::uint8_t>& costs, std::uint8_t closed_from,
                              bool unknown_is_closed) {
  assert(costs.width() <= kLargestSide && costs.height() <= kLargestSide);
  upright_.resize(costs.width(), costs.height());
  lying_.resize(costs.height(), costs.width());
  const auto width = static_cast<std::size_t>(costs.width());
  for (int y = 0; y < costs.height(); ++y) {
    const std::uint8_t* __restrict row = costs.row(y);
    std::uint16_t* __restrict closed = upright_.closed.data() + upright_.index(0, y);
    const std::uint8_t unknown = unknown_is_closed ? 255 : 0;
    for (std::size_t x = 0; x < width; ++x) {
      const std::uint8_t cost = row[x] == 255 ? unknown : row[x];
      closed[x] = cost >= closed_from ? 0xffff : 0;
    }
  }
  transpose(upright_.closed.data() + upright_.index(0, 0), upright_.stride, upright_.width,
            upright_.height, lying_.closed.data() + lying_.index(0, 0), lying_.stride);
}

bool Wavefront::sweep(Plane& plane) const {
  const auto kernel = avx2_ ? sweep_avx2 : sweep_portable;
  // Whole vectors: the columns after the last are closed and stay unreachable.
  const auto width = static_cast<std::size_t>((plane.width + 15) / 16 * 16);
  return kernel(plane.lengths.data() + plane.index(0, 0), plane.closed.data() + plane.index(0, 0),
                plane.stride, width, plane.height);
}

void Wavefront::spread(Cell target, std::vector<std::uint16_t>& lengths) {
  assert(target.x >= 0 && target.y >= 0 && target.x < upright_.width && target.y < upright_.height);
  std::fill(upright_.lengths.begin(), upright_.lengths.end(), kUnreachable);
  upright_.lengths[upright_.index(target.x, target.y)] = 0;
  std::uint16_t* const upright = upright_.lengths.data() + upright_.index(0, 0);
  std::uint16_t* const lying = lying_.lengths.data() + lying_.index(0, 0);
  // Done when both planes, one after the other, have nothing to add. A round that changes something
  // settles at least one more cell for good.
  const int most_rounds = upright_.width * upright_.height + 2;
  bool lying_changed = true;
  for (rounds_ = 1; rounds_ <= most_rounds; ++rounds_) {
    const bool upright_changed = sweep(upright_);
    if (!upright_changed && !lying_changed) break;
    transpose(upright, upright_.stride, upright_.width, upright_.height, lying, lying_.stride);
    lying_changed = sweep(lying_);
    if (!upright_changed && !lying_changed) break;
    transpose(lying, lying_.stride, lying_.width, lying_.height, upright, upright_.stride);
  }
  lengths.resize(static_cast<std::size_t>(upright_.width) *
                 static_cast<std::size_t>(upright_.height));
  for (int y = 0; y < upright_.height; ++y) {
    const std::uint16_t* row = upright + static_cast<std::size_t>(y) * upright_.stride;
    std::copy(row, row + upright_.width,
              lengths.begin() +
                  static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(upright_.width));
  }
}

}  // namespace usher::grid
