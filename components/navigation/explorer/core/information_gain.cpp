#include "navigation/explorer/core/information_gain.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/grid/sampling.hpp"

namespace usher::explorer {

namespace {

constexpr std::size_t kCompared = 8;    // options whose whole motion is simulated
constexpr double kClose = 0.6;          // of the best value: less is not made up for by the way
constexpr int kMostLooks = 250;         // candidates that are looked at for one choice
constexpr double kHeadingBase = 0.5;    // [m] of way that a heading is measured over
constexpr double kSimulatedStep = 0.5;  // [m] between simulated views on a way
constexpr double kSimulatedTurn = 0.5;  // [rad] between those of a turn
constexpr double kDone = 0.15;          // share of the promise that is worth no more stop

double heading(const Point2& from, const Point2& to, double otherwise) {
  const Point2 way = to - from;
  return way.squaredNorm() > 0.0 ? std::atan2(way.y(), way.x()) : otherwise;
}

}  // namespace

void InformationGain::place_candidates(const Outlook& outlook) {
  std::vector<Point2> places;
  grid::sample_points(outlook.ground.standing(), outlook.ground.standing_map(),
                      {.sampling = grid::Sampling::kCell,
                       .cell_size = config_.candidate_spacing,
                       .points_per_cell = 1},
                      random_, places);
  candidates_.clear();
  const auto most = static_cast<std::uint32_t>(outlook.seen.most_in_view());
  for (const Point2& place : places) candidates_.push_back({place, most});
}

/// By what they could be worth at most, the best first.
void InformationGain::order_candidates(const Outlook& outlook) {
  order_.clear();
  const std::size_t least = cells_of(outlook.seen, config_.least_gain);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (candidates_[i].bound < least) continue;
    const double way = outlook.ground.way_to(candidates_[i].place);
    if (!std::isfinite(way)) continue;
    const double time = config_.stop_time + way / config_.usual_speed;
    order_.push_back({candidates_[i].bound / std::max(time, 0.1), way, i});
  }
  std::sort(order_.begin(), order_.end(), [](const Bounded& a, const Bounded& b) {
    // Before anything is known all bounds are alike: then the nearest first.
    return a.value != b.value ? a.value > b.value : a.candidate < b.candidate;
  });
}

void InformationGain::offer(const Option& option) {
  const auto after = std::find_if(best_.begin(), best_.end(),
                                  [&](const Option& o) { return o.value < option.value; });
  if (after == best_.end() && best_.size() == kCompared) return;
  best_.insert(after, option);
  if (best_.size() > kCompared) best_.pop_back();
}

/// Looks around at a place and offers its best direction.
void InformationGain::try_place(const Outlook& outlook, Candidate& candidate, double way) {
  SeenArea::Gains gains;
  outlook.seen.gains(candidate.place, gains);
  candidate.bound = *std::max_element(gains.begin(), gains.end());
  const auto least = static_cast<std::uint32_t>(cells_of(outlook.seen, config_.least_gain));
  if (candidate.bound < least) return;
  double departure = outlook.robot.yaw, arrival = outlook.robot.yaw;
  if (way > 0.0) {
    outlook.ground.trace(candidate.place, way_);
    const double step = outlook.seen.geometry().resolution;
    const std::size_t base =
        std::min(way_.size() - 1, static_cast<std::size_t>(kHeadingBase / step));
    departure = heading(way_.front(), way_[base], outlook.robot.yaw);
    arrival = heading(way_[way_.size() - 1 - base], way_.back(), departure);
  }
  const double there =
      config_.stop_time + way / config_.usual_speed +
      std::abs(geometry::shortest_turn(outlook.robot.yaw, departure)) / config_.turn_rate;
  Option best;
  for (std::size_t d = 0; d < gains.size(); ++d) {
    if (gains[d] < least) continue;
    const double yaw =
        geometry::normalized(2.0 * geometry::kPi * static_cast<double>(d) / SeenArea::kDirections);
    const double time = there + std::abs(geometry::shortest_turn(arrival, yaw)) / config_.turn_rate;
    const double value = gains[d] / std::max(time, 0.1);
    if (value <= best.value) continue;
    best = {{candidate.place.x(), candidate.place.y(), yaw}, time, value};
  }
  offer(best);
}

/// The poses of the way to a view, from the robot on, the view being the last.
void InformationGain::simulate(const Outlook& outlook, const Pose2& view) {
  poses_.clear();
  Pose2 now = outlook.robot;
  const auto turn_to = [&](double yaw) {
    const double angle = geometry::shortest_turn(now.yaw, yaw);
    const int steps = static_cast<int>(std::ceil(std::abs(angle) / kSimulatedTurn));
    const double from = now.yaw;
    for (int i = 1; i <= steps; ++i) {
      now.yaw = geometry::normalized(from + angle * i / steps);
      poses_.push_back(now);
    }
  };
  outlook.ground.trace(view.position(), way_);
  const auto stride = std::max<std::size_t>(
      1, static_cast<std::size_t>(kSimulatedStep / outlook.seen.geometry().resolution));
  for (std::size_t i = stride; i < way_.size(); i += stride) {
    turn_to(heading(now.position(), way_[i], now.yaw));
    now = {way_[i].x(), way_[i].y(), now.yaw};
    poses_.push_back(now);
  }
  now = {view.x, view.y, now.yaw};
  turn_to(view.yaw);
  poses_.push_back(view);
}

std::optional<Pose2> InformationGain::next(const Outlook& outlook) {
  if (candidates_.empty()) place_candidates(outlook);
  best_.clear();
  Candidate here{outlook.robot.position(), 0};
  if (outlook.ground.standing().free(here.place)) try_place(outlook, here, 0.0);
  order_candidates(outlook);
  int looks = 0;
  for (const Bounded& bounded : order_) {
    if (!best_.empty() && bounded.value <= kClose * best_.front().value) break;
    if (++looks > kMostLooks) break;
    Candidate& candidate = candidates_[bounded.candidate];
    if (is_given_up(outlook, candidate.place, config_.give_up_radius)) continue;
    try_place(outlook, candidate, bounded.way);
  }
  std::optional<Pose2> chosen;
  double most = 0.0;
  for (const Option& option : best_) {
    if (!worth_at_all(option.view, outlook.seen)) continue;
    simulate(outlook, option.view);
    const double value =
        static_cast<double>(outlook.seen.gain(poses_)) / std::max(option.time, 0.1);
    if (value <= most) continue;
    most = value;
    chosen = option.view;
  }
  promised_ = chosen ? outlook.seen.gain({&*chosen, 1}) : 0;
  return chosen;
}

/// Its end alone; what is seen on the way comes on top.
bool InformationGain::worth_at_all(const Pose2& view, SeenArea& seen) const {
  return 2 * seen.gain({&view, 1}) >= cells_of(seen, config_.least_gain);
}

bool InformationGain::worth(const Pose2& view, SeenArea& seen) {
  const auto rest = static_cast<double>(seen.gain({&view, 1}));
  return worth_at_all(view, seen) && rest >= kDone * static_cast<double>(promised_);
}

}  // namespace usher::explorer
