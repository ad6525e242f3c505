#include "operations/manifest/manifest.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <string_view>

namespace usher::operations {

namespace {

constexpr int kMaxExtends = 8;

std::string at(const Tree& tree) { return " (" + tree.origin + ")"; }

/// Reads a map strictly: every key must be taken, and the first error is kept.
class Fields {
 public:
  Fields(const Tree& tree, std::string what) : tree_(tree), what_(std::move(what)) {
    if (tree.kind != Tree::Kind::kMap && tree.kind != Tree::Kind::kNull)
      fail(what_ + " must be a map" + at(tree));
  }

  const Tree* take(const std::string& key) {
    taken_.push_back(key);
    return tree_.find(key);
  }

  void text(const std::string& key, std::string& value) {
    const Tree* node = take(key);
    if (node == nullptr) return;
    if (node->kind != Tree::Kind::kScalar || node->scalar.empty()) {
      fail(what_ + ": '" + key + "' must be a word" + at(*node));
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
      fail(what_ + ": '" + key + "' must be a number in [" + std::to_string(low) + ", " +
           std::to_string(high) + "], got " + node->yaml() + at(*node));
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
    fail(what_ + ": '" + key + "' must be one of " + names + ", got " + node->yaml() + at(*node));
  }

  void texts(const std::string& key, std::vector<std::string>& values) {
    const Tree* node = take(key);
    if (node == nullptr) return;
    for (const auto& item : node->items) values.push_back(item.scalar);
    if (node->kind != Tree::Kind::kList) fail(what_ + ": '" + key + "' must be a list" + at(*node));
  }

  void fail(std::string message) {
    if (error_.empty()) error_ = std::move(message);
  }

  /// The first error, or the first key that nobody took.
  Status finish() {
    if (!error_.empty()) return Error{error_};
    for (const auto& [key, value] : tree_.entries) {
      if (std::find(taken_.begin(), taken_.end(), key) == taken_.end()) {
        std::string known;
        for (const auto& name : taken_) known += (known.empty() ? "" : ", ") + name;
        return Error{what_ + ": unknown key '" + key + "', expected one of " + known + at(value)};
      }
    }
    return {};
  }

 private:
  const Tree& tree_;
  std::string what_;
  std::vector<std::string> taken_;
  std::string error_;
};

/// The tree of a manifest with everything that it extends below it.
Result<Tree> read_extended(const std::filesystem::path& path, int depth) {
  if (depth > kMaxExtends)
    return Error{"manifests extend one another in a circle (" + path.string() + ")"};
  auto tree = read_tree(path.string());
  if (!tree) return tree;
  if (tree->kind != Tree::Kind::kMap) return Error{"a manifest must be a map" + at(*tree)};
  const Tree* extends = tree->find("extends");
  if (extends == nullptr) return tree;
  auto base = read_extended(path.parent_path() / extends->scalar, depth + 1);
  if (!base) return Error{base.error() + ", extended by " + extends->origin};
  std::erase_if(tree->entries, [](const auto& entry) { return entry.first == "extends"; });
  return overlay(std::move(base).value(), *tree);
}

Status read_component(const std::string& name, const Tree& tree, ManifestComponent& component) {
  component.name = name;
  component.type = name;
  component.origin = tree.origin;
  Fields fields(tree, "component '" + name + "'");
  fields.text("type", component.type);
  fields.text("host", component.host);
  fields.text("group", component.group);
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
  if (const Tree* parameters = fields.take("parameters"); parameters != nullptr) {
    for (const auto& [key, value] : parameters->entries) {
      component.parameters.push_back({key, value.yaml(), value.origin});
    }
  }
  return fields.finish();
}

Status read_host(const std::string& name, const Tree& tree, ManifestHost& host) {
  host.name = name;
  host.origin = tree.origin;
  Fields fields(tree, "host '" + name + "'");
  fields.texts("peers", host.peers);
  return fields.finish();
}

}  // namespace

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

Result<Manifest> read_manifest(const std::string& path, const std::string& config_directory) {
  const auto tree = read_extended(path, 0);
  if (!tree) return Error{tree.error()};

  Manifest manifest;
  manifest.path = path;
  manifest.name = std::filesystem::path(path).stem().string();
  Fields fields(*tree, "manifest");
  std::string robot;
  std::string site;
  fields.text("name", manifest.name);
  fields.text("robot", robot);
  fields.text("site", site);
  fields.number("domain", std::uint32_t{0}, std::uint32_t{232}, manifest.domain);
  fields.number("seed", std::uint64_t{0}, ~std::uint64_t{0}, manifest.seed);
  const Tree* hosts = fields.take("hosts");
  const Tree* components = fields.take("components");
  if (auto status = fields.finish(); !status) return Error{status.error()};

  if (robot.empty()) return Error{"manifest must name a robot" + at(*tree)};
  if (site.empty()) return Error{"manifest must name a site" + at(*tree)};
  if (hosts == nullptr || hosts->entries.empty())
    return Error{"manifest must name its hosts" + at(*tree)};
  if (components == nullptr || components->entries.empty()) {
    return Error{"manifest must name its components" + at(*tree)};
  }
  manifest.robot_file = config_directory + "/robots/" + robot + ".yaml";
  manifest.site_file = config_directory + "/sites/" + site + "/site.yaml";

  for (const auto& [name, entry] : hosts->entries) {
    if (auto status = read_host(name, entry, manifest.hosts.emplace_back()); !status)
      return Error{status.error()};
  }
  for (const auto& [name, entry] : components->entries) {
    auto& component = manifest.components.emplace_back();
    if (auto status = read_component(name, entry, component); !status) return Error{status.error()};
    if (manifest.host(component.host) == nullptr) {
      return Error{"component '" + name + "' runs on the unknown host '" + component.host + "'" +
                   at(entry)};
    }
  }
  return manifest;
}

}  // namespace usher::operations
