#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>

#include "foundation/random/random.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/hall.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/run_jobs.hpp"
#include "operations/experiments/site_facts.hpp"
#include "operations/people_study/tracking_judge.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using geometry::Point2;
using geometry::Pose2;
using people_study::TrackingJudge;
using runtime::Time;

constexpr int kSeeds = 5;
constexpr const char* kVisitor = "visitor";
constexpr double kSettles = 5.0;       // [s] until the robot knows where it is
constexpr double kStep = 8.0;          // [s] between two steps of who stays
constexpr double kLongestWay = 120.0;  // [s]
constexpr double kDrawn = 40.0;        // [s] of a run, in its picture
constexpr double kSeenNow = 0.5;       // [s]
// Where MARVIN's sensors show somebody: the Kinect, the camera that looks back, the laser.
constexpr double kKinectReach = 6.0, kRearReach = 4.0, kLaserReach = 6.5;     // [m]
constexpr double kKinectAngle = 0.58, kRearAngle = 0.48, kLaserAngle = 1.95;  // [rad] to a side
constexpr double kCamera = 0.2;   // [m] of Kinect and rear camera from the axle
constexpr double kNearest = 0.6;  // [m]
constexpr double kBody = 0.25;    // [m] of somebody who hides others

constexpr const char* kWorld = R"(name: hall
ceiling: 3.0
rooms: [{name: hall, title: Hall, area: [0, 0, 12, 9]}]
walls: [{name: hall, thickness: 0.2, points: [[0, 0], [12, 0], [12, 9], [0, 9], [0, 0]]}]
)";

/// Whether the first one minds the robot.
enum class Visitor : std::uint8_t { kNone, kFollows, kStays };

/// What robot and people do.
struct Case {
  const char* name;
  const char* text;
  const char* manifest;
  double minutes;
  bool drives;
  Visitor visitor;
};
constexpr std::array kCases{Case{"standing", "four people walk before a robot that stands",
                                 "marvin-depth-sim", 10.0, false, Visitor::kNone},
                            Case{"driving", "four people walk about a robot that drives",
                                 "marvin-depth-sim", 10.0, true, Visitor::kNone},
                            Case{"followed", "one follows a robot that drives among three others",
                                 "marvin-depth-sim", 20.0, true, Visitor::kFollows},
                            Case{"stays", "one stays with a robot that stands, three others pass",
                                 "marvin-depth-sim", 20.0, false, Visitor::kStays},
                            Case{"pixels", "as standing, with rendered images", "marvin-pixels",
                                 10.0, false, Visitor::kNone}};

/// Where and on which ways; the same for the same seed.
Hall hall_of(const Case& one, std::uint64_t seed) {
  Random random(stream_seed(seed, "tracking"));
  Hall hall{.world = kWorld, .start = {1.5, 4.5, 0.0}};
  if (one.drives) hall.places = {{"east", {10.5, 4.5, 0.0}}, {"west", {1.5, 4.5, geometry::kPi}}};
  hall.people = "people:\n";
  const bool has_visitor = one.visitor != Visitor::kNone;
  if (has_visitor) hall.people += "  - {name: visitor, at: [2.9, 4.5], yaw: 3.14}\n";
  const double from = one.drives ? 1.0 : 3.0, to = one.drives ? 11.0 : 7.0;
  for (int i = has_visitor ? 1 : 0; i < 4; ++i) {
    std::string loop;
    for (int k = 0; k < 6; ++k) {
      loop += (k > 0 ? ", [" : "[") + format("%.2f", random.uniform(from, to)) + ", " +
              format("%.2f", random.uniform(1.2, 7.8)) + "]";
    }
    hall.people += "  - {name: walker_" + std::to_string(i + 1) +
                   format(", speed: %.2f", random.uniform(0.7, 1.3)) +
                   format(", pause: %.1f", random.uniform(0.0, 3.0)) + ", loop: [" + loop + "]}\n";
  }
  return hall;
}

/// Of one run.
struct Watched {
  TrackingJudge::Figures all, first;
  double seconds = 0.0;
  double path = 0.0;  ///< [m] driven
  std::uint32_t contacts = 0;
  std::size_t errands = 0, arrivals = 0;
  std::string complaints;
  std::uint64_t digest = 0;
  std::string csv;  ///< who is where and told as whom
  std::vector<DrawnWay> ways;
};

/// Where a sensor of the robot looks.
bool is_in_view(const Point2& place) {
  const auto within = [](const Point2& at, double reach, double middle, double angle) {
    const double bearing = std::atan2(at.y(), at.x());
    return at.norm() < reach && at.norm() > kNearest &&
           std::abs(geometry::normalized(bearing - middle)) < angle;
  };
  const Point2 camera(kCamera, 0.0);
  return within(place - camera, kKinectReach, 0.0, kKinectAngle) ||
         within(place + camera, kRearReach, geometry::kPi, kRearAngle) ||
         within(place, kLaserReach, 0.0, kLaserAngle);
}

/// Behind somebody else.
bool is_hidden(const std::vector<Point2>& from_base, std::size_t who) {
  const auto bearing = [](const Point2& point) { return std::atan2(point.y(), point.x()); };
  for (std::size_t i = 0; i < from_base.size(); ++i) {
    const double near = from_base[i].norm();
    if (i == who || near >= from_base[who].norm()) continue;
    const double beside = geometry::normalized(bearing(from_base[who]) - bearing(from_base[i]));
    if (std::abs(beside) * near < kBody) return true;
  }
  return false;
}

/// Compares `people` with where people are.
class TrackingWatch {
 public:
  TrackingWatch(LockstepRun& run, bool notes) : run_(run), notes_(notes) {
    auto& world = run.world();
    world.observe(topics::kSimGroundTruth, [this](const auto& truth, const auto&) { take(truth); });
    world.observe(topics::kOdom, [this](const auto& odom, const auto&) {
      const auto pose = wire::to_planar(odom.pose().pose());
      if (pose) remember(odoms_, wire::from_message(odom.header().stamp()), *pose);
    });
    world.observe(topics::kPeople, [this](const auto& people, const auto&) { take(people); });
  }

  Watched watched() const {
    Watched found;
    found.all = judge_.figures();
    found.first = judge_.figures_of(0);
    found.seconds = runtime::seconds(run_.world().elapsed()) - kSettles;
    found.path = path_;
    found.contacts = contacts_;
    found.complaints = run_.complaints();
    found.digest = run_.world().digest();
    found.csv = csv_;
    found.ways = truths_;
    for (const auto& [id, way] : told_) found.ways.push_back(way);
    return found;
  }

 private:
  static constexpr std::size_t kRemembered = 200;
  struct Moment {
    Time stamp{};
    Pose2 pose;
    std::vector<Point2> people;
  };

  static void remember(std::deque<Moment>& moments, Time stamp, const Pose2& pose,
                       std::vector<Point2> people = {}) {
    moments.push_back({stamp, pose, std::move(people)});
    if (moments.size() > kRemembered) moments.pop_front();
  }
  static const Moment* nearest(const std::deque<Moment>& moments, Time stamp) {
    const auto best =
        std::min_element(moments.begin(), moments.end(), [&](const Moment& a, const Moment& b) {
          return std::chrono::abs(a.stamp - stamp) < std::chrono::abs(b.stamp - stamp);
        });
    return best == moments.end() ? nullptr : &*best;
  }

  void take(const usher_sim_msgs::msg::GroundTruth& truth) {
    const auto pose = wire::to_planar(truth.pose());
    if (!pose) return;
    std::vector<Point2> people;
    for (const auto& person : truth.people()) people.emplace_back(person.x(), person.y());
    if (!moments_.empty()) path_ += geometry::distance(*pose, moments_.back().pose);
    contacts_ = truth.contacts();
    remember(moments_, wire::from_message(truth.header().stamp()), *pose, std::move(people));
  }

  void take(const usher_msgs::msg::People& people) {
    const double t = runtime::seconds(run_.world().elapsed()) - kSettles;
    const Time stamp = wire::from_message(people.header().stamp());
    const Moment* truth = nearest(moments_, stamp);
    const Moment* odom = nearest(odoms_, stamp);
    if (t < 0.0 || truth == nullptr || odom == nullptr) return;
    const Pose2 map_T_odom = truth->pose * inverse(odom->pose);
    std::vector<Point2> from_base;
    for (const Point2& person : truth->people) from_base.push_back(inverse(truth->pose) * person);
    std::vector<TrackingJudge::Truth> truths;
    for (std::size_t i = 0; i < from_base.size(); ++i) {
      const bool in_view = is_in_view(from_base[i]);
      truths.push_back({truth->people[i], in_view, in_view && !is_hidden(from_base, i)});
    }
    std::vector<TrackingJudge::Told> told;
    for (const auto& person : people.people()) {
      told.push_back({person.id(), map_T_odom * Point2(person.x(), person.y()),
                      static_cast<double>(person.unseen()) < kSeenNow});
    }
    judge_.take(truths, told);
    if (!notes_) return;
    note(t, truth->pose, truths);
    if (t <= kDrawn) draw(truths, told);
  }

  void note(double t, const Pose2& robot, const std::vector<TrackingJudge::Truth>& truths) {
    for (std::size_t i = 0; i < truths.size(); ++i) {
      csv_ += format("%.3f", t) + "," + std::to_string(i + 1) +
              format(",%.3f", truths[i].place.x()) + format(",%.3f", truths[i].place.y()) +
              (truths[i].in_view ? ",1" : ",0") + (truths[i].visible ? ",1," : ",0,") +
              std::to_string(judge_.identity_now(i)) + format(",%.3f", robot.x) +
              format(",%.3f", robot.y) + format(",%.3f\n", robot.yaw);
    }
  }

  void draw(const std::vector<TrackingJudge::Truth>& truths,
            const std::vector<TrackingJudge::Told>& told) {
    if (truths_.empty()) truths_.resize(truths.size(), {"", 190, 190, 190, 7, {}});
    if (!truths_.empty()) truths_.front().label = "people";
    for (std::size_t i = 0; i < truths_.size(); ++i) truths_[i].points.push_back(truths[i].place);
    for (const auto& one : told) {
      DrawnWay& way = told_[one.id];
      way.label = "as " + std::to_string(one.id);
      way.paint(one.id);
      way.points.push_back(one.place);
    }
  }

  LockstepRun& run_;
  bool notes_;
  std::deque<Moment> moments_, odoms_;
  TrackingJudge judge_;
  double path_ = 0.0;
  std::uint32_t contacts_ = 0;
  std::string csv_;
  std::vector<DrawnWay> truths_;
  std::map<std::uint64_t, DrawnWay> told_;
};

void send_visitor(LockstepRun& run, const Point2& place, double speed, bool follow) {
  usher_sim_msgs::msg::PersonGoal goal;
  goal.name(kVisitor);
  goal.x(place.x());
  goal.y(place.y());
  goal.speed(speed);
  goal.follow(follow);
  run.world().publish(topics::kSimPersonGoal, goal, kVisitor);
}

/// The robot stands, and who stays with it steps about before it.
void stand(LockstepRun& run, const Case& one, std::uint64_t seed, double seconds) {
  if (one.visitor != Visitor::kStays) return run.world().run_for(runtime::from_seconds(seconds));
  Random random(stream_seed(seed, "steps"));
  const int steps = static_cast<int>(std::ceil(seconds / kStep));
  for (int i = 0; i < steps; ++i) {
    send_visitor(run, {random.uniform(3.2, 4.5), random.uniform(3.5, 5.5)}, 0.5, false);
    run.world().run_for(runtime::from_seconds(std::min(kStep, seconds - i * kStep)));
  }
}

Status save_notes(const ExperimentOptions& options, const Case& one, std::uint64_t seed,
                  const Deployment& deployment, const Watched& watched) {
  const auto map = site_map(deployment);
  if (!map) return Error{map.error()};
  const std::string path = options.out + "/" + one.name;
  Status saved =
      write_file(path + ".csv",
                 "t,person,x,y,in_view,visible,told_as,robot_x,robot_y,robot_yaw\n" + watched.csv);
  if (!saved) return saved;
  return draw_ways(watched.ways, *map,
                   std::string(one.text) + ", seed " + std::to_string(seed) + ", the first " +
                       format("%.0f s", kDrawn),
                   path + ".png");
}

Result<Watched> watch(const ExperimentOptions& options, const Case& one, std::uint64_t seed,
                      double minutes, bool notes, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{"cannot make " + folder + ": " + error.message()};
  const auto deployment = deploy_in_hall(hall_of(one, seed), one.manifest, folder,
                                         options.installation, {{"world", "people", "true"}});
  if (!deployment) return Error{deployment.error()};
  LockstepRun* run = nullptr;
  std::optional<TrackingWatch> watch;
  const auto robot = lockstep_robot(*deployment, seed, [&](LockstepRun& made) {
    run = &made;
    watch.emplace(made, notes);
  });
  if (!robot) return Error{robot.error()};
  run->world().run_for(runtime::from_seconds(kSettles));
  if (one.visitor == Visitor::kFollows) send_visitor(*run, Point2::Zero(), 1.3, true);
  const double end = kSettles + 60.0 * minutes;
  std::size_t errands = 0, arrivals = 0;
  const auto left = [&] { return end - (*robot)->elapsed(); };
  while (left() > 0.0) {
    if (!one.drives) {
      stand(*run, one, seed, left());
      continue;
    }
    const char* place = errands++ % 2 == 0 ? "east" : "west";
    const auto sent = (*robot)->send(place, std::min(kLongestWay, left()));
    if (!sent) return Error{sent.error()};
    arrivals += sent->reported;
  }
  Watched watched = watch->watched();
  watched.errands = errands, watched.arrivals = arrivals;
  if (notes) {
    const Status saved = save_notes(options, one, seed, *deployment, watched);
    if (!saved) return Error{saved.error()};
  }
  watched.csv.clear(), watched.ways.clear();
  return watched;
}

double in_ten_minutes(int switches, double seconds) { return 600.0 * switches / seconds; }

void judge_case(const Case& one, const std::vector<const Watched*>& runs, ResultSheet& sheet,
                Table& table) {
  TrackingJudge::Figures all, first;
  double seconds = 0.0, path = 0.0, worst = 0.0;
  std::uint32_t contacts = 0;
  std::size_t errands = 0, arrivals = 0;
  for (const Watched* run : runs) {
    all += run->all, first += run->first;
    seconds += run->seconds, path += run->path, contacts += run->contacts;
    errands += run->errands, arrivals += run->arrivals;
    worst = std::max(worst, in_ten_minutes(run->all.switches, run->seconds));
  }
  const double switches = in_ten_minutes(all.switches, seconds);
  const double in_view = in_ten_minutes(all.switches - all.away_switches, seconds);
  const int first_in_view = first.switches - first.away_switches;
  const bool has_visitor = one.visitor != Visitor::kNone;
  const std::string name(one.name);
  table.add({one.text, std::to_string(runs.size()), format("%.0f", seconds / 60.0),
             format("%.3f", all.mota()), format("%.2f", all.motp()),
             format("%.4f", double(all.misses) / all.truths),
             format("%.4f", double(all.false_alarms) / all.truths), format("%.1f", switches),
             format("%.1f", worst), format("%.1f", in_view),
             has_visitor ? std::to_string(first.switches) : "",
             has_visitor ? std::to_string(first_in_view) : "", format("%.0f", path),
             one.drives ? std::to_string(arrivals) + " of " + std::to_string(errands) : "",
             std::to_string(contacts)});
  sheet.metrics[name + "_mota"] = all.mota();
  sheet.metrics[name + "_motp_m"] = all.motp();
  sheet.metrics[name + "_switches_in_10_min"] = switches;
  sheet.metrics[name + "_switches_in_10_min_worst"] = worst;
  sheet.metrics[name + "_switches_in_view_in_10_min"] = in_view;
  sheet.targets[name + "_mota"] = {Bound::kAtLeast, 0.9};
  if (has_visitor) {
    sheet.metrics[name + "_visitor_switches"] = first.switches;
    sheet.metrics[name + "_visitor_switches_in_view"] = first_in_view;
    sheet.metrics[name + "_visitor_missed"] = double(first.misses) / first.truths;
    sheet.targets[name + "_visitor_switches"] = {Bound::kAtMost, 0.0};
  } else {
    sheet.targets[name + "_switches_in_10_min"] = {Bound::kAtMost, 2.0};
  }
}

std::string csv_line(const Case& one, std::uint64_t seed, const Watched& run) {
  const auto& all = run.all;
  return std::string(one.name) + "," + std::to_string(seed) + format(",%.0f,", run.seconds) +
         std::to_string(all.truths) + "," + std::to_string(all.misses) + "," +
         std::to_string(all.false_alarms) + "," + std::to_string(all.switches) + "," +
         std::to_string(all.away_switches) + format(",%.4f", all.mota()) +
         format(",%.3f,", all.motp()) + std::to_string(run.first.switches) + "," +
         std::to_string(run.first.away_switches) + "," + std::to_string(run.first.misses) +
         format(",%.1f,", run.path) + std::to_string(run.errands) + "," +
         std::to_string(run.arrivals) + "," + std::to_string(run.contacts) + "\n";
}

}  // namespace

Result<ResultSheet> run_tracking_experiment(const ExperimentOptions& options) {
  const auto only = only_run_of(options.only, names_of(kCases));
  if (!only) return Error{only.error()};
  const bool one_run = only->number > 0;
  const std::uint64_t first = one_run ? only->number : 1;
  const auto seeds =
      one_run ? 1 : static_cast<std::size_t>(options.seeds > 0 ? options.seeds : kSeeds);
  std::vector<const Case*> cases;
  for (const Case& one : kCases) {
    // Rendering takes longer than all the others.
    const bool is_slow = std::string_view(one.name) == "pixels";
    if (only->name.empty() ? !is_slow : only->takes(one.name)) cases.push_back(&one);
  }
  std::vector<Watched> runs(cases.size() * seeds);
  std::uint64_t again = 0;
  // The last job is the first run once more: the same bytes.
  const Status done = run_jobs(runs.size() + 1, "runs", [&](std::size_t i) -> Result<std::string> {
    const bool repeats = i == runs.size();
    const std::size_t which = repeats ? 0 : i;
    const Case& one = *cases[which / seeds];
    const std::uint64_t seed = first + which % seeds;
    const std::string name = std::string(one.name) + "_" + std::to_string(seed);
    auto watched =
        watch(options, one, seed, options.minutes > 0.0 ? options.minutes : one.minutes,
              seed == first && !repeats, options.out + "/sites/" + (repeats ? "again" : name));
    if (!watched) return Error{watched.error()};
    std::string said;
    if (repeats) {
      again = watched->digest;
      return said;
    }
    if (watched->all.mota() < 0.9 || watched->contacts > 0)
      said = name + ": MOTA " + format("%.3f", watched->all.mota()) + ", contacts " +
             std::to_string(watched->contacts) + "; again with usher experiment tracking --only " +
             name + "\n" + watched->complaints;
    runs[i] = std::move(watched).value();
    return said;
  });
  if (!done) return Error{done.error()};

  ResultSheet sheet;
  sheet.name = "tracking";
  sheet.input =
      "MARVIN in a hall of 12 x 9 m among people who cross and hide each other, lock-step, " +
      std::to_string(seeds) +
      " seeds; who is in the view of Kinect, rear camera or laser and not behind somebody must be "
      "told";
  Table table({"case", "runs", "minutes", "MOTA", "MOTP m", "missed", "false", "switches in 10 min",
               "worst run", "of them in view", "visitor's", "in view", "driven m", "arrived",
               "contacts"});
  std::string csv =
      "case,seed,seconds,truths,misses,false_alarms,switches,away_switches,mota,motp,first_"
      "switches,"
      "first_away_switches,first_misses,path,errands,arrivals,contacts\n";
  for (std::size_t c = 0; c < cases.size(); ++c) {
    std::vector<const Watched*> of_case;
    for (std::size_t s = 0; s < seeds; ++s) {
      of_case.push_back(&runs[c * seeds + s]);
      csv += csv_line(*cases[c], first + s, *of_case.back());
    }
    judge_case(*cases[c], of_case, sheet, table);
  }
  sheet.flags["digest_repeats"] = again == runs.front().digest;
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/runs.csv", csv);
  if (saved) saved = write_file(options.out + "/cases.md", table.markdown());
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
