#include "deployment/two_hosts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <thread>

namespace usher::test {

using namespace usher_msgs::msg;

TwoHosts::TwoHosts(TwoNetworks& networks, const Folder& folder, const Options& options)
    : networks_(networks), folder_(folder), domain_(test_domain()) {
  std::string text = "extends: " + std::string(USHER_SOURCE_DIR) + "/deploy/" + options.base;
  text += "\ndomain: " + std::to_string(domain_) + "\n";
  if (options.secure) text += "security: keys\n";
  if (options.discovery_server)
    text += "discovery_server: {host: nuc, address: " + networks.address_of_a() + "}\n";
  manifest_ = folder.file("deploy/robot.yaml", text + options.lines);
  if (options.secure) {
    Process keys(
        {usher_program(), "keys", folder.path() + "/deploy/keys", "--manifest", manifest_});
    EXPECT_EQ(keys.wait(), 0) << keys.errors();
  }
  for (const auto& host : options.hosts_of_a) launchers_.push_back(launch(networks.a(), host));
  for (const auto& host : options.hosts_of_b) launchers_.push_back(launch(networks.b(), host));
  ::setenv("XDG_RUNTIME_DIR", (folder.path() + "/nuc").c_str(), 1);
  ::setenv("XDG_STATE_HOME", (folder.path() + "/nuc").c_str(), 1);
  TwoNetworks::within(networks.a(), [&] { observe(options); });
}

TwoHosts::~TwoHosts() { stop(); }

void TwoHosts::stop() {
  statuses_.reset();
  observer_.reset();
  for (const auto& launcher : launchers_) launcher->signal(SIGTERM);
  for (const auto& launcher : launchers_) launcher->wait(std::chrono::seconds(30));
}

/// Each machine has a run directory of its own.
std::unique_ptr<Process> TwoHosts::launch(const std::string& network,
                                          const std::string& host) const {
  const std::string directory = folder_.path() + "/" + host;
  std::filesystem::create_directories(directory);
  ::setenv("XDG_RUNTIME_DIR", directory.c_str(), 1);
  ::setenv("XDG_STATE_HOME", directory.c_str(), 1);
  return TwoNetworks::start(network, {usher_program(), "launch", manifest_, "--host", host});
}

void TwoHosts::observe(const Options& options) {
  runtime::Observer::Options how{.name = "tests", .host = "nuc", .domain = domain_};
  if (options.secure) how.identity = folder_.path() + "/deploy/keys/operator";
  if (options.discovery_server) {
    how.discovery_server = networks_.address_of_a() + ":11811";
  } else {
    how.peers = {"127.0.0.1"};
  }
  auto made = runtime::Observer::create(how);
  ASSERT_TRUE(made) << made.error();
  observer_ = std::move(made).value();
  auto statuses =
      observer_->reader(topics::kSupervisorStatus, [this](const auto& message, const auto&) {
        const std::lock_guard lock(mutex_);
        status_ = message;
      });
  ASSERT_TRUE(statuses) << statuses.error();
  statuses_ = std::move(statuses).value();
  if (options.listen) options.listen(*observer_);
}

bool TwoHosts::wait_for(const std::function<bool()>& condition, Seconds limit) const {
  const auto end = std::chrono::steady_clock::now() + limit * kSanitizerFactor;
  while (!condition()) {
    for (const auto& launcher : launchers_) launcher->wait(std::chrono::milliseconds(0));
    const bool launched =
        std::ranges::all_of(launchers_, [](const auto& launcher) { return launcher->pid() > 0; });
    if (!launched || std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

std::optional<SupervisorStatus> TwoHosts::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

bool TwoHosts::granted() const {
  const auto now = status();
  return now && now->granted();
}

std::uint8_t TwoHosts::health_of(const std::string& component) const {
  const auto now = status();
  if (!now) return SupervisorStatus_Constants::HEALTH_MISSING;
  for (const auto& entry : now->components()) {
    if (entry.name() == component) return entry.health();
  }
  return SupervisorStatus_Constants::HEALTH_MISSING;
}

bool TwoHosts::is_ok(const std::string& component) const {
  return health_of(component) == SupervisorStatus_Constants::HEALTH_OK;
}

bool TwoHosts::all_is_well() const {
  const auto now = status();
  return now && now->granted() && std::ranges::all_of(now->components(), is_well);
}

std::unique_ptr<Process> TwoHosts::command(std::vector<std::string> words) const {
  words.insert(words.begin(), usher_program());
  words.insert(words.end(), {"--domain", std::to_string(domain_)});
  return TwoNetworks::start(networks_.a(), words);
}

std::string TwoHosts::story() const {
  std::string text;
  for (const auto& launcher : launchers_) text += launcher->output() + launcher->errors();
  if (const auto now = status()) {
    text += now->granted() ? "granted\n" : "not granted: " + now->reason() + "\n";
    for (const auto& component : now->components()) {
      if (!is_well(component)) text += component.name() + ": " + component.reason() + "\n";
    }
  }
  return text;
}

std::unique_ptr<TwoNetworks> two_networks(TwoNetworks::Kind kind) {
  std::string why;
  auto made = TwoNetworks::create(kind, why);
  if (!made) std::printf("NO NETWORK NAMESPACES: %s\n", why.c_str());
  return made;
}

}  // namespace usher::test
