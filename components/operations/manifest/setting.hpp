#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "operations/manifest/resolve.hpp"
#include "runtime/parameters/interpret.hpp"

namespace usher::operations {

/// What a parameter of a component is resolved to.
struct Setting {
  runtime::Interpretation value;
  std::string origin;  ///< empty = the contract's default
};

/// Of the component at `index` of the manifest; nothing where its contract has no parameter of this
/// name, or where nobody sets it and there is no default.
std::optional<Setting> setting(const Contracts& contracts, const Deployment& deployment,
                               std::size_t index, const std::string& name);

}  // namespace usher::operations
