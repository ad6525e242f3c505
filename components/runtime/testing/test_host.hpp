#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "idl/topics.hpp"
#include "runtime/lockstep/lockstep_world.hpp"

namespace usher::runtime {

/// One component in a small lockstep world, for the tests of its shell:
///
///     TestHost host(component_factory<ScanFilter>("scan_filter"), "robot.laser.mount_z: 0.3 m");
///     host.publish(topics::kScan, scan);
///     host.run_for(std::chrono::milliseconds(20));
///     ASSERT_EQ(host.written(topics::kScanFiltered).size(), 1U);
///
/// Everything is discovered at once; a sample needs 100 us each way. `parameters` is the mapping
/// below `parameters:` of a parameter file, without origins. Throws std::runtime_error when the
/// component cannot be made, with the reason.
class TestHost {
 public:
  explicit TestHost(ComponentFactory factory, const std::string& parameters = {},
                    std::uint64_t seed = 1);
  /// The same with a device at the end of its stream.
  TestHost(ComponentFactory factory, const std::string& parameters,
           std::shared_ptr<LockstepDevice> device);
  /// The same component and parameters without a world: the error that a wrong parameter gives.
  static Status try_make(ComponentFactory factory, const std::string& parameters);

  /// Writes as a participant "test" on the component's host, or as another one.
  template <class Message>
  void publish(const topics::Topic<Message>& topic, const std::type_identity_t<Message>& message,
               const std::string& participant = "test") {
    world_->publish(topic, message, participant);
  }
  void run_for(Duration duration) { world_->run_for(duration); }
  Time now() const { return world_->now(); }

  /// What the component has written since the start or the last clear(), oldest first.
  template <class Message>
  std::vector<Message> written(const topics::Topic<Message>& topic) const {
    std::vector<Message> messages;
    for (const auto& message : samples(topic.name)) {
      messages.push_back(*static_cast<const Message*>(message.get()));
    }
    return messages;
  }
  /// The newest of them.
  template <class Message>
  std::optional<Message> last(const topics::Topic<Message>& topic) const {
    const auto& all = samples(topic.name);
    if (all.empty()) return std::nullopt;
    return *static_cast<const Message*>(all.back().get());
  }
  void clear() { written_.clear(); }

  /// The newest heartbeat; there is one from the component's first moment on.
  usher_msgs::msg::Heartbeat heartbeat() const { return last(topics::kHeartbeat).value(); }
  /// A counter of the newest heartbeat; zero when nothing was counted.
  std::uint64_t counter(const std::string& name) const;
  bool running() const { return world_->running(name_); }
  const std::string& fault_reason() const { return world_->fault_reason(name_); }

  /// For everything else: other components, links, crashes, restarts.
  LockstepWorld& world() { return *world_; }
  const std::string& name() const { return name_; }

 private:
  using Samples = std::vector<std::shared_ptr<const void>>;
  const Samples& samples(std::string_view topic) const;
  void start(ComponentFactory factory, const std::string& parameters, std::uint64_t seed,
             const LockstepHost::Options& options);

  std::string name_;
  std::map<std::string, Samples, std::less<>> written_;
  std::unique_ptr<LockstepWorld> world_;
};

/// A parameter file as the launcher would write it, from the mapping below `parameters:`.
Result<ParameterFile> test_parameters(const std::string& component, const std::string& parameters);

}  // namespace usher::runtime
