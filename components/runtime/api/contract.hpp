#pragma once

#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "runtime/api/parameters.hpp"
#include "runtime/api/ports.hpp"

namespace usher::runtime {

/// What a component declares, as `usher-<component> --contract` prints it and `usher check` reads
/// it.
struct Contract {
  struct InputPort {
    std::string topic, type, on_loss;
    Qos qos;
    double rate_hz = 0.0, max_age = 0.0;
    bool optional = false;
    topics::Scope scope = topics::Scope::kRobot;
  };
  struct OutputPort {
    std::string topic, type;
    Qos qos;
    double rate_hz = 0.0;
    topics::Scope scope = topics::Scope::kRobot;
  };
  struct Parameter {
    std::string name, unit, fallback, text;
    ParameterKind kind = ParameterKind::kNumber;
    Range range{};
    bool required = false;
    std::vector<std::string> options;
    std::vector<RecordField> fields;
    std::size_t count_min = 0, count_max = 0;
  };
  struct Timer {
    std::string name;
    double period = 0.0;
  };

  std::string component;
  std::string version;
  std::string idl_digest;
  std::vector<InputPort> inputs;
  std::vector<OutputPort> outputs;
  std::vector<Parameter> parameters;
  std::vector<Timer> timers;
};

std::string to_yaml(const Contract& contract);
/// `where` names the source in errors.
Result<Contract> contract_from_yaml(const std::string& yaml, const std::string& where);

}  // namespace usher::runtime
