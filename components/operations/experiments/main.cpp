#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>

#include "foundation/text/suggestion.hpp"
#include "operations/command_line/usage.hpp"
#include "operations/experiments/experiment.hpp"

namespace usher::operations {

namespace {

constexpr double kMost = 1e6;  // seeds, windows or minutes

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all = {
      {"guide",
       "Seeded visits in the office, lock-step: arrivals, contacts, localization error, "
       "determinism",
       run_guide_experiment,
       {"--seeds", "--only"}},
      {"guide-pixels",
       "The same with every pixel of both depth cameras rendered, five seeds",
       run_guide_pixels_experiment,
       {"--seeds", "--only"}},
      {"follow",
       "MARVIN with its depth cameras guides visitors who follow, dawdle, tie a lace, walk away, "
       "lock-step: gaps, losses noticed, ETA; --only follows | dawdles | lace | returns | leaves",
       run_follow_experiment,
       {"--seeds", "--only"}},
      {"visits",
       "Seeded visits with whatever visitors do, lock-step: each must end, politely or at the "
       "place; --seeds N, --only follows | map | types | dawdles | lace | returns | leaves | stops "
       "| forgets | cancels | blocks | crowd | leads | again | silent",
       run_visits_experiment,
       {"--seeds", "--only"}},
      {"usability",
       "The seven tasks of the thesis' usability study by touch, by voice and by turns, lock-step: "
       "success, times, touches, table 7.1 beside them; --only touch | voice | mixed",
       run_usability_experiment,
       {"--seeds", "--only"}},
      {"buildings",
       "Ten goals on each map of a real building, lock-step; --seeds N goals of N seeds, --only "
       "NAME one building",
       run_buildings_experiment,
       {"--seeds", "--only"}},
      {"buildings-dds",
       "The same in one building as DDS processes; --only NAME",
       run_buildings_dds_experiment,
       {"--only", "--domain"}},
      {"tracking-log",
       "Localizes on recorded logs from raw odometry and laser, against their reference poses; "
       "--only LOG",
       run_tracking_log_experiment,
       {"--seeds", "--only"}},
      {"prm",
       "Samplings and connections of the roadmap in the arena: path lengths beside figure 8 of the "
       "meeting report",
       run_prm_experiment,
       {}},
      {"coverage",
       "Strategies of exploration in the arena, lock-step: what the camera saw after 8 minutes "
       "beside figure 12 of the meeting report; --only STRATEGY",
       run_coverage_experiment,
       {"--seeds", "--only", "--minutes"}},
      {"interaction-zones",
       "A visitor walks through the zones of the thesis' figure 7.4, lock-step: zones, poses of "
       "the "
       "torso, times, borders",
       run_interaction_zones_experiment,
       {"--seeds"}},
      {"stopping",
       "Stopping distances of the thesis' table 8.1 and figures 8.1-8.4, lock-step; how far laser "
       "and "
       "rendered depth images agree meanwhile",
       run_stopping_experiment,
       {"--seeds", "--only"}},
      {"reaction",
       "Kills and hangs every critical component of a driving robot (real processes), touches Stop "
       "on its tablet: time to zero at the base, standstill, return; --only COMPONENT or tablet",
       run_reaction_experiment,
       {"--seeds", "--only", "--domain"}},
      {"false-stops",
       "Drives beside two busy loops (real processes) and counts stops without a cause; --minutes "
       "N",
       run_false_stops_experiment,
       {"--minutes", "--domain"}},
      {"monopoly",
       "Foreign writers on every topic that moves the robot (real processes): samples executed, "
       "time until they are named; --only TOPIC",
       run_monopoly_experiment,
       {"--seeds", "--only", "--domain"}},
      {"faults",
       "Seeded windows of 20 s in which something goes wrong while the robot drives, lock-step, "
       "and a "
       "judge of the movement chain; --windows N, goes on where it was killed; --only SEED",
       run_faults_experiment,
       {"--windows", "--only"}},
      {"depth-pipeline",
       "Thesis 4.4: figures 4.11 to 4.21 (but for 4.13, 4.14 and 4.18, which hold no data), table "
       "4.2 over DDS processes, scans against the truth; --only images without processes",
       run_depth_pipeline_experiment,
       {"--only", "--domain"}},
      {"human-detection",
       "Thesis 8.3: people in the cases of figures 8.16 to 8.21 and in random rooms (--seeds N), "
       "the thesis' blobs with each fix of 8.3.3 beside the shipped detector",
       run_human_detection_experiment,
       {"--seeds"}},
      {"tracking",
       "Four people cross and hide each other before MARVIN, standing and driving, and one follows "
       "it or stays with it for 20 minutes, lock-step: MOTA, switched identities; --only standing "
       "| "
       "driving | followed | stays | pixels (rendered images), --minutes N",
       run_tracking_experiment,
       {"--seeds", "--only", "--minutes"}},
      {"people-data",
       "Legs in recorded scans and a person in recorded depth images, with what others marked in "
       "them: recall, precision; --only laser | frames",
       run_people_data_experiment,
       {"--only"}},
      {"obstacle-course",
       "Thesis 8.2.3: MARVIN drives round the objects of table 8.2, lock-step: five trials with "
       "rendered images, with and without pitch correction, --seeds N with the depth model; --only "
       "trials, seeds or no-pitch",
       run_obstacle_course_experiment,
       {"--seeds", "--only"}},
      {"corridor",
       "MARVIN drives along a corridor, lock-step; --glass: with panes in it that the map does not "
       "have, with and without its ultrasonic sensors",
       run_corridor_experiment,
       {"--seeds", "--glass"}},
      {"haar",
       "OpenCV's cascades on annotated photographs: sensitivity, false positives, time; ROC beside "
       "the meeting report's figure 9",
       run_haar_experiment,
       {}},
      {"depth-model",
       "Experiment D of the meeting report, simulated: faces and what cascades take for faces, "
       "without and with depth models",
       run_depth_model_experiment,
       {"--seeds", "--only"}},
      {"tracking-error",
       "How far the Pioneer's localization is from the truth on a round through the arena, "
       "lock-step, beside figure 6 of the meeting report; --only amcl | amcl_plain | mcl",
       run_tracking_error_experiment,
       {"--seeds", "--only"}},
      {"find-room",
       "The meeting assistant finds an empty room, lock-step: three world states, two starts, "
       "times "
       "beside section IV-F of the meeting report; --only STATE",
       run_find_room_experiment,
       {"--seeds", "--only"}},
      {"gather",
       "The meeting assistant brings two persons from short, medium and long distances, lock-step: "
       "times, misses and failures beside figure 15 of the meeting report; --only DISTANCE, or one "
       "meeting: medium_72",
       run_gather_experiment,
       {"--seeds", "--only", "--robots", "--minutes"}},
      {"gather-buildings",
       "The same in maps of real buildings, with rooms and people put into them; --only NAME",
       run_gather_buildings_experiment,
       {"--seeds", "--only", "--minutes"}},
      {"gather-pixels",
       "The same with rendered images, photographed faces and the face detector itself; --only "
       "DISTANCE",
       run_gather_pixels_experiment,
       {"--seeds", "--only", "--minutes"}},
      {"voice",
       "Recorded words and synthetic voices through the recognizer, without and with 52 dB of "
       "noise; "
       "--only SET",
       run_voice_experiment,
       {"--only"}},
  };
  return all;
}

/// The first option given that this experiment does not take.
std::optional<std::string> stray_option(const CLI::App& app, const Experiment& experiment) {
  for (const auto& other : experiments()) {
    for (const std::string& option : other.takes) {
      const auto& taken = experiment.takes;
      if (app.count(option) > 0 && std::find(taken.begin(), taken.end(), option) == taken.end())
        return option;
    }
  }
  return std::nullopt;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? "nothing" : text;
}

int run(const Experiment& experiment, ExperimentOptions options) {
  if (options.out.empty()) options.out = std::string("build/experiments/") + experiment.name;
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) return fail("cannot make " + options.out + ": " + error.message());
  std::cerr << experiment.name << ", results in " << options.out << "\n";
  const auto sheet = experiment.run(options);
  // What an experiment says of an option begins with it.
  if (!sheet) return sheet.error().starts_with("--") ? misused(sheet.error()) : fail(sheet.error());
  Status saved = write_file(options.out + "/result.json", sheet->json());
  if (saved) saved = write_file(options.out + "/table.md", sheet->markdown());
  if (!saved) return fail(saved.error());
  std::cout << sheet->markdown() << "\nin " << options.out << "\n";
  return sheet->pass() ? 0 : 1;
}

}  // namespace
}  // namespace usher::operations

int main(int argc, char** argv) {
  using namespace usher::operations;
  CLI::App app("Reruns experiments and writes result.json, table.md, *.csv and *.png",
               "usher experiment");
  std::string name;
  bool list = false;
  ExperimentOptions options;
  options.installation = Installation::of_this_program();
  if (const char* data = std::getenv("USHER_TEST_DATA")) options.data = data;
  app.add_option("name", name, "Which one");
  app.add_flag("--list", list, "Name them all");
  app.add_option("--seeds", options.seeds, "How many seeded runs; 0 = the experiment's own number")
      ->check(within(0, kMost));
  app.add_option("--windows", options.windows, "How many fault windows; 0 = the experiment's own")
      ->check(within(0, kMost));
  app.add_option("--out", options.out, "Folder for the results");
  app.add_option("--only", options.only, "One of the experiment's inputs, for example a seed");
  app.add_option("--minutes", options.minutes, "How long; 0 = the experiment's own time")
      ->check(within(0, kMost));
  app.add_flag("--glass", options.glass, "corridor: with glass panes in it");
  app.add_option("--robots", options.robots,
                 "gather: also with so many robots that call the meeting together")
      ->check(within(1, 2))
      ->capture_default_str();
  app.add_option("--domain", options.domain, "DDS domain of experiments with real processes")
      ->check(domain_number())
      ->capture_default_str();
  app.footer(kExitCodes);
  if (const auto ended = ended_by(app, argc, argv)) return *ended;
  std::vector<std::string> names;
  for (const auto& experiment : experiments()) {
    if (list) std::cout << experiment.name << ": " << experiment.text << "\n";
    if (!list && experiment.name == name) {
      if (const auto stray = stray_option(app, experiment))
        return misused(name + " takes no " + *stray + "; besides --out it takes " +
                       joined(experiment.takes));
      return run(experiment, options);
    }
    names.emplace_back(experiment.name);
  }
  if (list) return 0;
  if (name.empty()) return misused("name an experiment; see usher experiment --list");
  return misused("unknown experiment '" + name + "'; see usher experiment --list" +
                 usher::suggestion(name, names));
}
