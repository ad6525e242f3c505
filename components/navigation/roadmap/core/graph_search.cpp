#include "navigation/roadmap/core/graph_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace usher::roadmap {

void GraphSearch::grow(std::size_t size) {
  if (marks_.size() < size || round_ == std::numeric_limits<std::uint32_t>::max()) {
    marks_.assign(size, {});
    goal_round_.assign(size, 0);
    goal_distance_.resize(size);
    round_ = 0;
  }
  ++round_;
  open_.clear();
}

/// Distances of all vertices from one, along edges.
void GraphSearch::spread(const Graph& graph, std::uint32_t from, std::size_t landmark) {
  grow(graph.size());
  landmarks_[from][landmark] = 0.0F;
  open_.push_back({0.0F, from});
  while (!open_.empty()) {
    std::pop_heap(open_.begin(), open_.end());
    const Entry entry = open_.back();
    open_.pop_back();
    if (entry.key > landmarks_[entry.vertex][landmark]) continue;
    for (std::uint32_t at = graph.first_link(entry.vertex); at != Graph::kNone;) {
      const Graph::Link& link = graph.link(at);
      const float cost = entry.key + link.length;
      if (cost < landmarks_[link.to][landmark]) {
        landmarks_[link.to][landmark] = cost;
        open_.push_back({cost, link.to});
        std::push_heap(open_.begin(), open_.end());
      }
      at = link.next;
    }
  }
}

void GraphSearch::prepare(const Graph& graph) {
  landmarks_.assign(graph.size(), {});
  for (Distances& distances : landmarks_) distances.fill(kUnreached);
  prepared_edges_ = graph.edge_count();
  if (graph.size() == 0) return;
  std::uint32_t from = spread_widely(graph);
  // Each landmark is as far as can be from those before it, in the part that hangs together.
  for (std::size_t landmark = 0; landmark < kLandmarks; ++landmark) {
    if (landmark > 0) spread(graph, from, landmark);
    float farthest = -1.0F;
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
      const float near = *std::min_element(
          landmarks_[v].begin(), landmarks_[v].begin() + static_cast<std::ptrdiff_t>(landmark) + 1);
      if (near > farthest && near < kUnreached) farthest = near, from = v;
    }
  }
}

/// A vertex in a part of the graph that holds half of all vertices, where there is one.
std::uint32_t GraphSearch::spread_widely(const Graph& graph) {
  constexpr std::uint32_t kTrials = 4;
  const auto size = static_cast<std::uint32_t>(graph.size());
  std::uint32_t from = 0;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    from = size / (2 * kTrials) * (2 * trial + 1);
    for (Distances& distances : landmarks_) distances[0] = kUnreached;
    spread(graph, from, 0);
    const auto reached = std::count_if(landmarks_.begin(), landmarks_.end(),
                                       [](const auto& d) { return d[0] < kUnreached; });
    if (2 * reached >= static_cast<std::ptrdiff_t>(size)) break;
  }
  return from;
}

/// A way from v to the goal leaves the graph at some vertex u of `to`. Along it, no distance from a
/// landmark changes faster than the way is long: that bounds it from both sides.
void GraphSearch::bound_goal(const Query& query) {
  use_landmarks_ =
      landmarks_.size() == query.graph.size() && prepared_edges_ == query.graph.edge_count();
  for (std::size_t landmark = 0; use_landmarks_ && landmark < kLandmarks; ++landmark) {
    constexpr float kNever = std::numeric_limits<float>::infinity();
    beyond_[landmark] = kNever;
    before_[landmark] = -kNever;
    bool reached = !query.to.empty();
    for (const auto& candidate : query.to) {
      const float distance = landmarks_[candidate.vertex][landmark];
      const float last = std::sqrt(candidate.squared_distance);
      reached = reached && distance < kUnreached;
      beyond_[landmark] = std::min(beyond_[landmark], distance + last);
      before_[landmark] = std::max(before_[landmark], distance - last);
    }
    if (!reached) beyond_[landmark] = -kNever, before_[landmark] = kNever;
  }
}

float GraphSearch::ahead(const Query& query, std::uint32_t v) const {
  const double dx = query.graph.vertex(v).x() - query.goal.x();
  const double dy = query.graph.vertex(v).y() - query.goal.y();
  auto bound = static_cast<float>(std::sqrt(dx * dx + dy * dy));
  if (!use_landmarks_) return bound;
  for (std::size_t landmark = 0; landmark < kLandmarks; ++landmark) {
    const float distance = landmarks_[v][landmark];
    bound = std::max({bound, beyond_[landmark] - distance, distance - before_[landmark]});
  }
  return bound;
}

template <bool kInformed>
void GraphSearch::reach(const Query& query, std::uint32_t v, std::uint32_t parent, float cost) {
  Mark& mark = marks_[v];
  if (mark.round != round_) {
    mark.ahead = kInformed ? ahead(query, v) : 0.0F;
  } else if (mark.settled || mark.cost <= cost) {
    return;
  }
  mark.round = round_;
  mark.parent = parent;
  mark.cost = cost;
  mark.settled = false;
  open_.push_back({cost + mark.ahead, v});
  std::push_heap(open_.begin(), open_.end());
}

/// Returns the last vertex of the way, or kNone.
template <bool kInformed>
std::uint32_t GraphSearch::search(const Query& query) {
  for (const auto& candidate : query.from)
    reach<kInformed>(query, candidate.vertex, Graph::kNone, std::sqrt(candidate.squared_distance));
  std::uint32_t best = Graph::kNone;
  float best_length = std::numeric_limits<float>::infinity();
  while (!open_.empty() && open_.front().key < best_length) {
    std::pop_heap(open_.begin(), open_.end());
    const std::uint32_t v = open_.back().vertex;
    open_.pop_back();
    if (marks_[v].settled) continue;
    marks_[v].settled = true;
    ++settled_;
    const float cost = marks_[v].cost;
    if (goal_round_[v] == round_ && cost + goal_distance_[v] < best_length) {
      best_length = cost + goal_distance_[v];
      best = v;
    }
    for (std::uint32_t at = query.graph.first_link(v); at != Graph::kNone;) {
      const Graph::Link& link = query.graph.link(at);
      if (query.graph.usable(link)) reach<kInformed>(query, link.to, v, cost + link.length);
      at = link.next;
    }
  }
  length_ = static_cast<double>(best_length);
  return best;
}

std::optional<std::span<const std::uint32_t>> GraphSearch::run(const Query& query) {
  grow(query.graph.size());
  settled_ = 0;
  if (query.informed) bound_goal(query);
  for (const auto& candidate : query.to) {
    goal_round_[candidate.vertex] = round_;
    goal_distance_[candidate.vertex] = std::sqrt(candidate.squared_distance);
  }
  std::uint32_t v = query.informed ? search<true>(query) : search<false>(query);
  if (v == Graph::kNone) return std::nullopt;
  way_.clear();
  for (; v != Graph::kNone; v = marks_[v].parent) way_.push_back(v);
  std::reverse(way_.begin(), way_.end());
  return way_;
}

}  // namespace usher::roadmap
