#pragma once

#include <cstdint>
#include <vector>

#include "navigation/explorer/core/strategy.hpp"

namespace usher::explorer {

/// Chooses the view that shows most for its time, what is seen on the way included: the greatest
/// unseen area over the time of the first turn, the way, the turn at its end and the stop.
///
/// Candidates are a place in each small square of the floor, each with all directions, and the
/// place where the robot stands. What a place can show only shrinks while a round lasts, so what it
/// showed when it was last looked at bounds it from above: only candidates whose bound could still
/// win are looked at again. The best few are then compared by all that is seen on the way.
class InformationGain final : public Strategy {
 public:
  InformationGain(const StrategyConfig& config, std::uint64_t seed)
      : config_(config), random_(seed) {}

  void begin_round() override { candidates_.clear(); }
  std::optional<Pose2> next(const Outlook& outlook) override;
  /// While enough of what it promised is still unseen.
  bool worth(const Pose2& view, SeenArea& seen) override;

 private:
  struct Candidate {
    Point2 place;
    std::uint32_t bound;  ///< [cells] that one view from here shows at most
  };
  struct Option {
    Pose2 view;
    double time = 0.0;   ///< [s]
    double value = 0.0;  ///< [cells/s]
  };
  void place_candidates(const Outlook& outlook);
  void order_candidates(const Outlook& outlook);
  void try_place(const Outlook& outlook, Candidate& candidate, double way);
  void offer(const Option& option);
  bool worth_at_all(const Pose2& view, SeenArea& seen) const;
  void simulate(const Outlook& outlook, const Pose2& view);

  StrategyConfig config_;
  Random random_;
  std::vector<Candidate> candidates_;
  struct Bounded {
    double value = 0.0;  ///< [cells/s] at most
    double way = 0.0;    ///< [m]
    std::size_t candidate = 0;
  };
  std::vector<Bounded> order_;
  std::vector<Option> best_;  ///< sorted, the best first; at most kCompared
  std::vector<Point2> way_;
  std::vector<Pose2> poses_;  ///< of the simulated motion
  std::size_t promised_ = 0;  ///< [cells] by the end of the view that was chosen last
};

}  // namespace usher::explorer
