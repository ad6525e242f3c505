#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "conformance/stage.hpp"
#include "runtime/lockstep/lockstep_world.hpp"
#include "runtime/parameters/parameter_file.hpp"

namespace usher::conformance {
namespace {

runtime::ParameterFile file_of(const Stage::Role& role) {
  std::ostringstream text;
  text << "component: subject\nname: " << role.name << "\nhost: " << role.host
       << "\nseed: " << role.seed << "\ncritical: " << (role.critical ? "true" : "false")
       << (role.robot.empty() ? "" : "\nrobot: " + role.robot + "\nfleet_domain: 1")
       << "\nparameters:\n";
  std::istringstream lines(role.parameters);
  for (std::string line; std::getline(lines, line);) text << "  " << line << '\n';
  return runtime::parse_parameter_file(text.str(), role.name + ".yaml").value();
}

class LockstepStage final : public Stage {
 public:
  LockstepStage() {
    world_.observe(topics::kHeartbeat, [this](const usher_msgs::msg::Heartbeat& beat, const auto&) {
      heartbeats_[beat.component_name()].push_back(beat);
    });
  }

  Status start(const Role& role, Make make) override {
    const std::string full = role.robot.empty() ? role.name : role.robot + "/" + role.name;
    if (makers_.count(full) > 0) {
      makers_[full] = std::move(make);
      world_.start(full);
      return world_.running(full) ? Status() : Status(Error{world_.fault_reason(full)});
    }
    makers_[full] = std::move(make);
    runtime::ComponentFactory factory{"subject",
                                      [this, full](Host& host) { return makers_.at(full)(host); }};
    return world_.add(std::move(factory), file_of(role), {role.work, std::nullopt});
  }
  void stop(const std::string& name) override {
    world_.stop(name);
    stopped_.insert(name);
  }
  std::optional<int> exit_code(const std::string& name) override {
    if (world_.running(name)) return std::nullopt;
    return stopped_.count(name) > 0 ? 0 : 3;
  }
  void hold(const std::string& name, Duration duration) override { world_.hang(name, duration); }
  void work(const Role& /*role*/) override {}  // the world charges it

  void publish_all(const Topic& topic, const std::vector<Message>& messages,
                   const Sender& sender) override {
    for (const Message& each : messages) world_.publish(topic, each, sender.name, sender.host);
  }
  void publish_bytes(const Topic& topic, const Bytes& cdr) override {
    world_.publish_bytes(topic, cdr, "outsider", "here");
  }
  void leave(const Sender& sender) override { world_.leave(sender.name, sender.host); }
  bool cut(const std::string& a, const std::string& b, Duration duration) override {
    world_.cut(a, b, world_.now(), world_.now() + duration);
    return true;
  }

  Time now() const override { return world_.now(); }
  bool run_until(const std::function<bool()>& condition, Duration limit) override {
    const Time end = world_.now() + limit;
    while (!condition()) {
      if (world_.now() >= end) return false;
      world_.run_until(std::min(end, world_.now() + std::chrono::milliseconds(1)));
    }
    return true;
  }
  void settle() override { world_.run_for(std::chrono::milliseconds(100)); }
  std::vector<usher_msgs::msg::Heartbeat> heartbeats(const std::string& name) override {
    return heartbeats_[name];
  }
  Duration tolerance() const override { return {}; }

 private:
  std::map<std::string, Make> makers_;
  std::set<std::string> stopped_;
  std::map<std::string, std::vector<usher_msgs::msg::Heartbeat>> heartbeats_;
  runtime::LockstepWorld world_;
};

}  // namespace

std::unique_ptr<Stage> make_stage() { return std::make_unique<LockstepStage>(); }

}  // namespace usher::conformance
