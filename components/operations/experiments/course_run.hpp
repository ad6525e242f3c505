#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "operations/experiments/obstacle_judge.hpp"
#include "operations/experiments/run_record.hpp"
#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// One drive through a site with obstacles that nobody has mapped.
struct CourseCase {
  std::string goal = "goal";  ///< location of the site
  std::uint64_t seed = 1;
  double start_jitter = 0.0;   ///< [m], and half as many rad
  double object_jitter = 0.0;  ///< [m], and as many rad
  double longest = 180.0;      ///< [s]
  bool obstacles = true;       ///< else they are taken away
  bool ultrasonics = true;     ///< else they are silent
  bool pitch_hidden = false;   ///< nobody is told how the base leans: no correction
  std::string folder;          ///< a world with moved obstacles is written there
  std::string name;            ///< of that file
};

struct CourseRun {
  std::string world_file;  ///< as driven
  bool arrived = false;
  std::string outcome;  ///< why not
  RunRecord record;
  RunRecord::Summary summary;
  std::vector<ObstacleJudge::Verdict> objects;
  std::size_t costmaps = 0, false_costmaps = 0, scans = 0, false_scans = 0;
  double false_share = 0.0;            ///< of the depth camera's bearings
  double steepest = 0.0;               ///< [rad] of the pitch
  double simulated = 0.0, wall = 0.0;  ///< [s], the latter of the processor
  std::uint64_t digest = 0;
  std::string complaints;

  bool all_in_time() const {
    return std::ranges::all_of(objects, &ObstacleJudge::Verdict::in_time);
  }
};

/// In lock-step, judged beside the truth. The deployment has lock-step components and a site with a
/// world file.
Result<CourseRun> run_course(Deployment deployment, const CourseCase& one);

/// Map, obstacles (of the first run) and the ways of runs as a picture (PNG).
Status draw_course(const Deployment& deployment, const std::vector<const CourseRun*>& runs,
                   const std::string& title, const std::string& path);

}  // namespace usher::operations
