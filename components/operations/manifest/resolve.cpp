#include "operations/manifest/resolve.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "foundation/text/suggestion.hpp"
#include "idl/topics.hpp"
#include "operations/manifest/dialogue.hpp"
#include "operations/manifest/site.hpp"
#include "operations/manifest/wiring.hpp"
#include "runtime/guard/port.hpp"
#include "runtime/parameters/interpret.hpp"

namespace usher::operations {

namespace {

using runtime::Contract;
using runtime::ParameterKind;
using runtime::ParameterValue;

constexpr const char* kCommandLine = "command line";

/// A value of a lower or higher layer that may belong to some component.
struct Layer {
  std::map<std::string, ParameterValue> shared;  ///< by full name, "robot.laser.x"
  std::map<std::string, std::map<std::string, ParameterValue>>
      components;     ///< by component name, then parameter
  bool read = false;  ///< the file is there and is YAML
};

Movement movement_of(const Contract& contract) {
  Movement movement = Movement::kNone;
  for (const auto& output : contract.outputs) {
    if (output.topic == topics::kBaseStatus.name) return Movement::kBaseDriver;
    if (output.topic.starts_with("cmd_vel/")) movement = Movement::kCommands;
  }
  return movement;
}

/// Who alone may set a parameter of this name; empty = anybody.
std::string owner_of(const std::string& name) {
  if (name.starts_with("robot.")) return "the robot's file or the manifest's robot_facts";
  if (name.starts_with("site.")) return "the site's file";
  if (name.starts_with("manifest.")) return "the launcher";
  return {};
}

/// Puts the leaves of a map under their dotted names.
void flatten(const Tree& node, const std::string& name, Layer& layer,
             std::vector<Finding>& findings) {
  if (node.kind == Tree::Kind::kMap) {
    for (const auto& [key, value] : node.entries) flatten(value, name + "." + key, layer, findings);
    return;
  }
  if (!layer.shared.emplace(name, ParameterValue{name, node.yaml(), node.origin}).second)
    findings.push_back({Verdict::kWrongValue, "'" + name + "' is given twice", node.origin});
}

/// What the manifest could have named instead of the file, which is not there: of robots the files
/// beside it, of sites the folders beside its own.
std::string others_than(const std::filesystem::path& file, const std::string& prefix) {
  return suggestion_beside(prefix == "robot" ? file.parent_path() / file.stem()
                                             : file.parent_path());
}

/// Reads the robot's or site's file, which the manifest names at `origin`: `components:` holds
/// settings of single components, all else are facts under PREFIX.
Layer read_layer(const std::string& path, const std::string& prefix, const std::string& origin,
                 std::vector<Finding>& findings) {
  Layer layer;
  if (path.empty()) return layer;  // not named, which is a finding already
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    findings.push_back(
        {Verdict::kMissingFile,
         "'" + prefix + "' names " + path + ", which is not there" + others_than(path, prefix),
         origin});
    return layer;
  }
  const auto tree = read_tree(path);
  if (!tree) {
    findings.push_back(finding_of(Verdict::kUnreadable, tree.error(), path));
    return layer;
  }
  const auto is_map = [&](const Tree& node, const std::string& what) {
    if (node.kind == Tree::Kind::kMap) return true;
    if (node.kind != Tree::Kind::kNull)
      findings.push_back(
          {Verdict::kWrongValue, what + " must be a map, got " + brief(node.yaml()), node.origin});
    return false;
  };
  layer.read = true;
  if (!is_map(*tree, "the " + prefix + "'s file")) return layer;
  for (const auto& [key, value] : tree->entries) {
    if (key != "components") {
      flatten(value, prefix + "." + key, layer, findings);
    } else if (is_map(value, "'components'")) {
      for (const auto& [component, settings] : value.entries) {
        if (!is_map(settings, "the settings of '" + component + "'")) continue;
        for (const auto& [name, setting] : settings.entries)
          layer.components[component][name] = {name, setting.yaml(), setting.origin};
      }
    }
  }
  return layer;
}

/// Lays what the manifest says of its robot over the robot's file.
void lay_facts(const Manifest& manifest, Layer& robot, std::vector<Finding>& findings) {
  Layer facts;
  for (const auto& [key, value] : manifest.robot_facts.entries)
    flatten(value, "robot." + key, facts, findings);
  for (auto& [name, value] : facts.shared) robot.shared.insert_or_assign(name, std::move(value));
}

/// Facts that the launcher knows best; a component asks for them like for any parameter.
ParameterValue derived(const std::string& name, const Manifest& manifest) {
  const std::string origin = manifest.path + ":1";
  if (name != "manifest.components")  // manifest.name
    return {name, Tree::word(manifest.name, origin).yaml(), origin};
  std::string records;
  for (const auto& component : manifest.components) {
    records += (records.empty() ? "" : ", ") +
               ("{name: " + component.name + ", type: " + component.type) +
               ", host: " + component.host + ", criticality: " + to_string(component.criticality) +
               ", timeout: " + std::to_string(component.heartbeat_timeout) + " s}";
  }
  return {name, "[" + records + "]", origin};
}

class Resolver {
 public:
  Resolver(const Manifest& manifest, const Contracts& contracts, Deployment& deployment)
      : manifest_(manifest),
        contracts_(contracts),
        out_(deployment),
        robot_(read_layer(manifest.robot_file, "robot", manifest.origin_of("robot"),
                          deployment.findings)),
        site_(read_layer(manifest.site_file, "site", manifest.origin_of("site"),
                         deployment.findings)) {
    lay_facts(manifest, robot_, deployment.findings);
  }

  void run(const std::vector<Override>& overrides) {
    if (!manifest_.fleet.robot.empty() && !manifest_.keys.empty())
      found(Verdict::kWrongValue,
            "a fleet and security do not go together: nothing on the fleet's domain is signed",
            manifest_.origin_of("fleet"));
    for (const auto& component : manifest_.components) resolve(component, overrides);
    report_shared_devices();
    report_other_base();
    report_unknown_facts(robot_);
    report_unknown_facts(site_);
    report_unknown_components(robot_);
    report_unknown_components(site_);
    for (const auto& o : overrides) {
      if (manifest_.component(o.component) == nullptr) {
        found(Verdict::kUnknownKey,
              "no component '" + o.component + "' in the manifest" +
                  suggestion(o.component, component_names()),
              kCommandLine);
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
    file.discovery_server = manifest_.discovery_server.locator();
    if (!manifest_.keys.empty()) file.identity = manifest_.keys + "/" + component.name;
    file.robot = manifest_.fleet.robot;
    file.fleet_domain = manifest_.fleet.domain;
    file.fleet_peers = manifest_.fleet.peers;

    const auto contract = contracts_.find(component.type);
    if (contract == contracts_.end()) {
      found(Verdict::kUnknownType,
            "component '" + component.name + "' has the unknown type '" + component.type + "'" +
                suggestion(component.type, known_types()),
            component.origin_of("type"));
      return;
    }
    // Who may move the robot shows life at 50 Hz, so that an impostor of its name is soon found
    // out; what stands in for a device must be as prompt as one.
    for (const auto& output : contract->second.outputs) {
      file.critical =
          file.critical || output.topic.starts_with("cmd_vel/") || output.topic.starts_with("sim/");
    }
    auto own = layers_of(component, overrides);
    for (const auto& parameter : contract->second.parameters) {
      const auto value = value_of(parameter, own);
      if (value.yaml.empty()) {
        if (parameter.required && !lies_in_a_missing_file(parameter.name)) {
          found(
              Verdict::kMissingValue,
              "'" + parameter.name + "' of '" + component.name + "' must be set: " + parameter.text,
              place_for(parameter.name, component));
        }
        continue;
      }
      judge(parameter, value, file);
    }
    for (const auto& [name, value] : own) {
      if (const auto owner = owner_of(name); !owner.empty()) {
        found(Verdict::kMisplaced, "'" + name + "' can be set only by " + owner, value.origin);
      } else {
        std::vector<std::string> known;
        for (const auto& parameter : contract->second.parameters) known.push_back(parameter.name);
        found(Verdict::kUnknownKey,
              "component '" + component.name + "' has no parameter '" + name + "'" +
                  suggestion(name, known),
              value.origin);
      }
    }
  }

  std::vector<std::string> known_types() const {
    std::vector<std::string> types;
    for (const auto& [type, contract] : contracts_) types.push_back(type);
    return types;
  }

  std::vector<std::string> component_names() const {
    std::vector<std::string> names;
    for (const auto& component : manifest_.components) names.push_back(component.name);
    return names;
  }

  /// That the robot's or the site's file is missing is a finding already, and one is enough.
  bool lies_in_a_missing_file(const std::string& parameter) const {
    return (parameter.starts_with("robot.") && !robot_.read) ||
           (parameter.starts_with("site.") && !site_.read);
  }

  /// Where a value that is missing would have to be set.
  std::string place_for(const std::string& parameter, const ManifestComponent& component) const {
    if (parameter.starts_with("robot.")) return manifest_.robot_file + ":1";
    if (parameter.starts_with("site.")) return manifest_.site_file + ":1";
    return component.origin;
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
      if (o.component != component.name) continue;
      const auto value = parse_tree(o.value, kCommandLine);
      if (value) {
        own[o.parameter] = {o.parameter, value->yaml(), kCommandLine};
      } else {
        const auto finding = finding_of(Verdict::kWrongValue, value.error(), kCommandLine);
        found(finding.verdict, o.component + "." + o.parameter + ": " + finding.text, kCommandLine);
      }
    }
    return own;
  }

  /// Takes the parameter's value out of the settings; empty when nobody sets it.
  ParameterValue value_of(const Contract::Parameter& parameter,
                          std::map<std::string, ParameterValue>& own) {
    if (parameter.name.starts_with("manifest.")) return derived(parameter.name, manifest_);
    if (const auto& start = manifest_.fleet.start;
        !start.yaml.empty() && parameter.name == start.name)
      return start;
    if (!owner_of(parameter.name).empty()) {
      const Layer& layer = parameter.name.starts_with("robot.") ? robot_ : site_;
      const auto value = layer.shared.find(parameter.name);
      return value == layer.shared.end() ? ParameterValue{} : value->second;
    }
    const auto value = own.extract(parameter.name);
    return value ? value.mapped() : ParameterValue{};
  }

  void judge(const Contract::Parameter& parameter, ParameterValue value,
             runtime::ParameterFile& file) {
    const auto given = runtime::interpret(parameter, value);
    if (!given && value.name.starts_with("manifest.")) return;  // found where the manifest was read
    if (!given) {
      out_.findings.push_back(finding_of(Verdict::kWrongValue, given.error(), value.origin));
      return;
    }
    if (parameter.kind == ParameterKind::kFile && !given->text.empty()) {
      std::error_code ignored;
      if (!std::filesystem::exists(given->text, ignored) ||
          std::filesystem::is_directory(given->text, ignored)) {
        found(Verdict::kMissingFile,
              "'" + parameter.name + "' names " + given->text + ", which is not there",
              value.origin);
      }
      value.yaml = Tree::word(given->text, value.origin).yaml();
    }
    if (is_stream(parameter)) {
      if (const auto address = runtime::StreamAddress::parse(given->text); !address)
        found(Verdict::kWrongValue, "'" + parameter.name + "': " + address.error(), value.origin);
    }
    file.values.push_back(std::move(value));
  }

  /// A text whose default is a stream's address is one.
  static bool is_stream(const Contract::Parameter& parameter) {
    return parameter.kind == ParameterKind::kText &&
           runtime::StreamAddress::parse(parameter.fallback);
  }

  /// Two components of one host that read one device take each other's bytes.
  void report_shared_devices() {
    std::map<std::pair<std::string, std::string>, std::string> users;  // of host and device
    for (const auto& file : out_.files) {
      const auto contract = contracts_.find(file.component);
      if (contract == contracts_.end()) continue;
      for (const auto& parameter : contract->second.parameters) {
        if (!is_stream(parameter)) continue;
        const auto set = std::ranges::find(file.values, parameter.name, &ParameterValue::name);
        const bool given = set != file.values.end();
        const auto value = given ? runtime::interpret(parameter, *set)
                                 : runtime::interpret(parameter, {.yaml = parameter.fallback});
        const auto address = value ? runtime::StreamAddress::parse(value->text)
                                   : Result<runtime::StreamAddress>(Error{value.error()});
        using Kind = runtime::StreamAddress::Kind;
        if (!address || (address->kind != Kind::kSerial && address->kind != Kind::kDevice))
          continue;
        const auto [user, first] = users.emplace(std::pair(file.host, address->target), file.name);
        if (!first) {
          found(Verdict::kWrongValue,
                "'" + user->second + "' and '" + file.name + "' of host '" + file.host +
                    "' both open " + address->target,
                given ? set->origin : manifest_.component(file.name)->origin_of("type"));
        }
      }
    }
  }

  /// With the file of a robot on another base, a base that leans is taken for one that does not.
  void report_other_base() {
    constexpr std::array<std::pair<const char*, const char*>, 2> kBases{
        {{"segway_rmp", "segway"}, {"p3dx", "pioneer"}}};
    Contract::Parameter base;
    base.kind = ParameterKind::kText;
    const auto given = robot_.shared.find("robot.base");
    const bool said = given != robot_.shared.end();
    const auto read = said ? runtime::interpret(base, given->second)
                           : runtime::interpret(base, {.yaml = "segway"});
    if (!read) return;  // found where it is judged
    for (const auto& [driver, kind] : kBases) {
      for (const auto& component : manifest_.components) {
        if (role(component.type) != driver || read->text == kind) continue;
        found(Verdict::kWrongValue,
              "'" + component.name + "' drives a " + kind + ", and the robot's file says base: " +
                  read->text + (said ? "" : " (by saying nothing)") + ": is it this robot's?",
              said ? given->second.origin : manifest_.origin_of("robot"));
      }
    }
  }

  /// A fact of the robot or site that no contract at all asks for is a typing error.
  void report_unknown_facts(const Layer& layer) {
    std::set<std::string> known;
    for (const auto& [type, contract] : contracts_) {
      for (const auto& parameter : contract.parameters) known.insert(parameter.name);
    }
    for (const auto& [name, value] : layer.shared) {
      if (known.contains(name)) continue;
      const auto prefix = name.find('.') + 1;  // "robot.", "site."
      std::vector<std::string> facts;
      for (const auto& fact : known) {
        if (fact.starts_with(name.substr(0, prefix))) facts.push_back(fact.substr(prefix));
      }
      const std::string fact = name.substr(prefix);
      found(Verdict::kUnknownKey, "no component asks for '" + fact + "'" + suggestion(fact, facts),
            value.origin);
    }
  }

  void report_unknown_components(const Layer& layer) {
    for (const auto& [component, settings] : layer.components) {
      // Settings for a component that this manifest leaves out are fine; those for one that does
      // not exist are not.
      if (manifest_.component(component) == nullptr && !contracts_.contains(component) &&
          !settings.empty()) {
        found(Verdict::kUnknownKey,
              "settings for the unknown component '" + component + "'" +
                  suggestion(component, known_types()),
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

Deployment resolve(const Manifest& manifest, const Contracts& contracts,
                   const std::vector<Override>& overrides) {
  Deployment deployment;
  deployment.manifest = manifest;
  deployment.findings = manifest.findings;
  Resolver(manifest, contracts, deployment).run(overrides);
  judge_wiring(manifest, contracts, deployment.findings);
  judge_dialogue(contracts, deployment);
  judge_whiskers(contracts, deployment);
  judge_site(contracts, deployment);
  for (const auto& component : manifest.components) {
    const auto contract = contracts.find(component.type);
    if (contract != contracts.end())
      deployment.movement[component.name] = movement_of(contract->second);
  }
  return deployment;
}

}  // namespace usher::operations
