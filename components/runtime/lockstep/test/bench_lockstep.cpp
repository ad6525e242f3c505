// What the runtime itself costs in lock-step simulation: a robot of 15 components that exchange the
// real messages at their real rates and do nothing else.
#include <memory>
#include <string>

#include "idl/topics.hpp"
#include "runtime/lockstep/lockstep_world.hpp"
#include "support/bench.hpp"

namespace {

using namespace usher;           // NOLINT: a program of one file
using namespace usher::runtime;  // NOLINT
using std::chrono::milliseconds;

std::uint64_t received = 0;

template <class Message>
void listen(Host& host, const topics::Topic<Message>& topic, int depth = 0) {
  host.input(topic, {milliseconds(500), "nothing", depth},
             [](const auto&, const auto&) { ++received; });
}

/// Publishes one message again and again, and listens to what its place in the robot would.
template <class Message>
class Source final : public Component {
 public:
  Source(Host& host, const topics::Topic<Message>& topic, Message message, bool driving)
      : message_(std::move(message)),
        output_(host.output(topic)),
        timer_(host.timer("tick", from_seconds(1.0 / topic.rate_hz),
                          [this](auto) { output_.publish(message_); })) {
    if (!driving) return;
    listen(host, topics::kScanFiltered);
    listen(host, topics::kOdom);
    listen(host, topics::kTf);
    listen(host, topics::kBaseStatus);
    host.input(topics::kLocalCosts, {});
  }

 private:
  Message message_;
  Output<Message> output_;
  Timer timer_;
};

class Watcher final : public Component {
 public:
  explicit Watcher(Host& host) {
    listen(host, topics::kHeartbeat, 64);
    listen(host, topics::kDriveCommand);
    listen(host, topics::kBaseStatus);
  }
};

class Robot {
 public:
  Robot() {
    sensor_msgs::msg::LaserScan scan;
    scan.ranges(std::vector<float>(541, 3.0F));
    usher_msgs::msg::Costmap costs;
    costs.costs(std::vector<std::uint8_t>(200 * 200, 1));
    tf2_msgs::msg::TFMessage tf;
    tf.transforms().resize(1);
    add(topics::kSimScan, scan, false);
    add(topics::kScan, scan, false);
    add(topics::kScanFiltered, scan, false);
    add(topics::kOdom, {}, false);
    add(topics::kTf, tf, false);
    add(topics::kBaseStatus, {}, false);
    add(topics::kLocalCosts, costs, true);
    add(topics::kCmdVelNavigation, {}, true);
    add(topics::kDriveCommand, {}, true);
    add(topics::kMovementStatus, {}, true);
    add(topics::kLocalizationStatus, {}, true);
    add(topics::kFollowStatus, {}, true);
    add(topics::kNavigateStatus, {}, true);
    add(topics::kWhiskers, {}, false);
    check(world_.add(component_factory<Watcher>("watcher"), file()));
    run(1.0);
  }
  void run(double duration) { world_.run_for(from_seconds(duration)); }
  std::uint64_t written() const { return world_.written(); }

 private:
  template <class Message>
  void add(const topics::Topic<Message>& topic, std::type_identity_t<Message> message,
           bool driving) {
    check(world_.add({"source",
                      [=](Host& host) {
                        return std::make_unique<Source<Message>>(host, topic, message, driving);
                      }},
                     file()));
  }
  ParameterFile file() {
    ParameterFile result;
    result.component = "source";
    result.name = "source_" + std::to_string(++count_);
    result.host = "nuc";
    result.critical = true;
    return result;
  }
  static void check(const Status& status) {
    if (!status.ok()) throw std::runtime_error(status.error());
  }

  int count_ = 0;
  LockstepWorld world_;
};

}  // namespace

int main(int argc, char** argv) {
  bench::Bench bench(
      "runtime", "15 components, critical heartbeats, 541-beam scans, 200x200 costmap, lock-step");
  Robot robot;
  const std::uint64_t written = robot.written(), handled = received;
  robot.run(1.0);
  const auto per_second = static_cast<double>(robot.written() - written);
  const auto samples = static_cast<double>(received - handled);
  bench.time("simulated_second_ms", 1e-3, [&] { robot.run(1.0); });
  bench.metric("samples_written_per_second", [=] { return per_second; });
  bench.metric("samples_handled_per_second", [=] { return samples; });
  bench.metric("us_per_handled_sample",
               [&] { return 1e3 * bench.metrics().at("simulated_second_ms") / samples; });
  bench.metric("realtime_factor", [&] { return 1e3 / bench.metrics().at("simulated_second_ms"); });
  bench.target("us_per_handled_sample", bench::Bound::kAtMost, 5.0);
  bench.target("realtime_factor", bench::Bound::kAtLeast, 60.0);
  return bench.run(argc, argv);
}
