#include "perception/face_detector/core/cell_map.hpp"

#include <algorithm>
#include <cmath>

namespace usher::face_detector {

namespace {
constexpr double kBeside = 1.1;  // of a box' side: so far from its middle there is no head any more
constexpr double kMost = 0.4;    // [m] that one side counts for
constexpr double kLeast = -0.1;  // [m]
constexpr std::size_t kDepths = 6000;  // [mm] farther ones are all the same

/// Bit 0 is nearer than 0.25 m, bit 63 farther than 5 m: no face is there.
int bit(double depth) {
  constexpr double kFirst = 0.25, kPerDoubling = 14.5;
  return std::clamp(1 + static_cast<int>(std::floor(kPerDoubling * std::log2(depth / kFirst))), 0,
                    63);
}

}  // namespace

CellMap::CellMap() : bit_of_(kDepths) {
  for (std::size_t i = 1; i < kDepths; ++i)
    bit_of_[i] = static_cast<std::uint8_t>(bit(1e-3 * static_cast<double>(i)));
}

std::uint64_t CellMap::bits_of(const Span& span) {
  if (!(span.from <= span.to)) return 0;
  std::uint64_t bits = 0;
  for (int i = bit(span.from); i <= bit(span.to); ++i) bits |= std::uint64_t{1} << i;
  return bits;
}

void CellMap::measure(const imaging::DepthImage& depth) {
  width_ = depth.width;
  columns_ = (depth.width + kCell - 1) / kCell;
  rows_ = (depth.height + kCell - 1) / kCell;
  cells_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), {});
  for (int row = 0; row < depth.height; ++row) {
    const std::uint16_t* pixel =
        depth.millimeters.data() + static_cast<std::ptrdiff_t>(row) * depth.width;
    Cell* cell = cells_.data() + static_cast<std::ptrdiff_t>(row / kCell) * columns_;
    for (int column = 0; column < depth.width; column += kCell, ++cell) {
      for (const auto* end = pixel + std::min(kCell, depth.width - column); pixel < end; ++pixel) {
        if (*pixel == 0) continue;
        cell->depths |= std::uint64_t{1} << bit_of_[std::min<std::size_t>(*pixel, kDepths - 1)];
        cell->sum += *pixel;
        ++cell->count;
      }
    }
  }
  for (Cell& cell : cells_) {
    if (cell.count > 0) cell.mean = static_cast<std::uint16_t>(cell.sum / cell.count);
  }
}

double CellMap::stands_before(int column, int row, double depth) const {
  if (column < 0 || column >= columns_) return kMost;
  const std::uint16_t mean =
      cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
             static_cast<std::size_t>(column)]
          .mean;
  return mean == 0 ? kMost : std::clamp(1e-3 * mean - depth, kLeast, kMost);
}

double CellMap::relief(double column, double row, double side, double depth) const {
  const int at = std::clamp(static_cast<int>(row) / kCell, 0, rows_ - 1);
  const auto cell = [](double pixel) { return static_cast<int>(std::floor(pixel / kCell)); };
  return stands_before(cell(column - kBeside * side), at, depth) +
         stands_before(cell(column + kBeside * side), at, depth);
}

int CellMap::mark(int side, const Span& center, const Span& beside, const DepthModel& model,
                  double relief, std::span<std::uint8_t> marks) const {
  const std::uint64_t center_bits = bits_of(center), beside_bits = bits_of(beside);
  int count = 0;
  std::size_t i = 0;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column, ++i) {
      const double middle = (column + 0.5) * kCell;
      const bool is_center = model.is_center(middle, width_);
      const Span& span = is_center ? center : beside;
      const Cell& cell = cells_[i];
      marks[i] = 0;
      if ((cell.depths & (is_center ? center_bits : beside_bits)) == 0) continue;
      const double depth = std::clamp(1e-3 * cell.mean, span.from, span.to);
      if (relief > 0.0 && this->relief(middle, (row + 0.5) * kCell, side, depth) < relief) continue;
      marks[i] = 1;
      ++count;
    }
  }
  return count;
}

}  // namespace usher::face_detector
