#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"

namespace usher::grid {

/// How pixels become occupancy, the names and rules of ROS's map_server.
enum class MapMode {
  kTrinary,  ///< occupied above one threshold, free below the other, else unknown; alpha counts as
             ///< a channel
  kScale,    ///< between the thresholds linear in 0..100; a pixel that is not opaque is unknown
  kRaw,      ///< pixel values 0..100 are occupancy, all else unknown; thresholds and negate have no
             ///< effect
};

/// The YAML half of a map.
struct MapDescription {
  std::string image;  ///< as written: relative to the YAML file unless it starts with '/'
  MapMode mode = MapMode::kTrinary;
  double resolution = 0.0;  ///< [m] per pixel
  geometry::Pose2 origin;   ///< of the lower-left pixel's lower-left corner, in map
  bool negate = false;
  double occupied_threshold = 0.0;  ///< [0, 1]
  double free_threshold = 0.0;      ///< [0, occupied_threshold]
};

/// The picture half: row 0 is the top.
struct MapImage {
  int width = 0;
  int height = 0;
  int channels = 1;  ///< 1 grey, 3 colour, 4 colour and alpha (last)
  int max_value = 255;
  std::vector<std::uint16_t> samples;  ///< channels interleaved
};

/// Refuses absurd sizes before anything is allocated: 8192 x 8192 cells, 400 m at 0.05 m.
inline constexpr std::size_t kMaxMapCells = std::size_t{1} << 26;

/// Loads a map_server map: YAML and a PGM (P2, P5, up to 16 bit, comments) or PNG. A map whose
/// origin has a yaw is turned upright. Errors name file and line: missing, doubled or unknown key,
/// value out of range, picture damaged or larger than `max_cells` (also after turning).
Result<OccupancyGrid> load_map(const std::string& yaml_path, std::size_t max_cells = kMaxMapCells);

/// Writes `yaml_path` and, beside it, the same name with .pgm: trinary, occupied from 65, free up
/// to 25, else unknown; numbers with 6 decimals, free_thresh 0.196 (a larger one would read the
/// unknown grey 205 as free). Each file appears whole or not at all. load_map() gives back the same
/// cells, and the same place within a micrometre.
Status save_map(const OccupancyGrid& map, const std::string& yaml_path);

/// The pieces, for tests and other sources; `name` is for messages.
Result<MapDescription> parse_map_description(const std::string& text, const std::string& name);
Result<MapImage> decode_map_image(std::span<const std::uint8_t> bytes, const std::string& name,
                                  std::size_t max_cells = kMaxMapCells);
/// Bottom row first; ignores the yaw of the origin.
OccupancyGrid to_occupancy(const MapImage& image, const MapDescription& description);

/// A grid whose own frame lies at `origin` in the map (its origin fields are ignored), resampled to
/// be axis-aligned at the same resolution; what the turned grid does not cover is unknown. Each
/// cell takes the value under its centre. Then what touches stays in touch: for each two
/// neighbouring cells (diagonal ones too) every cell on the line between their turned centres gets
/// at least the smaller of both values, so a wall of one cell gets no hole.
Result<OccupancyGrid> turned_upright(const OccupancyGrid& grid, const geometry::Pose2& origin,
                                     std::size_t max_cells = kMaxMapCells);

}  // namespace usher::grid
