#pragma once

#include <vector>

#include "runtime/api/host.hpp"

namespace usher::wire {

/// Every component of the manifest, from the launcher: texts `name`, `type`, `host` and
/// `criticality`, and the number `timeout` [s]. Empty where nobody launched the component.
std::vector<runtime::Record> read_manifest(runtime::Host& host);

}  // namespace usher::wire
