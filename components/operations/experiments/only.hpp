#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::operations {

/// What `--only` chose of an experiment's inputs: all of them, one, or one run of it.
struct Only {
  std::string name;          ///< empty = all
  std::uint64_t number = 0;  ///< of the run, from 1 on; 0 = all runs

  bool takes(std::string_view input) const { return name.empty() || name == input; }
};

/// Reads `--only`: empty, or one of `names`.
Result<Only> only_of(const std::string& text, const std::vector<std::string>& names);
/// The same, or one run of one of them: "lace_5".
Result<Only> only_run_of(const std::string& text, const std::vector<std::string>& names);
/// Reads an `--only` that takes a seed from 1 on; 0 where it is empty.
Result<std::uint64_t> only_seed(const std::string& text);

/// "--only takes follows, lace or leaves, not lase; did you mean lace?"
Error wrong_only(const std::string& text, const std::vector<std::string>& names,
                 const std::string& besides = {});

/// The member `name` of all that an experiment has.
template <class Inputs>
std::vector<std::string> names_of(const Inputs& inputs) {
  std::vector<std::string> names;
  names.reserve(inputs.size());
  for (const auto& input : inputs) names.emplace_back(input.name);
  return names;
}

}  // namespace usher::operations
