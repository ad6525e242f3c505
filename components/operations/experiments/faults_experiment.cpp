#include <algorithm>
#include <charconv>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>

#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/experiments/run_jobs.hpp"
#include "operations/fault_windows/window.hpp"

namespace usher::operations {

namespace {

constexpr int kWindows = 200;
constexpr const char* kHeader =
    "seed,kind,fault,end,reason,violation,hit_speed,touches,deaf_contacts,simulated,wall,digest,"
    "speeds";
constexpr std::size_t kFields = 13;
constexpr std::size_t kMostViolations = 20;  // that the sheet's table names
const std::string kTwoAtOnce = "two at once";

/// A window that was run: a line of windows.csv.
struct Row {
  std::uint64_t seed = 0;
  std::string kind, fault, end, reason, violation;
  double hit_speed = 0.0;
  std::uint32_t touches = 0, deaf_contacts = 0;
  double simulated = 0.0, wall = 0.0;
  std::uint64_t digest = 0;
  std::vector<double> speeds;
};

/// Free text in a field of a line.
std::string field(std::string text) {
  std::replace(text.begin(), text.end(), ',', ';');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

Row row_of(const WindowResult& window) {
  return {window.seed,
          window.plan.kind(),
          window.plan.text(),
          std::string(text(window.judgement.end)),
          window.judgement.reason,
          window.judgement.violation,
          window.hit_speed,
          window.touches,
          window.judgement.deaf_contacts,
          window.simulated,
          window.wall,
          window.digest,
          window.speeds};
}

std::string line_of(const Row& row) {
  char numbers[128];
  std::snprintf(numbers, sizeof(numbers), ",%.3f,%u,%u,%.2f,%.3f,%016" PRIx64 ",", row.hit_speed,
                row.touches, row.deaf_contacts, row.simulated, row.wall, row.digest);
  std::string line = std::to_string(row.seed) + "," + row.kind + "," + field(row.fault) + "," +
                     row.end + "," + field(row.reason) + "," + field(row.violation) + numbers;
  for (const double speed : row.speeds)
    line += std::to_string(std::lround(100.0 * speed)) + " ";  // cm/s
  return line + "\n";
}

/// Nothing for a line that a killed run did not finish.
std::optional<Row> row_from(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string one; std::getline(stream, one, ',');) fields.push_back(one);
  if (fields.size() != kFields) return std::nullopt;
  Row row{std::strtoull(fields[0].c_str(), nullptr, 10),
          fields[1],
          fields[2],
          fields[3],
          fields[4],
          fields[5],
          std::strtod(fields[6].c_str(), nullptr),
          static_cast<std::uint32_t>(std::strtoul(fields[7].c_str(), nullptr, 10)),
          static_cast<std::uint32_t>(std::strtoul(fields[8].c_str(), nullptr, 10)),
          std::strtod(fields[9].c_str(), nullptr),
          std::strtod(fields[10].c_str(), nullptr),
          std::strtoull(fields[11].c_str(), nullptr, 16),
          {}};
  std::istringstream speeds(fields[12]);
  for (double speed = 0.0; speeds >> speed;) row.speeds.push_back(speed / 100.0);
  return row;
}

/// What is known of windows that were run before, in a file that grows by a line for each.
class WindowFile {
 public:
  explicit WindowFile(std::string path) : path_(std::move(path)) {}

  /// Reads what is there and begins the file anew with it, without a last line that was cut off.
  Status open() {
    std::ifstream in(path_);
    std::string line;
    std::getline(in, line);
    if (in && line != kHeader) return Error{path_ + " is no file of this experiment"};
    std::string whole = std::string(kHeader) + "\n";
    while (std::getline(in, line)) {
      auto row = row_from(line);
      if (!row || in.eof()) break;  // a finished line ends with its end
      whole += line + "\n";
      rows_[row->seed] = std::move(*row);
    }
    in.close();
    if (auto saved = write_file(path_, whole); !saved) return saved;
    out_.open(path_, std::ios::app);
    return {};
  }
  Status add(Row row) {
    const std::lock_guard lock(mutex_);
    out_ << line_of(row) << std::flush;
    rows_[row.seed] = std::move(row);
    return out_ ? Status{} : Status{Error{"cannot write " + path_}};
  }
  const std::map<std::uint64_t, Row>& rows() const { return rows_; }

 private:
  std::string path_;
  std::ofstream out_;
  std::mutex mutex_;
  std::map<std::uint64_t, Row> rows_;
};

struct Tally {
  int windows = 0, broken = 0;
  std::map<std::string, int> ends;
  std::vector<double> speed_sums;
};

std::map<std::string, Tally> tallies(const std::vector<Row>& rows) {
  std::map<std::string, Tally> by_kind;
  for (const Row& row : rows) {
    Tally& tally = by_kind[row.kind];
    ++tally.windows;
    tally.broken += row.violation.empty() ? 0 : 1;
    ++tally.ends[row.end];
    tally.speed_sums.resize(std::max(tally.speed_sums.size(), row.speeds.size()), 0.0);
    for (std::size_t i = 0; i < row.speeds.size(); ++i) tally.speed_sums[i] += row.speeds[i];
  }
  return by_kind;
}

/// A row for each kind of fault: how its windows ended.
Table table_of(const std::map<std::string, Tally>& by_kind) {
  Table table({"fault", "windows", "on its way", "arrived", "waits", "stands, says why",
               "navigation ended, says why", "laws broken"});
  for (const auto& [kind, tally] : by_kind) {
    const auto ended = [&, &each = tally](WindowEnd end) {
      const auto found = each.ends.find(std::string(text(end)));
      return std::to_string(found == each.ends.end() ? 0 : found->second);
    };
    table.add({kind, std::to_string(tally.windows), ended(WindowEnd::kDrives),
               ended(WindowEnd::kArrived), ended(WindowEnd::kWaits), ended(WindowEnd::kStands),
               ended(WindowEnd::kGaveUp), std::to_string(tally.broken)});
  }
  return table;
}

/// How the speed goes after the hit, on the mean over the windows of a kind.
Status draw_speeds(const std::map<std::string, Tally>& by_kind, const std::string& path) {
  struct Drawn {
    std::string kind;
    int red, green, blue;
  };
  const std::vector<Drawn> drawn = {{"crash", 200, 60, 50},       {"topic silent", 40, 120, 200},
                                    {"rogue writer", 30, 30, 30}, {"laser", 230, 150, 30},
                                    {"clock jump", 130, 70, 170}, {"flood", 60, 160, 70},
                                    {kTwoAtOnce, 150, 150, 150}};
  std::vector<Curve> curves;
  for (const Drawn& each : drawn) {
    const auto found = by_kind.find(each.kind);
    if (found == by_kind.end()) continue;
    Curve curve{each.kind, each.red, each.green, each.blue, {}};
    for (std::size_t i = 0; i < found->second.speed_sums.size(); ++i) {
      curve.points.emplace_back(0.5 * static_cast<double>(i),
                                found->second.speed_sums[i] / found->second.windows);
    }
    curves.push_back(std::move(curve));
  }
  return draw_plot(curves, "Speed after the hit, mean over the windows of a kind",
                   "time since the hit [s]", "speed [m/s]", path);
}

std::string said_of(const Row& row) {
  return "seed " + std::to_string(row.seed) + ": " + row.fault + ": " + row.violation +
         " (replay: usher experiment faults --only " + std::to_string(row.seed) + ")\n";
}

Result<ResultSheet> sheet_of(const std::vector<Row>& rows, const std::string& out) {
  ResultSheet sheet;
  sheet.name = "faults";
  sheet.input = std::to_string(rows.size()) +
                " seeded windows of 20 s, MARVIN in the office among people, lock-step";
  double contacts = 0, without_grant = 0, unexplained = 0, broken = 0, simulated = 0, wall = 0,
         touches = 0, deaf = 0;
  std::string markdown;
  std::size_t told = 0;
  for (const Row& row : rows) {
    const auto says = [&row](const char* words) {
      return row.violation.find(words) == std::string::npos ? 0.0 : 1.0;
    };
    contacts += says("contact with");
    without_grant += says("without a");
    unexplained += says("nobody says why");
    broken += row.violation.empty() ? 0.0 : 1.0;
    touches += row.touches;
    deaf += row.deaf_contacts;
    simulated += row.simulated;
    wall += row.wall;
    if (!row.violation.empty() && ++told <= kMostViolations) markdown += "- " + said_of(row);
  }
  sheet.metrics = {{"windows", static_cast<double>(rows.size())},
                   {"contacts", contacts},
                   {"motions_without_a_live_grant", without_grant},
                   {"ends_without_a_reason", unexplained},
                   {"windows_with_a_broken_law", broken},
                   {"touches", touches},
                   {"contacts_of_a_base_that_hears_nobody", deaf},
                   {"simulated_s_per_wall_s_and_thread", wall > 0 ? simulated / wall : 0.0}};
  for (const char* zero : {"contacts", "motions_without_a_live_grant", "ends_without_a_reason",
                           "windows_with_a_broken_law"})
    sheet.targets[zero] = {Bound::kAtMost, 0.0};
  const auto by_kind = tallies(rows);
  markdown = table_of(by_kind).markdown() + (markdown.empty() ? "" : "\n" + markdown);
  std::printf("%s\n", table_of(by_kind).text().c_str());
  Status saved = write_file(out + "/kinds.md", markdown);
  if (saved) saved = draw_speeds(by_kind, out + "/speeds.png");
  if (!saved) return Error{saved.error()};
  return sheet;
}

struct Seeds {
  std::uint64_t first = 0, last = 0;
};

/// "17" or "300-600".
Result<Seeds> seeds_from(const std::string& text) {
  Seeds seeds;
  const char* const end = text.data() + text.size();
  auto read = std::from_chars(text.data(), end, seeds.first);
  seeds.last = seeds.first;
  if (read.ec == std::errc{} && read.ptr != end && *read.ptr == '-')
    read = std::from_chars(read.ptr + 1, end, seeds.last);
  if (read.ec != std::errc{} || read.ptr != end || seeds.first == 0 || seeds.last < seeds.first)
    return Error{
        "--only takes a seed from 1 on, or the first and the last of some (300-600), not " + text};
  return seeds;
}

/// One window once more, with its trace.
Result<ResultSheet> replay(const WindowSetting& setting, std::uint64_t seed,
                           const ExperimentOptions& options) {
  const auto window = run_window(setting, seed, options.out + "/window");
  if (!window) return Error{window.error()};
  const Row row = row_of(*window);
  const auto& start = setting.starts[window->plan.start];
  std::printf("%s from (%.1f, %.1f) to %s, hit at %.2f s at %.2f m/s: %s %s\n%s", row.fault.c_str(),
              start.x(), start.y(), setting.locations[window->plan.goal].c_str(), window->hit_at,
              window->hit_speed, row.end.c_str(), row.reason.c_str(),
              row.violation.empty() ? "" : said_of(row).c_str());
  return sheet_of({row}, options.out);
}

}  // namespace

Result<ResultSheet> run_faults_experiment(const ExperimentOptions& options) {
  const auto setting = window_setting(options.installation.share);
  if (!setting) return Error{setting.error()};
  Seeds seeds{1, static_cast<std::uint64_t>(options.windows > 0 ? options.windows : kWindows)};
  if (!options.only.empty()) {
    const auto chosen = seeds_from(options.only);
    if (!chosen) return Error{chosen.error()};
    if (chosen->first == chosen->last) return replay(*setting, chosen->first, options);
    seeds = *chosen;
  }

  WindowFile file(options.out + "/windows.csv");
  if (auto opened = file.open(); !opened) return Error{opened.error()};
  const bool resumed = !file.rows().empty();
  std::vector<std::uint64_t> missing;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; ++seed) {
    if (!file.rows().contains(seed)) missing.push_back(seed);
  }
  // The same bytes as before: else the file is of another build.
  const std::uint64_t known = resumed ? file.rows().begin()->first : seeds.first;
  if (resumed) {
    const auto again = run_window(*setting, known);
    if (!again) return Error{again.error()};
    if (again->digest != file.rows().at(known).digest)
      return Error{options.out + "/windows.csv is of another build; remove it to begin anew"};
    std::printf("%zu windows are known, %zu to go\n", file.rows().size(), missing.size());
  }
  const auto run_one = [&](std::size_t i) -> Result<std::string> {
    const auto window = run_window(*setting, missing[i]);
    if (!window) return Error{window.error()};
    const Row row = row_of(*window);
    if (auto added = file.add(row); !added) return Error{added.error()};
    return row.violation.empty() ? std::string() : said_of(row);
  };
  if (auto done = run_jobs(missing.size(), "windows", run_one); !done) return Error{done.error()};

  std::vector<Row> rows;
  for (const auto& [seed, row] : file.rows()) {
    if (seed >= seeds.first && seed <= seeds.last) rows.push_back(row);
  }
  auto sheet = sheet_of(rows, options.out);
  if (!sheet) return sheet;
  if (!resumed) {
    const auto again = run_window(*setting, known);
    if (!again) return Error{again.error()};
    sheet->flags["digest_repeats"] = again->digest == file.rows().at(known).digest;
  } else {
    sheet->flags["digest_repeats"] = true;
  }
  return sheet;
}

}  // namespace usher::operations
