#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "foundation/random/random.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/meeting_run.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/run_jobs.hpp"
#include "operations/experiments/site_facts.hpp"
#include "operations/face_study/annotated.hpp"

namespace usher::operations {

namespace {

constexpr int kSeeds = 10;
constexpr int kPixelSeeds = 5;
constexpr double kLeastPortrait = 60.0;  // [pixels]
constexpr std::uint32_t kPersons = 2;
constexpr double kLimit = 900.0;  // [s]
constexpr double kJitter = 0.3;   // [m]

/// R IV-G: how far from the meeting room's door the attendees stand.
struct Distance {
  const char* name;
  double published;         ///< [s] to bring them, without finding the room; 0: not tried
  double published_missed;  ///< persons
  const char* published_failed;
  std::array<geometry::Point2, 4> spots;
  bool strays = false;  ///< the first one stays behind on the way
};
const std::array<Distance, 4> kDistances{
    {{"short", 264.0, 1.0, "4", {{{3.6, 6.4}, {1.5, 6.6}, {5.0, 7.0}, {2.2, 5.2}}}},
     {"medium", 559.0, 2.5, "5", {{{7.3, 4.6}, {4.4, 2.0}, {7.4, 2.0}, {6.8, 9.8}}}},
     {"long", 715.0, 2.0, "10", {{{10.2, 10.4}, {10.2, 1.5}, {13.4, 9.2}, {10.2, 5.2}}}},
     {"stray", 0.0, 0.0, "", {{{7.3, 4.6}, {4.4, 2.0}, {7.4, 2.0}, {6.8, 9.8}}}, true}}};

/// Beside the first robot.
const geometry::Pose2 kSecondStart{2.35, 1.5, 1.5708};

struct Trial {
  std::size_t distance = 0;
  std::uint64_t seed = 0;
  int robots = 1;
  std::optional<MeetingRun> run;
  bool failed() const {
    using namespace usher_msgs::msg::MeetingStatus_Constants;
    return run->status.mission().outcome() != OUTCOME_COMPLETE || run->summary.contacts > 0 ||
           wrongly_counted() > 0;
  }
  /// Persons who are not in the room.
  std::uint32_t wrongly_counted() const {
    const std::uint32_t brought = run->status.mission().brought();
    return brought - std::min(brought, run->present);
  }
  /// [s] after the room was found.
  double gathering() const {
    const double room = run->status.mission().room_time();
    return run->seconds - (std::isfinite(room) ? room : 0.0);
  }
  /// What all robots did.
  usher_msgs::msg::MeetingReport mission() const {
    auto all = run->status.mission();
    std::uint32_t checked = 0, refused = 0, invited = 0, unanswered = 0, lost = 0;
    for (const auto& [robot, status] : run->statuses) {
      const auto& m = status.mission();
      checked += m.faces_checked(), refused += m.faces_refused();
      invited += m.invited(), unanswered += m.unanswered(), lost += m.lost();
    }
    all.faces_checked(checked);
    all.faces_refused(refused);
    all.invited(invited);
    all.unanswered(unanswered);
    all.lost(lost);
    return all;
  }
};

MeetingCase case_of(const Trial& trial, double limit) {
  MeetingCase one;
  one.start = {1.5, 1.5, 1.5708};
  if (trial.robots > 1) one.starts_of_others = {kSecondStart};
  one.persons = kPersons;
  one.longest = limit;
  Random random(stream_seed(trial.seed, "gather"));
  const auto& spots = kDistances[trial.distance].spots;
  const auto first = static_cast<std::size_t>(random.uniform() * 4.0);
  const auto second = (first + 1 + static_cast<std::size_t>(random.uniform() * 3.0)) % 4;
  const char* const names[] = {"ada", "boole"};
  for (const std::size_t spot : {first, second}) {
    const geometry::Point2 shift(kJitter * (2.0 * random.uniform() - 1.0),
                                 kJitter * (2.0 * random.uniform() - 1.0));
    const bool strays = kDistances[trial.distance].strays && one.people.empty();
    one.people.push_back({names[one.people.size()], spots[spot] + shift, true, strays});
  }
  return one;
}

/// "short", or "short_2_robots".
std::string row_of(std::size_t distance, int robots) {
  const std::string name = kDistances[distance].name;
  return robots == 1 ? name : name + "_" + std::to_string(robots) + "_robots";
}

std::string name_of(const Trial& trial) {
  return row_of(trial.distance, trial.robots) + "_" + std::to_string(trial.seed);
}

std::vector<std::string> row_names(int most_robots) {
  std::vector<std::string> names;
  for (int robots = 1; robots <= most_robots; ++robots) {
    for (std::size_t distance = 0; distance < kDistances.size(); ++distance)
      names.push_back(row_of(distance, robots));
  }
  return names;
}

/// Of a row ("short"; of its distance, with more robots, too), one of it ("short_7"), or all.
std::vector<Trial> trials_of(const Only& only, int seeds, int most_robots) {
  const bool one = only.number > 0;
  const int first = one ? static_cast<int>(only.number) : 1;
  const int last = one ? first : seeds;
  std::vector<Trial> trials;
  for (int robots = 1; robots <= most_robots; ++robots) {
    for (std::size_t distance = 0; distance < kDistances.size(); ++distance) {
      const bool of_distance = !one && only.name == kDistances[distance].name;
      if (!only.takes(row_of(distance, robots)) && !of_distance) continue;
      for (int seed = first; seed <= last; ++seed)
        trials.push_back({distance, static_cast<std::uint64_t>(seed), robots, {}});
    }
  }
  return trials;
}

/// With the detector's fitted model, or with pixels and the detector itself.
struct Setup {
  const char* name;
  int seeds;
  bool pixels;
  double least_speed;  ///< [s simulated per s and thread]
};

/// Photographs where there are any; else the simulator draws faces.
Status put_faces(Deployment& deployment, const ExperimentOptions& options) {
  if (options.data.empty()) {
    std::printf("drawn faces: USHER_TEST_DATA names no folder with faces/\n");
    return {};
  }
  const auto portraits = face_study::read_portraits(options.data + "/faces", kLeastPortrait);
  if (!portraits) return Error{portraits.error()};
  const std::filesystem::path folder = std::filesystem::absolute(options.out) / "faces";
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const cv::Mat& rgb : *portraits) {
    cv::Mat bgr;
    cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
    const std::string file = folder / (format("%02.0f", number++) + ".png");
    if (!cv::imwrite(file, bgr)) return Error{file + ": cannot be written"};
  }
  std::printf("%d photographed faces\n", number);
  set_value(deployment, "world", "face_pictures", folder);
  return {};
}

Result<ResultSheet> run_gather(const Setup& setup, const ExperimentOptions& options) {
  const auto only = only_run_of(setup.pixels && options.only.empty() ? "medium" : options.only,
                                row_names(options.robots));
  if (!only) return Error{only.error()};
  auto deployment =
      meeting_deployment(options, setup.pixels ? "meeting-pixels.yaml" : "meeting-demo.yaml");
  if (!deployment) return Error{deployment.error()};
  if (setup.pixels) {
    if (Status put = put_faces(*deployment, options); !put) return Error{put.error()};
  }
  const int seeds = options.seeds > 0 ? options.seeds : setup.seeds;
  const double limit = options.minutes > 0.0 ? 60.0 * options.minutes : kLimit;
  std::vector<Deployment> fleet;
  if (options.robots > 1) {
    if (setup.pixels) return Error{"a fleet is simulated without pixels"};
    auto read = meeting_fleet(options);
    if (!read) return Error{read.error()};
    fleet = std::move(read).value();
  }
  std::vector<Trial> trials = trials_of(*only, seeds, options.robots);
  const auto run_one = [&](const Trial& trial, const std::string& name, const std::string& title) {
    return run_meeting(trial.robots > 1 ? fleet : std::vector{*deployment}, case_of(trial, limit),
                       trial.seed, options.out, name, title);
  };
  const Status done =
      run_jobs(trials.size(), "meetings", [&](std::size_t i) -> Result<std::string> {
        Trial& trial = trials[i];
        auto run = run_one(trial, name_of(trial), trial.seed == 1 ? name_of(trial) : "");
        if (!run) return Error{name_of(trial) + ": " + run.error()};
        trial.run = std::move(run).value();
        if (!trial.failed() || trial.seed == 1) return std::string();
        // Once more, for its picture and trace.
        const auto traced = run_one(trial, name_of(trial), name_of(trial));
        if (!traced) return Error{traced.error()};
        return std::string();
      });
  if (!done) return Error{done.error()};

  ResultSheet sheet;
  sheet.name = setup.name;
  sheet.input = std::to_string(kPersons) + " persons in the arena, " + std::to_string(seeds) +
                " seeds for each distance, 0.7 m/s and 0.4 rad/s, lock-step" +
                (setup.pixels ? ", rendered images" : "");
  Table table({"distance", "runs", "failed", "R", "mean", "R", "longest", "with room, longest",
               "missed", "R", "checked", "refused", "lost", "contacts"});
  std::string csv =
      "distance,seed,failed,room_s,gather_s,total_s,brought,missed,checked,refused,invited,"
      "unanswered,lost,contacts\n";
  std::vector<double> look_backs;  // of one robot
  double failed_all = 0.0, worst = 0.0, missed_all = 0.0, contacts = 0.0, wall = 0.0,
         simulated = 0.0;
  for (std::size_t row = 0; row < kDistances.size() * static_cast<std::size_t>(options.robots);
       ++row) {
    const std::size_t distance = row / static_cast<std::size_t>(options.robots);
    const int robots = 1 + static_cast<int>(row % static_cast<std::size_t>(options.robots));
    double n = 0, failed = 0, mean = 0, longest = 0, total = 0, missed = 0, checked = 0,
           refused = 0, lost = 0, wrong = 0, touched = 0, met = 0, grazed = 0, whole = 0;
    for (const Trial& trial : trials) {
      if (trial.distance != distance || trial.robots != robots) continue;
      const MeetingRun& run = *trial.run;
      const auto m = trial.mission();
      ++n;
      failed += trial.failed() ? 1 : 0;
      mean += trial.gathering();
      longest = std::max(longest, trial.gathering());
      total = std::max(total, run.seconds);
      missed += run.missed;
      checked += m.faces_checked();
      refused += m.faces_refused();
      lost += m.lost();
      wrong += trial.wrongly_counted();
      touched += run.summary.contacts;
      met += run.robot_contacts;
      grazed += run.robot_touches;
      whole += run.seconds;
      if (robots == 1) {
        wall += run.wall, simulated += run.simulated;
        look_backs.insert(look_backs.end(), run.look_backs.begin(), run.look_backs.end());
      }
      csv += row_of(distance, robots) + "," + std::to_string(trial.seed) + "," +
             (trial.failed() ? "1" : "0") + format(",%.1f", m.room_time()) +
             format(",%.1f", trial.gathering()) + format(",%.1f,", run.seconds) +
             std::to_string(m.brought()) + "," + std::to_string(run.missed) + "," +
             std::to_string(m.faces_checked()) + "," + std::to_string(m.faces_refused()) + "," +
             std::to_string(m.invited()) + "," + std::to_string(m.unanswered()) + "," +
             std::to_string(m.lost()) + "," + std::to_string(run.summary.contacts) + "\n";
      if (trial.failed())
        std::printf(
            "%s: %u brought, %u there (%s) after %s, %s; contacts %u %s, localized to %.2f m\n%s"
            "replay: usher experiment %s --only %s%s\n",
            name_of(trial).c_str(), m.brought(), run.present, run.whereabouts.c_str(),
            minutes(run.seconds).c_str(), m.reason().c_str(), run.summary.contacts,
            run.summary.contact_with.c_str(), run.summary.localization_max, run.complaints.c_str(),
            setup.name, name_of(trial).c_str(),
            robots > 1 ? (" --robots " + std::to_string(robots)).c_str() : "");
    }
    if (n == 0) continue;
    const Distance& d = kDistances[distance];
    const bool published = d.published > 0.0;
    table.add({row_of(distance, robots), format("%.0f", n), format("%.0f", failed),
               d.published_failed, minutes(mean / n), published ? minutes(d.published) : "",
               minutes(longest), minutes(total), format("%.2f", missed / n),
               published ? format("%.1f", d.published_missed) : "", format("%.1f", checked / n),
               format("%.1f", refused / n), format("%.0f", lost), format("%.0f", touched)});
    const std::string name = row_of(distance, robots);
    if (options.robots > 1) sheet.metrics["mean_with_room_s_" + name] = whole / n;
    if (robots > 1) {
      sheet.metrics["between_robots_contacts_" + name] = met;
      sheet.targets["between_robots_contacts_" + name] = {Bound::kAtMost, 0.0};
      sheet.metrics["between_robots_touches_" + name] = grazed;
    }
    sheet.metrics["mean_s_" + name] = mean / n;
    sheet.metrics["missed_" + name] = missed / n;
    if (published) {
      sheet.published["mean_s_" + name] = d.published;
      sheet.targets["mean_s_" + name] = {Bound::kAtMost, d.published};
      sheet.published["missed_" + name] = d.published_missed;
      sheet.targets["missed_" + name] = {Bound::kAtMost, 1.0};
    } else {  // who stays behind is noticed, and brought in the end
      sheet.metrics["noticed_" + name] = lost / n;
      sheet.targets["noticed_" + name] = {Bound::kAtLeast, 0.9};
    }
    sheet.metrics["wrongly_counted_" + name] = wrong;
    sheet.targets["wrongly_counted_" + name] = {Bound::kAtMost, 0.0};
    failed_all += failed, worst = std::max(worst, total), contacts += touched;
    missed_all += missed;
  }
  sheet.metrics["failed"] = failed_all;
  sheet.targets["failed"] = {Bound::kAtMost, 0.0};
  sheet.metrics["longest_with_room_s"] = worst;
  sheet.targets["longest_with_room_s"] = {Bound::kAtMost, limit};
  if (!look_backs.empty()) {
    std::sort(look_backs.begin(), look_backs.end());
    sheet.metrics["look_back_s_median"] = look_backs[look_backs.size() / 2];
    sheet.metrics["look_back_s_p95"] = look_backs[look_backs.size() * 95 / 100];
    sheet.metrics["look_back_s_longest"] = look_backs.back();
    sheet.targets["look_back_s_p95"] = {Bound::kAtMost, 15.0};
  }
  sheet.metrics["contacts"] = contacts;
  sheet.targets["contacts"] = {Bound::kAtMost, 0.0};
  const char* const speed = "simulated_s_per_wall_s_and_thread";
  sheet.metrics[speed] = wall > 0.0 ? simulated / wall : 0.0;
  sheet.targets[speed] = {Bound::kAtLeast, setup.least_speed};
  const auto again = run_one(trials.front(), name_of(trials.front()), "");
  if (!again) return Error{again.error()};
  sheet.flags["digest_repeats"] = again->digest == trials.front().run->digest;
  if (options.robots > 1) {
    const auto together = run_one(trials.back(), name_of(trials.back()), "");
    if (!together) return Error{together.error()};
    sheet.flags["digest_repeats_of_a_fleet"] = together->digest == trials.back().run->digest;
  }
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/meetings.md", table.markdown());
  if (saved) saved = write_file(options.out + "/meetings.csv", csv);
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace

Result<ResultSheet> run_gather_experiment(const ExperimentOptions& options) {
  return run_gather({"gather", kSeeds, false, 20.0}, options);
}

Result<ResultSheet> run_gather_pixels_experiment(const ExperimentOptions& options) {
  return run_gather({"gather-pixels", kPixelSeeds, true, 1.5}, options);
}

}  // namespace usher::operations
