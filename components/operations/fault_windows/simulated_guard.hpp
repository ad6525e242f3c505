#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "foundation/kinematics/roll_out.hpp"
#include "runtime/guard/guard.hpp"
#include "runtime/lockstep/lockstep_world.hpp"

namespace usher::operations {

/// The guard process in front of a simulated base. It decides as on a robot (runtime::Guard); what
/// the driver writes is on its way to the base already, so that only its own words are added. A
/// new life of the driver gets a new guard, as there.
///
/// The world must outlive it, and it the world's run. One per base.
class SimulatedGuard {
 public:
  /// `driver` is a component of the world; silent for so long {> 0}, it is overruled. Before
  /// whatever tampers with the line, which begins behind the guard.
  SimulatedGuard(runtime::LockstepWorld& world, std::string driver, runtime::Guard::Time silence);
  SimulatedGuard(const SimulatedGuard&) = delete;
  SimulatedGuard& operator=(const SimulatedGuard&) = delete;

 private:
  runtime::Guard::Time now() const { return world_.now().time_since_epoch(); }
  void hear(const geometry::Twist2& told);
  void watch();
  void pass();

  runtime::LockstepWorld& world_;
  const std::string driver_;
  const runtime::Guard::Time silence_;
  std::uint64_t life_ = 0;  ///< of the driver, whose guard it is
  std::optional<runtime::Guard> guard_;
  const kinematics::StoppingDistance stopping_;  ///< MARVIN's
  kinematics::RollOut roll_out_;                 ///< by what the driver told the base
  geometry::Twist2 will_;
};

}  // namespace usher::operations
