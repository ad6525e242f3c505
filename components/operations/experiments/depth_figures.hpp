#pragma once

#include "operations/experiments/depth_stage.hpp"

namespace usher::operations {

constexpr double kThesisFar = 12.0;  ///< [m] of the value 255 in the thesis' images

depth_pipeline::DepthPipeline pipeline_of(const DepthStage& stage, int confidence_frames);

/// Figures 4.11, 4.12, 4.15, 4.16, 4.17, 4.19, 4.20 and 4.21 of the thesis, and table 4.1, with
/// what Usher makes of the same rendered images. Not 4.13, 4.14 and 4.18: two sketches of the
/// camera and a listing, which hold no data.
Status draw_depth_figures(DepthStage& stage, const std::string& out);

}  // namespace usher::operations
