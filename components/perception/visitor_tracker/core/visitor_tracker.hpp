#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/imaging/appearance.hpp"

namespace usher::visitor_tracker {

/// What the robot is about.
enum class Service : std::uint8_t {
  kNobody,   ///< it waits for somebody to stand before it
  kTalks,    ///< a visit goes on
  kGuides,   ///< a journey goes on: the visitor follows
  kFollows,  ///< the robot follows the visitor
};

/// Somebody whom the people tracker knows, in odom.
struct Person {
  std::uint64_t id = 0;  ///< {1..}
  geometry::Point2 position = geometry::Point2::Zero();
  geometry::Point2 velocity = geometry::Point2::Zero();      ///< [m/s]
  double age = std::numeric_limits<double>::infinity();      ///< [s] since the first sighting
  double unseen = 0.0;                                       ///< [s] since the last one
  double height = std::numeric_limits<double>::quiet_NaN();  ///< [m] NaN: not known
  imaging::Appearances appearances{};                        ///< to Kinect and rear camera
};

struct Moment {
  double time = 0.0;  ///< [s] of the people's states
  geometry::Pose2 odom_T_base;
  Service service = Service::kNobody;
  std::span<const Person> people;
  bool looks_ahead = false;   ///< a camera looks for people there, so that none means nobody
  bool looks_behind = false;  ///< likewise
};

struct Config {
  double within = 3.5;        ///< [m] farther nobody stands before the robot
  double bearing = 1.05;      ///< [rad] to either side of ahead, likewise
  double stands_below = 0.6;  ///< [m/s] who is slower stands
  double passes_at = 0.7;     ///< [m] who walks by the robot's middle farther off passes by
  double dwell = 0.4;         ///< [s] before the robot until somebody is its visitor
  double unseen = 0.5;        ///< [s] then the visitor counts as not seen
  double blind_from = 1.75;   ///< [rad] to either side, where nothing looks; the laser sees less
  double blind_to = 2.6;      ///< [rad] and the rear camera more
  double blind_for = 60.0;    ///< [s] so long a follower who went there counts as seen
  double trail = 1.5;         ///< [m] beside the robot's way a follower may walk
  double follows = 0.6;       ///< [s] of following until somebody is the one whose identity broke
  double farthest = 8.0;      ///< [m] whom the robot follows counts as seen up to here
  double returns = 2.5;       ///< [s] so long stands at the robot whoever is the one that it lost
};

enum class Presence : std::uint8_t { kUnknown, kNobody, kSeen };

struct Estimate {
  Presence presence = Presence::kUnknown;
  std::uint64_t person = 0;                                 ///< 0: none
  geometry::Point2 place = geometry::Point2::Zero();        ///< [m] in base_footprint, when seen
  double speed = std::numeric_limits<double>::quiet_NaN();  ///< [m/s] likewise
};

/// Which of the people around is the visitor. Before a visit: the nearest who stands before the
/// robot or comes up to it; in it the same one as long as the people tracker keeps the identity. On
/// a journey, when the identity broke: whoever turns up where the visitor was going to be, else
/// whoever walks behind the robot for a while, near enough to where the visitor was last seen. Who
/// crosses, comes from ahead or stands beside the way is not taken for him. When the first identity
/// turns up again, it counts. When the robot follows the visitor: the same one, wherever he goes;
/// when the identity broke, whoever first turned up where he was going to be, comes to stand at the
/// robot for a while, or wears his clothes. Who was there beside him is another one, and so is
/// whose clothes have clearly other colors, whatever number the people tracker gives him.
///
/// Nobody is there only where a camera looks; else it is not known. Deterministic; up to 64 people.
class VisitorTracker {
 public:
  explicit VisitorTracker(const Config& config) : config_(config) {}

  /// At 10 Hz or faster. People and poses that are not finite are left out; after a jump of time or
  /// of the odometry what was gathered so far about who follows counts no longer.
  const Estimate& update(const Moment& moment);
  /// Nobody says who is around.
  const Estimate& lose();

 private:
  static constexpr double kMostTrail = 12.0;  ///< [m]

  /// When and where a sensor showed somebody.
  struct Sighting {
    double time = 0.0;  ///< [s]
    geometry::Point2 place = geometry::Point2::Zero();
    geometry::Point2 velocity = geometry::Point2::Zero();  ///< [m/s]
  };
  struct Habit {
    double before = 0.0;   ///< [s] in front without a break
    double follows = 0.0;  ///< [s] behind, less the time that they did not
    double since = 0.0;    ///< [s] and where somebody was first known
    geometry::Point2 from = geometry::Point2::Zero();
    bool from_ahead = false;
    std::optional<geometry::Point2> beside;  ///< where, when the visitor was seen elsewhere
    geometry::Point2 anchor = geometry::Point2::Zero();
    double stays = 0.0;   ///< [s] near `anchor` and the robot, which stands
    double stands = 0.0;  ///< [s] at the robot without a break
    double unlike = 0.0;  ///< [s] clearly, without a break
    double alike = 0.0;   ///< [s] seen in the visitor's clothes, without another between
  };
  struct Look {
    const Person* person = nullptr;
    geometry::Point2 place;  ///< in base_footprint
    double range = 0.0;
    double speed = 0.0;
    bool heads_here = false;  ///< walks to the robot
    Habit habit;
  };

  void forget_other_people(const Moment& moment);
  void remember_way(const Moment& moment);
  bool moves(double time) const;
  Look look_at(const Person& person, const geometry::Pose2& base_T_odom) const;
  void observe(const Moment& moment, double passed);
  bool before(const Look& look) const;
  double following(const Look& look, const geometry::Pose2& odom_T_base, bool moves) const;
  const Look* find(std::uint64_t id) const;
  const Look* nearest_before() const;
  void choose_to_serve();
  void keep_served();
  void keep_follower(const geometry::Pose2& odom_T_base);
  const Look* waits(const geometry::Pose2& odom_T_base) const;
  void distrust(const geometry::Pose2& odom_T_base);
  void distrust_clothes();
  void take_from(const Look& look);
  void keep_leader(double passed);
  void note_others(double passed);
  const Look* come_from_there() const;
  const Look* come_back() const;
  const Look* recognised() const;
  geometry::Point2 expected(double gone) const;
  const Look* same_place(const geometry::Pose2& odom_T_base) const;
  const Look* follower(double least, double nearest, bool any) const;
  bool on_the_way() const { return service_ == Service::kGuides || service_ == Service::kFollows; }
  bool looks_there(const Moment& moment) const;
  bool seen(const Look* look) const;
  bool as_tall(const Look& look) const;
  bool is_another(const Person& person) const;
  bool may_be(const Look& look) const;
  bool looks_like_him(const Person& person) const;
  void learn(const Person& person, double passed);
  bool blind_at(const geometry::Point2& place, double from, double around) const;
  void hold(const Look& look, double time);
  bool out_of_view(const geometry::Pose2& odom_T_base) const;
  void report(const Moment& moment, double passed);

  Config config_;
  std::deque<std::pair<double, geometry::Point2>>
      way_;  ///< where the robot was [s, m], newest last
  std::map<std::uint64_t, Habit> habits_;
  std::vector<Look> looks_;  ///< of this update, by id
  double time_ = -std::numeric_limits<double>::infinity();
  Service service_ = Service::kNobody;

  std::uint64_t held_ = 0;   ///< the visitor; 0: none
  std::uint64_t first_ = 0;  ///< who was the visitor when the way began
  double held_since_ = 0.0;  ///< [s]
  Sighting last_;            ///< of the held one
  Sighting last_of_first_;
  std::uint64_t measured_ = 0;  ///< whose height it is; 0: nobody's yet
  double height_ = 0.0;         ///< [m] his greatest; 0: not known
  imaging::Appearances worn_;   ///< his clothes, as each camera shows them
  Estimate estimate_;
};

}  // namespace usher::visitor_tracker
