#pragma once

#include "operations/experiments/experiment.hpp"

namespace usher::operations {

/// Table 4.2: how evenly raw depth images and scans come over DDS processes, of the whole robot and
/// of its depth cameras alone, how evenly people by the images of the Kinect alone, and what of a
/// core that takes. Writes table-4.2.md and prints it; takes one and a half minutes.
Status measure_depth_rates(const ExperimentOptions& options, ResultSheet& sheet);

}  // namespace usher::operations
