#include "runtime/parameters/parameter_set.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "foundation/text/suggestion.hpp"
#include "runtime/parameters/interpret.hpp"
#include "runtime/parameters/units.hpp"

namespace usher::runtime {
namespace {

/// Zero where the range allows it, else the end of the range that is nearer to it.
double harmless(const Range& range) { return std::clamp(0.0, range.low, range.high); }

}  // namespace

ParameterSet::ParameterSet(std::vector<ParameterValue> values, std::string where, Missing missing)
    : values_(std::move(values)), where_(std::move(where)), missing_(missing) {}

void ParameterSet::check_declaration(const Contract::Parameter& parameter) {
  const auto wrong = [&](const std::string& what) {
    errors_.push_back("programming error: parameter " + parameter.name + " " + what);
  };
  const auto check_rule = [&](const std::string& unit, const Range& range) {
    if (!is_si(unit)) wrong("is declared in the unit \"" + unit + "\", which is not SI");
    if (!(range.low <= range.high)) {
      wrong("has the empty range [" + shortest(range.low) + ", " + shortest(range.high) + "]");
    }
  };
  if (parameter.name.empty()) wrong("has no name");
  if (parameter.text.empty()) wrong("has no text");
  check_rule(parameter.unit, parameter.range);
  for (const RecordField& field : parameter.fields) {
    if (field.kind != ParameterKind::kText) check_rule(field.unit, field.range);
  }
  if (parameter.kind == ParameterKind::kNumbers && parameter.count_min > parameter.count_max) {
    wrong("has an empty range of counts");
  }
  if (std::any_of(declared_.begin(), declared_.end(),
                  [&](const auto& other) { return other.name == parameter.name; })) {
    wrong("is declared twice");
  }
}

Parameters::Value ParameterSet::declare(const Declaration& declaration) {
  Contract::Parameter parameter;
  parameter.name = declaration.name;
  parameter.unit = declaration.unit;
  parameter.fallback = declaration.fallback;
  parameter.text = declaration.text;
  parameter.kind = declaration.kind;
  parameter.range = declaration.range;
  parameter.required = declaration.required;
  parameter.options = declaration.options;
  parameter.fields = declaration.fields;
  parameter.count_min = declaration.count_min;
  parameter.count_max = declaration.count_max;
  const std::size_t errors_before = errors_.size();
  check_declaration(parameter);

  Interpretation value;
  value.number = harmless(parameter.range);
  if (!parameter.required) {
    // The default passes the same judge: a bad one is found by every test that makes the component.
    auto fallback =
        interpret(parameter, {parameter.name, parameter.fallback, "the declared default"});
    if (fallback) {
      value = std::move(*fallback);
    } else if (errors_.size() == errors_before) {
      errors_.push_back("programming error: " + fallback.error());
    }
  }
  const auto given = std::find_if(values_.begin(), values_.end(), [&](const ParameterValue& each) {
    return each.name == parameter.name;
  });
  if (given != values_.end()) {
    auto read = interpret(parameter, *given);
    if (read) {
      value = std::move(*read);
    } else {
      errors_.push_back(read.error());
    }
  } else if (parameter.required && missing_ == Missing::kIsError) {
    errors_.push_back(parameter.name + " must be set to " + expectation(parameter) + " (" + where_ +
                      "): " + parameter.text);
  }
  declared_.push_back(std::move(parameter));
  return {value.number, std::move(value.text), std::move(value.numbers), std::move(value.records)};
}

Status ParameterSet::finish(bool all_declared) const {
  std::vector<std::string> errors = errors_;
  std::vector<std::string> known;
  known.reserve(declared_.size());
  for (const auto& parameter : declared_) known.push_back(parameter.name);
  for (const ParameterValue& value : values_) {
    if (!all_declared || std::find(known.begin(), known.end(), value.name) != known.end()) continue;
    errors.push_back("unknown parameter " + value.name + " (" + value.origin + ")" +
                     suggestion(value.name, known));
  }
  if (errors.empty()) return {};
  std::string text = std::move(errors.front());
  for (std::size_t i = 1; i < errors.size(); ++i) text += "\n" + errors[i];
  return Error{std::move(text)};
}

}  // namespace usher::runtime
