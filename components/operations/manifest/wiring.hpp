#pragma once

#include <vector>

#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// Judges who writes and reads what, how fast, with which quality of service, on which host.
void judge_wiring(const Manifest& manifest, const Contracts& contracts,
                  std::vector<Finding>& findings);

/// Where nothing may move without whiskers somebody must write them.
void judge_whiskers(const Contracts& contracts, Deployment& deployment);

/// A simulated variant counts as the component whose place it takes.
std::string role(const std::string& type);

}  // namespace usher::operations
