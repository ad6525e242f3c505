#pragma once

#include <vector>

#include "operations/fault_windows/fault.hpp"
#include "runtime/lockstep/lockstep_world.hpp"

namespace usher::operations {

/// Lets the fault begin now; it ends by itself. The world must outlive it. Returns the writers of
/// the movement chain's topics that must not be there.
std::vector<runtime::Guid> inject(const Fault& fault, runtime::LockstepWorld& world);

}  // namespace usher::operations
