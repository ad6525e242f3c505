#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "operations/command_line/installation.hpp"
#include "operations/results/result_sheet.hpp"

namespace usher::operations {

/// What every experiment is given.
struct ExperimentOptions {
  int seeds = 0;              ///< 0 = the experiment's own number
  int windows = 0;            ///< of the fault windows; 0 = the experiment's own number
  std::string out;            ///< folder for result.json, table.md, *.csv, *.png; exists
  std::string data;           ///< folder with real data, empty = none
  std::string only;           ///< one of the experiment's inputs; empty = all
  int robots = 1;             ///< that work together, for those that know fleets
  bool glass = false;         ///< of the corridor
  double minutes = 0.0;       ///< how long, for those that run for a time; 0 = their own
  std::uint32_t domain = 44;  ///< of those with real processes
  Installation installation;
};

struct Experiment {
  const char* name;
  const char* text;
  /// The error says why it could not run; a sheet that does not pass is a result.
  std::function<Result<ResultSheet>(const ExperimentOptions&)> run;
  std::vector<std::string> takes;  ///< options, besides --out
};

Result<ResultSheet> run_guide_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_guide_pixels_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_follow_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_visits_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_usability_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_buildings_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_buildings_dds_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_tracking_log_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_prm_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_coverage_experiment(const ExperimentOptions& options);

Result<ResultSheet> run_stopping_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_reaction_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_false_stops_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_faults_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_monopoly_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_depth_pipeline_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_human_detection_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_people_data_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_tracking_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_haar_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_depth_model_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_tracking_error_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_find_room_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_gather_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_gather_buildings_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_gather_pixels_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_corridor_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_obstacle_course_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_voice_experiment(const ExperimentOptions& options);
Result<ResultSheet> run_interaction_zones_experiment(const ExperimentOptions& options);

/// One line that is rewritten: "17 of 100  ..."; where standard error is no terminal, the first
/// line at once, then a line a minute.
void show_progress(const std::string& line);

}  // namespace usher::operations
