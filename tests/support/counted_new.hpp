#pragma once

#include <cstdint>

namespace usher::test {

/// How often this program has called operator new, which counted_new.cpp replaces.
std::uint64_t allocation_count();

}  // namespace usher::test
