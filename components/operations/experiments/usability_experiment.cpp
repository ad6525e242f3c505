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
#include "operations/experiments/visit_tasks.hpp"

namespace usher::operations {

namespace {

using std::chrono::seconds;

constexpr int kSeeds = 18;  // participants of the thesis' study
constexpr auto kLongest = seconds(900);
constexpr double kWalking = 0.05;  // [m/s]
constexpr const char* kVisitor = "visitor";

struct Input {
  const char* name;
  int red, green, blue;  ///< in the picture
};
constexpr std::array kInputs{Input{"touch", 30, 120, 60}, Input{"voice", 40, 90, 200},
                             Input{"mixed", 200, 130, 20}};

struct Visit {
  std::vector<double> tasks;  ///< [s] from the moment that the robot waited for a visitor
  std::uint32_t touches = 0, ignored = 0, contacts = 0;
  std::string contact_with;
  std::uint64_t said = 0, asked_back = 0, mistaken = 0;  ///< utterances of the visitor
  double distance = NAN;  ///< [m] of the visitor from the robot at a question, median
  double speed = NAN;     ///< [m/s] of the robot while it guides and moves, mean
  std::string state, complaints;
  std::uint64_t digest = 0;

  bool done() const { return tasks.size() == visit_tasks().size() && contacts == 0; }
};

double median(std::vector<double> values) {
  if (values.empty()) return NAN;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double each : values) sum += each;
  return values.empty() ? NAN : sum / static_cast<double>(values.size());
}

/// One participant: comes up to the robot, waits for it, asks for a map, is guided to a place and
/// back, says goodbye and what it was like. `csv` gets the run when it is a path.
Result<Visit> take_part(Deployment deployment, const Input& input, const std::string& place,
                        const std::string& home, std::uint64_t seed, const std::string& csv) {
  Random random(seed * 2003 + 11);
  const auto set = [&](const char* name, const std::string& value) {
    set_value(deployment, kVisitor, name, value);
  };
  set("destination", place);
  set("returns_to", home);
  set("looks_at_map", "true");
  set("waits_for_greeting", "true");
  set("steps_up_to", "1.1");
  set("input", input.name);
  set("rates", "all");
  set("reading_time", format("%.1f", random.uniform(1.0, 5.0)));
  set_value(deployment, "guide", "questionnaire", "true");
  auto run = LockstepRun::create(deployment, seed);
  if (!run) return Error{run.error()};
  auto& world = (*run)->world();
  const RunRecord& record = (*run)->record();
  Visit visit;
  std::vector<std::pair<double, std::string>> states;
  std::optional<double> waits_since;
  std::optional<usher_msgs::msg::GuideVisit> report;
  std::vector<double> distances, speeds;
  world.observe(topics::kDialogueScreen, [&](const auto& screen, const auto&) {
    const double now = runtime::seconds(world.elapsed());
    if (!waits_since && screen.state() == "inactive") waits_since = now;
    if (waits_since && (states.empty() || states.back().second != screen.state()))
      states.emplace_back(now - *waits_since, screen.state());
  });
  world.observe(topics::kHeartbeat, [&](const auto& heartbeat, const auto&) {
    if (heartbeat.component_name() != kVisitor) return;
    for (const auto& counter : heartbeat.counters()) {
      if (counter.name() == "voice: said") visit.said = counter.count();
      if (counter.name() == "voice: asked back") visit.asked_back = counter.count();
      if (counter.name() == "voice: taken for another") visit.mistaken = counter.count();
    }
  });
  world.observe(topics::kGuideVisit, [&](const auto& message, const auto&) { report = message; });
  world.observe(topics::kSimGroundTruth, [&](const auto& truth, const auto&) {
    if (states.empty()) return;
    const std::string& state = states.back().second;
    if (state == "guide_active" && truth.v() > kWalking) speeds.push_back(truth.v());
    if (state != "guide_ask" && state != "guide_options" && state != "location_show") return;
    for (const auto& person : truth.people()) {
      if (person.name() == kVisitor)
        distances.push_back(std::hypot(person.x() - truth.pose().position().x(),
                                       person.y() - truth.pose().position().y()));
    }
  });
  while (world.elapsed() < kLongest && !report) world.run_for(std::chrono::milliseconds(500));
  if (!csv.empty()) {
    if (const Status saved = write_file(csv, run_csv(record)); !saved) return Error{saved.error()};
  }
  visit.tasks = tasks_done(states);
  visit.state = states.empty() ? "no dialogue" : states.back().second;
  visit.contacts = record.summary().contacts;
  visit.contact_with = record.summary().contact_with;
  visit.complaints = (*run)->complaints();
  visit.digest = world.digest();
  visit.distance = median(std::move(distances));
  visit.speed = mean(speeds);
  if (report) {
    visit.touches = report->touches();
    visit.ignored = report->ignored();
  }
  return visit;
}

/// What was measured here beside what people said there.
std::string beside(std::size_t statement, const std::vector<Visit>& visits) {
  const auto task = [&](std::size_t which) {
    std::vector<double> times;
    for (const Visit& each : visits) {
      if (each.tasks.size() > which) times.push_back(each.tasks[which] - each.tasks[which - 1]);
    }
    return format("%.0f s on the mean, reading included", mean(times));
  };
  std::vector<double> distances, speeds;
  for (const Visit& each : visits) {
    if (std::isfinite(each.distance)) distances.push_back(each.distance);
    if (std::isfinite(each.speed)) speeds.push_back(each.speed);
  }
  switch (statement) {
    case 4:
      return format("%.1f m from the robot's middle", median(distances));
    case 7:
      return task(1);
    case 9:
      return task(2);
    case 10:
    case 11:
      return format("%.2f m/s on the mean while it moves", mean(speeds));
    default:
      return "";
  }
}

}  // namespace

Result<ResultSheet> run_usability_experiment(const ExperimentOptions& options) {
  const auto only = only_run_of(options.only, names_of(kInputs));
  if (!only) return Error{only.error()};
  const auto deployment =
      load_deployment(options.installation.share + "/deploy/demo.yaml", options.installation, {});
  if (!deployment) return Error{deployment.error()};
  const auto places = site_places(*deployment);
  if (!places) return Error{places.error()};
  if (places->size() < 2) return Error{"the site needs two places, to go to one and back"};
  const bool one = only->number > 0;
  const std::size_t first = one ? only->number : 1;
  std::vector<const Input*> inputs;
  for (const Input& input : kInputs) {
    if (only->takes(input.name)) inputs.push_back(&input);
  }
  const auto seeds = one ? 1 : static_cast<std::size_t>(options.seeds > 0 ? options.seeds : kSeeds);
  // The same participants by each input.
  const auto seed_of = [&](std::size_t i) { return first + i / inputs.size(); };
  const auto run_visit = [&](std::size_t i) {
    const std::size_t seed = seed_of(i);
    const std::string& place = (*places)[1 + seed % (places->size() - 1)].name;
    return take_part(*deployment, *inputs[i % inputs.size()], place, places->front().name, seed,
                     one ? options.out + "/run.csv" : "");
  };
  std::vector<std::optional<Visit>> results(seeds * inputs.size());
  const Status ran = run_jobs(results.size(), "visits", [&](std::size_t i) -> Result<std::string> {
    auto each = run_visit(i);
    if (!each) return Error{each.error()};
    std::string said;
    if (!each->done()) {
      said = std::string(inputs[i % inputs.size()]->name) + ", seed " + std::to_string(seed_of(i)) +
             ": " + std::to_string(each->tasks.size()) + " tasks, contacts " +
             std::to_string(each->contacts) + " " + each->contact_with + ", " + each->state +
             " (replay: usher experiment usability --only " + inputs[i % inputs.size()]->name +
             "_" + std::to_string(seed_of(i)) + ")\n" + each->complaints;
    }
    results[i] = std::move(each).value();
    return said;
  });
  if (!ran) return Error{ran.error()};

  Table table({"input", "visits", "all seven tasks", "tasks", "mean s", "touches", "utterances",
               "asked back", "misunderstood", "late answers", "contacts"});
  std::vector<std::string> columns{"input"};
  for (const VisitTask& task : visit_tasks()) columns.emplace_back(task.text);
  Table times(columns);
  std::vector<Curve> curves;
  std::vector<Visit> all;
  std::string csv =
      "input,seed,tasks,seconds,touches,utterances,asked_back,misunderstood,late,contacts,last_"
      "state\n";
  ResultSheet sheet;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    double done = 0, tasks = 0, touches = 0, said = 0, asked = 0, mistaken = 0, late = 0,
           contacts = 0;
    std::vector<double> whole;
    std::vector<std::vector<double>> each_task(visit_tasks().size());
    for (std::size_t i = k; i < results.size(); i += inputs.size()) {
      const Visit& visit = *results[i];
      all.push_back(visit);
      done += visit.done() ? 1 : 0;
      tasks += static_cast<double>(visit.tasks.size());
      touches += visit.touches;
      said += static_cast<double>(visit.said);
      asked += static_cast<double>(visit.asked_back);
      mistaken += static_cast<double>(visit.mistaken);
      late += visit.ignored;
      contacts += visit.contacts;
      if (visit.done()) whole.push_back(visit.tasks.back());
      for (std::size_t t = 0; t < visit.tasks.size(); ++t)
        each_task[t].push_back(visit.tasks[t] - (t > 0 ? visit.tasks[t - 1] : 0.0));
      csv += std::string(inputs[k]->name) + "," + std::to_string(seed_of(i)) + "," +
             std::to_string(visit.tasks.size()) + "," +
             format("%.1f", visit.tasks.empty() ? NAN : visit.tasks.back()) + "," +
             std::to_string(visit.touches) + "," + std::to_string(visit.said) + "," +
             std::to_string(visit.asked_back) + "," + std::to_string(visit.mistaken) + "," +
             std::to_string(visit.ignored) + "," + std::to_string(visit.contacts) + "," +
             visit.state + "\n";
    }
    const auto n = static_cast<double>(seeds);
    table.add({inputs[k]->name, format("%.0f", n), format("%.0f", done), format("%.1f", tasks / n),
               format("%.0f", mean(whole)), format("%.1f", touches / n), format("%.1f", said / n),
               format("%.1f", asked / n), format("%.2f", mistaken / n), format("%.0f", late),
               format("%.0f", contacts)});
    std::vector<std::string> row{inputs[k]->name};
    Curve curve{inputs[k]->name, inputs[k]->red, inputs[k]->green, inputs[k]->blue, {{0.0, 0.0}}};
    double sum = 0.0;
    for (std::size_t t = 0; t < each_task.size(); ++t) {
      row.push_back(format("%.0f s", mean(each_task[t])));
      sum += mean(each_task[t]);
      curve.points.emplace_back(static_cast<double>(t + 1), sum);
    }
    times.add(row);
    curves.push_back(std::move(curve));
    sheet.metrics[std::string(inputs[k]->name) + "_did_all_seven_tasks"] = done;
    sheet.targets[std::string(inputs[k]->name) + "_did_all_seven_tasks"] = {Bound::kAtLeast, n};
    sheet.metrics[std::string(inputs[k]->name) + "_seconds"] = mean(whole);
    sheet.metrics[std::string(inputs[k]->name) + "_utterances"] = said / n;
    sheet.metrics["contacts"] += contacts;
  }
  Table said(
      {"", "statement (thesis, table 7.1)", "18 people, mean", "deviation", "measured here"});
  for (std::size_t i = 0; i < table_7_1().size(); ++i) {
    const Statement& statement = table_7_1()[i];
    said.add({std::to_string(i + 1), statement.text, format("%.1f", statement.mean),
              format("%.1f", statement.deviation), beside(i, all)});
  }
  std::printf("%s\n%s\n%s\n", table.text().c_str(), times.text().c_str(), said.text().c_str());

  sheet.name = "usability";
  sheet.input =
      "the seven tasks of the thesis' usability study, MARVIN with its depth cameras in the "
      "office among others, lock-step, " +
      std::to_string(seeds) +
      " simulated participants, the same by each input; what is said is understood, asked back for "
      "or "
      "mistaken as often as in usher experiment voice (ctest -L hri has true voices)";
  sheet.targets["contacts"] = {Bound::kAtMost, 0.0};
  const auto again = run_visit(0);
  if (!again) return Error{again.error()};
  sheet.flags["digest_repeats"] = again->digest == results.front()->digest;
  Status saved = write_file(options.out + "/visits.csv", csv);
  if (saved)
    saved = write_file(options.out + "/usability.md",
                       table.markdown() + "\n" + times.markdown() + "\n" + said.markdown());
  if (saved)
    saved = draw_plot(curves, "Until each task of the study is done", "task", "seconds",
                      options.out + "/tasks.png");
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
