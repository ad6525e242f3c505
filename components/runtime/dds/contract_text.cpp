#include "runtime/dds/contract_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace usher::runtime {
namespace {

using Row = std::vector<std::string>;

std::string number(double value) {
  if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

std::string rate(double hertz) { return hertz > 0.0 ? number(hertz) + " Hz" : "on occasion"; }

std::string quality(const Qos& qos) {
  return std::string(qos.latched    ? "latched"
                     : qos.reliable ? "reliable"
                                    : "best effort") +
         ", depth " + std::to_string(qos.depth);
}

std::string scope(topics::Scope scope) { return scope == topics::Scope::kFleet ? " (fleet)" : ""; }

/// Columns aligned under their titles; nothing when there are no rows.
std::string table(const std::string& title, const std::vector<Row>& rows) {
  if (rows.size() < 2) return {};
  std::vector<std::size_t> widths(rows[0].size());
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text = '\n' + title + '\n';
  for (const Row& row : rows) {
    std::string line = "  ";
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i];
      if (i + 1 < row.size()) line += std::string(widths[i] - row[i].size() + 2, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

std::string values(const Contract::Parameter& parameter) {
  if (!parameter.options.empty()) {
    std::string text;
    for (const std::string& option : parameter.options)
      text += (text.empty() ? "" : " | ") + option;
    return text;
  }
  switch (parameter.kind) {
    case ParameterKind::kInteger:
    case ParameterKind::kNumber:
    case ParameterKind::kNumbers:
      return number(parameter.range.low) + ".." + number(parameter.range.high) +
             (parameter.unit == "-" ? "" : ' ' + parameter.unit);
    case ParameterKind::kFlag:
      return "true | false";
    case ParameterKind::kRecords: {
      std::string text;
      for (const RecordField& field : parameter.fields)
        text += (text.empty() ? "list of {" : ", ") + field.name;
      return text + '}';
    }
    case ParameterKind::kText:
    case ParameterKind::kChoice:
    case ParameterKind::kFile:
      return "text";
  }
  return {};
}

}  // namespace

std::string to_table(const Contract& contract) {
  std::vector<Row> inputs{{"topic", "type", "rate", "quality", "oldest", "when it is lost"}};
  for (const auto& port : contract.inputs) {
    inputs.push_back({port.topic + scope(port.scope) + (port.optional ? " (optional)" : ""),
                      port.type, rate(port.rate_hz), quality(port.qos),
                      port.max_age > 0.0 ? number(port.max_age) + " s" : "-", port.on_loss});
  }
  std::vector<Row> outputs{{"topic", "type", "rate", "quality"}};
  for (const auto& port : contract.outputs) {
    outputs.push_back(
        {port.topic + scope(port.scope), port.type, rate(port.rate_hz), quality(port.qos)});
  }
  std::vector<Row> parameters{{"name", "values", "default", "meaning"}};
  for (const auto& parameter : contract.parameters) {
    parameters.push_back({parameter.name, values(parameter),
                          parameter.required ? "(required)" : parameter.fallback, parameter.text});
  }
  return table("Inputs", inputs) + table("Outputs", outputs) + table("Parameters", parameters);
}

}  // namespace usher::runtime
