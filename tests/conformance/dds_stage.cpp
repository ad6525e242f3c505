#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <future>
#include <map>
#include <sstream>
#include <thread>

#include "conformance/stage.hpp"
#include "runtime/dds/dds_host.hpp"
#include "runtime/dds/observer.hpp"
#include "runtime/parameters/parameter_file.hpp"
#include "support/test_domain.hpp"

namespace usher::conformance {
namespace {

using runtime::DdsHost;
using runtime::Observer;

/// A component with its dispatcher thread.
class Actor {
 public:
  Actor(runtime::ParameterFile file, const Stage::Make& make) {
    std::promise<Status> constructed;
    auto status = constructed.get_future();
    thread_ = std::thread([this, file = std::move(file), &make, &constructed] {
      auto created = DdsHost::create(file, stop_);
      if (!created) {
        constructed.set_value(Error{created.error()});
        exit_code_ = 2;
        return;
      }
      const std::unique_ptr<DdsHost> host = std::move(created).value();
      const Status made = host->construct({"subject", make});
      if (made.ok()) engine_ = &host->engine();
      constructed.set_value(made);
      const int code = made.ok() ? host->run() : (host->engine().faulted() ? 3 : 2);
      engine_ = nullptr;
      exit_code_ = code;
    });
    status_ = status.get();
  }
  ~Actor() { stop(); }

  const Status& status() const { return status_; }
  void stop() {
    stop_.set();
    if (thread_.joinable()) thread_.join();
  }
  int exit_code() const { return exit_code_; }
  void hold(Duration duration) {
    if (runtime::Engine* engine = engine_) {
      engine->post([duration] { std::this_thread::sleep_for(duration); });
    }
  }

 private:
  runtime::StopFlag stop_;
  std::atomic<int> exit_code_{-1};
  std::atomic<runtime::Engine*> engine_{nullptr};
  Status status_;
  std::thread thread_;
};

class DdsStage final : public Stage {
 public:
  DdsStage() : run_directory_(std::filesystem::temp_directory_path() / unique_name()) {
    std::filesystem::create_directories(run_directory_);
    observer_ = make_observer({"judge", "nowhere"});
    heartbeat_reader_.emplace(
        observer_
            ->reader(topics::kHeartbeat,
                     {[this](const usher_msgs::msg::Heartbeat& beat, const Observer::RawSample&) {
                       const std::lock_guard lock(mutex_);
                       heartbeats_[beat.component_name()].push_back(beat);
                     }})
            .value());
  }
  ~DdsStage() override {
    actors_.clear();
    std::filesystem::remove_all(run_directory_);
  }

  Status start(const Role& role, Make make) override {
    std::ostringstream text;
    text << "component: subject\nname: " << role.name << "\nhost: " << role.host
         << "\nseed: " << role.seed << "\ncritical: " << (role.critical ? "true" : "false")
         << "\nparameters:\n";
    std::istringstream lines(role.parameters);
    for (std::string line; std::getline(lines, line);) text << "  " << line << '\n';
    auto file = runtime::parse_parameter_file(text.str(), role.name + ".yaml").value();
    // Each robot has its domain; the one without a fleet is where outsiders and the judge are.
    const std::string full = role.robot.empty() ? role.name : role.robot + "/" + role.name;
    if (!role.robot.empty() && robots_.count(role.robot) == 0)
      robots_.emplace(role.robot, static_cast<std::uint32_t>(robots_.size() + 2));
    file.robot = role.robot;
    file.fleet_domain = test_domain(1);
    file.domain = test_domain(role.robot.empty() ? 0 : robots_.at(role.robot));
    file.run_directory = run_directory_;
    file.clock_anchor = kAnchor;
    actors_.erase(full);
    makers_[full] = std::move(make);
    auto& actor = actors_[full];
    actor = std::make_unique<Actor>(std::move(file), makers_[full]);
    return actor->status();
  }
  void stop(const std::string& name) override { actors_.at(name)->stop(); }
  std::optional<int> exit_code(const std::string& name) override {
    const int code = actors_.at(name)->exit_code();
    return code < 0 ? std::nullopt : std::optional<int>(code);
  }
  void hold(const std::string& name, Duration duration) override {
    actors_.at(name)->hold(duration);
  }
  void work(const Role& role) override {
    const Time end = now() + role.work;
    while (now() < end) {
    }
  }

  void publish_all(const Topic& topic, const std::vector<Message>& messages,
                   const Sender& sender) override {
    auto& writer = writer_of(topic, sender);
    for (const Message& each : messages) writer.write(each);
  }
  void publish_bytes(const Topic& topic, const Bytes& cdr) override {
    writer_of(topic, {}).write_raw(cdr);
  }
  void leave(const Sender& sender) override {
    for (auto each = writers_.begin(); each != writers_.end();) {
      each = each->first.first == sender.name ? writers_.erase(each) : std::next(each);
    }
    outsiders_.erase(sender.name);
  }
  bool cut(const std::string&, const std::string&, Duration) override { return false; }

  Time now() const override {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return Time(std::chrono::seconds(time.tv_sec) + Duration(time.tv_nsec + kAnchor));
  }
  bool run_until(const std::function<bool()>& condition, Duration limit) override {
    const Time end = now() + limit;
    while (!condition()) {
      if (now() >= end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
  }
  void settle() override {
    // Everybody that runs was heard by the judge, and everybody hears everybody at about the same
    // time.
    run_until(
        [this] {
          const std::lock_guard lock(mutex_);
          for (const auto& [name, actor] : actors_) {
            if (actor->exit_code() < 0 && heartbeats_[name].empty()) return false;
          }
          return true;
        },
        std::chrono::seconds(5));
    run_for(std::chrono::milliseconds(200));
  }
  std::vector<usher_msgs::msg::Heartbeat> heartbeats(const std::string& name) override {
    const std::lock_guard lock(mutex_);
    return heartbeats_[name];
  }
  Duration tolerance() const override { return std::chrono::milliseconds(15); }

 private:
  static constexpr std::int64_t kAnchor = 1'700'000'000'000'000'000;

  static std::string unique_name() {
    static int count = 0;
    return "usher-conformance-" + std::to_string(::getpid()) + "-" + std::to_string(++count);
  }
  static std::unique_ptr<Observer> make_observer(const Sender& sender) {
    Observer::Options options;
    options.name = sender.name;
    options.host = sender.host;
    options.domain = test_domain();
    options.clock_anchor = kAnchor;
    return std::move(Observer::create(options)).value();
  }
  Observer::Writer<Message>& writer_of(const Topic& topic, const Sender& sender) {
    const auto key = std::pair(sender.name, std::string(topic.name));
    const auto known = writers_.find(key);
    if (known != writers_.end()) return known->second;
    auto& outsider = outsiders_[sender.name];
    if (!outsider) outsider = make_observer(sender);
    auto& writer = writers_.emplace(key, outsider->writer(topic).value()).first->second;
    writer.wait_for_readers(1, std::chrono::seconds(5));
    return writer;
  }

  const std::filesystem::path run_directory_;
  std::map<std::string, std::uint32_t> robots_;  ///< of a fleet, with the offset of their domain
  std::mutex mutex_;
  std::map<std::string, std::vector<usher_msgs::msg::Heartbeat>> heartbeats_;
  std::unique_ptr<Observer> observer_;
  std::optional<Observer::Reader<usher_msgs::msg::Heartbeat>> heartbeat_reader_;
  std::map<std::string, std::unique_ptr<Observer>> outsiders_;
  std::map<std::pair<std::string, std::string>, Observer::Writer<Message>> writers_;
  std::map<std::string, Make> makers_;
  std::map<std::string, std::unique_ptr<Actor>> actors_;
};

}  // namespace

std::unique_ptr<Stage> make_stage() { return std::make_unique<DdsStage>(); }

}  // namespace usher::conformance
