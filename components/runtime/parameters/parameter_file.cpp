#include "runtime/parameters/parameter_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

namespace usher::runtime {
namespace {

/// Thrown inside this file only; a public function turns it into its error.
struct Problem : std::runtime_error {
  using std::runtime_error::runtime_error;
};

constexpr int kDeepest = 32;
constexpr std::streamoff kLargestFile = 16 * 1024 * 1024;

class Document {
 public:
  explicit Document(std::string where) : where_(std::move(where)) {}

  std::string at(const YAML::Node& node) const {
    return where_ + ":" + std::to_string(std::max(node.Mark().line, 0) + 1);
  }
  [[noreturn]] void fail(const YAML::Node& node, const std::string& text) const {
    throw Problem(text + " (" + at(node) + ")");
  }
  YAML::Node load(const std::string& text) const {
    try {
      return YAML::Load(text);
    } catch (const YAML::Exception& error) {
      throw Problem("not YAML: " + error.msg + " (" + where_ + ":" +
                    std::to_string(error.mark.line + 1) + ")");
    }
  }
  std::string scalar(const YAML::Node& node, const std::string& what) const {
    if (!node.IsScalar()) fail(node, what + " must be a plain value");
    return node.Scalar();
  }
  template <class Integer>
  Integer integer(const YAML::Node& node, const std::string& what) const {
    const std::string text = scalar(node, what);
    Integer value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) {
      fail(node, what + " must be a whole number, got \"" + text + '"');
    }
    return value;
  }
  /// The value as text of one line, the way it can be read again.
  std::string yaml(const YAML::Node& key, const YAML::Node& node, const std::string& name) const {
    if (node.IsNull()) fail(key, name + " has no value");
    check_depth(node, 0);
    YAML::Emitter emitter;
    emitter.SetSeqFormat(YAML::Flow);
    emitter.SetMapFormat(YAML::Flow);
    // Flow sequences that yaml-cpp would break into lines stay one line this way: the text travels
    // in errors.
    YAML::Node flow = YAML::Clone(node);
    flow.SetStyle(YAML::EmitterStyle::Flow);
    emitter << flow;
    return emitter.c_str();
  }
  /// Visits the entries of a mapping; repeated and empty keys are errors.
  void each(const YAML::Node& map,
            const std::function<void(const std::string&, const YAML::Node&, const YAML::Node&)>&
                visit) const {
    std::set<std::string> seen;
    for (const auto& entry : map) {
      const std::string key = scalar(entry.first, "a key");
      if (key.empty()) fail(entry.first, "empty key");
      if (!seen.insert(key).second) fail(entry.first, "key " + key + " is given twice");
      visit(key, entry.first, entry.second);
    }
  }

 private:
  void check_depth(const YAML::Node& node, int depth) const {
    if (depth > kDeepest) fail(node, "nested deeper than " + std::to_string(kDeepest));
    if (node.IsSequence()) {
      for (const auto& element : node) check_depth(element, depth + 1);
    } else if (node.IsMap()) {
      for (const auto& entry : node) check_depth(entry.second, depth + 1);
    }
  }

  std::string where_;
};

Result<std::string> content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return Error{"cannot read the file " + path};
  if (file.tellg() > kLargestFile) return Error{"larger than 16 MB: " + path};
  file.seekg(0);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) return Error{"cannot read the file " + path};
  return text.str();
}

ParameterValue read_value(const Document& document, const std::string& name, const YAML::Node& key,
                          const YAML::Node& node) {
  if (!node.IsMap()) return {name, document.yaml(key, node, name), document.at(key)};
  ParameterValue value{name, "", document.at(key)};
  bool given = false;
  document.each(
      node, [&](const std::string& part, const YAML::Node& part_key, const YAML::Node& content) {
        if (part == "value") {
          value.yaml = document.yaml(part_key, content, name);
          given = true;
        } else if (part == "origin") {
          value.origin = document.scalar(content, "origin of " + name);
        } else {
          document.fail(part_key, "unknown key " + part + " of parameter " + name +
                                      ", expected value and origin");
        }
      });
  if (!given) document.fail(key, "parameter " + name + " has no value");
  return value;
}

std::uint32_t read_domain(const Document& document, const YAML::Node& node,
                          const std::string& key) {
  const auto domain = document.integer<std::uint32_t>(node, key);
  if (domain > 232) document.fail(node, key + " must be in [0, 232], got " + node.Scalar());
  return domain;
}

std::vector<std::string> read_peers(const Document& document, const YAML::Node& node,
                                    const std::string& key) {
  if (!node.IsSequence()) document.fail(node, key + " must be a list of addresses");
  std::vector<std::string> peers;
  peers.reserve(node.size());
  for (const auto& peer : node) peers.push_back(document.scalar(peer, "a peer"));
  return peers;
}

ParameterFile read_file(const Document& document, const YAML::Node& root) {
  if (!root.IsMap()) document.fail(root, "a parameter file must be a mapping");
  ParameterFile file;
  document.each(root,
                [&](const std::string& key, const YAML::Node& key_node, const YAML::Node& node) {
                  if (key == "component") {
                    file.component = document.scalar(node, key);
                  } else if (key == "name") {
                    file.name = document.scalar(node, key);
                  } else if (key == "host") {
                    file.host = document.scalar(node, key);
                  } else if (key == "domain") {
                    file.domain = read_domain(document, node, key);
                  } else if (key == "seed") {
                    file.seed = document.integer<std::uint64_t>(node, key);
                  } else if (key == "critical") {
                    const std::string text = document.scalar(node, key);
                    if (text != "true" && text != "false") {
                      document.fail(node, "critical must be true or false, got \"" + text + '"');
                    }
                    file.critical = text == "true";
                  } else if (key == "run_directory") {
                    file.run_directory = document.scalar(node, key);
                  } else if (key == "clock_anchor") {
                    file.clock_anchor = document.integer<std::int64_t>(node, key);
                  } else if (key == "peers") {
                    file.peers = read_peers(document, node, key);
                  } else if (key == "robot") {
                    file.robot = document.scalar(node, key);
                  } else if (key == "fleet_domain") {
                    file.fleet_domain = read_domain(document, node, key);
                  } else if (key == "fleet_peers") {
                    file.fleet_peers = read_peers(document, node, key);
                  } else if (key == "discovery_server") {
                    file.discovery_server = document.scalar(node, key);
                  } else if (key == "identity") {
                    file.identity = document.scalar(node, key);
                  } else if (key == "parameters") {
                    if (node.IsNull()) return;
                    if (!node.IsMap()) document.fail(node, "parameters must be a mapping");
                    document.each(node, [&](const std::string& name, const YAML::Node& name_node,
                                            const YAML::Node& value) {
                      file.values.push_back(read_value(document, name, name_node, value));
                    });
                  } else {
                    document.fail(key_node, "unknown key " + key);
                  }
                });
  if (file.component.empty()) document.fail(root, "component must be set");
  if (file.name.empty()) document.fail(root, "name must be set");
  if (file.host.empty()) document.fail(root, "host must be set");
  if (!file.robot.empty() && file.fleet_domain == file.domain)
    document.fail(root,
                  "fleet_domain must differ from domain, both are " + std::to_string(file.domain));
  return file;
}

void flatten_into(const Document& document, const YAML::Node& map, const std::string& prefix,
                  int depth, std::set<std::string>& seen, std::vector<ParameterValue>& values) {
  if (depth > kDeepest) document.fail(map, "nested deeper than " + std::to_string(kDeepest));
  document.each(
      map, [&](const std::string& key, const YAML::Node& key_node, const YAML::Node& node) {
        const std::string name = prefix + key;
        if (node.IsMap()) {
          flatten_into(document, node, name + ".", depth + 1, seen, values);
          return;
        }
        if (!seen.insert(name).second) document.fail(key_node, "key " + name + " is given twice");
        values.push_back({name, document.yaml(key_node, node, name), document.at(key_node)});
      });
}

}  // namespace

Result<ParameterFile> parse_parameter_file(const std::string& text, const std::string& where) {
  const Document document(where);
  try {
    return read_file(document, document.load(text));
  } catch (const Problem& problem) {
    return Error{problem.what()};
  }
}

Result<ParameterFile> read_parameter_file(const std::string& path) {
  const auto text = content_of(path);
  if (!text) return Error{text.error()};
  return parse_parameter_file(*text, path);
}

Result<std::vector<ParameterValue>> flatten(const std::string& yaml, const std::string& where) {
  const Document document(where);
  try {
    const YAML::Node root = document.load(yaml);
    std::vector<ParameterValue> values;
    if (root.IsNull()) return values;
    if (!root.IsMap()) document.fail(root, "expected a mapping");
    std::set<std::string> seen;
    flatten_into(document, root, "", 0, seen, values);
    return values;
  } catch (const Problem& problem) {
    return Error{problem.what()};
  }
}

Result<std::vector<ParameterValue>> flatten_file(const std::string& path) {
  const auto text = content_of(path);
  if (!text) return Error{text.error()};
  return flatten(*text, path);
}

}  // namespace usher::runtime
