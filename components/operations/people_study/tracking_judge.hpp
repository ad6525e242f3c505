#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::people_study {

/// Compares who is told with who is there, by CLEAR-MOT [bernardin2008clear]: a person keeps the
/// track that told them before while it fits, others get the nearest.
class TrackingJudge {
 public:
  static constexpr double kSame = 0.75;  ///< [m] the gate that others use

  struct Truth {
    geometry::Point2 place = geometry::Point2::Zero();
    bool in_view = false;  ///< of a sensor; perhaps behind somebody
    bool visible = false;  ///< in view and not hidden: must be told; else may be
  };
  struct Told {
    std::uint64_t id = 0;  ///< from 1 on
    geometry::Point2 place = geometry::Point2::Zero();
    bool seen = false;  ///< by a sensor, just now
  };
  struct Figures {
    int truths = 0, misses = 0, false_alarms = 0;
    int switches = 0;       ///< another identity than the last one
    int away_switches = 0;  ///< of them who was in no sensor's view meanwhile
    double error = 0.0;     ///< [m] sum over those who were told
    double mota() const {
      return truths > 0 ? 1.0 - double(misses + false_alarms + switches) / truths : 1.0;
    }
    double motp() const { return truths > misses ? error / (truths - misses) : 0.0; }
    Figures& operator+=(const Figures& other);
  };

  /// The truths are the same people in the same order each time.
  void take(std::span<const Truth> truths, std::span<const Told> told);

  const Figures& figures() const { return all_; }
  /// Of one person, without false alarms.
  Figures figures_of(std::size_t person) const {
    return person < people_.size() ? people_[person].figures : Figures{};
  }
  /// Who tells a person now; 0: nobody.
  std::uint64_t identity_now(std::size_t person) const {
    return person < people_.size() ? people_[person].now : 0;
  }

 private:
  struct Person {
    std::uint64_t identity = 0, now = 0;
    bool was_away = false;  ///< since `identity` was told
    Figures figures;
  };
  void match(std::span<const Truth> truths, std::span<const Told> told);

  Figures all_;
  std::vector<Person> people_;
  std::vector<std::size_t> matches_;  ///< among the told, for each person
  std::vector<char> used_;
};

}  // namespace usher::people_study
