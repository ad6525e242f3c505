#include "operations/experiments/course_run.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "foundation/random/random.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/site_facts.hpp"
#include "operations/results/result_sheet.hpp"
#include "simulation/world/core/map_drawing.hpp"
#include "simulation/world/core/world_file.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

constexpr double kArrival = 0.4;  // [m]
constexpr double kKinectX = 0.2;  // [m] of MARVIN's Kinect ahead of the axle

/// The world file with every obstacle moved a little, or without them.
Result<std::string> moved_obstacles(const std::string& world_file, const CourseCase& one,
                                    Random& random) {
  const double jitter = one.object_jitter;
  try {
    YAML::Node root = YAML::LoadFile(world_file);
    if (!one.obstacles) root.remove("obstacles");
    for (YAML::Node obstacle : root["obstacles"]) {
      for (const char* kind : {"box", "disc", "table", "chair"}) {
        if (!obstacle[kind]) continue;
        auto numbers = obstacle[kind].as<std::vector<double>>();
        numbers.at(0) += random.uniform(-jitter, jitter);
        numbers.at(1) += random.uniform(-jitter, jitter);
        const double turn = random.uniform(-jitter, jitter);
        if (std::string_view(kind) != "disc") numbers.at(2) += turn;
        obstacle[kind] = numbers;
      }
    }
    YAML::Emitter out;
    out << root;
    return std::string(out.c_str()) + "\n";
  } catch (const std::exception& e) {
    return Error{world_file + ": " + e.what()};
  }
}

std::string pose_yaml(const geometry::Pose2& pose) {
  return "[" + format("%.6f", pose.x) + ", " + format("%.6f", pose.y) + ", " +
         format("%.6f", pose.yaw) + "]";
}

Result<geometry::Pose2> place(const Deployment& deployment, const std::string& name) {
  const auto places = site_places(deployment);
  if (!places) return Error{places.error()};
  for (const SitePlace& one : *places) {
    if (one.name == name) return one.pose;
  }
  return Error{"the site has no place '" + name + "'"};
}

void watch(LockstepRun& run, ObstacleJudge& judge) {
  auto& world = run.world();
  world.observe(topics::kSimGroundTruth, [&judge](const auto& truth, const auto&) {
    const auto pose = wire::to_planar(truth.pose());
    if (pose)
      judge.take_truth(wire::from_message(truth.header().stamp()), *pose, truth.v(), truth.pitch());
  });
  world.observe(topics::kOdom, [&judge](const auto& odom, const auto&) {
    const auto pose = wire::to_planar(odom.pose().pose());
    if (pose) judge.take_odometry(wire::from_message(odom.header().stamp()), *pose);
  });
  world.observe(topics::kLocalCosts, [&judge](const auto& message, const auto&) {
    const auto costs = wire::from_message(message);
    if (costs) judge.take_costs(wire::from_message(message.header().stamp()), *costs);
  });
  world.observe(topics::kKinectScan, [&judge](const auto& scan, const auto&) {
    judge.take_scan({wire::from_message(scan.header().stamp()), kKinectX,
                     static_cast<double>(scan.angle_min()),
                     static_cast<double>(scan.angle_increment()), scan.ranges()});
  });
}

/// The outline of a thing as a closed line.
std::vector<geometry::Point2> outline_of(const world::Thing& thing) {
  constexpr int kCorners = 24;
  std::vector<geometry::Point2> line = thing.outline;
  for (int i = 0; thing.outline.empty() && i < kCorners; ++i) {
    const double angle = 2.0 * geometry::kPi * i / kCorners;
    line.push_back(thing.center +
                   thing.radius * geometry::Point2(std::cos(angle), std::sin(angle)));
  }
  line.push_back(line.front());
  return line;
}

}  // namespace

Result<CourseRun> run_course(Deployment deployment, const CourseCase& one) {
  Random random(stream_seed(one.seed, "course"));
  CourseRun run;
  const auto original = site_world(deployment);
  if (!original) return Error{original.error()};
  run.world_file = *original;
  const auto start = place(deployment, "start");
  const auto goal = place(deployment, one.goal);
  const auto footprint = robot_footprint(deployment);
  if (!start || !goal || !footprint)
    return Error{!start ? start.error() : !goal ? goal.error() : footprint.error()};
  const double far = one.start_jitter;
  const geometry::Pose2 from{start->x + random.uniform(-far, far),
                             start->y + random.uniform(-far, far),
                             start->yaw + 0.5 * random.uniform(-far, far)};
  set_site_value(deployment, "site.initial_pose", pose_yaml(from));
  if (one.object_jitter > 0.0 || !one.obstacles) {
    const auto text = moved_obstacles(*original, one, random);
    if (!text) return Error{text.error()};
    run.world_file = std::filesystem::absolute(one.folder + "/" + one.name + ".yaml").string();
    if (auto saved = write_file(run.world_file, *text); !saved) return Error{saved.error()};
    set_site_value(deployment, "site.world", run.world_file);
  }
  const auto building = world::load_building(run.world_file);
  if (!building) return Error{building.error()};

  ObstacleJudge judge({.footprint = *footprint}, objects_of(building->obstacles),
                      world::construct(*building), building->ceiling);
  LockstepRun* lockstep = nullptr;
  const auto robot = lockstep_robot(deployment, one.seed, [&](LockstepRun& made) {
    lockstep = &made;
    watch(made, judge);
    if (!one.ultrasonics)
      made.world().tamper(topics::kUltrasonic, [](const auto&, auto&) { return false; });
    if (!one.pitch_hidden) return;
    made.world().tamper(topics::kBaseStatus, [](const auto&, auto& status) {
      status.pitch(0.0);
      status.pitch_rate(0.0);
      return true;
    });
  });
  if (!robot) return Error{robot.error()};
  const auto sent = (*robot)->send(one.goal, one.longest);
  if (!sent) return Error{sent.error()};
  run.record = (*robot)->take_record();
  run.summary = run.record.summary();
  run.simulated = (*robot)->elapsed();
  run.wall = (*robot)->processor_time();
  run.digest = lockstep->world().digest();
  run.complaints = (*robot)->complaints();
  const auto truth = run.record.truth();
  run.arrived = sent->reported && truth && (truth->position() - goal->position()).norm() < kArrival;
  run.outcome = run.arrived ? "" : sent->reported ? "is not where it says" : sent->reason;
  for (const auto& sample : run.record.samples())
    run.steepest = std::max(run.steepest, std::abs(sample.pitch));
  run.objects = judge.verdicts();
  run.costmaps = judge.costmaps();
  run.false_costmaps = judge.false_costmaps();
  run.scans = judge.scans();
  run.false_scans = judge.false_scans();
  run.false_share = judge.false_share();
  return run;
}

Status draw_course(const Deployment& deployment, const std::vector<const CourseRun*>& runs,
                   const std::string& title, const std::string& path) {
  const auto map = site_map(deployment);
  if (!map) return Error{map.error()};
  const auto building = world::load_building(runs.front()->world_file);
  if (!building) return Error{building.error()};
  std::vector<DrawnWay> ways;
  ways.reserve(building->obstacles.size() + runs.size());
  for (const world::Thing& thing : building->obstacles)
    ways.push_back({ways.empty() ? "not on the map" : "", 230, 120, 30, 2, outline_of(thing)});
  for (const CourseRun* run : runs) {
    DrawnWay way{run == runs.front() ? "driven" : "", 40, 140, 60, 2, {}};
    way.points.reserve(run->record.samples().size());
    for (const auto& sample : run->record.samples()) way.points.push_back(sample.truth.position());
    ways.push_back(std::move(way));
  }
  return draw_ways(ways, *map, title, path);
}

}  // namespace usher::operations
