#include "wire/whiskers.hpp"

namespace usher::wire {

kinematics::WhiskerMount read_whiskers(runtime::Host& host) {
  auto& parameters = host.parameters();
  kinematics::WhiskerMount mount;
  mount.length = parameters.number("robot.whiskers.length", "m", {0.01, 1}, mount.length,
                                   "Of a whisker, from its corner.");
  mount.outward = parameters.number("robot.whiskers.outward", "rad", {0, 1.5}, mount.outward,
                                    "Between a whisker and straight ahead, or straight back.");
  return mount;
}

}  // namespace usher::wire
