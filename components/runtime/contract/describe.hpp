#pragma once

#include "foundation/result/result.hpp"
#include "runtime/api/contract.hpp"
#include "runtime/api/host.hpp"
#include "runtime/parameters/parameter_file.hpp"

namespace usher::runtime {

/// What a component of this type declares in its constructor, which runs on a host that records and
/// does nothing: parameters have their defaults (required ones the harmless end of their range),
/// time stands still, nothing is opened, kept or offloaded. The heartbeat, which the host writes
/// for every component, is the last output.
///
/// A constructor that ends with fault() has declared what there is to declare before: a component
/// declares first and loads after. Any other exception, or a wrong declaration (default out of
/// range, unit that is not SI, an input with an age and nothing said about its loss), is an error.
Result<Contract> describe(const ComponentFactory& factory);

/// Whether a component of this type can be constructed with these values, on such a host: an error
/// says what it refuses, values that contradict one another too. It may read the files that its
/// parameters name.
Status judge(const ComponentFactory& factory, const ParameterFile& file);

}  // namespace usher::runtime
