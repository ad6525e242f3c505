#include "runtime/api/contract.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <string_view>

#include "runtime/parameters/units.hpp"

namespace usher::runtime {
namespace {

constexpr std::array<std::string_view, 8> kKinds{"flag",   "integer", "number",  "text",
                                                 "choice", "file",    "numbers", "records"};

std::string kind_name(ParameterKind kind) {
  return std::string(kKinds.at(static_cast<std::size_t>(kind)));
}

// --- Writing
// ------------------------------------------------------------------------------------------------------------

YAML::Node qos_node(const Qos& qos) {
  YAML::Node node;
  node["reliable"] = qos.reliable;
  node["latched"] = qos.latched;
  node["depth"] = qos.depth;
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

/// yaml-cpp would print 17 digits.
YAML::Node number_node(double value) {
  if (std::isinf(value)) return YAML::Node(value < 0 ? "-.inf" : ".inf");
  return YAML::Node(shortest(value));
}

YAML::Node range_node(const Range& range) {
  YAML::Node node;
  node.push_back(number_node(range.low));
  node.push_back(number_node(range.high));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

bool measured(ParameterKind kind) {
  return kind == ParameterKind::kInteger || kind == ParameterKind::kNumber ||
         kind == ParameterKind::kNumbers;
}

YAML::Node parameter_node(const Contract::Parameter& parameter) {
  YAML::Node node;
  node["name"] = parameter.name;
  node["kind"] = kind_name(parameter.kind);
  if (measured(parameter.kind)) {
    node["unit"] = parameter.unit;
    node["range"] = range_node(parameter.range);
  }
  if (parameter.required) {
    node["required"] = true;
  } else {
    node["default"] = parameter.fallback;
  }
  if (parameter.kind == ParameterKind::kNumbers) {
    node["count"].push_back(parameter.count_min);
    node["count"].push_back(parameter.count_max);
    node["count"].SetStyle(YAML::EmitterStyle::Flow);
  }
  for (const std::string& option : parameter.options) node["options"].push_back(option);
  for (const RecordField& field : parameter.fields) {
    YAML::Node entry;
    entry["name"] = field.name;
    entry["kind"] = kind_name(field.kind);
    if (measured(field.kind)) {
      entry["unit"] = field.unit;
      entry["range"] = range_node(field.range);
    }
    entry["text"] = field.text;
    node["fields"].push_back(entry);
  }
  node["text"] = parameter.text;
  return node;
}

// --- Reading
// ------------------------------------------------------------------------------------------------------------

struct Problem : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Reader {
 public:
  explicit Reader(const std::string& where) : where_(where) {}

  [[noreturn]] void fail(const YAML::Node& node, const std::string& text) const {
    throw Problem(text + " (" + where_ + ":" + std::to_string(node.Mark().line + 1) + ")");
  }
  void allow(const YAML::Node& map, std::initializer_list<std::string_view> keys) const {
    if (!map.IsMap()) fail(map, "expected a mapping");
    for (const auto& entry : map) {
      const std::string& key = entry.first.Scalar();
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
        fail(entry.first, "unknown key " + key);
      }
    }
  }
  template <class T>
  T value(const YAML::Node& map, const char* key) const {
    const YAML::Node node = map[key];
    if (!node) fail(map, std::string(key) + " must be set");
    return converted<T>(node, key);
  }
  template <class T>
  T value(const YAML::Node& map, const char* key, T fallback) const {
    const YAML::Node node = map[key];
    return node ? converted<T>(node, key) : std::move(fallback);
  }
  Qos qos(const YAML::Node& map) const {
    const YAML::Node node = map["qos"];
    if (!node) fail(map, "qos must be set");
    allow(node, {"reliable", "latched", "depth"});
    return {value<bool>(node, "reliable"), value<bool>(node, "latched"), value<int>(node, "depth")};
  }
  topics::Scope scope(const YAML::Node& map) const {
    return value<bool>(map, "fleet", false) ? topics::Scope::kFleet : topics::Scope::kRobot;
  }
  Range range(const YAML::Node& map) const {
    const YAML::Node node = map["range"];
    if (!node) return {};
    if (!node.IsSequence() || node.size() != 2) fail(node, "range must be [low, high]");
    return {converted<double>(node[0], "range"), converted<double>(node[1], "range")};
  }
  ParameterKind kind(const YAML::Node& map) const {
    const auto text = value<std::string>(map, "kind");
    const auto found = std::find(kKinds.begin(), kKinds.end(), text);
    if (found == kKinds.end()) fail(map["kind"], "unknown kind of parameter: " + text);
    return static_cast<ParameterKind>(found - kKinds.begin());
  }
  YAML::Node list(const YAML::Node& map, const char* key) const {
    const YAML::Node node = map[key];
    if (node && !node.IsSequence()) fail(node, std::string(key) + " must be a list");
    return node;
  }

 private:
  template <class T>
  T converted(const YAML::Node& node, const char* key) const {
    try {
      return node.as<T>();
    } catch (const YAML::Exception&) {
      fail(node, std::string(key) + " has the wrong type");
    }
  }
  const std::string& where_;
};

RecordField read_field(const Reader& reader, const YAML::Node& node) {
  reader.allow(node, {"name", "kind", "unit", "range", "text"});
  return {reader.value<std::string>(node, "name"), reader.kind(node),
          reader.value<std::string>(node, "unit", "-"), reader.range(node),
          reader.value<std::string>(node, "text")};
}

Contract::Parameter read_parameter(const Reader& reader, const YAML::Node& node) {
  reader.allow(node, {"name", "kind", "unit", "range", "required", "default", "count", "options",
                      "fields", "text"});
  Contract::Parameter parameter;
  parameter.name = reader.value<std::string>(node, "name");
  parameter.kind = reader.kind(node);
  parameter.unit = reader.value<std::string>(node, "unit", "-");
  parameter.range = reader.range(node);
  parameter.required = reader.value<bool>(node, "required", false);
  if (!parameter.required) parameter.fallback = reader.value<std::string>(node, "default");
  const auto counts = reader.value<std::vector<std::size_t>>(node, "count", {0, 0});
  if (counts.size() != 2) reader.fail(node["count"], "count must be [least, most]");
  parameter.count_min = counts[0];
  parameter.count_max = counts[1];
  parameter.options = reader.value<std::vector<std::string>>(node, "options", {});
  for (const auto& field : reader.list(node, "fields")) {
    parameter.fields.push_back(read_field(reader, field));
  }
  parameter.text = reader.value<std::string>(node, "text");
  return parameter;
}

Contract::InputPort read_input(const Reader& reader, const YAML::Node& node) {
  reader.allow(node, {"topic", "type", "qos", "rate", "max_age", "on_loss", "optional", "fleet"});
  return {reader.value<std::string>(node, "topic"),
          reader.value<std::string>(node, "type"),
          reader.value<std::string>(node, "on_loss", ""),
          reader.qos(node),
          reader.value<double>(node, "rate"),
          reader.value<double>(node, "max_age", 0.0),
          reader.value<bool>(node, "optional", false),
          reader.scope(node)};
}

Contract::OutputPort read_output(const Reader& reader, const YAML::Node& node) {
  reader.allow(node, {"topic", "type", "qos", "rate", "fleet"});
  return {reader.value<std::string>(node, "topic"), reader.value<std::string>(node, "type"),
          reader.qos(node), reader.value<double>(node, "rate"), reader.scope(node)};
}

Contract read_contract(const Reader& reader, const YAML::Node& root) {
  reader.allow(root,
               {"component", "version", "idl_digest", "inputs", "outputs", "timers", "parameters"});
  Contract contract;
  contract.component = reader.value<std::string>(root, "component");
  contract.version = reader.value<std::string>(root, "version");
  contract.idl_digest = reader.value<std::string>(root, "idl_digest");
  for (const auto& node : reader.list(root, "inputs")) {
    contract.inputs.push_back(read_input(reader, node));
  }
  for (const auto& node : reader.list(root, "outputs")) {
    contract.outputs.push_back(read_output(reader, node));
  }
  for (const auto& node : reader.list(root, "timers")) {
    reader.allow(node, {"name", "period"});
    contract.timers.push_back(
        {reader.value<std::string>(node, "name"), reader.value<double>(node, "period")});
  }
  for (const auto& node : reader.list(root, "parameters")) {
    contract.parameters.push_back(read_parameter(reader, node));
  }
  return contract;
}

}  // namespace

std::string to_yaml(const Contract& contract) {
  YAML::Node root;
  root["component"] = contract.component;
  root["version"] = contract.version;
  root["idl_digest"] = contract.idl_digest;
  for (const auto& input : contract.inputs) {
    YAML::Node node;
    node["topic"] = input.topic;
    node["type"] = input.type;
    node["qos"] = qos_node(input.qos);
    node["rate"] = number_node(input.rate_hz);
    if (input.max_age > 0.0) {
      node["max_age"] = number_node(input.max_age);
      node["on_loss"] = input.on_loss;
    } else if (!input.on_loss.empty()) {
      node["on_loss"] = input.on_loss;
    }
    if (input.optional) node["optional"] = true;
    if (input.scope == topics::Scope::kFleet) node["fleet"] = true;
    root["inputs"].push_back(node);
  }
  for (const auto& output : contract.outputs) {
    YAML::Node node;
    node["topic"] = output.topic;
    node["type"] = output.type;
    node["qos"] = qos_node(output.qos);
    node["rate"] = number_node(output.rate_hz);
    if (output.scope == topics::Scope::kFleet) node["fleet"] = true;
    root["outputs"].push_back(node);
  }
  for (const auto& timer : contract.timers) {
    YAML::Node node;
    node["name"] = timer.name;
    node["period"] = number_node(timer.period);
    node.SetStyle(YAML::EmitterStyle::Flow);
    root["timers"].push_back(node);
  }
  for (const auto& parameter : contract.parameters) {
    root["parameters"].push_back(parameter_node(parameter));
  }
  return YAML::Dump(root) + "\n";
}

Result<Contract> contract_from_yaml(const std::string& yaml, const std::string& where) {
  const Reader reader(where);
  try {
    return read_contract(reader, YAML::Load(yaml));
  } catch (const YAML::Exception& error) {
    return Error{"not YAML: " + error.msg + " (" + where + ":" +
                 std::to_string(error.mark.line + 1) + ")"};
  } catch (const Problem& problem) {
    return Error{problem.what()};
  }
}

}  // namespace usher::runtime
