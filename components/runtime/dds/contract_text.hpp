#pragma once

#include <string>

#include "runtime/api/contract.hpp"

namespace usher::runtime {

/// A contract for people: tables of inputs, outputs and parameters.
std::string to_table(const Contract& contract);

}  // namespace usher::runtime
