#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "foundation/random/random.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/run_jobs.hpp"
#include "operations/experiments/site_facts.hpp"
#include "operations/experiments/visit_end.hpp"

namespace usher::operations {

namespace {

using std::chrono::seconds;
namespace outcome = usher_msgs::msg::GuideVisit_Constants;

constexpr int kSeeds = 100;
constexpr auto kLongest = seconds(1200);
constexpr double kStands = 0.05;  // [m/s]
constexpr auto kStandsFor = seconds(10);
constexpr const char* kVisitor = "visitor";

/// In the corners of the foyer.
constexpr const char* kBystanders =
    "[1.5 m, 1.6 m, 1.5 m, 2.6 m, 2.5 m, 1.5 m, 7.0 m, 1.6 m, 1.6 m, 7.6 m]";

using Values = std::vector<std::pair<const char*, std::string>>;

/// What a visitor is up to. Times are after the departure.
struct Manner {
  const char* name;
  const char* text;
  Values (*character)(Random& random);
  Wish wish = Wish::kToArrive;
};

std::string within(Random& random, double least, double most) {
  return format("%.1f", random.uniform(least, most));
}

Values gives_up(Random& random) {
  constexpr std::array kWhere{"location_ask",  "location_show", "guide_ask",
                              "guide_options", "guide_start",   "end_ask"};
  return {{"gives_up_in", kWhere[random.below(kWhere.size())]}, {"looks_at_map", "true"}};
}

const std::array kManners{
    Manner{"follows", "follows", [](Random&) { return Values{}; }},
    Manner{"map", "looks at the map, asks where the place is",
           [](Random&) {
             return Values{{"looks_at_map", "true"}, {"asks_where", "true"}};
           }},
    Manner{"types", "types the name",
           [](Random&) {
             return Values{{"types", "true"}};
           }},
    Manner{"dawdles", "walks at 0.5 m/s",
           [](Random& r) {
             return Values{{"dawdles_at", within(r, 2, 30)}};
           }},
    Manner{"lace", "stands to tie a lace",
           [](Random& r) {
             return Values{{"ties_lace_at", within(r, 3, 30)}, {"ties_lace_for", within(r, 5, 30)}};
           }},
    Manner{
        "returns", "walks away, comes back",
        [](Random& r) {
          return Values{{"walks_away_at", within(r, 3, 30)}, {"walks_away_for", within(r, 5, 50)}};
        }},
    Manner{"leaves", "walks away for good",
           [](Random& r) {
             return Values{{"walks_away_at", within(r, 3, 30)}};
           },
           Wish::kToBreakOff},
    Manner{"stops", "stops the robot, goes on",
           [](Random& r) {
             return Values{{"stops_at", within(r, 3, 30)}, {"stops_for", within(r, 2, 60)}};
           }},
    Manner{"forgets", "stops the robot, forgets it",
           [](Random& r) {
             return Values{{"stops_at", within(r, 3, 30)}, {"gives_up_in", "guide_paused"}};
           },
           Wish::kToBreakOff},
    Manner{"cancels", "cancels on the way",
           [](Random& r) {
             return Values{{"cancels_at", within(r, 1, 30)}};
           },
           Wish::kToBreakOff},
    Manner{"blocks", "steps in the robot's way",
           [](Random& r) {
             return Values{{"blocks_at", within(r, 3, 30)}, {"blocks_for", within(r, 3, 40)}};
           }},
    Manner{"crowd", "others crowd round the robot",
           [](Random& r) {
             return Values{{"crowd_at", within(r, 3, 30)}, {"crowd_for", within(r, 3, 40)}};
           }},
    Manner{"leads", "lets the robot follow",
           [](Random&) {
             return Values{{"leads", "true"}, {"steps_up_to", "1.1"}};
           },
           Wish::kToLead},
    Manner{"again", "goes to a second place, says what it was like",
           [](Random& r) {
             return Values{{"returns_to", "foyer"}, {"rates", r.below(2) == 0 ? "all" : "some"}};
           }},
    Manner{"silent", "stops answering", gives_up, Wish::kToFallSilent}};

struct Visit {
  bool ended = false;                    ///< and the robot is free for the next one
  std::optional<std::string> waits_for;  ///< unless it ended, and safely
  std::uint8_t outcome = outcome::OUTCOME_OPEN;
  std::string language, place, state, complaints;
  double duration = NAN;  ///< [s]
  std::uint32_t touches = 0, utterances = 0, waits = 0;
  std::size_t ratings = 0;
  std::uint32_t contacts = 0, touched = 0;
  std::string contact_with;
  std::uint64_t digest = 0;
};

bool stands(const std::vector<RunRecord::Sample>& samples) {
  return !samples.empty() && std::ranges::none_of(samples, [&](const auto& sample) {
    return samples.back().stamp - sample.stamp <= kStandsFor && std::abs(sample.v) >= kStands;
  });
}

Result<Visit> visit(Deployment deployment, const Manner& manner, const std::string& place,
                    std::uint64_t seed, const std::string& trace, const grid::OccupancyGrid& map) {
  Random random(seed * 1009 + 7);
  set_value(deployment, kVisitor, "destination", place);
  constexpr std::array kLanguages{"en", "de", "fr", "mi"};
  constexpr std::array kInputs{"touch", "voice", "mixed"};
  set_value(deployment, kVisitor, "language", kLanguages[random.below(kLanguages.size())]);
  set_value(deployment, kVisitor, "input", kInputs[random.below(kInputs.size())]);
  set_value(deployment, kVisitor, "reading_time", within(random, 0.5, 6.0));
  set_value(deployment, "guide", "questionnaire", "true");
  if (manner.name == std::string_view("crowd"))
    set_value(deployment, "world", "bystanders", kBystanders);
  for (const auto& [name, value] : manner.character(random))
    set_value(deployment, kVisitor, name, value);
  auto run = LockstepRun::create(deployment, seed);
  if (!run) return Error{run.error()};
  auto& world = (*run)->world();
  const RunRecord& record = (*run)->record();
  std::optional<usher_msgs::msg::GuideVisit> report;
  world.observe(topics::kGuideVisit, [&](const auto& message, const auto&) { report = message; });
  std::string dialogue;
  if (!trace.empty()) {
    world.observe(topics::kDialogueScreen, [&](const auto& screen, const auto&) {
      if (dialogue.ends_with(screen.state() + ": " + screen.spoken() + "\n")) return;
      dialogue += format("%7.1f s  ", runtime::seconds(world.elapsed())) + screen.state() + ": " +
                  screen.spoken() + "\n";
    });
    world.observe(topics::kDialogueAnswer, [&](const auto& answer, const auto&) {
      dialogue += format("%7.1f s  ", runtime::seconds(world.elapsed())) + "    " +
                  answer.client() + " answers " + answer.option_id() +
                  (answer.text().empty() ? "" : " \"" + answer.text() + "\"") + "\n";
    });
  }
  OpenVisit open;
  world.observe(topics::kSupervisorStatus,
                [&](const auto& status, const auto&) { open.supervisor = status; });
  const auto free = [&] { return report && record.dialogue().back() == "inactive"; };
  while (world.elapsed() < kLongest && !free()) world.run_for(std::chrono::milliseconds(500));
  Visit visit;
  visit.ended = free();
  visit.place = place;
  visit.state = record.dialogue().empty() ? "no dialogue" : record.dialogue().back();
  open.stands = stands(record.samples());
  if (!visit.ended) visit.waits_for = waits_safely_for(open);
  visit.contacts = record.summary().contacts;
  visit.contact_with = record.summary().contact_with;
  visit.touched = record.summary().touches;
  visit.complaints = (*run)->complaints();
  visit.digest = world.digest();
  if (report) {
    visit.outcome = report->outcome();
    visit.language = report->language();
    visit.duration = report->duration();
    visit.touches = report->touches();
    visit.utterances = report->utterances();
    visit.waits = report->waits();
    visit.ratings = report->ratings().size();
  }
  if (!trace.empty()) {
    Status saved = write_file(trace + ".csv", run_csv(record));
    if (saved) saved = write_file(trace + "_dialogue.txt", dialogue);
    if (saved)
      saved = draw_run(record, map, std::string("visitor ") + manner.text + ", to " + place,
                       trace + ".png");
    if (!saved) return Error{saved.error()};
  }
  return visit;
}

constexpr std::array kOutcomes{"open", "left", "ended", "arrived", "given up"};

std::string line(const Manner& manner, std::size_t seed, const Visit& visit) {
  return std::string(manner.name) + "," + std::to_string(seed) + "," + visit.place + "," +
         visit.language + "," + (visit.ended ? "1" : "0") + "," + kOutcomes.at(visit.outcome) +
         format(",%.1f", visit.duration) + "," + std::to_string(visit.touches) + "," +
         std::to_string(visit.utterances) + "," + std::to_string(visit.waits) + "," +
         std::to_string(visit.ratings) + "," + std::to_string(visit.contacts) + "," + visit.state +
         "," + visit.waits_for.value_or("") + "\n";
}

}  // namespace

Result<ResultSheet> run_visits_experiment(const ExperimentOptions& options) {
  const auto only = only_run_of(options.only, names_of(kManners));
  if (!only) return Error{only.error()};
  const auto deployment =
      load_deployment(options.installation.share + "/deploy/demo.yaml", options.installation, {});
  if (!deployment) return Error{deployment.error()};
  const auto places = site_places(*deployment);
  if (!places) return Error{places.error()};
  if (places->size() < 2) return Error{"the site needs two places, one to start from"};
  const auto map = site_map(*deployment);
  if (!map) return Error{map.error()};
  std::vector<const Manner*> manners;
  for (const Manner& manner : kManners) {
    if (only->takes(manner.name)) manners.push_back(&manner);
  }
  const bool one = only->number > 0;
  const std::size_t first = one ? only->number : 1;
  const std::size_t count =
      one ? 1 : static_cast<std::size_t>(options.seeds > 0 ? options.seeds : kSeeds);
  const auto manner_of = [&](std::size_t i) -> const Manner& {
    return *manners[i % manners.size()];
  };
  const auto end_of = [&](std::size_t i, const Visit& visit) {
    return VisitEnd{manner_of(i).wish, visit.ended, visit.outcome};
  };
  const auto run_visit = [&](std::size_t i, const std::string& trace) {
    const std::size_t seed = first + i;
    const std::string& place = (*places)[1 + seed % (places->size() - 1)].name;
    return visit(*deployment, manner_of(i), place, seed, trace, *map);
  };
  std::vector<std::optional<Visit>> visits(count);
  const Status done = run_jobs(count, "visits", [&](std::size_t i) -> Result<std::string> {
    const std::string name = manner_of(i).name;
    auto each = run_visit(i, i < manners.size() ? options.out + "/" + name : std::string());
    if (!each) return Error{each.error()};
    std::string said;
    if (!ended_as_wished(end_of(i, *each)) || each->contacts > 0) {
      said = name + " to " + each->place + ": " + kOutcomes.at(each->outcome) + ", " + each->state +
             ", waits for " + each->waits_for.value_or("nothing") + ", contacts " +
             std::to_string(each->contacts) +
             (each->contacts > 0 ? ", the last with " + each->contact_with : "") +
             "; again with usher experiment visits --only " + name + "_" +
             std::to_string(first + i) + "\n" + each->complaints;
    }
    visits[i] = std::move(each).value();
    return said;
  });
  if (!done) return Error{done.error()};

  Table table({"visitor", "visits", "arrived", "ended politely", "waits safely", "dead ends",
               "mean s", "longest s", "waits", "answers", "contacts"});
  std::string csv =
      "visitor,seed,destination,language,ended,outcome,seconds,touches,utterances,waits,ratings,"
      "contacts,last_state,waits_for\n";
  double arrived = 0, polite = 0, waiting = 0, dead = 0, contacts = 0, rated = 0;
  std::vector<double> durations;
  for (std::size_t m = 0; m < manners.size(); ++m) {
    double n = 0, here = 0, ends = 0, waits_for = 0, lost = 0, time = 0, longest = 0, waits = 0,
           answers = 0, hits = 0;
    for (std::size_t i = m; i < count; i += manners.size()) {
      const Visit& each = *visits[i];
      csv += line(*manners[m], first + i, each);
      ++n;
      const bool there = each.ended && each.outcome == outcome::OUTCOME_ARRIVED;
      here += there ? 1 : 0;
      ends += each.ended && !there ? 1 : 0;
      waits_for += each.waits_for ? 1 : 0;
      lost += !each.ended && !each.waits_for ? 1 : 0;
      waits += each.waits;
      answers += each.touches + each.utterances;
      hits += each.contacts;
      rated += each.ratings > 0 ? 1 : 0;
      if (std::isfinite(each.duration)) {
        time += each.duration;
        longest = std::max<double>(longest, each.duration);
        durations.push_back(each.duration);
      }
    }
    if (n == 0) continue;
    table.add({manners[m]->text, format("%.0f", n), format("%.0f", here), format("%.0f", ends),
               format("%.0f", waits_for), format("%.0f", lost), format("%.0f", time / n),
               format("%.0f", longest), format("%.0f", waits), format("%.0f", answers),
               format("%.0f", hits)});
    arrived += here, polite += ends, waiting += waits_for, dead += lost, contacts += hits;
  }
  std::printf("%s\n", table.text().c_str());

  ResultSheet sheet;
  sheet.name = "visits";
  sheet.input =
      std::to_string(count) +
      " visits to MARVIN with its depth cameras in the office, lock-step; what the visitor "
      "does, language, input, reading time and place are drawn from the seed";
  sheet.metrics["visits"] = static_cast<double>(count);
  sheet.metrics["arrived"] = arrived;
  sheet.metrics["ended_politely"] = polite;
  sheet.metrics["answered_the_questionnaire"] = rated;
  sheet.metrics["wait_safely_after_20_minutes"] = waiting;
  sheet.metrics["dead_ends"] = dead;
  sheet.targets["dead_ends"] = {Bound::kAtMost, 0.0};
  sheet.metrics["contacts"] = contacts;
  sheet.targets["contacts"] = {Bound::kAtMost, 0.0};
  std::vector<VisitEnd> ends;
  for (std::size_t i = 0; i < count; ++i) ends.push_back(end_of(i, *visits[i]));
  judge_ends(ends, sheet);
  // The first visit once more: the same bytes.
  const auto again = run_visit(0, "");
  if (!again) return Error{again.error()};
  sheet.flags["digest_repeats"] = again->digest == visits.front()->digest;
  std::ranges::sort(durations);
  Curve share{"visits that are over", 30, 120, 60, {}};
  for (std::size_t i = 0; i < durations.size(); ++i)
    share.points.emplace_back(durations[i],
                              static_cast<double>(i + 1) / static_cast<double>(durations.size()));
  Status saved = write_file(options.out + "/visits.csv", csv);
  if (saved) saved = write_file(options.out + "/visits.md", table.markdown());
  if (saved)
    saved = draw_plot({share}, "How long visits last", "seconds", "share",
                      options.out + "/durations.png");
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
