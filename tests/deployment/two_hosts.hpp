#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "deployment/running_robot.hpp"
#include "deployment/two_networks.hpp"

namespace usher::test {

/// One robot on two machines: the hosts of a manifest, those of each machine launched in a network
/// of its own, and somebody who listens on the first one's, the nuc's.
class TwoHosts {
 public:
  struct Options {
    std::string base = "marvin-sim.yaml";  ///< in deploy/
    std::string lines;                     ///< the rest of the manifest
    bool secure = false;
    bool discovery_server = false;  ///< the nuc's; nobody announces to anybody else
    std::vector<std::string> hosts_of_a = {"nuc"}, hosts_of_b = {"tablet"};
    /// Opens what else is listened to; runs where the observer lives.
    std::function<void(runtime::Observer&)> listen;
  };
  TwoHosts(TwoNetworks& networks, const Folder& folder, const Options& options);
  ~TwoHosts();
  TwoHosts(const TwoHosts&) = delete;
  TwoHosts& operator=(const TwoHosts&) = delete;

  /// Ends the launchers; what was opened by `listen` must have been closed.
  void stop();

  /// False when the limit passes, or a launcher ends.
  bool wait_for(const std::function<bool()>& condition, Seconds limit) const;
  std::optional<usher_msgs::msg::SupervisorStatus> status() const;
  bool granted() const;
  std::uint8_t health_of(const std::string& component) const;
  bool is_ok(const std::string& component) const;
  bool all_is_well() const;
  std::map<std::string, pid_t> components() const { return components_from(folder_.path()); }
  /// A command of the program, typed on the nuc.
  std::unique_ptr<Process> command(std::vector<std::string> words) const;
  /// What the launchers said, and who is not well.
  std::string story() const;

 private:
  void observe(const Options& options);
  std::unique_ptr<Process> launch(const std::string& network, const std::string& host) const;

  TwoNetworks& networks_;
  const Folder& folder_;
  std::uint32_t domain_;
  std::string manifest_;
  std::vector<std::unique_ptr<Process>> launchers_;
  mutable std::mutex mutex_;
  std::optional<usher_msgs::msg::SupervisorStatus> status_;
  std::unique_ptr<runtime::Observer> observer_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::SupervisorStatus>> statuses_;
};

/// The networks; nothing, and a loud line, where the machine does not permit namespaces.
std::unique_ptr<TwoNetworks> two_networks(TwoNetworks::Kind kind);
inline constexpr const char* kNoNamespaces = "network namespaces are not permitted here";

}  // namespace usher::test
