#include "navigation/local_planner/core/contact.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace usher::local_planner {
namespace {

constexpr double kVertical =
    1e-9;  // a side whose normal has a smaller x bounds rows only, which the box does too
constexpr int kSpareRows =
    8;  // readable after the last row, so that kernels may take several rows at once
constexpr double kFarAway =
    1e6;  // [cells] poses beyond are outside any grid and would overflow an int

/// The smallest whole number not below a value that is not negative.
int rounded_up(double value) {
  const int whole = static_cast<int>(value);
  return whole + (value > whole ? 1 : 0);
}

/// 16 costs to 16 bits, 1 = lethal.
std::uint64_t lethal_bits16(const std::uint8_t* costs, bool unknown_is_lethal) {
#if defined(__SSE2__)
  const __m128i values = _mm_loadu_si128(reinterpret_cast<const __m128i*>(costs));
  __m128i lethal = _mm_cmpeq_epi8(values, _mm_set1_epi8(static_cast<char>(grid::kLethalCost)));
  if (unknown_is_lethal) {
    lethal = _mm_or_si128(
        lethal, _mm_cmpeq_epi8(values, _mm_set1_epi8(static_cast<char>(grid::kUnknownCost))));
  }
  return static_cast<std::uint64_t>(_mm_movemask_epi8(lethal));
#else
  std::uint64_t bits = 0;
  for (int i = 0; i < 16; ++i) {
    const bool lethal =
        costs[i] == grid::kLethalCost || (unknown_is_lethal && costs[i] == grid::kUnknownCost);
    bits |= static_cast<std::uint64_t>(lethal) << i;
  }
  return bits;
#endif
}

}  // namespace

void LethalBits::assign(const grid::Grid<std::uint8_t>& costs, bool unknown_is_lethal, int rim) {
  rim_ = rim;
  cells_per_metre_ = 1.0 / costs.resolution();
  rows_ = costs.height() + 2 * rim;
  columns_ = costs.width() + 2 * rim;
  stride_ = static_cast<std::size_t>(rows_ + kSpareRows);
  const auto word_columns = static_cast<std::size_t>(columns_ / kStride + 1);
  words_.assign(stride_ * word_columns, ~std::uint64_t{0});
  line_.resize(static_cast<std::size_t>(columns_ / 64 + 4));
  for (int y = 0; y < costs.height(); ++y)
    fill_row(costs.row(y), costs.width(), unknown_is_lethal, y + rim);
}

void LethalBits::fill_row(const std::uint8_t* costs, int width, bool unknown_is_lethal, int row) {
  std::fill(line_.begin(), line_.end(), ~std::uint64_t{0});
  const auto clear_bits = [this](int column, std::uint64_t free) {
    const auto word = static_cast<std::size_t>(column / 64);
    const int shift = column % 64;
    line_[word] &= ~(free << shift);
    if (shift != 0) line_[word + 1] &= ~(free >> (64 - shift));
  };
  int x = 0;
  for (; x + 16 <= width; x += 16) {
    clear_bits(x + rim_, ~lethal_bits16(costs + x, unknown_is_lethal) & 0xffffU);
  }
  for (; x < width; ++x) {
    const bool lethal =
        costs[x] == grid::kLethalCost || (unknown_is_lethal && costs[x] == grid::kUnknownCost);
    if (!lethal) clear_bits(x + rim_, 1);
  }
  const int word_columns = columns_ / kStride + 1;
  for (int w = 0; w < word_columns; ++w) {
    const int column = w * kStride;
    const auto word = static_cast<std::size_t>(column / 64);
    const int shift = column % 64;
    std::uint64_t bits = line_[word] >> shift;
    if (shift != 0) bits |= line_[word + 1] << (64 - shift);
    words_[static_cast<std::size_t>(w) * stride_ + static_cast<std::size_t>(row)] = bits;
  }
}

bool LethalBits::test(int column, int row) const {
  return (words(column / kStride)[row] >> (column % kStride)) & 1U;
}

void LethalBits::clear(int column, int row) {
  for (int w = std::max(0, (column - 63 + kStride - 1) / kStride); w <= column / kStride; ++w) {
    words_[static_cast<std::size_t>(w) * stride_ + static_cast<std::size_t>(row)] &=
        ~(std::uint64_t{1} << (column - w * kStride));
  }
}

void LethalBits::set(int column, int row) {
  for (int w = std::max(0, (column - 63 + kStride - 1) / kStride); w <= column / kStride; ++w) {
    words_[static_cast<std::size_t>(w) * stride_ + static_cast<std::size_t>(row)] |=
        std::uint64_t{1} << (column - w * kStride);
  }
}

ContactTest::ContactTest(const Footprint& footprint, CellExtent extent, cpu::Simd simd)
    : corners_(footprint.corners().begin(), footprint.corners().end()),
      sides_(footprint.sides().begin(), footprint.sides().end()),
      circumscribed_(footprint.circumscribed_radius()),
      half_(extent == CellExtent::kWhole ? 0.5 : 0.0),
      avx2_(simd == cpu::Simd::kAvx2) {
  assert(sides_.size() <= TurnedFootprint::kMaxSides);
}

int ContactTest::reach_cells(double resolution) const {
  return static_cast<int>(std::ceil(circumscribed_ / resolution)) + 2;
}

void ContactTest::turn(double cosine, double sine, double resolution,
                       TurnedFootprint& turned) const {
  const double scale = 1.0 / resolution;
  turned.min_x = turned.min_y = 1e9;
  turned.max_x = turned.max_y = -1e9;
  for (const geometry::Point2& corner : corners_) {
    const double x = (cosine * corner.x() - sine * corner.y()) * scale;
    const double y = (sine * corner.x() + cosine * corner.y()) * scale;
    turned.min_x = std::min(turned.min_x, x), turned.max_x = std::max(turned.max_x, x);
    turned.min_y = std::min(turned.min_y, y), turned.max_y = std::max(turned.max_y, y);
  }
  turned.min_x -= half_, turned.max_x += half_;
  turned.min_y -= half_, turned.max_y += half_;
  turned.lower_count = turned.upper_count = 0;
  for (const Footprint::Side& side : sides_) {
    const double nx = cosine * side.normal_x - sine * side.normal_y;
    const double ny = sine * side.normal_x + cosine * side.normal_y;
    if (std::abs(nx) < kVertical) continue;
    const double inverse = 1.0 / nx;
    // A cell meets the side's half-plane when its corner nearest to the inside does.
    const double intercept =
        (side.offset * scale + half_ * (std::abs(nx) + std::abs(ny))) * inverse;
    const double slope = -ny * inverse;
    if (nx < 0.0) {
      turned.lower_slope[turned.lower_count] = slope;
      turned.lower_intercept[turned.lower_count++] = intercept;
    } else {
      turned.upper_slope[turned.upper_count] = slope;
      turned.upper_intercept[turned.upper_count++] = intercept;
    }
  }
}

bool ContactTest::touches(const LethalBits& bits, const TurnedFootprint& turned, double x,
                          double y) const {
  detail::Rows rows;
  rows.x = x + bits.rim() - 0.5;
  rows.y = y + bits.rim() - 0.5;
  const double low_x = rows.x + turned.min_x;
  const double low_y = rows.y + turned.min_y;
  const double high_x = rows.x + turned.max_x;
  const double high_y = rows.y + turned.max_y;
  // A corner beyond the rim's middle lies in the rim: a contact. So is what is not finite.
  if (!(low_x >= 0.0 && low_y >= 0.0 && high_x < bits.columns() && high_y < bits.rows())) {
    return true;
  }
  rows.first = rounded_up(low_y);
  rows.last = static_cast<int>(high_y);
  rows.first_column = rounded_up(low_x);
  rows.last_column = static_cast<int>(high_x);
  return avx2_ ? detail::touches_avx2(bits, turned, rows)
               : detail::touches_portable(bits, turned, rows);
}

bool ContactTest::clear_around(const LethalBits& bits, double x, double y) const {
  const double reach = circumscribed_ * bits.cells_per_metre();
  // Cells whose square is within reach along both axes: a superset of what any yaw touches.
  const double low_x = x + bits.rim() - reach;
  const double low_y = y + bits.rim() - reach;
  const double high_x = x + bits.rim() + reach;
  const double high_y = y + bits.rim() + reach;
  if (!(low_x >= 0.0 && low_y >= 0.0 && high_x < bits.columns() && high_y < bits.rows())) {
    return false;
  }
  detail::Rows rows;
  rows.first = static_cast<int>(low_y);
  rows.last = static_cast<int>(high_y);
  rows.first_column = static_cast<int>(low_x);
  rows.last_column = static_cast<int>(high_x);
  return !(avx2_ ? detail::any_avx2(bits, rows) : detail::any_portable(bits, rows));
}

int ContactTest::erase_touched(LethalBits& bits, const TurnedFootprint& turned, double x,
                               double y) const {
  const double px = x + bits.rim() - 0.5;
  const double py = y + bits.rim() - 0.5;
  int erased = 0;
  for (int row = bits.rim(); row < bits.rows() - bits.rim(); ++row) {
    const double line = row - py;
    if (!(line >= turned.min_y && line <= turned.max_y)) continue;
    double low = turned.min_x;
    double high = turned.max_x;
    for (int i = 0; i < turned.lower_count; ++i) {
      low = std::max(low, turned.lower_intercept[i] + turned.lower_slope[i] * line);
    }
    for (int i = 0; i < turned.upper_count; ++i) {
      high = std::min(high, turned.upper_intercept[i] + turned.upper_slope[i] * line);
    }
    low = std::min(low, turned.max_x + 1.0);
    high = std::max(high, turned.min_x - 1.0);
    const int first = std::max(static_cast<int>(std::ceil(px + low)), bits.rim());
    const int last =
        std::min(static_cast<int>(std::floor(px + high)), bits.columns() - bits.rim() - 1);
    for (int column = first; column <= last; ++column) {
      if (bits.test(column, row)) bits.clear(column, row), ++erased;
    }
  }
  return erased;
}

namespace detail {

bool touches_portable(const LethalBits& bits, const TurnedFootprint& turned, const Rows& rows) {
  for (int base = rows.first_column; base <= rows.last_column; base += LethalBits::kSpan) {
    const std::uint64_t* words = bits.words(base / LethalBits::kStride);
    const int shift = base % LethalBits::kStride;
    const int width = std::min(LethalBits::kSpan, rows.last_column - base + 1);
    const std::uint64_t box = ~std::uint64_t{0} >> (64 - width);
    for (int row = rows.first; row <= rows.last; ++row) {
      const std::uint64_t lethal = (words[row] >> shift) & box;
      if (lethal == 0) continue;
      const double line = row - rows.y;
      double low = turned.min_x;
      double high = turned.max_x;
      for (int i = 0; i < turned.lower_count; ++i) {
        low = std::max(low, turned.lower_intercept[i] + turned.lower_slope[i] * line);
      }
      for (int i = 0; i < turned.upper_count; ++i) {
        high = std::min(high, turned.upper_intercept[i] + turned.upper_slope[i] * line);
      }
      low = std::min(low, turned.max_x + 1.0);  // near-vertical sides give bounds that no int holds
      high = std::max(high, turned.min_x - 1.0);
      const int first = std::max(static_cast<int>(std::ceil(rows.x + low)) - base, 0);
      const int last = std::min(static_cast<int>(std::floor(rows.x + high)) - base, 63);
      if (first > 63 || last < first) continue;
      if (((lethal >> first) << first) & (~std::uint64_t{0} >> (63 - last))) return true;
    }
  }
  return false;
}

bool any_portable(const LethalBits& bits, const Rows& rows) {
  for (int base = rows.first_column; base <= rows.last_column; base += LethalBits::kSpan) {
    const std::uint64_t* words = bits.words(base / LethalBits::kStride);
    const int width = std::min(LethalBits::kSpan, rows.last_column - base + 1);
    const std::uint64_t box = (~std::uint64_t{0} >> (64 - width)) << (base % LethalBits::kStride);
    std::uint64_t any = 0;
    for (int row = rows.first; row <= rows.last; ++row) any |= words[row];
    if (any & box) return true;
  }
  return false;
}

#if !defined(__x86_64__)
bool touches_avx2(const LethalBits& bits, const TurnedFootprint& turned, const Rows& rows) {
  return touches_portable(bits, turned, rows);
}
bool any_avx2(const LethalBits& bits, const Rows& rows) { return any_portable(bits, rows); }
#endif

}  // namespace detail
}  // namespace usher::local_planner
