#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "foundation/imaging/depth_image.hpp"
#include "perception/face_detector/core/depth_model.hpp"

namespace usher::face_detector {

/// A depth image in cells of 8 x 8 pixels: where the middle of a window can be.
class CellMap {
 public:
  static constexpr int kCell = 8;  ///< [pixels]

  CellMap();

  /// Depths [m]; empty by default.
  struct Span {
    double from = 1.0, to = 0.0;
  };

  /// No allocation while the size stays the same.
  void measure(const imaging::DepthImage& depth);
  int columns() const { return columns_; }
  int rows() const { return rows_; }

  /// 1 for each cell in which something lies at a depth in [from, to] [m] and stands out (see
  /// Plausibility) as the face of a window of `side` pixels would; 0 for the others. `model`
  /// says, by the cell's column, which of both spans counts. Returns how many.
  int mark(int side, const Span& center, const Span& beside, const DepthModel& model, double relief,
           std::span<std::uint8_t> marks) const;

  /// How far [m] a point [pixels] at a depth [m] stands before what is to its left and right, both
  /// added; each counts for at most 0.4 m, and so does what was not measured.
  double relief(double column, double row, double side, double depth) const;

 private:
  struct Cell {
    std::uint64_t depths = 0;  // one bit for every 5 % of depth
    std::uint32_t sum = 0;     // [mm]
    std::uint16_t count = 0;
    std::uint16_t mean = 0;  // [mm]; 0: nothing measured
  };
  static std::uint64_t bits_of(const Span& span);
  double stands_before(int column, int row, double depth) const;

  std::vector<std::uint8_t> bit_of_;  // by depth [mm]
  int width_ = 0, columns_ = 0, rows_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace usher::face_detector
