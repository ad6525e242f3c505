#include "operations/manifest/manifest.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <initializer_list>
#include <string_view>

#include "foundation/text/suggestion.hpp"
#include "runtime/parameters/units.hpp"

namespace usher::operations {

namespace {

constexpr std::size_t kMaxExtends = 8;
constexpr std::size_t kLongestName = 64;

/// Reads a map strictly: every key must be taken; all that is wrong becomes a finding.
class Fields {
 public:
  Fields(const Tree& tree, std::string what, std::vector<Finding>& findings)
      : tree_(tree), what_(std::move(what)), findings_(findings) {
    if (tree.kind != Tree::Kind::kMap && tree.kind != Tree::Kind::kNull)
      wrong("must be a map, got " + brief(tree.yaml()), tree);
  }

  const Tree* take(const std::string& key) {
    taken_.push_back(key);
    return tree_.find(key);
  }

  void text(const std::string& key, std::string& value) {
    const Tree* node = take(key);
    if (node == nullptr) return;
    if (node->kind != Tree::Kind::kScalar || node->scalar.empty()) {
      wrong("'" + key + "' must be a word, got " + brief(node->yaml()), *node);
    } else {
      value = node->scalar;
    }
  }

  template <class Number>
  void number(const std::string& key, Number low, Number high, Number& value) {
    const Tree* node = take(key);
    if (node == nullptr) return;
    Number read{};
    const char* end = node->scalar.data() + node->scalar.size();
    const auto [rest, error] = std::from_chars(node->scalar.data(), end, read);
    if (node->kind != Tree::Kind::kScalar || error != std::errc() || rest != end ||
        !(read >= low && read <= high)) {
      wrong("'" + key + "' must be a " + (std::is_integral_v<Number> ? "whole number" : "number") +
                " in [" + runtime::shortest(static_cast<double>(low)) + ", " +
                runtime::shortest(static_cast<double>(high)) + "], got " + brief(node->yaml()),
            *node);
    } else {
      value = read;
    }
  }

  template <class Enum>
  void one_of(const std::string& key,
              std::initializer_list<std::pair<std::string_view, Enum>> options, Enum& value) {
    const Tree* node = take(key);
    if (node == nullptr) return;
    std::string names;
    for (const auto& [name, option] : options) {
      if (node->scalar == name) {
        value = option;
        return;
      }
      names += (names.empty() ? "" : ", ") + std::string(name);
    }
    wrong("'" + key + "' must be one of " + names + ", got " + brief(node->yaml()), *node);
  }

  void texts(const std::string& key, std::vector<std::string>& values) {
    const Tree* node = take(key);
    if (node == nullptr) return;
    if (node->kind != Tree::Kind::kList)
      wrong("'" + key + "' must be a list, got " + brief(node->yaml()), *node);
    for (const auto& item : node->items) {
      if (item.kind == Tree::Kind::kScalar && !item.scalar.empty()) {
        values.push_back(item.scalar);
      } else {
        wrong("'" + key + "' must hold words, got " + brief(item.yaml()), item);
      }
    }
  }

  /// A map of whatever keys; null where it is not there, which `required` makes a finding.
  const Tree* map(const std::string& key, bool required = false) {
    const Tree* node = take(key);
    if (node != nullptr && node->kind != Tree::Kind::kMap && node->kind != Tree::Kind::kNull) {
      wrong("'" + key + "' must be a map, got " + brief(node->yaml()), *node);
      return nullptr;
    }
    if (required && (node == nullptr || node->entries.empty())) missing(key);
    return node;
  }

  /// A key that is there and says nothing is wrong already.
  void missing(const std::string& key) {
    if (const Tree* node = tree_.find(key); node != nullptr && node->kind == Tree::Kind::kScalar)
      return;
    findings_.push_back(
        {Verdict::kMissingValue, what_ + ": '" + key + "' must be given", tree_.origin});
  }

  void wrong(const std::string& text, const Tree& node) {
    findings_.push_back({Verdict::kWrongValue, what_ + ": " + text, node.origin});
  }

  /// The keys that were asked for: "name, robot, site".
  std::string known() const {
    std::string names;
    for (const auto& name : taken_) names += (names.empty() ? "" : ", ") + name;
    return names;
  }

  /// Reports the keys that nobody took.
  void finish() {
    for (const auto& [key, value] : tree_.entries) {
      if (std::find(taken_.begin(), taken_.end(), key) != taken_.end()) continue;
      const std::string meant = suggestion(key, taken_);
      findings_.push_back({Verdict::kUnknownKey,
                           what_ + ": unknown key '" + brief(key) + "'" +
                               (meant.empty() ? ", expected one of " + known() : meant),
                           value.origin});
    }
  }

 private:
  const Tree& tree_;
  std::string what_;
  std::vector<Finding>& findings_;
  std::vector<std::string> taken_;
};

/// The tree of a manifest with everything that it extends below it. `open` are the manifests that
/// led here.
Result<Tree> read_extended(const std::filesystem::path& path, std::vector<std::string> open,
                           std::vector<Finding>& findings) {
  auto tree = read_tree(path.string());
  if (!tree) return tree;
  if (tree->kind != Tree::Kind::kMap)
    return Error{"a manifest must be a map (" + tree->origin + ")"};
  const Tree* extends = tree->find("extends");
  if (extends == nullptr) return tree;
  if (extends->kind != Tree::Kind::kScalar || extends->scalar.empty())
    return Error{"'extends' must name a file, got " + brief(extends->yaml()) + " (" +
                 extends->origin + ")"};
  std::error_code ignored;
  open.push_back(std::filesystem::weakly_canonical(path, ignored).string());
  const auto base_path = (path.parent_path() / extends->scalar).lexically_normal();
  const auto canonical = std::filesystem::weakly_canonical(base_path, ignored).string();
  if (std::find(open.begin(), open.end(), canonical) != open.end())
    return Error{"manifests extend one another in a circle (" + extends->origin + ")"};
  if (open.size() > kMaxExtends)
    return Error{"more than 8 manifests extend one another (" + extends->origin + ")"};
  if (!std::filesystem::is_regular_file(base_path, ignored))
    return Error{"'extends' names " + base_path.string() + ", which is no file" +
                 suggestion_beside(base_path) + " (" + extends->origin + ")"};
  auto base = read_extended(base_path, std::move(open), findings);
  if (!base) return base;
  std::erase_if(tree->entries, [](const auto& entry) { return entry.key == "extends"; });
  return overlay(std::move(base).value(), *tree, findings);
}

/// Names become file names, words in lists and names of participants. Says whether it is one.
bool judge_name(const std::string& name, const std::string& what, const std::string& origin,
                std::vector<Finding>& findings) {
  const bool good =
      !name.empty() && name.size() <= kLongestName &&
      std::all_of(name.begin(), name.end(), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
      });
  if (good) return true;
  findings.push_back({Verdict::kWrongValue,
                      what + " name must be 1 to 64 letters, digits, '_' or '-', got " +
                          brief(Tree::word(name, {}).yaml()),
                      origin});
  return false;
}

ManifestComponent read_component(const std::string& name, const Tree& tree,
                                 std::vector<Finding>& findings) {
  ManifestComponent component;
  component.name = name;
  component.type = name;
  component.origin = tree.origin;
  for (const auto& [key, value] : tree.entries) component.origins[key] = value.origin;
  judge_name(name, "a component's", tree.origin, findings);
  Fields fields(tree, "component '" + name + "'", findings);
  fields.text("type", component.type);
  fields.text("host", component.host);
  fields.text("group", component.group);
  if (!component.group.empty())
    judge_name(component.group, "a group's", component.origin_of("group"), findings);
  fields.one_of("criticality",
                {{"stop", Criticality::kStop},
                 {"degrade", Criticality::kDegrade},
                 {"notify", Criticality::kNotify}},
                component.criticality);
  fields.one_of("restart",
                {{"always", RestartPolicy::kAlways},
                 {"on_failure", RestartPolicy::kOnFailure},
                 {"never", RestartPolicy::kNever}},
                component.restart);
  fields.number("restart_budget", 0, 1000, component.restart_budget);
  fields.number("heartbeat_timeout", 0.05, 60.0, component.heartbeat_timeout);
  fields.number("start_patience", 1.0, 600.0, component.start_patience);
  fields.one_of("real_time", {{"true", true}, {"false", false}}, component.real_time);
  if (const Tree* parameters = fields.map("parameters"); parameters != nullptr) {
    for (const auto& [key, value] : parameters->entries)
      component.parameters.push_back({key, value.yaml(), value.origin});
  }
  fields.finish();
  return component;
}

bool is_address(const std::string& text) {
  in_addr ignored{};
  return inet_pton(AF_INET, text.c_str(), &ignored) == 1;
}

/// Where a key of a map is given, or the map where it is not.
const std::string& origin_of(const Tree& tree, const std::string& key) {
  const Tree* node = tree.find(key);
  return node == nullptr ? tree.origin : node->origin;
}

void judge_address(const std::string& what, const std::string& address, const std::string& origin,
                   std::vector<Finding>& findings) {
  if (is_address(address)) return;
  findings.push_back({Verdict::kWrongValue,
                      what + " must be an IPv4 address like 10.0.0.2, got " +
                          brief(Tree::word(address, {}).yaml()),
                      origin});
}

ManifestHost read_host(const std::string& name, const Tree& tree, std::vector<Finding>& findings) {
  ManifestHost host;
  host.name = name;
  host.origin = tree.origin;
  judge_name(name, "a host's", tree.origin, findings);
  Fields fields(tree, "host '" + name + "'", findings);
  fields.texts("peers", host.peers);
  fields.finish();
  for (const auto& peer : host.peers)
    judge_address("a peer of '" + name + "'", peer, origin_of(tree, "peers"), findings);
  return host;
}

void judge_host(const std::string& who, const std::string& name, const std::string& origin,
                Manifest& manifest) {
  if (manifest.hosts.empty() || manifest.host(name) != nullptr) return;
  std::string known;
  for (const auto& host : manifest.hosts) known += (known.empty() ? "" : ", ") + host.name;
  if (name.empty()) {
    manifest.findings.push_back({Verdict::kMissingValue,
                                 who +
                                     " has no host, neither here nor in what this manifest "
                                     "extends; expected one of " +
                                     known,
                                 origin});
    return;
  }
  manifest.findings.push_back(
      {Verdict::kUnknownHost,
       who + " runs on the unknown host '" + name + "', expected one of " + known, origin});
}

ManifestDiscoveryServer read_discovery_server(const Tree& tree, std::vector<Finding>& findings) {
  ManifestDiscoveryServer server;
  Fields fields(tree, "the discovery server", findings);
  fields.text("host", server.host);
  fields.text("address", server.address);
  fields.number("port", std::uint16_t{1024}, std::uint16_t{65535}, server.port);
  fields.finish();
  if (server.host.empty()) fields.missing("host");
  judge_address("the discovery server's address", server.address, origin_of(tree, "address"),
                findings);
  return server;
}

ManifestFleet read_fleet(const Tree& tree, const Manifest& manifest,
                         std::vector<Finding>& findings) {
  ManifestFleet fleet;
  Fields fields(tree, "the fleet", findings);
  fields.text("robot", fleet.robot);
  fields.number("domain", std::uint32_t{0}, std::uint32_t{232}, fleet.domain);
  fields.texts("peers", fleet.peers);
  if (const Tree* start = fields.take("start"); start != nullptr)
    fleet.start = {"site.initial_pose", start->yaml(), start->origin};
  fields.finish();
  if (tree.find("domain") == nullptr) fields.missing("domain");
  if (fleet.robot.empty()) fields.missing("robot");
  if (!fleet.robot.empty()) judge_name(fleet.robot, "a robot's", tree.origin, findings);
  for (const auto& peer : fleet.peers)
    judge_address("a peer of the fleet", peer, origin_of(tree, "peers"), findings);
  if (fleet.domain == manifest.domain)
    fields.wrong(
        "its domain must not be the robot's own, both are " + std::to_string(manifest.domain),
        tree);
  return fleet;
}

/// A path is meant from the folder of the file that gives it.
std::string beside(const std::string& origin, const std::string& path) {
  const std::filesystem::path file = origin.substr(0, origin.rfind(':'));
  std::error_code ignored;
  return std::filesystem::absolute(file.parent_path() / path, ignored).lexically_normal().string();
}

/// The first one that is there; the first one at all where none is, to be named in the error.
std::string find_config(const std::vector<std::string>& directories, const std::string& relative) {
  std::error_code ignored;
  for (const auto& directory : directories) {
    auto path = directory + "/" + relative;
    if (std::filesystem::exists(path, ignored)) return path;
  }
  return directories.empty() ? relative : directories.front() + "/" + relative;
}

}  // namespace

const std::string& ManifestComponent::origin_of(const std::string& key) const {
  const auto found = origins.find(key);
  return found == origins.end() ? origin : found->second;
}

const ManifestComponent* Manifest::component(const std::string& component_name) const {
  const auto found =
      std::find_if(components.begin(), components.end(),
                   [&](const ManifestComponent& c) { return c.name == component_name; });
  return found == components.end() ? nullptr : &*found;
}

const ManifestHost* Manifest::host(const std::string& host_name) const {
  const auto found = std::find_if(hosts.begin(), hosts.end(),
                                  [&](const ManifestHost& h) { return h.name == host_name; });
  return found == hosts.end() ? nullptr : &*found;
}

std::string Manifest::origin_of(const std::string& key) const {
  const auto found = origins.find(key);
  return found == origins.end() ? path + ":1" : found->second;
}

std::string to_string(Criticality criticality) {
  switch (criticality) {
    case Criticality::kStop:
      return "stop";
    case Criticality::kDegrade:
      return "degrade";
    case Criticality::kNotify:
      return "notify";
  }
  return "stop";
}

std::string suggestion_beside(const std::filesystem::path& path) {
  if (path.filename().empty()) return {};
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  std::vector<std::string> known;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (!path.has_extension() && entry.path().stem() == path.stem())
      return "; did you mean " + entry.path().filename().string() + "?";
    if (!path.has_extension() || entry.path().extension() == path.extension())
      known.push_back(entry.path().stem().string());
  }
  std::sort(known.begin(), known.end());
  std::string meant = suggestion(path.stem().string(), known);
  if (!meant.empty()) meant.insert(meant.size() - 1, path.extension().string());  // before the '?'
  return meant;
}

Result<Manifest> read_manifest(const std::string& path,
                               const std::vector<std::string>& config_directories) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    return Error{"there is no such file" + suggestion_beside(path) + " (" + path + ")"};
  Manifest manifest;
  const auto tree = read_extended(path, {}, manifest.findings);
  if (!tree) return Error{tree.error()};

  manifest.path = path;
  manifest.name = std::filesystem::path(path).stem().string();
  Fields fields(*tree, "manifest", manifest.findings);
  std::string robot;
  std::string site;
  fields.text("name", manifest.name);
  fields.text("robot", robot);
  fields.text("site", site);
  fields.number("domain", std::uint32_t{0}, std::uint32_t{232}, manifest.domain);
  fields.number("seed", std::uint64_t{0}, ~std::uint64_t{0}, manifest.seed);
  fields.one_of("fresh_start", {{"true", true}, {"false", false}}, manifest.fresh_start);
  if (const Tree* facts = fields.map("robot_facts"); facts != nullptr)
    manifest.robot_facts = *facts;
  if (robot.empty()) fields.missing("robot");
  if (site.empty()) fields.missing("site");
  std::string keys;
  fields.text("security", keys);
  const Tree* server = fields.map("discovery_server");
  const Tree* fleet = fields.map("fleet");
  const Tree* hosts = fields.map("hosts", true);
  const Tree* components = fields.map("components", true);
  const auto has = [&](const char* key) { return tree->find(key) != nullptr; };
  if (!has("robot") && !has("site") && !has("hosts"))  // a robot's file may have the other keys
    return Error{"no manifest: expected the keys robot, site, hosts, components (" + tree->origin +
                 ")"};
  fields.finish();
  if (!robot.empty() &&
      judge_name(robot, "a robot's", origin_of(*tree, "robot"), manifest.findings))
    manifest.robot_file = find_config(config_directories, "robots/" + robot + ".yaml");
  if (!site.empty() && judge_name(site, "a site's", origin_of(*tree, "site"), manifest.findings))
    manifest.site_file = find_config(config_directories, "sites/" + site + "/site.yaml");

  if (hosts != nullptr) {
    for (const auto& [name, entry] : hosts->entries)
      manifest.hosts.push_back(read_host(name, entry, manifest.findings));
  }
  if (components != nullptr) {
    for (const auto& [name, entry] : components->entries) {
      const auto& component =
          manifest.components.emplace_back(read_component(name, entry, manifest.findings));
      if (!component.host.empty() || !component.origins.contains("host"))
        judge_host("component '" + name + "'", component.host, component.origin_of("host"),
                   manifest);
    }
    for (const auto& [name, entry] : components->removed) {
      const Tree* type = entry.find("type");
      manifest.removed.push_back({name, type == nullptr ? name : type->scalar, entry.origin});
    }
  }
  for (const auto& [key, value] : tree->entries) manifest.origins[key] = value.origin;
  if (!keys.empty()) manifest.keys = beside(manifest.origin_of("security"), keys);
  if (server != nullptr) {
    manifest.discovery_server = read_discovery_server(*server, manifest.findings);
    if (const auto& host = manifest.discovery_server.host; !host.empty())
      judge_host("the discovery server", host, server->origin, manifest);
  }
  if (fleet != nullptr) manifest.fleet = read_fleet(*fleet, manifest, manifest.findings);
  return manifest;
}

}  // namespace usher::operations
