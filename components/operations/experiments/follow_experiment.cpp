#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>

#include "foundation/grid/ray_cast.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/follow_judge.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/run_jobs.hpp"
#include "operations/experiments/site_facts.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using geometry::Point2;
using geometry::Pose2;
using std::chrono::seconds;

constexpr int kSeeds = 20;
constexpr auto kLongest = seconds(420);
constexpr const char* kVisitor = "visitor";
constexpr double kSame = 0.7;        // [m] so far from the visitor another one is meant
constexpr double kArrived = 3.5;     // [m] of the visitor from the robot at the end
constexpr double kDrives = 0.05;     // [m/s]
constexpr double kSightedNow = 0.1;  // [s]
constexpr double kHalfBody = 0.2;    // [m]
constexpr double kFarEnough = 10.0;  // [m]

/// How a visitor behaves on the way.
struct Manner {
  const char* name;
  const char* text;
  std::array<std::pair<const char*, const char*>, 2> character;  ///< parameters of the visitor
  bool arrives;
  int red, green, blue;  ///< in the picture
};
constexpr std::array kManners{
    Manner{"follows", "follows at 1.2 m/s", {}, true, 30, 120, 60},
    Manner{"dawdles", "walks at 0.5 m/s from 5 s on", {{{"dawdles_at", "5"}}}, true, 40, 90, 200},
    Manner{"lace",
           "stands for 12 s to tie a lace",
           {{{"ties_lace_at", "15"}, {"ties_lace_for", "12"}}},
           true,
           200,
           130,
           20},
    Manner{"returns",
           "walks away, comes back after 20 s",
           {{{"walks_away_at", "18"}, {"walks_away_for", "20"}}},
           true,
           140,
           60,
           160},
    Manner{"leaves", "walks away for good", {{{"walks_away_at", "18"}}}, false, 200, 40, 40}};

struct Journey {
  bool right = false;  ///< arrived together, or given up for one who left
  bool arrived = false;
  std::string outcome, complaints;
  FollowJudge judge;
  std::size_t told = 0, told_right = 0;  ///< visitors seen on the way, and those who were the one
  double eta_error = NAN;
  double seconds = 0.0;
  std::vector<std::pair<double, double>> gaps;  ///< [s] since the departure, [m]
  RunRecord::Summary summary;
  std::uint64_t digest = 0;
};

/// Watches one journey of the whole robot.
class FollowRun {
 public:
  FollowRun(LockstepRun& run, const grid::OccupancyGrid& map) : run_(run), map_(map) {
    auto& world = run.world();
    world.observe(topics::kSimGroundTruth, [this](const auto& truth, const auto&) { take(truth); });
    world.observe(topics::kVisitor, [this](const auto& visitor, const auto&) { take(visitor); });
    world.observe(topics::kOdom, [this](const auto& odom, const auto&) {
      if (const auto pose = wire::to_planar(odom.pose().pose())) odom_T_base_ = *pose;
    });
    world.observe(topics::kPeople, [this](const auto& people, const auto&) { take(people); });
    world.observe(topics::kDialogueScreen, [this](const auto& screen, const auto&) {
      guides_ = screen.state() == "guide_active";
      namespace follower = usher_msgs::msg::DialogueScreen_Constants;
      waits_ = screen.follower() >= follower::FOLLOWER_AWAITED;
      over_ = screen.state() == "end" || screen.state() == "guide_error";
    });
    world.observe(topics::kGuideVisit, [this](const auto& visit, const auto&) { visit_ = visit; });
  }

  bool over() const { return over_ && visit_; }
  Journey journey(bool arrives) {
    namespace outcome = usher_msgs::msg::GuideVisit_Constants;
    journey_.judge.finish();
    journey_.summary = run_.record().summary();
    journey_.complaints = run_.complaints();
    journey_.digest = run_.world().digest();
    journey_.seconds = runtime::seconds(run_.world().elapsed());
    const auto& dialogue = run_.record().dialogue();
    journey_.outcome = dialogue.empty() ? "no dialogue" : dialogue.back();
    if (visit_) {
      journey_.arrived = visit_->arrived() > 0 && near_at_arrival_;
      journey_.eta_error = visit_->eta_error();
      journey_.right = arrives ? journey_.arrived : visit_->outcome() == outcome::OUTCOME_GIVEN_UP;
    }
    return std::move(journey_);
  }

 private:
  void take(const usher_sim_msgs::msg::GroundTruth& truth) {
    const auto pose = wire::to_planar(truth.pose());
    if (!pose) return;
    map_T_base_ = *pose;
    for (const auto& person : truth.people()) {
      if (person.name() == kVisitor) person_ = {person.x(), person.y()};
    }
    const double gap = (person_ - map_T_base_.position()).norm();
    if (!run_.record().dialogue().empty() && run_.record().dialogue().back() == "guide_success")
      near_at_arrival_ = near_at_arrival_ || gap < kArrived;
    if (!guides_) return;
    const double t = runtime::seconds(run_.world().elapsed());
    if (!departed_) departed_ = t;
    journey_.judge.take({.t = t,
                         .drives = std::abs(truth.v()) > kDrives,
                         .waits = waits_,
                         .gap = gap,
                         .visible = sighted_ || visible()});
    const double since = t - *departed_;
    if (journey_.gaps.empty() || since - journey_.gaps.back().first >= 0.2)
      journey_.gaps.emplace_back(since, gap);
  }
  void take(const usher_msgs::msg::People& people) {
    const Pose2 map_T_odom = map_T_base_ * inverse(odom_T_base_);
    sighted_ = std::ranges::any_of(people.people(), [&](const auto& person) {
      return person.unseen() < kSightedNow &&
             (map_T_odom * Point2(person.x(), person.y()) - person_).norm() < kSame;
    });
  }
  void take(const usher_msgs::msg::Visitor& visitor) {
    if (!guides_ || visitor.presence() != usher_msgs::msg::Visitor_Constants::PRESENCE_SEEN) return;
    ++journey_.told;
    const Point2 told = map_T_base_ * Point2(visitor.x(), visitor.y());
    if ((told - person_).norm() < kSame) ++journey_.told_right;
  }
  /// Some of the visitor's body can be seen past the walls of the map; sensors see past its glass,
  /// too.
  bool visible() const {
    const Point2 way = person_ - map_T_base_.position();
    const Point2 beside = kHalfBody * Point2(-way.y(), way.x()).normalized();
    return free_to(person_) || free_to(person_ + beside) || free_to(person_ - beside);
  }
  bool free_to(const Point2& point) const {
    bool free = true;
    grid::traverse(map_.geometry(), map_T_base_.position(), point, [&](const grid::Cell& cell) {
      free = !map_.geometry().contains(cell) || map_.at(cell) != grid::kOccupied;
      return free;
    });
    return free;
  }

  LockstepRun& run_;
  const grid::OccupancyGrid& map_;
  Pose2 map_T_base_, odom_T_base_;
  bool sighted_ = false;  ///< a sensor shows somebody where the visitor is
  Point2 person_ = Point2::Zero();
  bool guides_ = false, waits_ = false, over_ = false, near_at_arrival_ = false;
  std::optional<double> departed_;
  std::optional<usher_msgs::msg::GuideVisit> visit_;
  Journey journey_;
};

Result<Journey> guide(Deployment deployment, const grid::OccupancyGrid& map, const Manner& manner,
                      const std::string& place, std::uint64_t seed, const std::string& trace) {
  set_value(deployment, kVisitor, "destination", place);
  for (const auto& [name, value] : manner.character) {
    if (name != nullptr) set_value(deployment, kVisitor, name, value);
  }
  auto run = LockstepRun::create(deployment, seed);
  if (!run) return Error{run.error()};
  FollowRun watch(**run, map);
  auto& world = (*run)->world();
  while (world.elapsed() < kLongest && !watch.over()) world.run_for(std::chrono::milliseconds(500));
  Journey journey = watch.journey(manner.arrives);
  if (!trace.empty()) {
    Status saved = write_file(trace + ".csv", run_csv((*run)->record()));
    if (saved) {
      saved = draw_run((*run)->record(), map,
                       std::string("seed ") + std::to_string(seed) + ", visitor " + manner.text +
                           ", to " + place,
                       trace + ".png");
    }
    if (!saved) return Error{saved.error()};
  }
  return journey;
}

/// Sums over the journeys of one manner.
struct Sums {
  double journeys = 0, right = 0, arrived = 0, waits = 0, needless = 0, waited = 0, contacts = 0,
         gap = 0, gap_driving = 0, loss = 0, losses = 0, told = 0, told_right = 0;
  std::vector<double> eta_errors;

  void add(const Journey& journey) {
    ++journeys;
    right += journey.right ? 1 : 0;
    arrived += journey.arrived ? 1 : 0;
    waits += static_cast<double>(journey.judge.waits());
    needless += static_cast<double>(journey.judge.needless_waits());
    waited += journey.judge.waited();
    contacts += journey.summary.contacts;
    gap = std::max(gap, journey.judge.largest_gap());
    gap_driving = std::max(gap_driving, journey.judge.largest_gap_driving());
    for (const double each : journey.judge.losses()) loss = std::max(loss, each);
    losses += static_cast<double>(journey.judge.losses().size());
    told += static_cast<double>(journey.told);
    told_right += static_cast<double>(journey.told_right);
    if (journey.arrived && std::isfinite(journey.eta_error))
      eta_errors.push_back(std::abs(journey.eta_error));
  }
  double eta_mean() const {
    return eta_errors.empty() ? NAN
                              : std::accumulate(eta_errors.begin(), eta_errors.end(), 0.0) /
                                    static_cast<double>(eta_errors.size());
  }
  /// Half of the journeys are told no worse; one that is stuck in a door decides the mean.
  double eta_median() const {
    if (eta_errors.empty()) return NAN;
    auto sorted = eta_errors;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return *middle;
  }
  double eta_max() const {
    return eta_errors.empty() ? NAN : *std::max_element(eta_errors.begin(), eta_errors.end());
  }
};

std::string csv_line(const Manner& manner, std::size_t seed, const std::string& place,
                     const Journey& journey) {
  double loss = 0.0;
  for (const double each : journey.judge.losses()) loss = std::max(loss, each);
  return std::string(manner.name) + "," + std::to_string(seed) + "," + place + "," +
         (journey.right ? "1" : "0") + format(",%.1f", journey.seconds) +
         format(",%.2f", journey.judge.largest_gap()) +
         format(",%.2f", journey.judge.largest_gap_driving()) + "," +
         std::to_string(journey.judge.losses().size()) + format(",%.2f", loss) + "," +
         std::to_string(journey.judge.waits()) + "," +
         std::to_string(journey.judge.needless_waits()) + format(",%.1f", journey.judge.waited()) +
         format(",%.3f", journey.eta_error) + "," + std::to_string(journey.told) + "," +
         std::to_string(journey.told_right) + "," + std::to_string(journey.summary.contacts) + "," +
         journey.outcome + "\n";
}

/// `who_follows`: the sums of those who do nothing else; null when there are none.
ResultSheet judged(const std::vector<Sums>& sums, const Sums* who_follows, std::size_t seeds) {
  ResultSheet sheet;
  sheet.name = "follow";
  sheet.input =
      "MARVIN with its depth cameras guides a visitor through the office among others, "
      "lock-step, " +
      std::to_string(seeds) + " seeds of each manner to follow";
  const auto metric = [&sheet](const char* key, double value, Bound bound, double target) {
    sheet.metrics[key] = value;
    sheet.targets[key] = {bound, target};
  };
  Sums all;
  for (const Sums& each : sums) {
    all.journeys += each.journeys;
    all.right += each.right;
    all.contacts += each.contacts;
    all.gap = std::max(all.gap, each.gap);
    all.gap_driving = std::max(all.gap_driving, each.gap_driving);
    all.loss = std::max(all.loss, each.loss);
    all.losses += each.losses;
    all.needless += each.needless;
    all.told += each.told;
    all.told_right += each.told_right;
  }
  metric("journeys_that_ended_right", all.right, Bound::kAtLeast, all.journeys);
  metric("contacts", all.contacts, Bound::kAtMost, 0.0);
  metric("largest_gap_without_waiting_m", all.gap, Bound::kAtMost, 6.0);
  metric("seconds_to_notice_a_loss_max", all.loss, Bound::kAtMost, 2.0);
  if (who_follows) {
    metric("eta_error_of_who_follows_mean", who_follows->eta_mean(), Bound::kAtMost, 0.15);
    sheet.metrics["eta_error_of_who_follows_median"] = who_follows->eta_median();
    sheet.metrics["eta_error_of_who_follows_max"] = who_follows->eta_max();
  }
  sheet.metrics["largest_gap_driving_m"] = all.gap_driving;
  sheet.metrics["losses"] = all.losses;
  sheet.metrics["needless_waits"] = all.needless;
  sheet.metrics["visitor_right_share"] = all.told > 0 ? all.told_right / all.told : NAN;
  return sheet;
}

}  // namespace

Result<ResultSheet> run_follow_experiment(const ExperimentOptions& options) {
  const auto only = only_run_of(options.only, names_of(kManners));
  if (!only) return Error{only.error()};
  const auto deployment =
      load_deployment(options.installation.share + "/deploy/demo.yaml", options.installation, {});
  if (!deployment) return Error{deployment.error()};
  const auto places = site_places(*deployment);
  if (!places) return Error{places.error()};
  const auto map = site_map(*deployment);
  if (!map) return Error{map.error()};
  const bool one = only->number > 0;
  const std::size_t first = one ? only->number : 1;
  std::vector<const Manner*> manners;
  for (const Manner& manner : kManners) {
    if (only->takes(manner.name)) manners.push_back(&manner);
  }
  const auto seeds = one ? 1 : static_cast<std::size_t>(options.seeds > 0 ? options.seeds : kSeeds);
  // Every place far enough for somebody to fall behind gets its turn; the first one is where the
  // robot stands.
  std::vector<std::string> far;
  for (const SitePlace& each : *places) {
    if (geometry::distance(each.pose, places->front().pose) >= kFarEnough) far.push_back(each.name);
  }
  if (far.empty()) return Error{"the site has no place farther than 10 m from the first one"};
  const auto place = [&](std::size_t seed) { return far[(seed - 1) % far.size()]; };

  std::vector<std::optional<Journey>> journeys(manners.size() * seeds);
  const Status done =
      run_jobs(journeys.size(), "journeys", [&](std::size_t i) -> Result<std::string> {
        const Manner& manner = *manners[i % manners.size()];
        const std::size_t seed = first + i / manners.size();
        const std::string trace = seed == first ? options.out + "/" + manner.name : std::string();
        auto journey = guide(*deployment, *map, manner, place(seed), seed, trace);
        if (!journey) return Error{journey.error()};
        std::string said;
        if (!journey->right || journey->summary.contacts > 0)
          said = std::string(manner.name) + " to " + place(seed) + ": " + journey->outcome +
                 ", contacts " + std::to_string(journey->summary.contacts) +
                 "; again with usher experiment follow --only " + manner.name + "_" +
                 std::to_string(seed) + "\n" + journey->complaints;
        if (seed > first) journey->gaps.clear();
        journeys[i] = std::move(journey).value();
        return said;
      });
  if (!done) return Error{done.error()};

  Table table({"visitor", "journeys", "ended right", "arrived", "largest gap m", "driving m",
               "losses", "noticed within s", "waits", "needless", "waited s", "ETA error mean",
               "median", "max", "right visitor", "contacts"});
  std::string csv =
      "visitor,seed,destination,right,seconds,gap,gap_driving,losses,noticed_within,waits,needless_"
      "waits,waited,eta_error,told,told_right,contacts,outcome\n";
  std::vector<Sums> sums(manners.size());
  std::vector<Curve> curves;
  curves.reserve(manners.size());
  for (std::size_t m = 0; m < manners.size(); ++m) {
    const Manner& manner = *manners[m];
    for (std::size_t i = 0; i < seeds; ++i) {
      const Journey& journey = *journeys[i * manners.size() + m];
      sums[m].add(journey);
      csv += csv_line(manner, first + i, place(first + i), journey);
    }
    const Sums& s = sums[m];
    table.add({manner.text, format("%.0f", s.journeys), format("%.0f", s.right),
               format("%.0f", s.arrived), format("%.2f", s.gap), format("%.2f", s.gap_driving),
               format("%.0f", s.losses), format("%.2f", s.loss), format("%.0f", s.waits),
               format("%.0f", s.needless), format("%.0f", s.waited), format("%.2f", s.eta_mean()),
               format("%.2f", s.eta_median()), format("%.2f", s.eta_max()),
               format("%.3f", s.told_right / s.told), format("%.0f", s.contacts)});
    curves.push_back({manner.name, manner.red, manner.green, manner.blue, journeys[m]->gaps});
  }
  const bool some_follow = manners.front() == kManners.data();
  ResultSheet sheet = judged(sums, some_follow ? sums.data() : nullptr, seeds);
  // The first journey once more: the same bytes.
  const auto again = guide(*deployment, *map, *manners.front(), place(first), first, "");
  if (!again) return Error{again.error()};
  sheet.flags["digest_repeats"] = again->digest == journeys.front()->digest;
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/journeys.csv", csv);
  if (saved) saved = write_file(options.out + "/journeys.md", table.markdown());
  if (saved)
    saved = draw_plot(
        curves,
        "How far the visitor is behind, seed " + std::to_string(first) + ", to " + place(first),
        "seconds since the departure", "m", options.out + "/gap.png");
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
