#include "operations/manifest/resolve.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "operations/manifest/wiring.hpp"
#include "runtime/parameters/interpret.hpp"

namespace usher::operations {

namespace {

using runtime::Contract;
using runtime::ParameterKind;
using runtime::ParameterValue;

/// A value of a lower or higher layer that may belong to some component.
struct Layer {
  std::map<std::string, ParameterValue> shared;  ///< by full name, "robot.laser.x"
  std::map<std::string, std::map<std::string, ParameterValue>>
      components;  ///< by component name, then parameter
};

bool is_owned(const std::string& name) {
  return name.starts_with("robot.") || name.starts_with("site.");
}

/// Reads the robot's or site's file: `components:` holds settings of single components, all else
/// are facts under PREFIX.
Layer read_layer(const std::string& path, const std::string& prefix,
                 std::vector<Finding>& findings) {
  Layer layer;
  const auto tree = read_tree(path);
  if (!tree) {
    findings.push_back({Verdict::kUnreadable, tree.error(), path});
    return layer;
  }
  Tree facts = *tree;
  std::erase_if(facts.entries, [](const auto& entry) { return entry.first == "components"; });
  const auto add = [](const auto& self, const Tree& node, const std::string& name,
                      Layer& into) -> void {
    if (node.kind != Tree::Kind::kMap) {
      into.shared[name] = {name, node.yaml(), node.origin};
      return;
    }
    for (const auto& [key, value] : node.entries) self(self, value, name + "." + key, into);
  };
  for (const auto& [key, value] : facts.entries) add(add, value, prefix + "." + key, layer);
  if (const Tree* components = tree->find("components"); components != nullptr) {
    for (const auto& [component, settings] : components->entries) {
      for (const auto& [key, value] : settings.entries) {
        layer.components[component][key] = {key, value.yaml(), value.origin};
      }
    }
  }
  return layer;
}

/// Facts that the launcher knows best; a component asks for them like for any parameter.
ParameterValue derived(const std::string& name, const Manifest& manifest) {
  std::string records;
  if (name == "manifest.components") {
    for (const auto& component : manifest.components) {
      records += (records.empty() ? "" : ", ") +
                 ("{name: " + component.name + ", type: " + component.type) +
                 ", host: " + component.host +
                 ", criticality: " + to_string(component.criticality) +
                 ", timeout: " + std::to_string(component.heartbeat_timeout) + " s}";
    }
    return {name, "[" + records + "]", manifest.path};
  }
  return {name, manifest.name, manifest.path};  // manifest.name
}

class Resolver {
 public:
  Resolver(const Manifest& manifest, const Contracts& contracts, Deployment& deployment)
      : manifest_(manifest),
        contracts_(contracts),
        out_(deployment),
        robot_(read_layer(manifest.robot_file, "robot", deployment.findings)),
        site_(read_layer(manifest.site_file, "site", deployment.findings)) {}

  void run(const std::vector<Override>& overrides) {
    for (const auto& component : manifest_.components) resolve(component, overrides);
    report_unknown_facts(robot_);
    report_unknown_facts(site_);
    report_unknown_components(robot_);
    report_unknown_components(site_);
    for (const auto& o : overrides) {
      if (manifest_.component(o.component) == nullptr) {
        found(Verdict::kUnknownKey, "no component '" + o.component + "' in the manifest",
              "command line");
      }
    }
  }

 private:
  void found(Verdict verdict, std::string text, std::string origin) {
    out_.findings.push_back({verdict, std::move(text), std::move(origin)});
  }

  void resolve(const ManifestComponent& component, const std::vector<Override>& overrides) {
    auto& file = out_.files.emplace_back();
    file.component = component.type;
    file.name = component.name;
    file.host = component.host;
    file.domain = manifest_.domain;
    file.seed = manifest_.seed;
    file.critical = component.criticality == Criticality::kStop;
    if (const auto* host = manifest_.host(component.host)) file.peers = host->peers;

    const auto contract = contracts_.find(component.type);
    if (contract == contracts_.end()) {
      found(Verdict::kUnknownType,
            "component '" + component.name + "' has the unknown type '" + component.type + "'",
            component.origin);
      return;
    }
    auto own = layers_of(component, overrides);
    for (const auto& parameter : contract->second.parameters) {
      const auto value = value_of(parameter, own);
      if (value.yaml.empty()) {
        if (parameter.required) {
          found(
              Verdict::kMissingValue,
              "'" + parameter.name + "' of '" + component.name + "' must be set: " + parameter.text,
              is_owned(parameter.name)
                  ? (parameter.name.starts_with("robot.") ? manifest_.robot_file
                                                          : manifest_.site_file)
                  : component.origin);
        }
        continue;
      }
      judge(parameter, value, file);
    }
    for (const auto& [name, value] : own) {
      if (is_owned(name)) {
        found(Verdict::kMisplaced,
              "'" + name + "' can be set only in the " +
                  (name.starts_with("robot.") ? "robot" : "site") + "'s file",
              value.origin);
      } else {
        found(Verdict::kUnknownKey,
              "component '" + component.name + "' has no parameter '" + name + "'", value.origin);
      }
    }
  }

  /// The component's own settings, later layers over earlier ones.
  std::map<std::string, ParameterValue> layers_of(const ManifestComponent& component,
                                                  const std::vector<Override>& overrides) {
    std::map<std::string, ParameterValue> own;
    for (const Layer* layer : {&robot_, &site_}) {
      const auto settings = layer->components.find(component.name);
      if (settings == layer->components.end()) continue;
      for (const auto& [name, value] : settings->second) own[name] = value;
    }
    for (const auto& value : component.parameters) own[value.name] = value;
    for (const auto& o : overrides) {
      if (o.component == component.name) own[o.parameter] = {o.parameter, o.value, "command line"};
    }
    return own;
  }

  /// Takes the parameter's value out of the settings; empty when nobody sets it.
  ParameterValue value_of(const Contract::Parameter& parameter,
                          std::map<std::string, ParameterValue>& own) {
    if (parameter.name.starts_with("manifest.")) return derived(parameter.name, manifest_);
    if (is_owned(parameter.name)) {
      const Layer& layer = parameter.name.starts_with("robot.") ? robot_ : site_;
      const auto value = layer.shared.find(parameter.name);
      return value == layer.shared.end() ? ParameterValue{} : value->second;
    }
    const auto value = own.extract(parameter.name);
    return value ? value.mapped() : ParameterValue{};
  }

  void judge(const Contract::Parameter& parameter, ParameterValue value,
             runtime::ParameterFile& file) {
    if (const auto given = runtime::interpret(parameter, value); !given) {
      found(Verdict::kWrongValue, given.error(), value.origin);
      return;
    }
    if (parameter.kind == ParameterKind::kFile) {
      const std::filesystem::path path(value.yaml);
      const auto folder =
          std::filesystem::path(value.origin.substr(0, value.origin.rfind(':'))).parent_path();
      const auto absolute =
          std::filesystem::absolute(path.is_absolute() ? path : folder / path).lexically_normal();
      if (!std::filesystem::exists(absolute)) {
        found(Verdict::kMissingFile,
              "'" + parameter.name + "' names " + absolute.string() + ", which is not there",
              value.origin);
      }
      value.yaml = absolute.string();
    }
    file.values.push_back(std::move(value));
  }

  /// A fact of the robot or site that no contract at all asks for is a typing error.
  void report_unknown_facts(const Layer& layer) {
    std::set<std::string> known;
    for (const auto& [type, contract] : contracts_) {
      for (const auto& parameter : contract.parameters) known.insert(parameter.name);
    }
    for (const auto& [name, value] : layer.shared) {
      if (!known.contains(name)) {
        found(Verdict::kUnknownKey,
              "no component asks for '" + name.substr(name.find('.') + 1) + "'", value.origin);
      }
    }
  }

  void report_unknown_components(const Layer& layer) {
    for (const auto& [component, settings] : layer.components) {
      // Settings for a component that this manifest leaves out are fine; those for one that does
      // not exist are not.
      if (manifest_.component(component) == nullptr && !contracts_.contains(component) &&
          !settings.empty()) {
        found(Verdict::kUnknownKey, "settings for the unknown component '" + component + "'",
              settings.begin()->second.origin);
      }
    }
  }

  const Manifest& manifest_;
  const Contracts& contracts_;
  Deployment& out_;
  Layer robot_;
  Layer site_;
};

}  // namespace

Result<Contracts> read_contracts(const std::string& directory) {
  Contracts contracts;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
    if (entry.path().extension() != ".yaml") continue;
    std::ifstream file(entry.path());
    const std::string text(std::istreambuf_iterator<char>(file), {});
    auto contract = runtime::contract_from_yaml(text, entry.path().string());
    if (!contract) return Error{contract.error()};
    const std::string type = contract->component;
    contracts.emplace(type, std::move(contract).value());
  }
  if (error) return Error{"cannot read the contracts in " + directory + ": " + error.message()};
  if (contracts.empty()) return Error{"no contract in " + directory};
  return contracts;
}

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kUnreadable:
      return "unreadable";
    case Verdict::kUnknownType:
      return "unknown type";
    case Verdict::kUnknownKey:
      return "unknown key";
    case Verdict::kWrongValue:
      return "wrong value";
    case Verdict::kMissingValue:
      return "missing value";
    case Verdict::kMissingFile:
      return "missing file";
    case Verdict::kMisplaced:
      return "misplaced";
    case Verdict::kNoWriter:
      return "no writer";
    case Verdict::kTwoWriters:
      return "two writers";
    case Verdict::kUnauthorizedWriter:
      return "unauthorized writer";
    case Verdict::kTypeMismatch:
      return "type mismatch";
    case Verdict::kQosMismatch:
      return "QoS mismatch";
    case Verdict::kRateTooLow:
      return "rate too low";
    case Verdict::kUnsafePolicy:
      return "unsafe policy";
    case Verdict::kSplitDriveChain:
      return "split drive chain";
    case Verdict::kSplitGroup:
      return "split group";
    case Verdict::kWrongIdl:
      return "wrong IDL";
  }
  return "?";
}

Deployment resolve(const Manifest& manifest, const Contracts& contracts,
                   const std::vector<Override>& overrides) {
  Deployment deployment;
  deployment.manifest = manifest;
  Resolver(manifest, contracts, deployment).run(overrides);
  judge_wiring(manifest, contracts, deployment.findings);
  return deployment;
}

}  // namespace usher::operations
