#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"
#include "perception/people_detector/core/leg_finder.hpp"

namespace usher::people_study {

/// Legs that somebody marked in a recording of a laser; those without a mark may be legs, too.
struct MarkedScan {
  double time = 0.0;                   ///< [s]
  std::vector<float> ranges;           ///< [m] infinity: no return, NaN: out of the laser's range
  std::vector<geometry::Point2> legs;  ///< [m] in the laser's frame
};
struct LegRecording {
  std::string name;
  double angle_min = 0.0, angle_increment = 0.0;  ///< [rad]
  std::vector<MarkedScan> scans;

  people_detector::ScanView view(const MarkedScan& scan) const {
    return {angle_min, angle_increment, scan.ranges};
  }
};

/// Reads lines `# .. angle_min A .. angle_inc B .. range_min C range_max D ..`, `S time ranges ..`
/// and `L time count x y x y ..`, the marks of the scan before. The error names the line.
Result<LegRecording> parse_leg_recording(std::string_view text, const std::string& name);
/// All `*.txt.gz` of a folder, by name.
Result<std::vector<LegRecording>> read_leg_recordings(const std::string& folder);

/// The rule that detectors of legs are compared with: neighbors at most 0.10 m apart are one thing,
/// things 0.06 to 0.22 m wide are legs. Their middles, in the laser's frame, up to `farthest` [m].
std::vector<geometry::Point2> legs_by_width(const people_detector::ScanView& scan, double farthest);

/// The map that a standing laser's own scans give: where three in ten scans meet something.
grid::OccupancyGrid map_of(const LegRecording& recording, double farthest);

}  // namespace usher::people_study
