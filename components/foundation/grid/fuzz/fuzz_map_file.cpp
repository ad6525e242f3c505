// libFuzzer: any bytes are refused or give a map within the limit. The first byte chooses YAML or
// picture.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "foundation/grid/map_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace usher::grid;
  constexpr std::size_t kLimit = 1 << 16;
  if (size == 0) return 0;
  if (bytes[0] == 'y') {
    const auto description = parse_map_description(std::string(bytes + 1, bytes + size), "input");
    if (description && !(description->resolution > 0 && description->origin.finite())) std::abort();
    return 0;
  }
  const auto image = decode_map_image({bytes + 1, size - 1}, "input", kLimit);
  if (!image) return 0;
  MapDescription description;
  description.mode = static_cast<MapMode>(bytes[0] % 3);
  description.resolution = 0.05;
  description.occupied_threshold = 0.65;
  description.free_threshold = 0.196;
  const OccupancyGrid map = to_occupancy(*image, description);
  if (map.size() > kLimit) std::abort();
  for (const std::int8_t value : map) {
    if (value < kUnknown || value > kOccupied) std::abort();
  }
  return 0;
}
