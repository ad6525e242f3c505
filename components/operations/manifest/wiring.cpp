#include "operations/manifest/wiring.hpp"

#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <map>
#include <set>
#include <sstream>

#include "idl/topics.hpp"
#include "operations/manifest/setting.hpp"

namespace usher::operations {

namespace {

using runtime::Contract;

struct CatalogueEntry {
  std::set<std::string> writers;
  bool anybody = false;
};

/// Topics that the deployment's own tools write besides components.
constexpr const char* kOperator = "operator";

const std::map<std::string, CatalogueEntry>& catalogue() {
  static const auto entries = [] {
    std::map<std::string, CatalogueEntry> map;
    std::apply(
        [&map](const auto&... topic) {
          const auto add = [&map](const auto& t) {
            CatalogueEntry entry;
            std::istringstream words{std::string(t.writers)};
            for (std::string word; words >> word;) {
              if (word == "*") entry.anybody = true;
              entry.writers.insert(word);
            }
            map.emplace(std::string(t.name), std::move(entry));
          };
          (add(topic), ...);
        },
        topics::kAll);
    return map;
  }();
  return entries;
}

/// What one device of a robot writes, whichever its make: of two the readers would make one.
bool of_one_device(std::string_view topic) {
  return topic == topics::kBaseStatus.name || topic == topics::kOdom.name ||
         topic == topics::kScan.name;
}

/// Of a component that must stop the robot [s]: its loss is seen, and the first zero reaches the
/// base, within 0.2 s. Heartbeats come every 0.02 s.
constexpr double kLongestCriticalTimeout = 0.15;

struct Writer {
  const ManifestComponent* component;
  const Contract::OutputPort* port;
};

class Judge {
 public:
  Judge(const Manifest& manifest, const Contracts& contracts, std::vector<Finding>& findings)
      : manifest_(manifest), contracts_(contracts), findings_(findings) {
    for (const auto& component : manifest.components) {
      const auto contract = contracts.find(component.type);
      if (contract == contracts.end()) continue;
      for (const auto& port : contract->second.outputs)
        writers_[port.topic].push_back({&component, &port});
    }
  }

  void run() {
    char digest[20];
    std::snprintf(digest, sizeof(digest), "%016llx",
                  static_cast<unsigned long long>(USHER_IDL_DIGEST));
    for (const auto& component : manifest_.components) {
      const auto contract = contracts_.find(component.type);
      if (contract == contracts_.end()) continue;
      if (contract->second.idl_digest != digest) {
        found(Verdict::kWrongIdl,
              "the contract of '" + component.type + "' was made from IDL " +
                  contract->second.idl_digest + ", this program from " + digest,
              component);
      }
      for (const auto& port : contract->second.inputs) judge_input(component, port);
    }
    for (const auto& [topic, writers] : writers_) judge_topic(topic, writers);
    judge_drive_chain();
    judge_groups();
  }

 private:
  /// At the key of the component that is to blame; what its contract brings is at `type`.
  void found(Verdict verdict, std::string text, const ManifestComponent& component,
             const std::string& key = "type") {
    findings_.push_back({verdict, std::move(text), component.origin_of(key)});
  }

  /// Who would write a topic had the manifest not taken him out; null if nobody would.
  const RemovedComponent* removed_writer(const std::string& topic) const {
    const auto writes = [&](const RemovedComponent& removed) {
      const auto contract = contracts_.find(removed.type);
      return contract != contracts_.end() &&
             std::ranges::any_of(contract->second.outputs,
                                 [&](const auto& port) { return port.topic == topic; });
    };
    const auto found = std::ranges::find_if(manifest_.removed, writes);
    return found == manifest_.removed.end() ? nullptr : &*found;
  }

  void judge_input(const ManifestComponent& reader, const Contract::InputPort& port) {
    const auto writers = writers_.find(port.topic);
    if (writers == writers_.end()) {
      const auto entry = catalogue().find(port.topic);
      const bool by_operator =
          entry != catalogue().end() && entry->second.writers.contains(kOperator);
      if (port.optional || by_operator) return;
      const std::string reads = "'" + reader.name + "' reads " + port.topic;
      if (const auto* removed = removed_writer(port.topic)) {
        findings_.push_back({Verdict::kNoWriter,
                             reads + ", which '" + removed->name + "' wrote that is taken out here",
                             removed->origin});
      } else {
        found(Verdict::kNoWriter, reads + ", and nobody writes it", reader);
      }
      return;
    }
    for (const auto& writer : writers->second) {
      if (writer.port->type != port.type) {
        found(Verdict::kTypeMismatch,
              port.topic + " is written as " + writer.port->type + " by '" +
                  writer.component->name + "' and read as " + port.type + " by '" + reader.name +
                  "'",
              reader);
      }
      if ((port.qos.reliable && !writer.port->qos.reliable) ||
          (port.qos.latched && !writer.port->qos.latched)) {
        found(Verdict::kQosMismatch,
              "'" + reader.name + "' asks more of " + port.topic + " than '" +
                  writer.component->name + "' offers",
              reader);
      }
      // One lost or late sample must not make an input stale.
      if (port.max_age > 0.0 && writer.port->rate_hz > 0.0 &&
          port.max_age < 1.5 / writer.port->rate_hz) {
        char text[256];
        std::snprintf(text, sizeof(text),
                      "'%s' accepts %s up to %.3g s old, but '%s' writes it at %.3g Hz only",
                      reader.name.c_str(), port.topic.c_str(), port.max_age,
                      writer.component->name.c_str(), writer.port->rate_hz);
        found(Verdict::kRateTooLow, text, reader);
      }
    }
  }

  void judge_topic(const std::string& topic, const std::vector<Writer>& writers) {
    const auto entry = catalogue().find(topic);
    if (entry == catalogue().end()) {
      found(Verdict::kTypeMismatch,
            "'" + writers.front().component->name + "' writes " + topic +
                ", which the catalogue does not know",
            *writers.front().component);
      return;
    }
    if (entry->second.anybody) return;
    std::map<std::string, const ManifestComponent*> by_role;
    for (const auto& writer : writers) {
      const std::string type = role(writer.component->type);
      if (!entry->second.writers.contains(type)) {
        found(Verdict::kUnauthorizedWriter,
              "'" + writer.component->name + "' (" + writer.component->type + ") may not write " +
                  topic,
              *writer.component);
      }
      const auto [other, first] =
          by_role.emplace(of_one_device(topic) ? std::string() : type, writer.component);
      if (!first) {
        found(Verdict::kTwoWriters,
              topic + " is written by '" + other->second->name + "' and by '" +
                  writer.component->name + "'",
              *writer.component);
      }
    }
  }

  /// Who writes one of the topics, by name.
  std::map<std::string, const ManifestComponent*> writers_of(
      std::initializer_list<const char*> topics) const {
    std::map<std::string, const ManifestComponent*> found;
    for (const auto* topic : topics) {
      const auto writers = writers_.find(topic);
      if (writers == writers_.end()) continue;
      for (const auto& writer : writers->second)
        found.emplace(writer.component->name, writer.component);
    }
    return found;
  }

  /// Its loss must stop the robot, and be noticed in time.
  void judge_critical(const ManifestComponent& component, const std::string& role) {
    const std::string who = "'" + component.name + "' " + role + ": its ";
    if (component.criticality != Criticality::kStop) {
      found(Verdict::kUnsafePolicy,
            who + "criticality must be stop, not " + to_string(component.criticality), component,
            "criticality");
    }
    if (component.heartbeat_timeout > kLongestCriticalTimeout) {
      char text[96];
      std::snprintf(text, sizeof(text), "heartbeat_timeout must be at most %.3g s, not %.3g s",
                    kLongestCriticalTimeout, component.heartbeat_timeout);
      found(Verdict::kUnsafePolicy, who + text, component, "heartbeat_timeout");
    }
  }

  /// Whoever writes a command, a grant or the base's state decides over motion. Nobody drives
  /// without those who tell where, either; they may live elsewhere.
  void judge_drive_chain() {
    const auto chain =
        writers_of({"drive/command", "drive/grant", "base/status", "movement/enable"});
    const auto guides =
        writers_of({"scan", "scan/filtered", "ultrasonic", "ultrasonic/filtered", "whiskers",
                    "local_costmap/costs", "localization/status", "cmd_vel/navigation"});
    for (const auto& [name, component] : guides) {
      if (!chain.contains(name)) judge_critical(*component, "tells where the robot may drive");
    }
    if (chain.empty()) return;
    // Where the base is plugged in is the right one.
    const auto bases = writers_of({"base/status"});
    const ManifestComponent* const base = (bases.empty() ? chain : bases).begin()->second;
    for (const auto& [name, component] : chain) {
      const std::string role = "belongs to the drive chain";
      judge_critical(*component, role);
      if (component->restart != RestartPolicy::kAlways) {
        found(Verdict::kUnsafePolicy, "'" + name + "' " + role + ": its restart must be always",
              *component, "restart");
      }
      if (component->restart_budget < 1) {
        found(Verdict::kUnsafePolicy,
              "'" + name + "' " + role + ": its restart_budget must be at least 1", *component,
              "restart_budget");
      }
      if (component->host != base->host) {
        found(Verdict::kSplitDriveChain,
              "the drive chain must live on one host: '" + base->name + "' is on " + base->host +
                  ", '" + name + "' on " + component->host,
              *component, "host");
      }
    }
  }

  /// A group is one process: one host, one restart policy, a name of its own.
  void judge_groups() {
    std::map<std::string, const ManifestComponent*> groups;
    for (const auto& component : manifest_.components) {
      if (component.group.empty()) continue;
      if (manifest_.component(component.group) != nullptr) {
        found(Verdict::kSplitGroup,
              "group '" + component.group + "' has the name of a component; choose another",
              component, "group");
      }
      const auto [entry, is_first] = groups.emplace(component.group, &component);
      const auto& first = *entry->second;
      if (first.host != component.host) {
        found(Verdict::kSplitGroup,
              "group '" + component.group + "' must live on one host: '" + first.name + "' is on " +
                  first.host + ", '" + component.name + "' on " + component.host,
              component, "host");
      }
      if (first.restart != component.restart || first.restart_budget != component.restart_budget) {
        found(Verdict::kSplitGroup,
              "group '" + component.group +
                  "' must have one restart and restart_budget: those of '" + first.name +
                  "' and '" + component.name + "' differ",
              component, first.restart != component.restart ? "restart" : "restart_budget");
      }
      if (first.real_time != component.real_time) {
        found(Verdict::kSplitGroup,
              "group '" + component.group + "' must have one real_time: those of '" + first.name +
                  "' and '" + component.name + "' differ",
              component, "real_time");
      }
    }
  }

  const Manifest& manifest_;
  const Contracts& contracts_;
  std::vector<Finding>& findings_;
  std::map<std::string, std::vector<Writer>> writers_;
};

}  // namespace

std::string role(const std::string& type) {
  constexpr std::string_view kSimulated = "_sim";
  return type.ends_with(kSimulated) ? type.substr(0, type.size() - kSimulated.size()) : type;
}

void judge_wiring(const Manifest& manifest, const Contracts& contracts,
                  std::vector<Finding>& findings) {
  Judge(manifest, contracts, findings).run();
}

void judge_whiskers(const Contracts& contracts, Deployment& deployment) {
  const auto& components = deployment.manifest.components;
  const bool written = std::ranges::any_of(components, [&](const ManifestComponent& component) {
    const auto contract = contracts.find(component.type);
    return contract != contracts.end() &&
           std::ranges::any_of(contract->second.outputs, [](const auto& port) {
             return port.topic == topics::kWhiskers.name;
           });
  });
  for (std::size_t i = 0; i < components.size() && !written; ++i) {
    const auto required = setting(contracts, deployment, i, "whiskers_required");
    if (!required || required->value.number == 0.0) continue;
    deployment.findings.push_back(
        {Verdict::kNoWriter,
         "'" + components[i].name +
             "' lets nothing move without whiskers, and nobody writes them; a robot that has none "
             "says whiskers_required: false",
         required->origin.empty() ? components[i].origin : required->origin});
  }
}

}  // namespace usher::operations
