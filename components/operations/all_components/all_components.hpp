#pragma once

#include <span>
#include <string>

#include "runtime/api/host.hpp"

namespace usher::operations {

/// Every component type that this build has.
std::span<const runtime::ComponentFactory> all_components();

/// Null for an unknown type.
const runtime::ComponentFactory* find_component(const std::string& type);

}  // namespace usher::operations
