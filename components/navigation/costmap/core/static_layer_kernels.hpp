#pragma once

#include <cstdint>

#include "navigation/costmap/core/static_layer.hpp"

// Included by static_layer.cpp and static_layer_avx2.cpp only. All samples of a run must lie within
// the map.
namespace usher::costmap::static_layer_kernels {

void sample_portable(const std::uint8_t* map, int map_width, const StaticLayer::Run& run,
                     std::uint8_t* states);
#if defined(__x86_64__)
/// Reads up to three bytes beyond a sample.
void sample_avx2(const std::uint8_t* map, int map_width, const StaticLayer::Run& run,
                 std::uint8_t* states);
#endif

}  // namespace usher::costmap::static_layer_kernels
