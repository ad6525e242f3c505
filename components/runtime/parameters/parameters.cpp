#include "runtime/api/parameters.hpp"

#include <yaml-cpp/yaml.h>

#include "runtime/parameters/units.hpp"

// The typed calls: each turns its arguments into a declaration with the default as YAML, so that
// defaults and given values pass the same judge (parameters/interpret.hpp).
namespace usher::runtime {

bool Parameters::flag(const std::string& name, bool fallback, const std::string& text) {
  Declaration declaration;
  declaration.name = name;
  declaration.kind = ParameterKind::kFlag;
  declaration.fallback = fallback ? "true" : "false";
  declaration.text = text;
  return declare(declaration).number != 0.0;
}

std::int64_t Parameters::integer(const std::string& name, const std::string& unit, Range range,
                                 std::int64_t fallback, const std::string& text) {
  Declaration declaration;
  declaration.name = name;
  declaration.kind = ParameterKind::kInteger;
  declaration.unit = unit;
  declaration.range = range;
  declaration.fallback = std::to_string(fallback) + (unit == "-" ? "" : " " + unit);
  declaration.text = text;
  return static_cast<std::int64_t>(declare(declaration).number);
}

double Parameters::number(const std::string& name, const std::string& unit, Range range,
                          double fallback, const std::string& text) {
  Declaration declaration;
  declaration.name = name;
  declaration.unit = unit;
  declaration.range = range;
  declaration.fallback = with_unit(fallback, unit);
  declaration.text = text;
  return declare(declaration).number;
}

double Parameters::number(const std::string& name, const std::string& unit, Range range,
                          const std::string& text) {
  Declaration declaration;
  declaration.name = name;
  declaration.unit = unit;
  declaration.range = range;
  declaration.required = true;
  declaration.text = text;
  return declare(declaration).number;
}

std::string Parameters::text(const std::string& name, const std::string& fallback,
                             const std::string& text) {
  Declaration declaration;
  declaration.name = name;
  declaration.kind = ParameterKind::kText;
  declaration.fallback = YAML::Dump(YAML::Node(fallback));
  declaration.text = text;
  return declare(declaration).text;
}

std::string Parameters::choice(const std::string& name, const std::vector<std::string>& options,
                               const std::string& fallback, const std::string& text) {
  Declaration declaration;
  declaration.name = name;
  declaration.kind = ParameterKind::kChoice;
  declaration.options = options;
  declaration.fallback = YAML::Dump(YAML::Node(fallback));
  declaration.text = text;
  return declare(declaration).text;
}

std::string Parameters::file(const std::string& name, const std::string& fallback,
                             const std::string& text) {
  Declaration declaration;
  declaration.name = name;
  declaration.kind = ParameterKind::kFile;
  declaration.fallback = YAML::Dump(YAML::Node(fallback));
  declaration.text = text;
  return declare(declaration).text;
}

std::vector<double> Parameters::numbers(const std::string& name, const std::string& unit,
                                        Range range, std::size_t count_min, std::size_t count_max,
                                        const std::vector<double>& fallback,
                                        const std::string& text) {
  Declaration declaration;
  declaration.name = name;
  declaration.kind = ParameterKind::kNumbers;
  declaration.unit = unit;
  declaration.range = range;
  declaration.count_min = count_min;
  declaration.count_max = count_max;
  YAML::Node list(YAML::NodeType::Sequence);
  list.SetStyle(YAML::EmitterStyle::Flow);
  for (const double value : fallback) list.push_back(with_unit(value, unit));
  declaration.fallback = YAML::Dump(list);
  declaration.text = text;
  return declare(declaration).numbers;
}

std::vector<double> Parameters::numbers(const std::string& name, const std::string& unit,
                                        Range range, std::size_t count_min, std::size_t count_max,
                                        const std::string& text) {
  Declaration declaration;
  declaration.name = name;
  declaration.kind = ParameterKind::kNumbers;
  declaration.unit = unit;
  declaration.range = range;
  declaration.count_min = count_min;
  declaration.count_max = count_max;
  declaration.required = true;
  declaration.text = text;
  return declare(declaration).numbers;
}

std::vector<Record> Parameters::records(const std::string& name,
                                        const std::vector<RecordField>& fields,
                                        const std::string& text) {
  Declaration declaration;
  declaration.name = name;
  declaration.kind = ParameterKind::kRecords;
  declaration.fields = fields;
  declaration.fallback = "[]";
  declaration.text = text;
  return declare(declaration).records;
}

}  // namespace usher::runtime
