#include "runtime/parameters/interpret.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "runtime/parameters/units.hpp"

namespace usher::runtime {
namespace {

/// What one number must be: of a parameter, of an element of a list or of a field of a record.
struct NumberRule {
  std::string unit;
  Range range;
  bool whole = false;
};

std::string range_text(const NumberRule& rule) {
  std::string text = "[";
  text.append(shortest(rule.range.low)).append(", ").append(shortest(rule.range.high)).append("]");
  if (rule.unit != "-") text.append(" ").append(rule.unit);
  return text;
}

bool is_unbounded(const Range& range) { return std::isinf(range.low) && std::isinf(range.high); }

std::string number_text(const NumberRule& rule) {
  std::string text = rule.whole ? "a whole number" : "a number";
  if (!is_unbounded(rule.range)) return text + " in " + range_text(rule);
  return rule.unit == "-" ? text : text + " in " + rule.unit;
}

/// A value as it stands in the file, short enough for an error.
std::string quoted(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  if (node.IsMap()) return "a mapping";
  if (node.IsSequence()) return "a list";
  constexpr std::size_t kLongest = 60;
  const std::string& text = node.Scalar();
  return text.size() <= kLongest ? '"' + text + '"' : '"' + text.substr(0, kLongest) + "...\"";
}

Error must(const std::string& name, const std::string& expected, const std::string& found,
           const std::string& origin) {
  return Error{name + " must be " + expected + ", got " + found + " (" + origin + ")"};
}

Result<double> read(const YAML::Node& node, const NumberRule& rule, const std::string& name,
                    const std::string& origin) {
  const auto written = node.IsScalar() ? read_number(node.Scalar()) : std::nullopt;
  if (!written) return must(name, number_text(rule), quoted(node), origin);
  const std::string& text = node.Scalar();
  const auto value =
      written->unit.empty() ? written->value : to_si(written->value, written->unit, rule.unit);
  if (!value) {
    const std::string expected =
        rule.unit == "-" ? "without unit" : "in one of the units " + units_of(rule.unit);
    return must(name, expected, text, origin);
  }
  if (rule.whole && (std::floor(*value) != *value || std::abs(*value) > 0x1p53)) {
    return must(name, number_text(rule), text, origin);
  }
  if (!(*value >= rule.range.low && *value <= rule.range.high)) {
    const bool bare = written->unit.empty() && rule.unit != "-";
    return must(name, "in " + range_text(rule), bare ? text + " " + rule.unit : text, origin);
  }
  return *value;
}

Result<double> read_flag(const YAML::Node& node, const std::string& name,
                         const std::string& origin) {
  if (node.IsScalar() && node.Scalar() == "true") return 1.0;
  if (node.IsScalar() && node.Scalar() == "false") return 0.0;
  return must(name, "true or false", quoted(node), origin);
}

Result<std::string> read_text(const YAML::Node& node, const std::string& name,
                              const std::string& origin) {
  if (node.IsScalar()) return node.Scalar();
  return must(name, "a text", quoted(node), origin);
}

/// "config/robots/marvin.yaml:12" -> config/robots
std::filesystem::path folder_of(const std::string& origin) {
  return std::filesystem::path(origin.substr(0, origin.rfind(':'))).parent_path();
}

std::string counted(std::size_t low, std::size_t high) {
  return low == high ? std::to_string(low) : std::to_string(low) + " to " + std::to_string(high);
}

Result<Interpretation> read_numbers(const Contract::Parameter& declared, const YAML::Node& node,
                                    const std::string& origin) {
  if (!node.IsSequence()) return must(declared.name, expectation(declared), quoted(node), origin);
  if (node.size() < declared.count_min || node.size() > declared.count_max) {
    return must(declared.name, expectation(declared), std::to_string(node.size()), origin);
  }
  Interpretation result;
  for (std::size_t i = 0; i < node.size(); ++i) {
    const auto number = read(node[i], {declared.unit, declared.range, false},
                             declared.name + "[" + std::to_string(i) + "]", origin);
    if (!number) return Error{number.error()};
    result.numbers.push_back(*number);
  }
  return result;
}

Status read_field(const RecordField& field, const YAML::Node& node, const std::string& name,
                  const std::string& origin, Record& record) {
  if (field.kind == ParameterKind::kText) {
    const auto text = read_text(node, name, origin);
    if (!text) return Error{text.error()};
    record.texts[field.name] = *text;
    return {};
  }
  const auto number =
      field.kind == ParameterKind::kFlag
          ? read_flag(node, name, origin)
          : read(node, {field.unit, field.range, field.kind == ParameterKind::kInteger}, name,
                 origin);
  if (!number) return Error{number.error()};
  record.numbers[field.name] = *number;
  return {};
}

Result<Record> read_record(const Contract::Parameter& declared, const YAML::Node& node,
                           const std::string& name, const std::string& origin) {
  if (!node.IsMap()) return must(name, "a mapping", quoted(node), origin);
  std::map<std::string, YAML::Node> given;
  for (const auto& entry : node) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : quoted(entry.first);
    const bool known = std::any_of(declared.fields.begin(), declared.fields.end(),
                                   [&](const RecordField& field) { return field.name == key; });
    if (!known) return Error{"unknown field \"" + key + "\" in " + name + " (" + origin + ")"};
    if (!given.emplace(key, entry.second).second) {
      return Error{"field \"" + key + "\" of " + name + " is given twice (" + origin + ")"};
    }
  }
  Record record;
  for (const RecordField& field : declared.fields) {
    const auto found = given.find(field.name);
    if (found == given.end()) {
      return Error{name + "." + field.name + " must be set (" + origin + ")"};
    }
    const Status status = read_field(field, found->second, name + "." + field.name, origin, record);
    if (!status.ok()) return Error{status.error()};
  }
  return record;
}

Result<Interpretation> read_records(const Contract::Parameter& declared, const YAML::Node& node,
                                    const std::string& origin) {
  if (!node.IsSequence()) return must(declared.name, expectation(declared), quoted(node), origin);
  Interpretation result;
  for (std::size_t i = 0; i < node.size(); ++i) {
    auto record =
        read_record(declared, node[i], declared.name + "[" + std::to_string(i) + "]", origin);
    if (!record) return Error{record.error()};
    result.records.push_back(std::move(*record));
  }
  return result;
}

Result<Interpretation> read_one_text(const Contract::Parameter& declared, const YAML::Node& node,
                                     const std::string& origin) {
  const auto text = read_text(node, declared.name, origin);
  if (!text) return Error{text.error()};
  Interpretation result;
  result.text = *text;
  const auto& options = declared.options;
  if (declared.kind == ParameterKind::kChoice &&
      std::find(options.begin(), options.end(), *text) == options.end()) {
    return must(declared.name, expectation(declared), quoted(node), origin);
  }
  if (declared.kind == ParameterKind::kFile && !text->empty()) {
    const std::filesystem::path path = folder_of(origin) / *text;
    result.text = std::filesystem::absolute(path).lexically_normal().string();
  }
  return result;
}

}  // namespace

std::string expectation(const Contract::Parameter& declared) {
  switch (declared.kind) {
    case ParameterKind::kFlag:
      return "true or false";
    case ParameterKind::kInteger:
    case ParameterKind::kNumber:
      return number_text({declared.unit, declared.range, declared.kind == ParameterKind::kInteger});
    case ParameterKind::kText:
      return "a text";
    case ParameterKind::kFile:
      return "a path";
    case ParameterKind::kRecords:
      return "a list of mappings";
    case ParameterKind::kNumbers: {
      const std::string text =
          "a list of " + counted(declared.count_min, declared.count_max) + " numbers";
      if (!is_unbounded(declared.range)) {
        return text + " in " + range_text({declared.unit, declared.range, false});
      }
      return declared.unit == "-" ? text : text + " in " + declared.unit;
    }
    case ParameterKind::kChoice: {
      std::string text = "one of ";
      for (std::size_t i = 0; i < declared.options.size(); ++i) {
        text += (i == 0 ? "" : ", ") + declared.options[i];
      }
      return text;
    }
  }
  return {};
}

Result<Interpretation> interpret(const Contract::Parameter& declared, const ParameterValue& given) {
  YAML::Node node;
  try {
    node = YAML::Load(given.yaml);
  } catch (const YAML::Exception& error) {
    return Error{declared.name + " is not YAML: " + error.msg + " (" + given.origin + ")"};
  }
  const auto as_interpretation = [](const Result<double>& number) -> Result<Interpretation> {
    if (!number) return Error{number.error()};
    Interpretation result;
    result.number = *number;
    return result;
  };
  switch (declared.kind) {
    case ParameterKind::kFlag:
      return as_interpretation(read_flag(node, declared.name, given.origin));
    case ParameterKind::kInteger:
    case ParameterKind::kNumber:
      return as_interpretation(
          read(node, {declared.unit, declared.range, declared.kind == ParameterKind::kInteger},
               declared.name, given.origin));
    case ParameterKind::kNumbers:
      return read_numbers(declared, node, given.origin);
    case ParameterKind::kRecords:
      return read_records(declared, node, given.origin);
    case ParameterKind::kText:
    case ParameterKind::kChoice:
    case ParameterKind::kFile:
      return read_one_text(declared, node, given.origin);
  }
  return Error{declared.name + " has no kind"};
}

}  // namespace usher::runtime
