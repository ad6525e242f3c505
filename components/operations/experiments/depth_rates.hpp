#pragma once

#include "operations/experiments/experiment.hpp"

namespace usher::operations {

/// Table 4.2: how evenly raw depth images, scans and people come over DDS processes, and what of a
/// core that takes; of the whole robot, and of its depth camera alone. Writes table-4.2.md and
/// prints it; takes one and a half minutes.
Status measure_depth_rates(const ExperimentOptions& options, ResultSheet& sheet);

}  // namespace usher::operations
