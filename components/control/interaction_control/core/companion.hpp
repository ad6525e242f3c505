#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "control/interaction_control/core/zones.hpp"

namespace usher::interaction_control {

struct Sighting {
  std::uint64_t id = 0;  ///< of the person {1..}
  Polar place;
};

/// Whom the robot poses for: the nearest of those in a zone, else the nearest of all. It stays with
/// one person until another is nearer by `margin`, so that two side by side do not take turns.
class Companion {
 public:
  explicit Companion(double margin) : margin_(margin) {}

  /// The one among `people`; nothing when there is nobody. Who is not among them is gone.
  std::optional<Sighting> choose(std::span<const Sighting> people, const Zones& zones);

 private:
  double margin_;         ///< [m]
  std::uint64_t id_ = 0;  ///< 0 = nobody
};

}  // namespace usher::interaction_control
