#pragma once

#include <cstdint>
#include <vector>

#include "foundation/cpu/cpu.hpp"
#include "foundation/geometry/footprint.hpp"
#include "foundation/grid/costs.hpp"
#include "foundation/grid/grid.hpp"

namespace usher::local_planner {

using geometry::Footprint;

/// The lethal cells of a cost grid as bits, with a rim of set bits around the grid: what lies
/// outside is not known to be free. Words overlap (word w of a row starts at column 16 w), so any
/// 49 columns of a row lie in one word, and the words of consecutive rows are neighbours in memory,
/// so that one load takes several rows.
class LethalBits {
 public:
  static constexpr int kStride = 16;  // columns between the starts of neighbouring words
  static constexpr int kSpan = 49;    // columns that one word always holds from any column on

  /// Takes the lethal cells of `costs`; unknown cells too when `unknown_is_lethal`. `rim` columns
  /// and rows around the grid count as lethal: at least the reach of the footprint in cells.
  /// Allocates only when the grid grows.
  void assign(const grid::Grid<std::uint8_t>& costs, bool unknown_is_lethal, int rim);

  int rim() const { return rim_; }
  double cells_per_metre() const { return cells_per_metre_; }
  int rows() const {
    return rows_;
  }  ///< with the rim, a few spare rows after the last are readable
  int columns() const { return columns_; }
  /// The words of columns [16 w, 16 w + 63] of all rows, rim included.
  const std::uint64_t* words(int w) const {
    return words_.data() + static_cast<std::size_t>(w) * stride_;
  }
  /// Both counted with the rim.
  bool test(int column, int row) const;
  /// Makes a cell free, or lethal; both counted with the rim.
  void clear(int column, int row);
  void set(int column, int row);

 private:
  void fill_row(const std::uint8_t* costs, int width, bool unknown_is_lethal, int row);

  int rim_ = 0;
  double cells_per_metre_ = 0.0;
  int rows_ = 0;
  int columns_ = 0;
  std::size_t stride_ = 0;  // words from one word column to the next
  std::vector<std::uint64_t> words_;
  std::vector<std::uint64_t> line_;  // one row without overlap
};

/// What of a lethal cell must meet the footprint to be a contact.
enum class CellExtent {
  kWhole,   ///< any part of its square: nothing real inside a lethal cell is ever touched
  kCenter,  ///< its center: the unbiased reading, needed where the free width is the robot's own
};

/// The footprint turned to one yaw, in cells: the cell centers (relative to the base) that are in
/// contact are those with lower(y) <= x <= upper(y), both piecewise linear. For kWhole this is the
/// Minkowski sum of polygon and cell.
struct TurnedFootprint {
  static constexpr int kMaxSides = 64;
  double min_x = 0.0, max_x = 0.0, min_y = 0.0, max_y = 0.0;
  int lower_count = 0;
  int upper_count = 0;
  // x bound of side i on the line y: intercept + slope y.
  double lower_slope[kMaxSides], lower_intercept[kMaxSides];
  double upper_slope[kMaxSides], upper_intercept[kMaxSides];
};

/// Exact contact of a convex footprint with the lethal cells of a grid. Exact: for every pose the
/// answer is that of intersecting the polygon with each lethal cell (or its center), up to the
/// rounding of double precision. Portable and AVX2 paths execute the same operations in the same
/// order and agree bit for bit.
class ContactTest {
 public:
  ContactTest(const Footprint& footprint, CellExtent extent, cpu::Simd simd = cpu::best_simd());

  /// The footprint turned by the angle with this cosine and sine, for cells of `resolution` [m].
  void turn(double cosine, double sine, double resolution, TurnedFootprint& turned) const;

  /// True when the footprint at (x, y), in cells from the grid's lower-left corner, touches a
  /// lethal cell or leaves the known grid. The bits must have a rim of at least reach_cells(). Not
  /// finite: true.
  bool touches(const LethalBits& bits, const TurnedFootprint& turned, double x, double y) const;

  /// True when no lethal cell lies in the square of the circumscribed radius around (x, y):
  /// whatever the yaw, there is no contact. The quick acceptance before a footprint is turned.
  bool clear_around(const LethalBits& bits, double x, double y) const;

  /// Removes the cells that the footprint touches from `bits`; returns how many there were inside
  /// the grid.
  int erase_touched(LethalBits& bits, const TurnedFootprint& turned, double x, double y) const;

  /// Rows and columns around the base's cell that the footprint may touch.
  int reach_cells(double resolution) const;

 private:
  std::vector<geometry::Point2> corners_;
  std::vector<Footprint::Side> sides_;
  double circumscribed_ = 0.0;
  double half_ = 0.0;  // half a cell for kWhole, in cells
  bool avx2_ = false;
};

namespace detail {
struct Rows {
  int first = 0, last = 0;  // rows, rim included
  int first_column = 0, last_column = 0;
  double x = 0.0,
         y = 0.0;  // the base, rim included, less half a cell: a cell's center is at its index
};
bool touches_portable(const LethalBits& bits, const TurnedFootprint& turned, const Rows& rows);
bool touches_avx2(const LethalBits& bits, const TurnedFootprint& turned, const Rows& rows);
bool any_portable(const LethalBits& bits, const Rows& rows);
bool any_avx2(const LethalBits& bits, const Rows& rows);
}  // namespace detail

}  // namespace usher::local_planner
