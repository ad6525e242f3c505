#include "perception/people_detector/core/assignment.hpp"

#include <algorithm>
#include <limits>

namespace usher::people_detector {

/// Shortest augmenting paths with potentials; row and column 0 are sentinels. The problem is made
/// square: whom nobody fits pays `forbidden`.
std::span<const int> Assignment::solve(std::span<const double> costs, int rows, int columns,
                                       double forbidden) {
  const int size = std::max(rows, columns);
  const auto n = static_cast<std::size_t>(size);
  const auto wide = static_cast<std::size_t>(columns);
  square_.assign(n * n, forbidden);
  for (std::size_t r = 0; r < static_cast<std::size_t>(rows); ++r) {
    for (std::size_t c = 0; c < wide; ++c)
      square_[r * n + c] = std::min(forbidden, costs[r * wide + c]);
  }
  row_potential_.assign(n + 1, 0.0);
  column_potential_.assign(n + 1, 0.0);
  row_of_.assign(n + 1, 0);
  way_.assign(n + 1, 0);
  for (int row = 1; row <= size; ++row) {
    row_of_[0] = row;
    std::size_t column = 0;
    slack_.assign(n + 1, std::numeric_limits<double>::infinity());
    visited_.assign(n + 1, 0);
    do {
      visited_[column] = 1;
      const auto here = static_cast<std::size_t>(row_of_[column]);
      double least = std::numeric_limits<double>::infinity();
      std::size_t next = 0;
      for (std::size_t c = 1; c <= n; ++c) {
        if (visited_[c]) continue;
        const double reduced =
            square_[(here - 1) * n + c - 1] - row_potential_[here] - column_potential_[c];
        if (reduced < slack_[c]) slack_[c] = reduced, way_[c] = static_cast<int>(column);
        if (slack_[c] < least) least = slack_[c], next = c;
      }
      for (std::size_t c = 0; c <= n; ++c) {
        if (visited_[c]) {
          row_potential_[static_cast<std::size_t>(row_of_[c])] += least;
          column_potential_[c] -= least;
        } else {
          slack_[c] -= least;
        }
      }
      column = next;
    } while (row_of_[column] != 0);
    for (; column != 0; column = static_cast<std::size_t>(way_[column]))
      row_of_[column] = row_of_[static_cast<std::size_t>(way_[column])];
  }
  result_.assign(static_cast<std::size_t>(rows), -1);
  for (std::size_t c = 1; c <= wide; ++c) {
    const int row = row_of_[c] - 1;
    if (row >= rows || row < 0) continue;
    if (square_[static_cast<std::size_t>(row) * n + c - 1] < forbidden)
      result_[static_cast<std::size_t>(row)] = static_cast<int>(c) - 1;
  }
  return result_;
}

}  // namespace usher::people_detector
