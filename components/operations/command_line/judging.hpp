#pragma once

#include <vector>

#include "operations/command_line/installation.hpp"
#include "operations/manifest/finding.hpp"
#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// What the components themselves refuse of a deployment whose wiring and values are good, each
/// asked by its own program (`usher-amcl --judge`): values that contradict one another, a file that
/// cannot be used. Those whose programs are not here are named on standard error.
std::vector<Finding> judge_by_components(const Deployment& deployment,
                                         const Installation& installation);

}  // namespace usher::operations
