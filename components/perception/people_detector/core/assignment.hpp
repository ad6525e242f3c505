#pragma once

#include <span>
#include <vector>

namespace usher::people_detector {

/// Pairs rows and columns so that the sum of costs is least [kuhn1955hungarian].
class Assignment {
 public:
  /// `costs` has `rows * columns` values, row by row, finite. The result has the column of each row
  /// or -1; rows and columns whose cost is `forbidden` or more stay alone. O(n^3); no allocation
  /// once it has seen the largest problem. The view stays valid until the next call.
  std::span<const int> solve(std::span<const double> costs, int rows, int columns,
                             double forbidden);

 private:
  std::vector<double> square_, row_potential_, column_potential_, slack_;
  std::vector<int> row_of_, way_, result_;
  std::vector<char> visited_;
};

}  // namespace usher::people_detector
