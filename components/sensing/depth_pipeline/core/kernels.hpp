#pragma once

#include <cstdint>

#include "sensing/depth_pipeline/core/row_limits.hpp"

// The loop over all pixels, for each instruction set. Included by depth_pipeline.cpp and the
// kernels_*.cpp only. All sets give the same bits.
namespace usher::depth_pipeline::kernels {

inline constexpr std::uint16_t kNothing = 0xffff;  ///< a depth, a distance or a row that is none
inline constexpr int kPad = 16;  ///< values before and after each row buffer that may be touched

/// What is known of each column while the rows pass; arrays of `width` values, rounded up to 16.
/// Distances are horizontal, from the camera's foot, in half millimetres.
struct Columns {
  struct Nearest {
    std::uint16_t* first;       ///< nearest pixel
    std::uint16_t* first_row;   ///< its row
    std::uint16_t* second;      ///< second nearest pixel: a single one may be noise
    std::uint16_t* second_row;  ///< its row
  };
  Nearest high;               ///< of the obstacles above low_height
  Nearest low;                ///< of those below
  std::uint16_t* valid;       ///< pixels that measured something
  std::uint16_t* fall_begin;  ///< [mm] floor distance where the present run below the floor began
  std::uint16_t* fall;        ///< [mm] nearest run that was long enough
};

struct Frame {
  const std::uint16_t* depth;  ///< [mm] height rows of `width`
  std::uint16_t* processed;    ///< [mm] the same size, 0 where there is no obstacle
  int width;
  int height;
  std::uint16_t least;        ///< [mm] nearer pixels measured nothing
  std::uint16_t fall_extent;  ///< [mm] of floor that must be missing
  bool missing_is_fall;       ///< pixels without a measurement count as below the floor
  bool open;                  ///< erode and dilate by 3 x 3 first
  const FloorPrediction* floor;
  Columns columns;
  /// Row buffers: three measured, three eroded, one opened, one column-wise; each padded.
  std::uint16_t* buffers[8];
};

void process_portable(const Frame& frame);
#if defined(__x86_64__)
void process_sse41(const Frame& frame);
void process_avx2(const Frame& frame);
#endif

}  // namespace usher::depth_pipeline::kernels
