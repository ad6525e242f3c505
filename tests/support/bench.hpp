#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "support/data.hpp"

namespace usher::bench {

enum class Bound { kAtMost, kAtLeast };

/// One performance figure program (`usher bench NAME`): measures with Google Benchmark, counts
/// instructions with callgrind, prints one object {"name", "input", "metrics", "published",
/// "targets", "pass"}.
///
///     int main(int argc, char** argv) {
///       usher::bench::Bench bench("amcl", "willow-trinary 1165x945, 60 beams, 2000 particles");
///       bench.time("likelihood_field_ms", 1e-3, [&] { field.build(map); });  // the least
///       bench.instructions("update_instructions", [&] { model.update(scan); });
///       bench.metric("cells", [&] { return 1e6; });
///       bench.published("likelihood_field_ms", 164, "ROS amcl");
///       bench.target("likelihood_field_ms", Bound::kAtMost, 16);
///       return bench.run(argc, argv);
///     }
///
/// Options: --json (the object on standard output, everything else on standard error),
/// --instructions (also count instructions: the program runs itself under valgrind, one run a
/// counted call), --help, and Google Benchmark's own
/// (--benchmark_min_time=0.01). Exit code 0 when every target that was measured holds, 1 when one
/// does not or a measurement failed, 2 on a wrong option, 4 when the input data is absent.
///
/// Keys are identifiers (letters, digits, underscore). `published` becomes {"<key> (<who>)":
/// value}, since one figure may have several peers. A figure that is not finite prints as null and
/// misses its target.
class Bench {
 public:
  Bench(std::string name, std::string input);

  /// The path of an input below USHER_TEST_DATA, or empty; then run() says what is absent and
  /// returns 4.
  std::string data(const std::string& relative);

  /// Least wall time of `work` over Google Benchmark repetitions, in multiples of `unit` seconds.
  void time(std::string key, double unit, std::function<void()> work);
  /// Mean over `cases` of the least wall time that `work(case)` took, in multiples of `unit`
  /// seconds: for cases so long that a disturbance seldom hits the same one each time.
  void time_each(std::string key, double unit, std::size_t cases,
                 std::function<void(std::size_t)> work);
  /// Instructions of one call of `work` after `warm_up` calls, by callgrind; only with
  /// --instructions.
  void instructions(std::string key, std::function<void()> work, int warm_up = 1);
  /// A figure computed when the program runs (after the timings, which it may read from
  /// `metrics()`).
  void metric(std::string key, std::function<double()> compute);
  /// What others reach on the same input.
  void published(const std::string& key, double value, const std::string& who);
  /// A figure that depends on the machine (its key ends with _us, _ms, _s, _percent, _per_second or
  /// realtime_factor) is judged by the ratio where the machine is slower than the one that the
  /// published figures were measured on: metric `machine_ratio`, greater than 1 then.
  void target(const std::string& key, Bound bound, double value);
  /// What has been measured so far; always has `reference_loop_ms`, a fixed scalar loop, and
  /// `machine_ratio`, how much longer it takes than on the machine of the published figures.
  const std::map<std::string, double>& metrics() const { return metrics_; }

  int run(int argc, char** argv);

 private:
  struct Timing {
    std::string key;
    double unit;
    std::function<void()> work;
    std::shared_ptr<std::vector<double>> cases;  // least time of each [s]; null: one case
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

  bool parse(int argc, char** argv);
  bool measure_times();
  bool count_instructions();
  int count_in_child(const std::string& key) const;
  double limit(const std::string& key) const;
  bool holds(const std::string& key) const;
  bool pass() const;
  std::string json() const;
  std::string table() const;

  std::string name_;
  std::string input_;
  std::vector<std::string> absent_;
  bool print_json_ = false;
  bool with_instructions_ = false;
  std::string counted_key_;  // set in the child that runs under valgrind
  std::vector<Timing> timings_;
  std::vector<Counted> counted_;
  std::vector<std::pair<std::string, std::function<double()>>> computed_;
  std::map<std::string, double> metrics_;
  std::map<std::string, double> published_;
  std::map<std::string, Target> targets_;
};

}  // namespace usher::bench
