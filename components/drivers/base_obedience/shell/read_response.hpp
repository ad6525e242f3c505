#pragma once

#include "drivers/base_obedience/core/response_watch.hpp"
#include "runtime/api/host.hpp"

namespace usher::drive {

/// How slowly the base may follow and from when on it disobeys, from the parameters
/// robot.response.*: one set for whoever watches the base.
ResponseWatch::Parameters read_response(runtime::Parameters& parameters);

}  // namespace usher::drive
