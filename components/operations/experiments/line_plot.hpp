#pragma once

#include <string>
#include <utility>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::operations {

struct Curve {
  std::string label;  ///< empty: not in the legend
  int red = 0, green = 0, blue = 0;
  std::vector<std::pair<double, double>> points;  ///< x, y; what is not finite is left out
};

/// Curves over common axes as a picture (PNG). Both axes begin at 0 or below, wherever the points
/// begin, and are marked at round numbers.
Status draw_plot(const std::vector<Curve>& curves, const std::string& title,
                 const std::string& x_label, const std::string& y_label, const std::string& path);

}  // namespace usher::operations
