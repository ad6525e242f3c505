#pragma once

#include <vector>

#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// Judges who writes and reads what, how fast, with which quality of service, on which host.
void judge_wiring(const Manifest& manifest, const Contracts& contracts,
                  std::vector<Finding>& findings);

}  // namespace usher::operations
