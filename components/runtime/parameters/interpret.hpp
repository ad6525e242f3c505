#pragma once

#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "runtime/api/contract.hpp"
#include "runtime/parameters/parameter_file.hpp"

namespace usher::runtime {

/// A parameter's value in SI. By kind: number (flags as 0 and 1), text, numbers or records.
struct Interpretation {
  double number = 0.0;
  std::string text;
  std::vector<double> numbers;
  std::vector<Record> records;
};

/// Reads a value as it is declared; the one place that judges types, units, ranges and counts, for
/// components and for `usher check`. An error says what was expected, what was found and where:
/// `sigma_hit must be in [0.005, 0.5] m, got 5 m (config/robots/marvin.yaml:12)`.
Result<Interpretation> interpret(const Contract::Parameter& declared, const ParameterValue& given);

/// What may be given: "a number in [0.005, 0.5] m", "one of a, b, c".
std::string expectation(const Contract::Parameter& declared);

}  // namespace usher::runtime
