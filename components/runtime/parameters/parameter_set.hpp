#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "runtime/api/contract.hpp"
#include "runtime/api/parameters.hpp"
#include "runtime/parameters/parameter_file.hpp"

namespace usher::runtime {

/// The values that one component was given, read as it declares them. Collects errors instead of
/// failing.
class ParameterSet final : public Parameters {
 public:
  enum class Missing { kIsError, kIsFine };

  /// `where` stands for the file in errors about values that are not there.
  explicit ParameterSet(std::vector<ParameterValue> values, std::string where,
                        Missing missing = Missing::kIsError);

  /// After the component is constructed: all errors so far and the values that nobody declared, one
  /// a line; without those where the constructor did not come to declare all of its own.
  Status finish(bool all_declared = true) const;
  /// What the component declared, in its order.
  const std::vector<Contract::Parameter>& declared() const { return declared_; }

 protected:
  Value declare(const Declaration& declaration) override;

 private:
  void check_declaration(const Contract::Parameter& parameter);

  std::vector<ParameterValue> values_;
  std::string where_;
  Missing missing_;
  std::vector<Contract::Parameter> declared_;
  std::vector<std::string> errors_;
};

}  // namespace usher::runtime
