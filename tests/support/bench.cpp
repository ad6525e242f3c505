#include "support/bench.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <numeric>

/// The region that callgrind collects: it toggles on this name, so the symbol must survive.
extern "C" __attribute__((noinline, used, visibility("default"))) void usher_bench_counted(
    const std::function<void()>* work) {
  (*work)();
  asm volatile("" ::
                   : "memory");  // keeps the call above from becoming a jump, which would end the
                                 // toggle early
}

namespace usher::bench {
namespace {

constexpr const char* kChildOption = "--count-instructions-of=";
constexpr int kRepetitions = 9;
/// Of the machine that the published figures were measured on (AMD EPYC).
constexpr double kReferenceLoopMs = 1.90;

const char* help() {
  return "options: --json          print one JSON object on standard output\n"
         "         --instructions  also count instructions (runs itself under valgrind "
         "--tool=callgrind)\n"
         "         --benchmark_*   options of Google Benchmark, for example "
         "--benchmark_min_time=0.01\n";
}

bool is_identifier(const std::string& key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_';
  });
}

/// Fixed scalar work (integer mixing and dependent floating point), the same on every machine.
void reference_loop() {
  std::uint64_t state = 1;
  double sum = 0.0;
  for (int i = 0; i < 1'000'000; ++i) {
    state = (state ^ (state >> 27)) * 0x94d049bb133111ebULL + 0x9e3779b97f4a7c15ULL;
    sum = sum * 0.5 + static_cast<double>(state >> 11);
  }
  benchmark::DoNotOptimize(sum);
}

/// Keeps the least real time in seconds of each benchmark, what other guests of the machine take is
/// not ours, and shows progress on standard error.
class LeastReporter : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.error_occurred) {
        std::fprintf(stderr, "%s failed: %s\n", run.run_name.function_name.c_str(),
                     run.error_message.c_str());
      } else if (run.run_type == Run::RT_Iteration) {
        const double seconds =
            run.GetAdjustedRealTime() / benchmark::GetTimeUnitMultiplier(run.time_unit);
        double& best = least.try_emplace(run.run_name.function_name, seconds).first->second;
        best = std::min(best, seconds);
        std::fprintf(stderr, "timed %s: %.6g s\n", run.run_name.function_name.c_str(), seconds);
      }
    }
  }
  std::map<std::string, double> least;
};

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(c));
      result += escape.data();
    } else {
      result += c;
    }
  }
  return result + "\"";
}

/// Shortest text that reads back as the same number; JSON has no NaN and no infinity.
std::string number(double value) {
  if (!std::isfinite(value)) return "null";
  std::array<char, 40> text{};
  for (int digits = 6; digits <= 17; ++digits) {
    std::snprintf(text.data(), text.size(), "%.*g", digits, value);
    if (std::strtod(text.data(), nullptr) == value) break;
  }
  return text.data();
}

template <class Entries, class Value>
std::string object(const Entries& entries, Value value_of) {
  std::string result = "{";
  for (const auto& [key, value] : entries) {
    if (result.size() > 1) result += ", ";
    result += quoted(key) + ": " + number(value_of(value));
  }
  return result + "}";
}

/// The total that callgrind prints ("==123== Collected : 4567"), or NaN with the reason on standard
/// error.
double run_under_callgrind(const std::string& key) {
  std::error_code error;
  const std::string self = std::filesystem::read_symlink("/proc/self/exe", error).string();
  if (error || self.find('\'') != std::string::npos) return std::nan("");
  const std::string command =
      "valgrind --tool=callgrind --toggle-collect=usher_bench_counted "
      "--callgrind-out-file=/dev/null '" +
      self + "' " + kChildOption + key + " 2>&1 >/dev/null";
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return std::nan("");
  double collected = std::nan("");
  std::string log;
  std::array<char, 512> line{};
  while (std::fgets(line.data(), static_cast<int>(line.size()), pipe) != nullptr) {
    log += line.data();
    const char* found = std::strstr(line.data(), "Collected : ");
    if (found != nullptr) collected = std::strtod(found + std::strlen("Collected : "), nullptr);
  }
  const int status = pclose(pipe);
  if (status == 0 && collected > 0) return collected;
  std::fprintf(stderr, "counting %s failed (is valgrind installed?):\n%s", key.c_str(),
               log.c_str());
  return std::nan("");
}

}  // namespace

Bench::Bench(std::string name, std::string input)
    : name_(std::move(name)), input_(std::move(input)) {
  time("reference_loop_ms", 1e-3, reference_loop);
}

std::string Bench::data(const std::string& relative) {
  std::string path = test_data(relative);
  if (path.empty()) absent_.push_back(relative);
  return path;
}

void Bench::time(std::string key, double unit, std::function<void()> work) {
  assert(is_identifier(key) && unit > 0);
  timings_.push_back({std::move(key), unit, std::move(work), nullptr});
}

void Bench::time_each(std::string key, double unit, std::size_t cases,
                      std::function<void(std::size_t)> work) {
  assert(cases > 0);
  auto least = std::make_shared<std::vector<double>>(cases, std::numeric_limits<double>::max());
  time(std::move(key), unit, [least, work = std::move(work)] {
    using Clock = std::chrono::steady_clock;
    for (std::size_t i = 0; i < least->size(); ++i) {
      const auto begin = Clock::now();
      work(i);
      const std::chrono::duration<double> taken = Clock::now() - begin;
      (*least)[i] = std::min((*least)[i], taken.count());
    }
  });
  timings_.back().cases = std::move(least);
}

void Bench::instructions(std::string key, std::function<void()> work, int warm_up) {
  assert(is_identifier(key) && warm_up >= 0);
  counted_.push_back({std::move(key), std::move(work), warm_up});
}

void Bench::metric(std::string key, std::function<double()> compute) {
  assert(is_identifier(key));
  computed_.emplace_back(std::move(key), std::move(compute));
}

void Bench::published(const std::string& key, double value, const std::string& who) {
  published_[key + " (" + who + ")"] = value;
}

void Bench::target(const std::string& key, Bound bound, double value) {
  targets_[key] = {bound, value};
}

bool Bench::parse(int argc, char** argv) {
  // Ours first: a later --benchmark_min_time from the command line wins.
  std::string min_time = "--benchmark_min_time=0.05";
  std::vector<char*> others = {argv[0], min_time.data()};
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--json") {
      print_json_ = true;
    } else if (option == "--instructions") {
      with_instructions_ = true;
    } else if (option.rfind(kChildOption, 0) == 0) {
      counted_key_ = option.substr(std::strlen(kChildOption));
    } else if (option.rfind("--benchmark_", 0) == 0) {
      others.push_back(argv[i]);
    } else {
      std::fprintf(stderr, "unknown option %s\n%s", option.c_str(), help());
      return false;
    }
  }
  int count = static_cast<int>(others.size());
  benchmark::Initialize(&count, others.data());
  return !benchmark::ReportUnrecognizedArguments(count, others.data());
}

bool Bench::measure_times() {
  benchmark::ClearRegisteredBenchmarks();
  for (const Timing& timing : timings_) {
    benchmark::RegisterBenchmark(timing.key.c_str(),
                                 [&timing](benchmark::State& state) {
                                   for (auto _ : state) timing.work();
                                 })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->Repetitions(kRepetitions);
  }
  LeastReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  bool complete = true;
  for (const Timing& timing : timings_) {
    const auto found = reporter.least.find(timing.key);
    complete = complete && found != reporter.least.end();
    if (found == reporter.least.end()) continue;
    const auto& cases = timing.cases;
    const double seconds = cases ? std::accumulate(cases->begin(), cases->end(), 0.0) /
                                       static_cast<double>(cases->size())
                                 : found->second;
    metrics_[timing.key] = seconds / timing.unit;
  }
  return complete;
}

bool Bench::count_instructions() {
  bool complete = true;
  for (const Counted& counted : counted_) {
    const double total = run_under_callgrind(counted.key);
    std::fprintf(stderr, "counted %s: %.0f\n", counted.key.c_str(), total);
    complete = complete && std::isfinite(total);
    metrics_[counted.key] = total;
  }
  return complete;
}

int Bench::count_in_child(const std::string& key) const {
  for (const Counted& counted : counted_) {
    if (counted.key != key) continue;
    for (int i = 0; i < counted.warm_up; ++i) counted.work();
    usher_bench_counted(&counted.work);
    return 0;
  }
  std::fprintf(stderr, "no counted call is named %s\n", key.c_str());
  return 2;
}

int Bench::run(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--help") {
      std::printf("usher bench %s: %s\n%s", name_.c_str(), input_.c_str(), help());
      return 0;
    }
  }
  if (!parse(argc, argv)) return 2;
  if (!absent_.empty()) {
    for (const std::string& path : absent_) {
      std::fprintf(stderr, "bench %s: no %s below USHER_TEST_DATA\n", name_.c_str(), path.c_str());
    }
    return 4;
  }
  if (!counted_key_.empty()) return count_in_child(counted_key_);

  bool complete = measure_times();
  metrics_["machine_ratio"] = metrics_["reference_loop_ms"] / kReferenceLoopMs;
  if (with_instructions_) complete = count_instructions() && complete;
  for (const auto& [key, compute] : computed_) {
    try {
      metrics_[key] = compute();
    } catch (const std::out_of_range&) {
      continue;  // of times that --benchmark_filter left out
    }
  }
  std::printf("%s\n", (print_json_ ? json() : table()).c_str());
  return complete && pass() ? 0 : 1;
}

double Bench::limit(const std::string& key) const {
  const auto& [bound, value] = targets_.at(key);
  const auto ends_with = [&](const char* ending) { return key.ends_with(ending); };
  constexpr std::array kOfTheMachine = {"_us",      "_ms",         "_s",
                                        "_percent", "_per_second", "realtime_factor"};
  if (std::none_of(kOfTheMachine.begin(), kOfTheMachine.end(), ends_with)) return value;
  const double slower = std::max(1.0, metrics_.at("machine_ratio"));
  return bound == Bound::kAtMost ? value * slower : value / slower;
}

bool Bench::holds(const std::string& key) const {
  const auto target = targets_.find(key);
  const auto metric = metrics_.find(key);
  if (target == targets_.end() || metric == metrics_.end()) return true;
  return target->second.bound == Bound::kAtMost ? metric->second <= limit(key)
                                                : metric->second >= limit(key);
}

bool Bench::pass() const {
  return std::all_of(targets_.begin(), targets_.end(),
                     [this](const auto& entry) { return holds(entry.first); });
}

std::string Bench::json() const {
  const auto plain = [](double value) { return value; };
  return "{\"name\": " + quoted(name_) + ", \"input\": " + quoted(input_) +
         ", \"metrics\": " + object(metrics_, plain) +
         ", \"published\": " + object(published_, plain) +
         ", \"targets\": " + object(targets_, [](const Target& target) { return target.value; }) +
         ", \"pass\": " + (pass() ? "true" : "false") + "}";
}

std::string Bench::table() const {
  std::string result = name_ + ": " + input_ + "\n";
  for (const auto& [key, value] : metrics_) {
    result += "  " + key + " = " + number(value);
    const auto target = targets_.find(key);
    if (target != targets_.end()) {
      result += std::string(holds(key) ? "  (holds: " : "  (MISSED: ") +
                (target->second.bound == Bound::kAtMost ? "at most " : "at least ") +
                number(limit(key)) + ")";
    }
    result += "\n";
  }
  for (const auto& [key, value] : published_)
    result += "  published " + key + " = " + number(value) + "\n";
  return result + (pass() ? "pass" : "FAIL");
}

}  // namespace usher::bench
