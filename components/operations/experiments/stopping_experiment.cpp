#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "foundation/geometry/angle.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/depth_stage.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/hall.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/only.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg;

constexpr int kSeeds = 20;
constexpr auto kTick = milliseconds(10);
constexpr const char* kOperator = "operator";
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kOnSpeed = 0.98;                // share of the target that counts as reached ...
constexpr auto kOnSpeedFor = milliseconds(200);  // ... when it is kept for so long
constexpr auto kWatched = std::chrono::seconds(6);  // after the stop command
constexpr double kUsable = 10.0;                    // [deg] of pitch: range data holds (T 8.1.3)

/// A hall with a flat measurement surface at its end, 4.4 m to either side: open space. The surface
/// is so near that the laser loses it to the floor only when the robot leans far.
constexpr const char* kHall = R"(name: hall
ceiling: 3.5
rooms: [{name: hall, title: Hall, area: [0, -4.4, 8.5, 4.4]}]
walls: [{name: hall, thickness: 0.1, points: [[0, -4.4], [8.55, -4.4], [8.55, 4.4], [-0.05, 4.4], [-0.05, -4.4]]}]
)";

struct Row {
  const char* name;
  double target;
  bool emergency;
  // The thesis, table 8.1: mean and standard deviation; NaN where the print is wrong.
  double distance, distance_sigma;
  double speed_low, speed_high, speed_sigma;
  double pitch_low, pitch_high, pitch_sigma;
  double yaw_low, yaw_high, yaw_sigma;
};

const std::array<Row, 4>& rows() {
  static const std::array<Row, 4> all{{
      {"standard_1.0", 1.0, false, 1.48, 0.05, -0.25, 1.08, 0.04, -9.22, 7.5, 0.54, -0.57, 1.06,
       0.36},
      {"standard_1.4", 1.4, false, 2.08, 0.07, -0.36, 1.49, 0.04, -13.5, 10.3, 0.49, -0.61, 1.19,
       0.43},
      {"emergency_1.0", 1.0, true, 0.76, 0.10, -0.25, 1.07, 0.02, kNone, 21.9, 0.66, -1.29, 1.04,
       1.13},
      {"emergency_1.4", 1.4, true, 1.53, 0.26, -0.31, 1.48, 0.02, kNone, 22.1, 0.74, -2.03, 2.76,
       3.36},
  }};
  return all;
}

/// Ways to a thing, or ways gone [m], each with the time at which it was measured [s]; NaN: nothing
/// was known.
using Series = std::vector<std::pair<double, double>>;

/// Between the two measurements around a time; NaN where one of them knows nothing.
double at(const Series& series, double t) {
  const auto after =
      std::lower_bound(series.begin(), series.end(), t,
                       [](const auto& point, double time) { return point.first < time; });
  if (after == series.end() || after == series.begin()) return kNone;
  const auto before = after - 1;
  const double share = (t - before->first) / (after->first - before->first);
  return before->second + share * (after->second - before->second);
}

/// What was seen over one trial, from the first command on.
struct Trace {
  struct Sample {
    double t = 0.0;           ///< [s]
    double truth = 0.0;       ///< [m] really gone
    double odometry = 0.0;    ///< [m] by the encoders, as the thesis measured: the lean is in it
    double laser = kNone;     ///< [m] by the way to the surface ahead, as measured
    double filtered = kNone;  ///< [m] the same after the ground and pitch filter
    double speed = 0.0;       ///< [m/s] by the encoders
    double pitch = 0.0;       ///< [deg]
    double yaw = 0.0;         ///< [deg]
  };
  std::vector<Sample> samples;
  // The same ways at the times of their stamps; those of depth images where they are rendered.
  Series truth, filtered, kinect;
  double stopped_at = kNone;  ///< [s] the stop command
  double distance = kNone;    ///< [m] really gone from there to the farthest point
};

/// One robot in the hall, its operator, and what instruments see.
class Trial {
 public:
  static Result<Trace> run(const Deployment& deployment, const Row& row, std::uint64_t seed) {
    auto made = LockstepRun::create(deployment, seed);
    if (!made) return Error{made.error()};
    Trial trial(std::move(made).value(), row, deployment.manifest.component("kinect") != nullptr);
    return trial.drive();
  }

 private:
  Trial(std::unique_ptr<LockstepRun> robot, const Row& row, bool camera)
      : run_(std::move(robot)), row_(row), camera_(camera) {
    auto& world = run_->world();
    world.observe(topics::kSimGroundTruth, [this](const auto& message, const auto&) {
      now_.truth = message.pose().position().x();
      truth_.emplace_back(time_of(message), now_.truth);
      now_.pitch = geometry::degrees(message.pitch());
      const auto& q = message.pose().orientation();
      now_.yaw = geometry::degrees(2.0 * std::atan2(q.z(), q.w()));
    });
    world.observe(topics::kSimBaseFeedback, [this](const auto& message, const auto&) {
      now_.odometry = 0.5 * (message.left_travel() + message.right_travel());
      now_.speed = 0.5 * (message.left_velocity() + message.right_velocity());
    });
    world.observe(topics::kScan, [this](const auto& m, const auto&) { now_.laser = ahead(m); });
    world.observe(topics::kScanFiltered, [this](const auto& m, const auto&) {
      now_.filtered = ahead(m);
      filtered_.emplace_back(time_of(m), now_.filtered);
    });
    world.observe(topics::kKinectScan, [this](const auto& m, const auto&) {
      kinect_.emplace_back(time_of(m), ahead(m));
    });
    world.observe(topics::kSupervisorStatus,
                  [this](const auto& message, const auto&) { status_ = message; });
    // The hall is empty, and the limit of a person ahead shall not hold.
    world.tamper(topics::kPersonAhead, [](const auto&, auto& message) {
      message.clear(true);
      message.distance(std::numeric_limits<float>::infinity());
      return true;
    });
  }

  /// Mean range of the few beams straight ahead [m]; NaN when they see nothing.
  static double ahead(const sensor_msgs::msg::LaserScan& scan) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < scan.ranges().size(); ++i) {
      const double angle = scan.angle_min() + static_cast<double>(i) * scan.angle_increment();
      const double range = scan.ranges()[i];
      if (std::abs(angle) > geometry::radians(1.0) || !std::isfinite(range)) continue;
      sum += range * std::cos(angle);
      ++count;
    }
    return count > 0 ? sum / count : kNone;
  }

  static double time_of(const auto& message) {
    return runtime::seconds(wire::from_message(message.header().stamp()).time_since_epoch());
  }

  void ask(std::uint8_t command) {
    SupervisorRequest request;
    request.id(++request_id_);
    request.client(kOperator);
    request.command(command);
    run_->world().publish(topics::kSupervisorRequest, request, kOperator);
  }

  void tick(bool held) {
    sensor_msgs::msg::Joy joy;
    joy.header(wire::header(run_->world().now(), ""));
    joy.axes({0.0F, held ? 1.0F : 0.0F, 0.0F, 0.0F});
    joy.buttons({0, 0, 0, 0, held ? 1 : 0});
    run_->world().publish(topics::kJoy, joy, kOperator);
    if (camera_) {  // it stands still, as in the thesis: it would turn with the supervisor's states
      CameraTilt tilt;
      tilt.servo(kCameraTilt);
      run_->world().publish(topics::kKinectTiltRequest, tilt, kOperator);
    }
    run_->world().run_for(kTick);
  }

  /// Manual mode, standing still; an error says what stands in the way.
  Status get_ready() {
    for (int i = 0; i < 2000; ++i) {
      tick(false);
      if (!status_) continue;
      if (status_->state() == SupervisorStatus_Constants::STATE_MANUAL && status_->granted())
        return {};
      if (i % 20 == 0) ask(SupervisorRequest_Constants::COMMAND_MANUAL_ON);
    }
    return Error{"the robot does not come to manual mode: " +
                 (status_ ? status_->reason() : "no supervisor") + "\n" + run_->complaints()};
  }

  void note(Trace& trace, const Trace::Sample& start, double t) const {
    Trace::Sample sample = now_;
    sample.t = t;
    sample.truth -= start.truth;
    sample.odometry -= start.odometry;
    sample.laser = start.laser - sample.laser;
    sample.filtered = start.filtered - sample.filtered;
    sample.yaw -= start.yaw;
    trace.samples.push_back(sample);
  }

  /// Since `begin` [s], by the way to the surface: the one before is where it started from.
  static Series gone(const Series& ways, double begin) {
    double sum = 0.0;
    int count = 0;
    for (const auto& [t, way] : ways) {
      if (t > begin || !std::isfinite(way)) continue;
      sum += way;
      ++count;
    }
    Series gone;
    for (const auto& [t, way] : ways)
      if (t > begin) gone.emplace_back(t - begin, sum / count - way);
    return gone;
  }

  Result<Trace> drive() {
    if (auto ready = get_ready(); !ready) return Error{ready.error()};
    for (int i = 0; i < 50; ++i) {
      // What is measured from here on tells where it starts.
      if (i == 0) truth_.clear(), filtered_.clear(), kinect_.clear();
      tick(false);
    }
    const Trace::Sample start = now_;
    const auto begin = run_->world().now();
    const auto elapsed = [&] { return runtime::seconds(run_->world().now() - begin); };
    Trace trace;
    int kept = 0;
    while (kept < kOnSpeedFor / kTick) {
      tick(true);
      note(trace, start, elapsed());
      kept = now_.speed >= kOnSpeed * row_.target ? kept + 1 : 0;
      if (elapsed() > 15.0)
        return Error{std::string(row_.name) + ": the robot does not reach its speed, " +
                     format("%.2f m/s", now_.speed) + "\n" + run_->complaints()};
    }
    trace.stopped_at = elapsed();
    const double from = now_.truth;
    double farthest = from;
    ask(row_.emergency ? SupervisorRequest_Constants::COMMAND_EMERGENCY_STOP
                       : SupervisorRequest_Constants::COMMAND_STOP);
    for (int i = 0; i < kWatched / kTick; ++i) {
      tick(true);  // the operator's hand stays where it is: the supervisor stops the robot
      note(trace, start, elapsed());
      farthest = std::max(farthest, now_.truth);
    }
    trace.distance = farthest - from;
    const double since = runtime::seconds(begin.time_since_epoch());
    for (auto& [t, x] : truth_) x = -x;  // ways to the surface, but for where that is
    trace.truth = gone(truth_, since);
    trace.filtered = gone(filtered_, since);
    trace.kinect = gone(kinect_, since);
    return trace;
  }

  std::unique_ptr<LockstepRun> run_;
  const Row& row_;
  const bool camera_;
  Trace::Sample now_;
  Series truth_, filtered_, kinect_;
  std::optional<SupervisorStatus> status_;
  std::uint64_t request_id_ = 0;
};

/// Without a depth camera, or with every image of it rendered; its scan leaves out what it is not
/// sure of, or says every measurement.
enum class Camera { kOff, kRated, kUnrated };

Result<Deployment> deploy_hall(const ExperimentOptions& options, double speed, Camera camera) {
  // As in the thesis, the stick's step reaches the base: nothing bounds it before, whatever is
  // ahead, and also while it leans to start and its laser sees the floor instead of the hall.
  std::vector<Override> overrides{{"manual_control", "linear", format("%.2f m/s", speed)},
                                  {"movement_control", "linear_speed_up", "0 m/s2"},
                                  {"movement_control", "linear_jerk", "0 m/s3"},
                                  {"movement_control", "corridor_v", "1.4 m/s"},
                                  {"movement_control", "confined_v", "1.4 m/s"},
                                  {"movement_control", "guard", "false"}};
  if (camera == Camera::kUnrated) overrides.push_back({"depth_pipeline", "confidence_frames", "1"});
  if (camera != Camera::kOff) {
    overrides.push_back({"world", "color", "false"});
    overrides.push_back({"depth_pipeline", "max_depth", "9 m"});  // the surface is 6.8 m away
    overrides.push_back({"depth_pipeline", "max_range", "8 m"});
  }
  return deploy_in_hall({.world = kHall, .start = {1.5, 0.0, 0.0}},
                        camera == Camera::kOff ? "marvin-sim" : "marvin-pixels", options.out,
                        options.installation, overrides);
}

struct Figures {
  std::vector<double> distance, speed_low, speed_high, pitch_low, pitch_high, yaw_low, yaw_high;
};

struct Statistics {
  double mean = kNone, sigma = kNone;
};

Statistics statistics(const std::vector<double>& values) {
  Statistics result;
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  result.mean = sum / static_cast<double>(values.size());
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  result.sigma =
      values.size() > 1 ? std::sqrt(squares / static_cast<double>(values.size() - 1)) : 0.0;
  return result;
}

void add(Figures& figures, const Trace& trace) {
  const auto extremes = [&](double Trace::Sample::*field) {
    const auto [low, high] =
        std::minmax_element(trace.samples.begin(), trace.samples.end(),
                            [field](const auto& a, const auto& b) { return a.*field < b.*field; });
    return std::pair((*low).*field, (*high).*field);
  };
  figures.distance.push_back(trace.distance);
  const auto speed = extremes(&Trace::Sample::speed);
  const auto pitch = extremes(&Trace::Sample::pitch);
  const auto yaw = extremes(&Trace::Sample::yaw);
  figures.speed_low.push_back(speed.first);
  figures.speed_high.push_back(speed.second);
  figures.pitch_low.push_back(pitch.first);
  figures.pitch_high.push_back(pitch.second);
  figures.yaw_low.push_back(yaw.first);
  figures.yaw_high.push_back(yaw.second);
}

/// Figures 8.1 to 8.4: velocity, pitch, displacement and yaw over time. `unrated` is the same trial
/// with every measurement of the Kinect: nothing of its scan reaches the wheels.
Status draw(const Row& row, const Trace& trace, const Trace& unrated, const std::string& out) {
  const auto curve = [&](const char* label, int red, int green, int blue,
                         double Trace::Sample::*field) {
    Curve made{label, red, green, blue, {}};
    for (const auto& sample : trace.samples) made.points.emplace_back(sample.t, sample.*field);
    return made;
  };
  const std::string kind = row.emergency ? "emergency stop from " : "standard stop from ";
  const std::string title = kind + format("%.1f m/s", row.target) + ", stop command at " +
                            format("%.1f s", trace.stopped_at);
  const std::string path = out + "/" + row.name;
  Status status = draw_plot({curve("odometry", 30, 110, 180, &Trace::Sample::speed)}, title,
                            "time [s]", "velocity [m/s]", path + "-velocity.png");
  if (status)
    status = draw_plot({curve("pitch", 200, 60, 40, &Trace::Sample::pitch)}, title, "time [s]",
                       "pitch [deg]", path + "-pitch.png");
  if (status)
    status = draw_plot({curve("odometry", 30, 110, 180, &Trace::Sample::odometry),
                        curve("laser", 200, 60, 40, &Trace::Sample::laser),
                        curve("laser, filtered", 230, 160, 30, &Trace::Sample::filtered),
                        {"Kinect, unrated", 190, 150, 215, unrated.kinect},
                        {"Kinect", 120, 70, 160, trace.kinect},
                        curve("truth", 60, 150, 60, &Trace::Sample::truth)},
                       title, "time [s]", "displacement [m]", path + "-displacement.png");
  if (status)
    status = draw_plot({curve("yaw", 120, 70, 160, &Trace::Sample::yaw)}, title, "time [s]",
                       "yaw [deg]", path + "-yaw.png");
  return status;
}

std::string trace_csv(const Trace& trace) {
  std::string csv =
      "t,truth_m,odometry_m,laser_m,laser_filtered_m,velocity_mps,pitch_deg,yaw_deg\n";
  for (const auto& s : trace.samples) {
    csv += format("%.2f", s.t);
    for (const double value : {s.truth, s.odometry, s.laser, s.filtered, s.speed, s.pitch, s.yaw})
      csv += format(",%.4f", value);
    csv += "\n";
  }
  return csv;
}

/// The ways gone at the times of the depth images.
std::string kinect_csv(const Trace& trace) {
  std::string csv = "t,kinect_m,laser_filtered_m,truth_m\n";
  for (const auto& [t, kinect] : trace.kinect) {
    csv += format("%.3f", t) + format(",%.4f", kinect) + format(",%.4f", at(trace.filtered, t)) +
           format(",%.4f\n", at(trace.truth, t));
  }
  return csv;
}

/// How far the ways gone by the depth images and by the laser agree, at the images' times.
struct Agreement {
  int images = 0, known = 0;       ///< of the depth camera, and in which it saw the surface
  std::vector<double> from_laser;  ///< [m] where both saw it
  std::vector<double> from_truth;  ///< [m]

  void take(double kinect, double laser, double truth) {
    ++images;
    known += std::isfinite(kinect) ? 1 : 0;
    if (std::isfinite(kinect - laser)) from_laser.push_back(std::abs(kinect - laser));
    if (std::isfinite(kinect - truth)) from_truth.push_back(std::abs(kinect - truth));
  }
  double known_percent() const { return images > 0 ? 100.0 * known / images : kNone; }
  static double quantile(std::vector<double> errors, double share) {
    if (errors.empty()) return kNone;
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(errors.size() - 1));
    std::nth_element(errors.begin(), errors.begin() + at, errors.end());
    return errors[static_cast<std::size_t>(at)];
  }
};

/// While it leans as it may (within kUsable), and farther.
std::pair<Agreement, Agreement> agreement(const Trace& trace) {
  std::pair<Agreement, Agreement> found;
  Series pitch;
  for (const auto& sample : trace.samples) pitch.emplace_back(sample.t, sample.pitch);
  for (const auto& [t, kinect] : trace.kinect) {
    const bool usable = std::abs(at(pitch, t)) <= kUsable;
    (usable ? found.first : found.second).take(kinect, at(trace.filtered, t), at(trace.truth, t));
  }
  return found;
}

/// One line of the table: ours beside the thesis', and whether it is within 10 % or one sigma.
bool compare(Table& table, ResultSheet& sheet, const Row& row, const char* what,
             const std::vector<double>& ours, double published, double sigma) {
  const Statistics found = statistics(ours);
  const std::string key = std::string(row.name) + "_" + what;
  sheet.metrics[key] = found.mean;
  const bool printed = std::isfinite(published);
  if (printed) sheet.published[key] = published;
  const bool holds =
      !printed || std::abs(found.mean - published) <= std::max(sigma, 0.1 * std::abs(published));
  table.add({row.name, what, format("%.2f", found.mean) + " +- " + format("%.2f", found.sigma),
             printed ? format("%.2f", published) + " +- " + format("%.2f", sigma) : "misprint",
             printed ? (holds ? "yes" : "no") : "-"});
  return holds;
}

void compare_ranges(Table& table, ResultSheet& sheet, const Row& row, const char* kind,
                    const Trace& trace) {
  const auto [usable, beyond] = agreement(trace);
  for (const Agreement* found : {&usable, &beyond}) {
    const auto error = [](const std::vector<double>& errors, double share) {
      return format("%.3f", Agreement::quantile(errors, share));
    };
    table.add({row.name, kind, found == &usable ? "to 10 deg" : "beyond",
               format("%.0f", found->images), format("%.1f", found->known_percent()),
               error(found->from_laser, 0.95), error(found->from_laser, 1.0),
               error(found->from_truth, 0.95), error(found->from_truth, 1.0)});
  }
  const std::string key = std::string(row.name) + "_kinect_" + kind;
  sheet.metrics[key + "_seen_percent"] = usable.known_percent();
  sheet.metrics[key + "_from_laser_m_p95"] = Agreement::quantile(usable.from_laser, 0.95);
  sheet.metrics[key + "_from_truth_m_p95"] = Agreement::quantile(usable.from_truth, 0.95);
  sheet.metrics[key + "_from_truth_m_worst"] = Agreement::quantile(usable.from_truth, 1.0);
}

/// The rated scan stands for the distance ahead as well as the laser does.
void judge_ranges(ResultSheet& sheet, const Row& row) {
  const std::string key = std::string(row.name) + "_kinect_rated";
  sheet.targets[key + "_seen_percent"] = {Bound::kAtLeast, 90.0};
  sheet.targets[key + "_from_laser_m_p95"] = {Bound::kAtMost, 0.05};
  sheet.targets[key + "_from_truth_m_worst"] = {Bound::kAtMost, 0.05};
}

/// Two more trials, with every depth image rendered: the curves of the figures.
Status draw_trial(const ExperimentOptions& options, const Row& row, Table& ranges,
                  ResultSheet& sheet) {
  const auto drive = [&](Camera camera) -> Result<Trace> {
    const auto deployment = deploy_hall(options, row.target, camera);
    if (!deployment) return Error{deployment.error()};
    show_progress(std::string(row.name) + ", with rendered depth images");
    return Trial::run(*deployment, row, 1);
  };
  const auto trace = drive(Camera::kRated), unrated = drive(Camera::kUnrated);
  if (!trace) return Error{trace.error()};
  if (!unrated) return Error{unrated.error()};
  compare_ranges(ranges, sheet, row, "rated", *trace);
  compare_ranges(ranges, sheet, row, "unrated", *unrated);
  judge_ranges(sheet, row);
  const std::string path = options.out + "/" + row.name;
  Status saved = write_file(path + ".csv", trace_csv(*trace));
  if (saved) saved = write_file(path + "-kinect.csv", kinect_csv(*trace));
  if (saved) saved = write_file(path + "-kinect-unrated.csv", kinect_csv(*unrated));
  return saved ? draw(row, *trace, *unrated, options.out) : saved;
}

}  // namespace

Result<ResultSheet> run_stopping_experiment(const ExperimentOptions& options) {
  const auto only = only_of(options.only, names_of(rows()));
  if (!only) return Error{only.error()};
  const int seeds = options.seeds > 0 ? options.seeds : kSeeds;
  ResultSheet sheet;
  sheet.name = "stopping";
  sheet.input =
      "MARVIN's whole deployment in lock-step in a hall, driven by the operator's gamepad "
      "and stopped by the supervisor, " +
      std::to_string(seeds) + " seeds";
  Table table({"test", "figure", "Usher", "thesis, table 8.1", "within 10 % or one sigma"});
  Table ranges({"test", "Kinect", "pitch", "images", "surface seen %", "from the laser, p95 m",
                "worst m", "from the truth, p95 m", "worst m"});
  bool all = true;
  for (const Row& row : rows()) {
    if (!only->takes(row.name)) continue;
    const auto deployment = deploy_hall(options, row.target, Camera::kOff);
    if (!deployment) return Error{deployment.error()};
    if (auto drawn = draw_trial(options, row, ranges, sheet); !drawn) return Error{drawn.error()};
    Figures figures;
    for (int seed = 1; seed <= seeds; ++seed) {
      show_progress(std::string(row.name) + ", seed " + std::to_string(seed) + " of " +
                    std::to_string(seeds));
      const auto trace = Trial::run(*deployment, row, static_cast<std::uint64_t>(seed));
      if (!trace) return Error{trace.error()};
      add(figures, *trace);
    }
    const auto line = [&](const char* what, const std::vector<double>& ours, double published,
                          double sigma) {
      all = compare(table, sheet, row, what, ours, published, sigma) && all;
    };
    line("distance_m", figures.distance, row.distance, row.distance_sigma);
    line("velocity_low_mps", figures.speed_low, row.speed_low, row.speed_sigma);
    line("velocity_high_mps", figures.speed_high, row.speed_high, row.speed_sigma);
    line("pitch_low_deg", figures.pitch_low, row.pitch_low, row.pitch_sigma);
    line("pitch_high_deg", figures.pitch_high, row.pitch_high, row.pitch_sigma);
    line("yaw_low_deg", figures.yaw_low, row.yaw_low, row.yaw_sigma);
    line("yaw_high_deg", figures.yaw_high, row.yaw_high, row.yaw_sigma);
  }
  show_progress("");
  sheet.flags["every_row_within_10_percent_or_one_sigma"] = all;
  std::printf("%s\n%s\n", table.text().c_str(), ranges.text().c_str());
  Status saved = write_file(options.out + "/table-8.1.md", table.markdown());
  if (saved) saved = write_file(options.out + "/ranges.md", ranges.markdown());
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
