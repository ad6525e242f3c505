#include "control/interaction_control/core/companion.hpp"

#include <limits>

namespace usher::interaction_control {

std::optional<Sighting> Companion::choose(std::span<const Sighting> people, const Zones& zones) {
  constexpr double kOutside = 1000.0;  // [m] farther than anybody in a zone
  const Sighting* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Sighting& person : people) {
    double cost = person.place.range + (zones.reaches(person.place) ? 0.0 : kOutside);
    if (person.id == id_) cost -= margin_;
    if (!(cost < least)) continue;
    least = cost;
    best = &person;
  }
  id_ = best != nullptr ? best->id : 0;
  return best != nullptr ? std::optional(*best) : std::nullopt;
}

}  // namespace usher::interaction_control
