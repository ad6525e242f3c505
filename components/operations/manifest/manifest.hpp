#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "operations/manifest/finding.hpp"
#include "operations/manifest/tree.hpp"
#include "runtime/parameters/parameter_file.hpp"

namespace usher::operations {

/// What the loss of a component means to the supervisor.
enum class Criticality { kStop, kDegrade, kNotify };
enum class RestartPolicy { kAlways, kOnFailure, kNever };

/// One component of a deployment.
struct ManifestComponent {
  std::string name;  ///< unique; also the name of its DDS participant
  std::string type;  ///< folder and program: usher-<type>; the name unless given
  std::string host;
  Criticality criticality = Criticality::kStop;
  RestartPolicy restart = RestartPolicy::kAlways;
  int restart_budget = 10;          ///< starts within a minute before the launcher gives up
  double heartbeat_timeout = 0.12;  ///< [s] six heartbeats of a critical component
  double start_patience = 30.0;  ///< [s] from its start to its first sign of life; with keys twice
  std::string group;             ///< components of one group share a process; empty = its own
  bool real_time = false;  ///< its process goes before all others, on one processor of its host:
                           ///< for short work that must be even, as that on a camera's images
  std::vector<runtime::ParameterValue> parameters;
  std::string origin;
  std::map<std::string, std::string> origins;  ///< of the keys that are given

  /// Where `key` is given, or the component itself where it is not.
  const std::string& origin_of(const std::string& key) const;
};

/// A component that a manifest takes out of what it extends.
struct RemovedComponent {
  std::string name;
  std::string type;
  std::string origin;  ///< of the null
};

struct ManifestHost {
  std::string name;
  std::vector<std::string> peers;  ///< addresses of the other hosts, where multicast does not reach
  std::string origin;
};

/// Where participants that multicast and peers do not bring together find one another.
struct ManifestDiscoveryServer {
  std::string host;     ///< that runs it; empty = there is none
  std::string address;  ///< of that host, as the others reach it
  std::uint16_t port = 11811;

  std::string locator() const { return host.empty() ? "" : address + ":" + std::to_string(port); }
};

/// Robots that work together share a second DDS domain.
struct ManifestFleet {
  std::string robot;         ///< name of this one, unique in the fleet; empty = belongs to none
  std::uint32_t domain = 0;  ///< other than that of each robot
  std::vector<std::string> peers;  ///< addresses of the others, where multicast does not reach
  runtime::ParameterValue start;   ///< where this one starts, instead of the site's `initial_pose`;
                                   ///< empty = there
};

/// What runs where. Read strictly: an unknown key, a missing host or a wrong type is a finding.
struct Manifest {
  std::string path;
  std::string name;        ///< of the deployment; the file's name unless given
  std::string robot_file;  ///< config/robots/<robot>.yaml
  std::string site_file;   ///< config/sites/<site>/site.yaml
  Tree robot_facts;        ///< what this robot has otherwise than its file says: a map, or null
  std::uint32_t domain = 0;
  std::uint64_t seed = 1;
  bool fresh_start = false;  ///< a launch forgets what components kept: a simulated robot stands
                             ///< elsewhere than the last one
  std::string keys;          ///< folder of `usher keys` (`security:`); empty = without security
  ManifestDiscoveryServer discovery_server;
  ManifestFleet fleet;
  std::vector<ManifestHost> hosts;
  std::vector<ManifestComponent> components;
  std::vector<RemovedComponent> removed;
  std::map<std::string, std::string> origins;  ///< of the keys that are given
  std::vector<Finding> findings;               ///< what is wrong with the manifest by itself

  const ManifestComponent* component(const std::string& component_name) const;
  const ManifestHost* host(const std::string& host_name) const;
  /// Where `key` is given, or the manifest itself where it is not.
  std::string origin_of(const std::string& key) const;
};

/// Reads a manifest and what it extends. The config directories hold robots/ and sites/; the first
/// one that has the file that is looked for counts. Fails only when there is no manifest to judge:
/// a file that cannot be read, bad YAML, a circle.
Result<Manifest> read_manifest(const std::string& path,
                               const std::vector<std::string>& config_directories);

/// "; did you mean marvin.yaml?" where a name in the folder of `path` is near to its own, with the
/// same extension unless it has none; else empty.
std::string suggestion_beside(const std::filesystem::path& path);

std::string to_string(Criticality criticality);

}  // namespace usher::operations
