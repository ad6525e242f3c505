#include "navigation/roadmap/core/path_smoother.hpp"

#include <algorithm>

namespace usher::roadmap {

namespace {

constexpr int kHalvings = 4;           // of the search for the farthest free place
constexpr int kUntilUnchanged = 100;   // passes of smooth() that end tighten()
constexpr double kWorthwhile = 0.004;  // [m] a shorter detour stays
constexpr std::size_t kMostPoints = 500;

/// The greatest share in [0, 1] for which `free` holds, to 1 / 2^kHalvings; 0 where none does.
template <class Free>
double greatest_share(Free&& free) {
  if (free(1.0)) return 1.0;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (free(middle) ? low : high) = middle;
  }
  return low;
}

Point2 on_line(const Point2& a, const Point2& b, const Point2& point) {
  const Point2 way = b - a;
  const double squared = way.squaredNorm();
  if (squared == 0.0) return a;
  return a + way * std::clamp((point - a).dot(way) / squared, 0.0, 1.0);
}

/// [m] that the way from a to c over b is longer than the straight one.
double detour(const Point2& a, const Point2& b, const Point2& c) {
  return (b - a).norm() + (c - b).norm() - (c - a).norm();
}

void pull(const FreeSpace& space, std::vector<Point2>& path) {
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const Point2& a = path[i - 1];
    const Point2& c = path[i + 1];
    if (detour(a, path[i], c) < kWorthwhile) continue;
    const Point2 from = path[i], to = on_line(a, c, from);
    const double share = greatest_share([&](double s) {
      const Point2 b = from + s * (to - from);
      return space.line_free(a, b) && space.line_free(b, c);
    });
    path[i] = from + share * (to - from);
  }
}

void cut_corners(const FreeSpace& space, std::vector<Point2>& path, std::vector<Point2>& cut) {
  cut.assign(1, path.front());
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const Point2& b = path[i];
    const Point2 back = 0.5 * (cut.back() - b), ahead = 0.5 * (path[i + 1] - b);
    const bool worthwhile =
        detour(b + back, b, b + ahead) > kWorthwhile && cut.size() + path.size() - i < kMostPoints;
    const double share =
        worthwhile
            ? greatest_share([&](double s) { return space.line_free(b + s * back, b + s * ahead); })
            : 0.0;
    if (share > 0.0) cut.push_back(b + share * back);
    cut.push_back(b + share * ahead);
  }
  cut.push_back(path.back());
  path.swap(cut);
}

}  // namespace

void smooth(const FreeSpace& space, int passes, std::vector<Point2>& path) {
  for (int pass = 0; pass < passes && path.size() > 2; ++pass) {
    // Kept points move to the front; the last of them is the `a` of the algorithm.
    std::size_t kept = 0;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const bool redundant = i + 1 < path.size() && space.line_free(path[kept], path[i + 1]);
      if (!redundant) path[++kept] = path[i];
    }
    if (kept + 1 == path.size()) return;
    path.resize(kept + 1);
  }
}

void tighten(const FreeSpace& space, int passes, std::vector<Point2>& path) {
  std::vector<Point2> cut;
  for (int pass = 0; pass < passes && path.size() > 2; ++pass) {
    pull(space, path);
    cut_corners(space, path, cut);
  }
  if (passes > 0) smooth(space, kUntilUnchanged, path);
}

double length(const std::vector<Point2>& path) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (path[i] - path[i - 1]).norm();
  return sum;
}

}  // namespace usher::roadmap
