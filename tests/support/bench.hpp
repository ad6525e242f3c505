#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace usher::bench {

enum class Bound { kAtMost, kAtLeast };

/// One performance figure program (`usher bench NAME`): measures with Google Benchmark, counts instructions with
/// callgrind, prints one object {"name", "input", "metrics", "published", "targets", "pass"}.
///
///     int main(int argc, char** argv) {
///       usher::bench::Bench bench("amcl", "willow-trinary 1165x945, 60 beams, 2000 particles");
///       bench.time("likelihood_field_ms", 1e-3, [&] { field.build(map); });          // median, in units of 1e-3 s
///       bench.instructions("sensor_update_instructions", [&] { model.update(...); });  // exactly this call
///       bench.metric("cells", 1e6);
///       bench.published("likelihood_field_ms", 164, "ROS amcl");
///       bench.target("likelihood_field_ms", Bound::kAtMost, 16);
///       return bench.run(argc, argv);
///     }
///
/// Options: --json (the object on standard output, everything else on standard error), --instructions (also count
/// instructions: the program runs itself under valgrind, one run a counted call), --help. Exit code 0 when every
/// target that was measured holds, 1 when one does not, 2 on a wrong option, 4 when the input data is absent.
class Bench {
 public:
  Bench(std::string name, std::string input);

  /// Median wall time of `work` over Google Benchmark repetitions, in multiples of `unit` seconds.
  void time(std::string key, double unit, std::function<void()> work);
  /// Instructions of one call of `work` after `warm_up` calls, by callgrind; only with --instructions.
  void instructions(std::string key, std::function<void()> work, int warm_up = 1);
  /// A figure computed when the program runs (after the timings, which it may read from `metrics()`).
  void metric(std::string key, std::function<double()> compute);
  /// What others reach on the same input.
  void published(const std::string& key, double value, const std::string& who);
  void target(const std::string& key, Bound bound, double value);
  /// Adds `reference_loop_ms` to the metrics: a fixed scalar loop, so that machines can be compared. On by default.
  const std::map<std::string, double>& metrics() const { return metrics_; }

  int run(int argc, char** argv);

 private:
  struct Timing {
    std::string key;
    double unit;
    std::function<void()> work;
  };
  struct Counted {
    std::string key;
    std::function<void()> work;
    int warm_up;
  };
  struct Target {
    Bound bound;
    double value;
  };

  std::string name_;
  std::string input_;
  std::vector<Timing> timings_;
  std::vector<Counted> counted_;
  std::vector<std::pair<std::string, std::function<double()>>> computed_;
  std::map<std::string, double> metrics_;
  std::map<std::string, double> published_;
  std::map<std::string, Target> targets_;
};

/// The folder with real data (environment variable USHER_TEST_DATA), joined with `relative`; empty when the variable
/// is unset or the file is absent. A test then skips with `USHER_REQUIRE_DATA(path, relative)` of data.hpp.
std::string test_data(const std::string& relative);

}  // namespace usher::bench
