#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "control/interaction_control/shell/read_posing.hpp"
#include "foundation/geometry/angle.hpp"
#include "foundation/random/random.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/run_jobs.hpp"
#include "operations/experiments/zone_walk.hpp"
#include "runtime/parameters/parameter_set.hpp"

namespace usher::operations {

namespace {

using geometry::degrees;
using geometry::radians;
using interaction_control::Polar;
using interaction_control::Zone;
using interaction_control::Zones;
using kinematics::kTorsoJoints;
using kinematics::TorsoPose;

constexpr int kSeeds = 8;
constexpr double kFar = 4.3, kNear = 0.95;  // [m] where lines across the zones begin and end
constexpr double kSettle = 6.0;             // [s] within which every pose is taken
constexpr double kLag = 0.8;  // [s] of tracking, threshold and status; who is in a zone for longer
constexpr double kShuffle = 60.0;  // [s] on a border

/// What the thesis says of each pose (7.3, figure 7.5).
const std::map<std::string, std::string>& words() {
  static const std::map<std::string, std::string> all{
      {"close", "neck and shoulders extended, red; disabled during the usability study"},
      {"nominal", "shoulders back, neck halfway extended, green; the base tracks"},
      {"left", "leans towards them"},
      {"right", "leans towards them"},
      {"far", "shoulder and neck extend: cranes towards them"},
      {"rest", "-"}};
  return all;
}

struct Facts {
  Zones zones;
  Zones::Thresholds thresholds;
  TorsoPose rates{};
};

struct Pose {
  TorsoPose joints{};
  std::array<float, 3> eye{};
  double error_deg = 0.0, error_mm = 0.0;  ///< the largest, against the configuration
};

/// What one visitor's walk showed.
struct Trial {
  std::vector<ZoneWalk::Sample> samples;  ///< of the lines across the zones
  std::size_t clear = 0, agree = 0;       ///< samples whose true zone is beyond doubt
  std::map<std::string, Pose> poses;
  std::vector<double> delays;  ///< [s] from the true crossing to the pose
  std::vector<double> facing;  ///< [deg] of the error in the nominal zone, settled
  double rate_share = 0.0;     ///< fastest joint, as part of its rate
  int changes = 0,
      changes_bare = 0;          ///< of the zone in kShuffle on two borders; without thresholds
  double moved_listening = 0.0;  ///< [rad, m] the largest
};

Result<Facts> facts_of(const Installation& installation, const std::string& folder) {
  const auto deployment = deploy_in_hall(ZoneWalk::hall(), "marvin-sim", folder, installation, {});
  if (!deployment) return Error{deployment.error()};
  for (const auto& file : deployment->files) {
    if (file.component != "interaction_control") continue;
    runtime::ParameterSet given(file.values, "interaction_control");
    Facts facts;
    facts.thresholds = interaction_control::read_thresholds(given);
    kinematics::TorsoLimits any;
    any.fill({-7.0, 7.0, 1.0});  // the component judges the poses itself
    auto zones = interaction_control::read_zones(given, facts.thresholds, any);
    if (!zones) return Error{zones.error()};
    facts.zones = std::move(zones).value();
    facts.rates.fill(given.number("robot.torso.turn_rate", "rad/s", {}, 1.0, "As configured."));
    facts.rates[static_cast<std::size_t>(kinematics::TorsoJoint::kHeadRise)] =
        given.number("robot.torso.rise_rate", "m/s", {}, 1.0, "As configured.");
    return facts;
  }
  return Error{"marvin-sim has no interaction_control"};
}

/// The zone that a person there is in whatever was before; nothing where that is in doubt.
std::optional<std::string> beyond_doubt(const Facts& facts, const Polar& place) {
  const auto& by = facts.thresholds;
  for (const Zone& zone : facts.zones.all()) {
    if (!zone.enabled) continue;
    if (zone.holds(place, -by.range, -by.bearing)) return zone.name;
    if (zone.holds(place, by.range, by.bearing)) return std::nullopt;
  }
  return "";
}

/// How far the slower of robot and truth may be behind.
void judge_zones(const Facts& facts, Trial& trial) {
  std::string last = "?";
  double since = 0.0;
  for (const auto& sample : trial.samples) {
    const auto zone = beyond_doubt(facts, {sample.range, sample.bearing});
    if (!zone || *zone != last) {
      since = sample.t;
      last = zone.value_or("?");
    }
    if (!zone || sample.t - since < kLag) continue;
    ++trial.clear;
    trial.agree += sample.zone == *zone;
  }
}

void judge_rates(const Facts& facts, Trial& trial) {
  constexpr std::size_t kOver = 4;  // samples: a reading is up to 20 ms old
  for (std::size_t i = kOver; i < trial.samples.size(); ++i) {
    const auto& now = trial.samples[i];
    const auto& before = trial.samples[i - kOver];
    if (now.t - before.t > 0.3) continue;
    for (std::size_t j = 0; j < kTorsoJoints; ++j) {
      const double rate = std::abs(now.joints[j] - before.joints[j]) / (now.t - before.t);
      trial.rate_share = std::max(trial.rate_share, rate / facts.rates[j]);
    }
  }
}

/// In and out along lines from the robot, all around.
void cross(ZoneWalk& walk, Random& random) {
  for (int degree = -110; degree <= 110; degree += 10) {
    const double bearing = radians(degree + random.uniform(-4.0, 4.0));
    walk.send(kFar, bearing, 1.2);
    walk.arrive(12.0);
    walk.send(kNear, bearing, random.uniform(0.4, 0.7));
    walk.arrive(12.0);
    walk.send(kFar, bearing, random.uniform(0.4, 0.7));
    walk.arrive(12.0);
  }
}

Pose pose_of(const ZoneWalk::Sample& sample, const Zone& zone) {
  Pose pose{sample.joints, sample.left_eye, 0.0, 0.0};
  for (std::size_t i = 0; i < kTorsoJoints; ++i) {
    const double error = std::abs(sample.joints[i] - zone.pose[i]);
    if (kinematics::is_length(i)) {
      pose.error_mm = std::max(pose.error_mm, 1000.0 * error);
    } else {
      pose.error_deg = std::max(pose.error_deg, degrees(error));
    }
  }
  return pose;
}

/// From zone to zone as a visitor does, with time to look at each pose.
void visit(ZoneWalk& walk, const Facts& facts, Random& random, Trial& trial) {
  const auto go = [&](const char* zone, double range, double bearing, double speed) {
    walk.send(range, radians(bearing), speed);
    const double from = walk.now().t;
    double crossed = std::numeric_limits<double>::quiet_NaN();
    double posed = crossed;
    while (walk.now().t < from + 6.0 + kSettle) {
      walk.run(0.1);
      const auto& now = walk.now();
      const auto truth = beyond_doubt(facts, {now.range, now.bearing});
      if (std::isnan(crossed) && truth == std::string(zone)) crossed = now.t;
      if (now.pose != zone || !now.posed) posed = std::numeric_limits<double>::quiet_NaN();
      if (std::isnan(posed) && now.pose == zone && now.posed) posed = now.t;
    }
    if (!std::isnan(crossed)) {
      const double never = std::numeric_limits<double>::infinity();
      trial.delays.push_back(std::isnan(posed) ? never : std::max(0.0, posed - crossed));
    }
    const Zone* configured = facts.zones.find(walk.now().pose);
    if (configured != nullptr && walk.now().posed)
      trial.poses[configured->name] = pose_of(walk.now(), *configured);
    if (walk.now().zone == "nominal") trial.facing.push_back(degrees(walk.now().bearing));
  };
  const auto jitter = [&random](double by) { return random.uniform(-by, by); };
  go("far", 2.5 + jitter(0.4), jitter(20.0), 1.0);
  go("nominal", 1.1 + jitter(0.1), jitter(15.0), 0.8);
  go("left", 1.1 + jitter(0.1), 70.0 + jitter(5.0), 1.4);
  go("nominal", 1.1 + jitter(0.1), jitter(10.0), 1.0);
  go("right", 1.1 + jitter(0.1), -70.0 + jitter(5.0), 1.4);
  go("far", 2.5 + jitter(0.4), jitter(20.0), 1.0);
  walk.send(kFar + 0.5, 0.0, 1.2);
  walk.run(2.0 * kSettle);
  const Zone* rest = facts.zones.find(walk.now().pose);
  if (rest != nullptr && walk.now().posed) trial.poses[rest->name] = pose_of(walk.now(), *rest);
}

/// Shuffles about a place for kShuffle and counts how often the zone changes.
int shuffle(ZoneWalk& walk, Random& random, double range, double bearing) {
  walk.send(range, radians(bearing), 1.2);
  walk.arrive(8.0);
  walk.run(1.5);
  int changes = 0;
  std::string last = walk.now().zone;
  for (const double end = walk.now().t + kShuffle; walk.now().t < end;) {
    walk.send(range + random.uniform(-0.1, 0.1), radians(bearing + random.uniform(-3.0, 3.0)), 0.4);
    for (int i = 0; i < 20; ++i) {
      walk.run(0.05);
      changes += walk.now().zone != last;
      last = walk.now().zone;
    }
  }
  return changes;
}

double move_while_listening(ZoneWalk& walk) {
  walk.send(2.5, 0.0, 1.2);
  walk.arrive(8.0);
  walk.run(kSettle);
  walk.send(1.1, 0.0, 1.2);
  walk.arrive(3.0);
  walk.listen(true);
  walk.run(0.5);  // it comes to a stop
  const auto held = walk.now().joints;
  double moved = 0.0;
  for (int i = 0; i < 40; ++i) {
    walk.run(0.2);
    for (std::size_t j = 0; j < kTorsoJoints; ++j)
      moved = std::max(moved, std::abs(walk.now().joints[j] - held[j]));
  }
  walk.listen(false);
  return moved;
}

Result<Trial> run_trial(const Installation& installation, const std::string& folder,
                        const Facts& facts, std::uint64_t seed) {
  Random random(stream_seed(seed, "walk"));
  auto walk = ZoneWalk::create(installation, folder, {}, seed);
  if (!walk) return Error{walk.error()};
  if (auto ready = (*walk)->get_ready(); !ready) return Error{ready.error()};
  Trial trial;
  cross(**walk, random);
  trial.samples = (*walk)->samples();
  judge_zones(facts, trial);
  judge_rates(facts, trial);
  visit(**walk, facts, random, trial);
  trial.moved_listening = move_while_listening(**walk);
  const std::vector<Override> none_thresholds{
      {"interaction_control", "zone_range_threshold", "0 m"},
      {"interaction_control", "zone_bearing_threshold", "0 rad"}};
  auto bare = ZoneWalk::create(installation, folder, none_thresholds, seed);
  if (!bare) return Error{bare.error()};
  if (auto ready = (*bare)->get_ready(); !ready) return Error{ready.error()};
  for (auto& [robot, count] :
       {std::pair{walk->get(), &trial.changes}, {bare->get(), &trial.changes_bare}}) {
    *count += shuffle(*robot, random, 1.5, 0.0);
    *count += shuffle(*robot, random, 2.2, 60.0);
  }
  return trial;
}

// --- The picture

constexpr int kSize = 1100, kSide = 520;  // [px]
constexpr double kScale = 115.0;          // [px/m]
const cv::Scalar kInk(50, 44, 40), kPaper(255, 255, 255);

cv::Scalar color_of(const std::string& zone) {
  static const std::map<std::string, cv::Scalar> all{{"close", {60, 60, 220}},
                                                     {"nominal", {90, 170, 60}},
                                                     {"left", {200, 130, 40}},
                                                     {"right", {170, 70, 150}},
                                                     {"far", {40, 160, 230}}};
  const auto found = all.find(zone);
  return found == all.end() ? cv::Scalar(190, 190, 190) : found->second;
}

/// The robot looks up.
cv::Point pixel(double range, double bearing) {
  return {kSize / 2 - static_cast<int>(std::lround(kScale * range * std::sin(bearing))),
          kSize * 6 / 10 - static_cast<int>(std::lround(kScale * range * std::cos(bearing)))};
}

void write(cv::Mat& image, const std::string& text, int x, int y, double size) {
  cv::putText(image, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

void draw_border(cv::Mat& image, const Zone& zone) {
  std::vector<cv::Point> outline;
  constexpr int kSteps = 60;
  const auto arc = [&](double range, bool back) {
    for (int i = 0; i <= kSteps; ++i) {
      const double share = static_cast<double>(back ? kSteps - i : i) / kSteps;
      outline.push_back(
          pixel(range, zone.bearing_min + share * (zone.bearing_max - zone.bearing_min)));
    }
  };
  arc(zone.range_max, false);
  arc(zone.range_min, true);
  cv::polylines(image, outline, true, zone.enabled ? kInk : cv::Scalar(170, 170, 170), 2,
                cv::LINE_AA);
}

/// The torso from the front, as who stands before it sees it: its left is on the right.
void draw_torso(cv::Mat& image, const cv::Point& foot, const std::string& name, const Pose& pose) {
  using kinematics::TorsoJoint;
  const auto joint = [&pose](TorsoJoint which) {
    return pose.joints[static_cast<std::size_t>(which)];
  };
  const cv::Point2d up(0.0, -1.0);
  const auto turned = [](const cv::Point2d& v, double angle) {  // toward its left: to the right
    return cv::Point2d(v.x * std::cos(angle) - v.y * std::sin(angle),
                       v.x * std::sin(angle) + v.y * std::cos(angle));
  };
  const double lean = joint(TorsoJoint::kTorsoTilt);
  const cv::Point2d along = turned(up, lean), across = turned({1.0, 0.0}, lean);
  const cv::Point2d base = foot, chest = base + 85.0 * along;
  const double rise = 12.0 + 450.0 * joint(TorsoJoint::kHeadRise);
  const double tilt = lean + joint(TorsoJoint::kHeadTilt);
  const cv::Point2d neck = chest + rise * along, middle = neck + 24.0 * turned(up, tilt);
  const auto line = [&](const cv::Point2d& a, const cv::Point2d& b, int width) {
    cv::line(image, a, b, kInk, width, cv::LINE_AA);
  };
  line(base, chest, 3);
  line(chest, neck, 3);
  for (const auto& [which, side] :
       {std::pair{TorsoJoint::kLeftShoulder, 1.0}, {TorsoJoint::kRightShoulder, -1.0}}) {
    // Extended forward comes nearer: it is drawn larger and lower.
    const double forward = joint(which);
    const cv::Point2d shoulder =
        chest + side * 42.0 * across + 22.0 * std::sin(forward) * cv::Point2d(0.0, 1.0);
    line(chest, shoulder, 3);
    cv::circle(image, shoulder, static_cast<int>(8.0 + 8.0 * std::sin(forward)), kInk, 2,
               cv::LINE_AA);
  }
  cv::ellipse(image, middle, {19, 25}, degrees(tilt), 0, 360, kInk, 2, cv::LINE_AA);
  const double brightest = std::max({pose.eye[0], pose.eye[1], pose.eye[2], 0.01F});
  const cv::Scalar eye(255.0 * pose.eye[2] / brightest, 255.0 * pose.eye[1] / brightest,
                       255.0 * pose.eye[0] / brightest);
  const cv::Point2d gaze(12.0 * std::sin(joint(TorsoJoint::kHeadShake)),
                         -14.0 * std::sin(joint(TorsoJoint::kHeadNod)) - 3.0);
  for (const double side : {-7.0, 7.0})
    cv::circle(image, middle + gaze + side * turned({1.0, 0.0}, tilt), 4, eye, cv::FILLED,
               cv::LINE_AA);
  write(image, name, foot.x - 30, foot.y + 24, 0.6);
}

Status draw(const Facts& facts, const std::vector<std::optional<Trial>>& trials,
            const std::string& path) {
  cv::Mat image(kSize, kSize + kSide, CV_8UC3, kPaper);
  for (const auto& trial : trials) {
    for (const auto& sample : trial->samples)
      cv::circle(image, pixel(sample.range, sample.bearing), 3, color_of(sample.zone), cv::FILLED,
                 cv::LINE_AA);
  }
  for (const Zone& zone : facts.zones.all()) {
    if (zone.range_max > 0.0) draw_border(image, zone);
  }
  cv::circle(image, pixel(0.0, 0.0), 36, kInk, 2, cv::LINE_AA);
  cv::arrowedLine(image, pixel(0.0, 0.0), pixel(0.3, 0.0), kInk, 2, cv::LINE_AA);
  cv::line(image, pixel(3.0, radians(-150.0)), pixel(3.0, radians(-150.0)) + cv::Point(115, 0),
           kInk, 2);
  write(image, "1 m", pixel(3.0, radians(-150.0)).x + 40, pixel(3.0, radians(-150.0)).y - 8, 0.55);
  write(image, "Where the visitor was (dots) and the zone that the robot took it for (color);", 16,
        28, 0.6);
  write(image, "lines: the zones as configured, grey: close, switched off", 16, 52, 0.6);
  int row = 0;
  for (const char* name : {"nominal", "left", "right", "far", ""}) {
    const int y = kSize - 130 + 24 * row++;
    cv::circle(image, {30, y}, 7, color_of(name), cv::FILLED, cv::LINE_AA);
    write(image, *name != '\0' ? name : "outside", 48, y + 6, 0.55);
  }
  write(image, "Measured poses, seen from the front", kSize + 20, 52, 0.6);
  int place = 0;
  for (const char* name : {"far", "nominal", "left", "right", "rest"}) {
    const auto found = trials.front()->poses.find(name);
    if (found != trials.front()->poses.end())
      draw_torso(image, {kSize + 130 + 230 * (place % 2), 260 + 280 * (place / 2)}, name,
                 found->second);
    ++place;
  }
  if (!cv::imwrite(path, image)) return Error{"cannot write " + path};
  return {};
}

std::string samples_csv(const std::vector<std::optional<Trial>>& trials) {
  std::string csv = "seed,t,range_m,bearing_deg,zone,pose,posed";
  for (const auto name : kinematics::kTorsoJointNames) csv.append(",").append(name);
  csv += "\n";
  std::size_t seed = 0;
  for (const auto& trial : trials) {
    ++seed;
    for (const auto& s : trial->samples) {
      csv.append(std::to_string(seed))
          .append(format(",%.2f", s.t))
          .append(format(",%.3f", s.range));
      csv.append(format(",%.1f,", degrees(s.bearing))).append(s.zone).append(",").append(s.pose);
      csv.append(s.posed ? ",1" : ",0");
      for (const double joint : s.joints) csv.append(format(",%.4f", joint));
      csv += "\n";
    }
  }
  return csv;
}

std::string pose_text(const Pose& pose) {
  std::string text;
  for (std::size_t i = 0; i < kTorsoJoints; ++i) {
    if (!text.empty()) text += ", ";
    text.append(kinematics::kTorsoJointNames[i]).append(" ");
    text += kinematics::is_length(i) ? format("%.0f mm", 1000.0 * pose.joints[i])
                                     : format("%.0f", degrees(pose.joints[i]));
  }
  return text;
}

std::string place_text(const Zone& zone) {
  if (zone.range_max <= 0.0) return "nobody, or on the way";
  return format("%.1f-", zone.range_min) + format("%.1f m, ", zone.range_max) +
         format("%.0f..", degrees(zone.bearing_min)) +
         format("%.0f deg", degrees(zone.bearing_max)) + (zone.enabled ? "" : ", off");
}

struct Totals {
  std::size_t clear = 0, agree = 0;
  double delay_sum = 0.0, delay_count = 0.0, delay_max = 0.0, facing_max = 0.0;
  double error_deg = 0.0, error_mm = 0.0, rate_share = 0.0, moved = 0.0, changes = 0.0, bare = 0.0;

  void add(const Trial& trial) {
    clear += trial.clear;
    agree += trial.agree;
    for (const double delay : trial.delays) {
      delay_sum += delay;
      ++delay_count;
      delay_max = std::max(delay_max, delay);
    }
    for (const double error : trial.facing) facing_max = std::max(facing_max, std::abs(error));
    for (const auto& [name, pose] : trial.poses) {
      error_deg = std::max(error_deg, pose.error_deg);
      error_mm = std::max(error_mm, pose.error_mm);
    }
    rate_share = std::max(rate_share, trial.rate_share);
    moved = std::max(moved, trial.moved_listening);
    changes += trial.changes;
    bare += trial.changes_bare;
  }
};

ResultSheet judged(const std::vector<std::optional<Trial>>& trials) {
  Totals all;
  bool every_pose = true;
  for (const auto& trial : trials) {
    all.add(*trial);
    for (const char* name : {"nominal", "left", "right", "far", "rest"})
      every_pose = every_pose && trial->poses.contains(name);
  }
  const auto seeds = static_cast<double>(trials.size());
  const double minutes = seeds * 2.0 * kShuffle / 60.0;
  ResultSheet sheet;
  sheet.name = "interaction-zones";
  sheet.input =
      "MARVIN's whole deployment in lock-step in a hall, a visitor who walks through the "
      "zones of figure 7.4, " +
      std::to_string(trials.size()) + " seeds";
  const auto metric = [&sheet](const char* key, double value, Bound bound, double target) {
    sheet.metrics[key] = value;
    sheet.targets[key] = {bound, target};
  };
  metric("zone_right_share", all.clear > 0 ? double(all.agree) / double(all.clear) : 0.0,
         Bound::kAtLeast, 0.98);
  metric("pose_error_deg_max", all.error_deg, Bound::kAtMost, 1.0);
  metric("pose_error_mm_max", all.error_mm, Bound::kAtMost, 1.0);
  metric("seconds_to_pose_max", all.delay_max, Bound::kAtMost, kSettle);
  sheet.metrics["seconds_to_pose_mean"] =
      all.delay_count > 0.0 ? all.delay_sum / all.delay_count : 0.0;
  metric("joint_rate_share_max", all.rate_share, Bound::kAtMost, 1.0);
  metric("facing_error_deg_max", all.facing_max, Bound::kAtMost, 18.0);
  metric("changes_on_a_border_per_minute", all.changes / minutes, Bound::kAtMost, 1.0);
  sheet.metrics["changes_without_thresholds_per_minute"] = all.bare / minutes;
  sheet.flags["every_pose_taken"] = every_pose;
  sheet.flags["still_while_it_listens"] = all.moved < 1e-6;
  return sheet;
}

}  // namespace

Result<ResultSheet> run_interaction_zones_experiment(const ExperimentOptions& options) {
  const auto seeds = static_cast<std::size_t>(options.seeds > 0 ? options.seeds : kSeeds);
  const auto facts = facts_of(options.installation, options.out);
  if (!facts) return Error{facts.error()};
  std::vector<std::optional<Trial>> trials(seeds);
  const Status done = run_jobs(seeds, "visitors", [&](std::size_t i) -> Result<std::string> {
    const std::string folder = options.out + "/seed-" + std::to_string(i + 1);
    std::filesystem::create_directories(folder);
    auto trial = run_trial(options.installation, folder, *facts, i + 1);
    if (!trial) return Error{trial.error()};
    trials[i] = std::move(trial).value();
    return std::string();
  });
  if (!done) return Error{done.error()};
  ResultSheet sheet = judged(trials);
  Table table({"zone", "where", "thesis, figures 7.4 and 7.5", "measured pose, deg"});
  for (const Zone& zone : facts->zones.all()) {
    const auto found = trials.front()->poses.find(zone.name);
    const auto said = words().find(zone.name);
    table.add({zone.name, place_text(zone), said == words().end() ? "-" : said->second,
               found == trials.front()->poses.end() ? "not taken" : pose_text(found->second)});
  }
  std::printf("%s\n", table.text().c_str());
  std::printf(
      "The thesis measured no zones; of its visitors 55.6 %% found that the poses improved "
      "their experience, 33.3 %% did not (question 13).\n\n");
  Status saved = write_file(options.out + "/poses.md", table.markdown());
  if (saved) saved = write_file(options.out + "/samples.csv", samples_csv(trials));
  if (saved) saved = draw(*facts, trials, options.out + "/zones.png");
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
