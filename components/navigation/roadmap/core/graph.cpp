#include "navigation/roadmap/core/graph.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace usher::roadmap {

namespace {

constexpr double kVerticesPerBucket = 1.0;  // over the whole plane; where it is free there are more
constexpr int kMostBucketsAcross = 2048;
constexpr double kWiden = 1.5;     // when too few were found
constexpr double kHeadroom = 1.1;  // over the radius that the vertex before needed

/// Nearest first. Distances are not negative, so their bits are in the order of their values.
void sort(std::vector<Graph::Candidate>& found) {
  static_assert(sizeof(Graph::Candidate) == sizeof(std::uint64_t));
  const auto key = [](const Graph::Candidate& c) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(c.squared_distance)} << 32 | c.vertex;
  };
  std::sort(found.begin(), found.end(),
            [&](const auto& a, const auto& b) { return key(a) < key(b); });
}

}  // namespace

void Graph::reset(std::span<const Point2> points) {
  links_.clear();
  usable_.clear();
  ends_.clear();
  built_edges_ = 0;
  index(points);
  first_.assign(points.size(), kNone);
  neighbor_.assign(points.size(), 0);
  inside_.assign(points.size(), 0);
  reached_.assign(points.size(), 0);
  tried_within_.assign(points.size(), -1.0F);
  round_ = 0;
  last_radius_ = usual_radius(30);
}

void Graph::index(std::span<const Point2> points) {
  vertices_.assign(points.size(), Point2::Zero());
  Point2 low = Point2::Zero(), high = Point2::Zero();
  if (!points.empty()) low = high = points.front();
  for (const Point2& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Point2 extent = high - low;
  const double count = static_cast<double>(std::max<std::size_t>(1, points.size()));
  bucket_side_ = std::max({std::sqrt(extent.x() * extent.y() * kVerticesPerBucket / count),
                           extent.maxCoeff() / kMostBucketsAcross, 1e-3});
  origin_ = low;
  columns_ = static_cast<int>(extent.x() / bucket_side_) + 1;
  rows_ = static_cast<int>(extent.y() / bucket_side_) + 1;
  bucket_begin_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (const Point2& p : points) ++bucket_begin_[bucket(p) + 1];
  for (std::size_t i = 1; i < bucket_begin_.size(); ++i) bucket_begin_[i] += bucket_begin_[i - 1];
  std::vector<std::uint32_t> at(bucket_begin_.begin(), bucket_begin_.end() - 1);
  for (const Point2& p : points) vertices_[at[bucket(p)]++] = p;
}

int Graph::column_of(double x) const {
  return static_cast<int>(std::clamp((x - origin_.x()) / bucket_side_, 0.0, columns_ - 1.0));
}

int Graph::row_of(double y) const {
  return static_cast<int>(std::clamp((y - origin_.y()) / bucket_side_, 0.0, rows_ - 1.0));
}

std::size_t Graph::bucket(const Point2& point) const {
  return static_cast<std::size_t>(row_of(point.y())) * static_cast<std::size_t>(columns_) +
         static_cast<std::size_t>(column_of(point.x()));
}

double Graph::usual_radius(std::size_t count) const {
  return bucket_side_ * std::sqrt(static_cast<double>(count) / (3.0 * kVerticesPerBucket));
}

void Graph::gather(const Point2& point, double radius, std::vector<Candidate>& found) const {
  found.clear();
  const auto left = static_cast<std::size_t>(column_of(point.x() - radius));
  const auto right = static_cast<std::size_t>(column_of(point.x() + radius));
  const auto limit = static_cast<float>(radius * radius);
  for (int row = row_of(point.y() - radius); row <= row_of(point.y() + radius); ++row) {
    const auto base = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    const std::uint32_t end = bucket_begin_[base + right + 1];
    for (std::uint32_t v = bucket_begin_[base + left]; v < end; ++v) {
      const double dx = vertices_[v].x() - point.x(), dy = vertices_[v].y() - point.y();
      const auto squared = static_cast<float>(dx * dx + dy * dy);
      if (squared <= limit) found.push_back({squared, v});
    }
  }
}

void Graph::nearest(const Point2& point, std::size_t count, double radius,
                    std::vector<Candidate>& found) const {
  count = std::min(count, size());
  found.clear();
  if (count == 0) return;
  for (gather(point, radius, found); found.size() < count; gather(point, radius, found))
    radius *= kWiden;
  sort(found);
  found.resize(count);
}

void Graph::join(std::uint32_t a, std::uint32_t b, double length) {
  const auto edge = static_cast<std::uint32_t>(usable_.size());
  usable_.push_back(1);
  ends_.push_back({a, b});
  const auto at = static_cast<std::uint32_t>(links_.size());
  links_.push_back({b, first_[a], edge, static_cast<float>(length)});
  links_.push_back({a, first_[b], edge, static_cast<float>(length)});
  first_[a] = at;
  first_[b] = at + 1;
}

void Graph::connect(const FreeSpace& space, const ConnectionParameters& parameters,
                    Random& random) {
  for (std::uint32_t v = 0; v < size(); ++v) connect_vertex(v, space, parameters, random);
  built_edges_ = usable_.size();
  compact();
}

/// Lays the links of each vertex side by side.
void Graph::compact() {
  std::vector<Link> ordered;
  ordered.reserve(links_.size());
  for (std::uint32_t v = 0; v < size(); ++v) {
    const auto begin = static_cast<std::uint32_t>(ordered.size());
    for (std::uint32_t at = first_[v]; at != kNone; at = links_[at].next) {
      ordered.push_back(links_[at]);
      ordered.back().next = static_cast<std::uint32_t>(ordered.size());
    }
    if (first_[v] == kNone) continue;
    ordered.back().next = kNone;
    first_[v] = begin;
  }
  links_.swap(ordered);
}

/// Starts a round for v: notes who is joined to it already; returns how many.
int Graph::note_neighbors(std::uint32_t v) {
  ++round_;
  int count = 0;
  for (std::uint32_t at = first_[v]; at != kNone; at = links_[at].next) {
    if (!usable(links_[at])) continue;
    neighbor_[links_[at].to] = round_;
    ++count;
  }
  neighbor_[v] = round_;
  return count;
}

void Graph::connect_vertex(std::uint32_t v, const FreeSpace& space,
                           const ConnectionParameters& parameters, Random& random) {
  if (parameters.connection == Connection::kThreshold) {
    gather(vertices_[v], parameters.threshold, candidates_);
    const std::size_t tried =
        std::min(candidates_.size(), static_cast<std::size_t>(parameters.max_attempts));
    for (std::size_t i = 0; i < tried; ++i)
      std::swap(candidates_[i], candidates_[i + random.below(candidates_.size() - i)]);
    candidates_.resize(tried);
  } else {
    // Its neighbor in memory is one in the plane.
    nearest(vertices_[v], static_cast<std::size_t>(parameters.max_attempts) + 1, last_radius_,
            candidates_);
    last_radius_ =
        kHeadroom * std::sqrt(static_cast<double>(candidates_.back().squared_distance)) + 1e-3;
  }
  if (parameters.connection == Connection::kNeighborhood) {
    connect_neighborhood(v, space, parameters);
  } else {
    connect_near(v, space, parameters);
  }
}

void Graph::connect_near(std::uint32_t v, const FreeSpace& space, const ConnectionParameters& p) {
  int connections = note_neighbors(v);
  for (const Candidate& candidate : candidates_) {
    if (connections >= p.max_connections) return;
    const std::uint32_t n = candidate.vertex;
    if (neighbor_[n] == round_ || known_blocked(v, candidate, 0.0F) ||
        !space.line_free(vertices_[v], vertices_[n]))
      continue;
    join(v, n, std::sqrt(static_cast<double>(candidate.squared_distance)));
    ++connections;
  }
  if (p.connection == Connection::kNearest) tried_within_[v] = candidates_.back().squared_distance;
}

/// Whether the other vertex looked at the line already and did not find it free. Inside the
/// neighborhood (`limit`, squared) it may have had another reason.
bool Graph::known_blocked(std::uint32_t v, const Candidate& candidate, float limit) const {
  return built_edges_ == 0 && candidate.vertex < v && candidate.squared_distance > limit &&
         candidate.squared_distance <= tried_within_[candidate.vertex];
}

/// Everything inside the neighborhood that can be reached from a vertex without leaving it.
void Graph::mark_reached(std::uint32_t from) {
  reached_[from] = round_;
  stack_.assign(1, from);
  while (!stack_.empty()) {
    const std::uint32_t u = stack_.back();
    stack_.pop_back();
    for (std::uint32_t at = first_[u]; at != kNone; at = links_[at].next) {
      const std::uint32_t w = links_[at].to;
      if (inside_[w] != round_ || reached_[w] == round_ || !usable(links_[at])) continue;
      reached_[w] = round_;
      stack_.push_back(w);
    }
  }
}

void Graph::connect_neighborhood(std::uint32_t v, const FreeSpace& space,
                                 const ConnectionParameters& p) {
  int connections = note_neighbors(v);
  const auto limit = static_cast<float>(p.neighborhood_radius * p.neighborhood_radius);
  for (const Candidate& candidate : candidates_) {
    if (candidate.squared_distance > limit) break;
    inside_[candidate.vertex] = round_;
  }
  mark_reached(v);
  for (const Candidate& candidate : candidates_) {
    if (connections >= p.max_connections) return;
    const std::uint32_t n = candidate.vertex;
    const bool near = candidate.squared_distance <= limit;
    if ((near ? reached_[n] : neighbor_[n]) == round_ || known_blocked(v, candidate, limit) ||
        !space.line_free(vertices_[v], vertices_[n]))
      continue;
    join(v, n, std::sqrt(static_cast<double>(candidate.squared_distance)));
    ++connections;
    if (near) mark_reached(n);
  }
  tried_within_[v] = candidates_.back().squared_distance;
}

std::size_t Graph::usable_edge_count() const {
  return static_cast<std::size_t>(std::count(usable_.begin(), usable_.end(), std::uint8_t{1}));
}

void Graph::update(const FreeSpace& space, const Box& box, const ConnectionParameters& parameters,
                   Random& random) {
  std::vector<std::uint32_t> wounded;
  for (std::size_t edge = 0; edge < usable_.size(); ++edge) {
    const auto [a, b] = ends_[edge];
    if (!box.touches(vertices_[a], vertices_[b])) continue;
    const bool was = usable_[edge] != 0;
    usable_[edge] = space.line_free(vertices_[a], vertices_[b]) ? 1 : 0;
    if (was && usable_[edge] == 0) wounded.insert(wounded.end(), {a, b});
  }
  std::sort(wounded.begin(), wounded.end());
  wounded.erase(std::unique(wounded.begin(), wounded.end()), wounded.end());
  for (const std::uint32_t v : wounded) {
    if (space.free(vertices_[v])) connect_vertex(v, space, parameters, random);
  }
}

void Graph::restore() {
  for (std::size_t link = links_.size(); link > 2 * built_edges_; --link) {
    // The newest link of a vertex is its first one.
    const std::uint32_t owner = links_[(link - 1) ^ 1].to;
    first_[owner] = links_[link - 1].next;
  }
  links_.resize(2 * built_edges_);
  ends_.resize(built_edges_);
  usable_.assign(built_edges_, 1);
}

}  // namespace usher::roadmap
