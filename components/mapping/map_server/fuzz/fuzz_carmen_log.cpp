// libFuzzer: any text is refused or gives scans with finite numbers.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "mapping/map_server/core/carmen_log.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  const auto scans = usher::map_server::parse_carmen_log(text, "input");
  if (scans) {
    for (const auto& scan : *scans) {
      if (!scan.odom_T_laser.finite() || !std::isfinite(scan.time)) std::abort();
    }
  }
  const auto poses = usher::map_server::parse_reference_poses(text, "input");
  if (poses && !poses->empty() && !poses->back().finite()) std::abort();
  return 0;
}
