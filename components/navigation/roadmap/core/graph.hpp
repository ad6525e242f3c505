#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "foundation/grid/free_space.hpp"
#include "foundation/random/random.hpp"

namespace usher::roadmap {

using geometry::Point2;
using grid::FreeSpace;

/// Which vertices a vertex is joined to (algorithm 3 of the meeting report).
enum class Connection : std::uint8_t {
  kNearest,       ///< the nearest ones that a free line reaches
  kThreshold,     ///< random ones within a distance
  kNeighborhood,  ///< nearest first; inside the neighborhood only those that are not yet joined to
                  ///< it by a way inside the neighborhood, beyond it all
};

struct ConnectionParameters {
  Connection connection = Connection::kNeighborhood;
  int max_connections = 30;          ///< C: a vertex looks for no more
  int max_attempts = 40;             ///< A: so many vertices are tried
  double neighborhood_radius = 1.0;  ///< [m] R_n of kNeighborhood
  double threshold = 4.0;            ///< [m] of kThreshold
};

/// A rectangle of the map [m].
struct Box {
  Point2 low, high;
  bool touches(const Point2& a, const Point2& b) const {
    return std::min(a.x(), b.x()) <= high.x() && std::max(a.x(), b.x()) >= low.x() &&
           std::min(a.y(), b.y()) <= high.y() && std::max(a.y(), b.y()) >= low.y();
  }
};

/// Vertices in free space and free straight edges between them. Vertices lie in memory as they lie
/// in the plane, so that looking for near ones and walking along edges stay in the cache.
class Graph {
 public:
  /// One way along an edge.
  struct Link {
    std::uint32_t to;
    std::uint32_t next;  ///< link of the same vertex, or kNone
    std::uint32_t edge;
    float length;  ///< [m]
  };
  struct Candidate {
    float squared_distance;  ///< [m^2]
    std::uint32_t vertex;
    auto operator<=>(const Candidate&) const = default;
  };
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// Takes the points as vertices, without edges.
  void reset(std::span<const Point2> points);
  /// Joins every vertex; `random` serves kThreshold. O(vertices x attempts).
  void connect(const FreeSpace& space, const ConnectionParameters& parameters, Random& random);

  std::size_t size() const { return vertices_.size(); }
  std::size_t edge_count() const { return usable_.size(); }
  std::size_t usable_edge_count() const;
  const Point2& vertex(std::uint32_t v) const { return vertices_[v]; }
  std::uint32_t first_link(std::uint32_t v) const { return first_[v]; }
  const Link& link(std::uint32_t index) const { return links_[index]; }
  /// False while something stands in the way of the edge.
  bool usable(const Link& link) const { return usable_[link.edge] != 0; }

  /// The `count` vertices nearest to a point, nearest first, equally near ones in their order.
  /// `found` is replaced. Looks within `radius` [m] first and farther when that holds too few:
  /// the better the guess, the faster.
  void nearest(const Point2& point, std::size_t count, double radius,
               std::vector<Candidate>& found) const;
  /// [m] a good guess for `count` vertices where most of them are.
  double usual_radius(std::size_t count) const;

  /// The free space changed inside `box`: looks at every edge there again. Vertices that lost edges
  /// but are free themselves are joined anew to what they can see; those edges are left out again
  /// by restore().
  void update(const FreeSpace& space, const Box& box, const ConnectionParameters& parameters,
              Random& random);
  /// Nothing stands in the way any more: the graph is what connect() left.
  void restore();

 private:
  void index(std::span<const Point2> points);
  std::size_t bucket(const Point2& point) const;
  int column_of(double x) const;
  int row_of(double y) const;
  void gather(const Point2& point, double radius, std::vector<Candidate>& found) const;
  void join(std::uint32_t a, std::uint32_t b, double length);
  void connect_vertex(std::uint32_t v, const FreeSpace& space,
                      const ConnectionParameters& parameters, Random& random);
  void connect_near(std::uint32_t v, const FreeSpace& space, const ConnectionParameters& p);
  void connect_neighborhood(std::uint32_t v, const FreeSpace& space, const ConnectionParameters& p);
  bool known_blocked(std::uint32_t v, const Candidate& candidate, float limit) const;
  void mark_reached(std::uint32_t from);
  int note_neighbors(std::uint32_t v);
  void compact();

  std::vector<Point2> vertices_;
  std::vector<std::uint32_t> first_;
  std::vector<Link> links_;
  std::vector<std::uint8_t> usable_;  // per edge
  std::size_t built_edges_ = 0;       // later ones are makeshift, their links in pairs at the end
  std::vector<std::array<std::uint32_t, 2>> ends_;  // per edge

  // Buckets: vertices of bucket b are bucket_begin_[b] .. bucket_begin_[b + 1].
  Point2 origin_ = Point2::Zero();
  double bucket_side_ = 1.0;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> bucket_begin_;

  // For the vertex that is being joined: equal to round_ means yes.
  std::uint32_t round_ = 0;
  std::vector<std::uint32_t> neighbor_, inside_, reached_;
  std::vector<std::uint32_t> stack_;
  std::vector<Candidate> candidates_;
  double last_radius_ = 1.0;
  std::vector<float> tried_within_;  // squared [m^2], per vertex that tried all that near
};

}  // namespace usher::roadmap
