#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "foundation/result/result.hpp"

namespace usher::operations {

/// Runs jobs 0 .. `count` - 1 on all processors, each alone in its thread, and shows "17 of 100
/// WHAT". A job returns what it has to say on lines of its own, empty for nothing; the first error
/// ends it all and is returned.
Status run_jobs(std::size_t count, const std::string& what,
                const std::function<Result<std::string>(std::size_t)>& job);

}  // namespace usher::operations
