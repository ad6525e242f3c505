#pragma once

#include <string_view>

namespace usher::runtime {

/// The text of all IDL files, in the order of their dependencies; compiled in from idl/.
std::string_view idl_text();

}  // namespace usher::runtime
