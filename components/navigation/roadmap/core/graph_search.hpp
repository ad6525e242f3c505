#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "navigation/roadmap/core/graph.hpp"

namespace usher::roadmap {

/// Shortest ways through a graph from one point to another, both joined to vertices near them.
/// Allocates only when the graph is larger than any before.
class GraphSearch {
 public:
  struct Query {
    const Graph& graph;
    Point2 start, goal;
    /// Vertices that a free line joins with the start, with the goal.
    std::span<const Graph::Candidate> from, to;
    bool informed = false;  ///< A*, else Dijkstra's algorithm
  };

  /// Prepares A* for a graph as Graph::connect() left it: distances from a few far vertices bound
  /// the way to the goal better than the straight distance does, where walls are in between
  /// [goldberg2005alt]. They hold while edges are closed, not for makeshift ones; without them the
  /// straight distance serves.
  void prepare(const Graph& graph);

  /// The vertices of the shortest way in order, without start and goal; nothing when there is none.
  /// `informed` or not, the way has the same length.
  std::optional<std::span<const std::uint32_t>> run(const Query& query);

  /// [m] of the way that was found last.
  double length() const { return length_; }
  std::uint32_t settled() const { return settled_; }

 private:
  struct Entry {
    float key;
    std::uint32_t vertex;
    // std::push_heap keeps the largest in front.
    bool operator<(const Entry& other) const {
      return key != other.key ? key > other.key : vertex > other.vertex;
    }
  };
  struct Mark {
    std::uint32_t round = 0;  ///< equal to round_: the rest holds
    std::uint32_t parent = Graph::kNone;
    float cost = 0.0F;   ///< [m] from the start
    float ahead = 0.0F;  ///< [m] to the goal, at least
    bool settled = false;
  };
  static constexpr std::size_t kLandmarks = 4;
  using Distances = std::array<float, kLandmarks>;
  static constexpr float kUnreached = 1e9F;

  template <bool kInformed>
  std::uint32_t search(const Query& query);
  void spread(const Graph& graph, std::uint32_t from, std::size_t landmark);
  std::uint32_t spread_widely(const Graph& graph);
  void bound_goal(const Query& query);
  float ahead(const Query& query, std::uint32_t v) const;
  void grow(std::size_t size);
  template <bool kInformed>
  void reach(const Query& query, std::uint32_t v, std::uint32_t parent, float cost);

  std::vector<Distances> landmarks_;  // per vertex, [m] from each landmark
  std::size_t prepared_edges_ = 0;
  bool use_landmarks_ = false;
  Distances beyond_{}, before_{};  // of the goal: h = max(beyond - d, d - before)
  std::vector<Mark> marks_;
  std::vector<std::uint32_t> goal_round_;
  std::vector<float> goal_distance_;
  std::vector<Entry> open_;
  std::vector<std::uint32_t> way_;
  std::uint32_t round_ = 0;
  std::uint32_t settled_ = 0;
  double length_ = 0.0;
};

}  // namespace usher::roadmap
