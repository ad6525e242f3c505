#pragma once

#include <vector>

#include "foundation/grid/free_space.hpp"

namespace usher::roadmap {

using geometry::Point2;
using grid::FreeSpace;

/// Algorithm 4 of the meeting report: passes over the path that leave out each way point whose
/// neighbors see each other, until nothing changes or `passes` are done.
void smooth(const FreeSpace& space, int passes, std::vector<Point2>& path);

/// Pulls the path tight, `passes` times: each way point moves as far toward the line between its
/// neighbors as both ways stay free, and a corner that remains is cut as far as the cut stays free.
/// Ends with smooth(). The path never gets longer.
void tighten(const FreeSpace& space, int passes, std::vector<Point2>& path);

/// [m]
double length(const std::vector<Point2>& path);

}  // namespace usher::roadmap
