#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace usher::runtime {

/// Closed range of allowed values.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

enum class ParameterKind { kFlag, kInteger, kNumber, kText, kChoice, kFile, kNumbers, kRecords };

/// One column of a parameter that is a list of records.
struct RecordField {
  std::string name;
  ParameterKind kind = ParameterKind::kNumber;  ///< kFlag, kInteger, kNumber or kText
  std::string unit;                             ///< of numbers; "-" for none
  Range range{};
  std::string text;
};

/// One entry of such a list: every declared field is there.
class Record {
 public:
  double number(const std::string& field) const { return numbers.at(field); }
  const std::string& text(const std::string& field) const { return texts.at(field); }
  bool flag(const std::string& field) const { return numbers.at(field) != 0.0; }

  std::map<std::string, double> numbers;
  std::map<std::string, std::string> texts;
};

/// The parameters of one component: declared and read in one call, in the component's constructor,
/// constant after it.
///
/// A name that starts with "robot." or "site." belongs to the robot's or site's file and can be set
/// only there
/// ("robot.lms100.mount_x" is `lms100: {mount_x: 0.2 m}` in config/robots/marvin.yaml). Every other
/// name is the component's own, set by robot, site, manifest or command line, the last one winning.
///
/// Values are written with or without a unit: `0.47`, `0.47 m`, `470 mm`, `20 deg`; the call gives
/// SI. A value that is missing without a default, has another unit, type or range, or a key that
/// nobody declared, is an error that names what was expected, what was found and file:line. Errors
/// are collected: the host refuses to start the component and prints all of them; until then the
/// calls return the default or the range's lower end.
class Parameters {
 public:
  virtual ~Parameters() = default;

  bool flag(const std::string& name, bool fallback, const std::string& text);
  std::int64_t integer(const std::string& name, const std::string& unit, Range range,
                       std::int64_t fallback, const std::string& text);
  double number(const std::string& name, const std::string& unit, Range range, double fallback,
                const std::string& text);
  /// Must be set somewhere: the robot's or site's own facts have no default.
  double number(const std::string& name, const std::string& unit, Range range,
                const std::string& text);
  std::string text(const std::string& name, const std::string& fallback, const std::string& text);
  std::string choice(const std::string& name, const std::vector<std::string>& options,
                     const std::string& fallback, const std::string& text);
  /// A path; relative ones are meant relative to the file that sets it and arrive here absolute.
  /// Empty = none.
  std::string file(const std::string& name, const std::string& fallback, const std::string& text);
  std::vector<double> numbers(const std::string& name, const std::string& unit, Range range,
                              std::size_t count_min, std::size_t count_max,
                              const std::vector<double>& fallback, const std::string& text);
  /// Must be set somewhere.
  std::vector<double> numbers(const std::string& name, const std::string& unit, Range range,
                              std::size_t count_min, std::size_t count_max,
                              const std::string& text);
  /// A list of records; empty when it is not set.
  std::vector<Record> records(const std::string& name, const std::vector<RecordField>& fields,
                              const std::string& text);

 protected:
  struct Declaration {
    std::string name;
    ParameterKind kind = ParameterKind::kNumber;
    std::string unit = "-";
    Range range{};
    bool required = false;
    std::string fallback;  ///< as YAML
    std::vector<std::string> options;
    std::vector<RecordField> fields;
    std::size_t count_min = 0;
    std::size_t count_max = 0;
    std::string text;
  };
  /// What was given for a declared parameter, checked against it. Exactly one member is meaningful,
  /// by kind.
  struct Value {
    double number = 0.0;
    std::string text;
    std::vector<double> numbers;
    std::vector<Record> records;
  };
  /// Records the declaration and returns its value.
  virtual Value declare(const Declaration& declaration) = 0;
};

}  // namespace usher::runtime
