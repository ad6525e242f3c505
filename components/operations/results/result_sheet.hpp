#pragma once

#include <map>
#include <string>

#include "foundation/result/result.hpp"

namespace usher::operations {

enum class Bound { kAtMost, kAtLeast };

/// What an experiment or a benchmark found; printed as one object of one shape:
/// {"name", "input", "metrics": {key: number}, "published": {key: number}, "targets": {key:
/// number}, "pass": bool}.
struct ResultSheet {
  struct Target {
    Bound bound = Bound::kAtMost;
    double value = 0.0;
  };

  std::string name;
  std::string input;
  std::map<std::string, double> metrics;
  std::map<std::string, bool> flags;  ///< metrics that are true or false; each must be true to pass
  std::map<std::string, double> published;  ///< what others reach
  std::map<std::string, Target> targets;

  /// Every flag is true, every target has a metric and holds.
  bool pass() const;
  /// Numbers with all their digits; not finite ones as null.
  std::string json() const;
  /// A row for each metric: found, target, published.
  std::string markdown() const;
};

/// Writes a text file as a whole; the error names it.
Status write_file(const std::string& path, const std::string& text);

}  // namespace usher::operations
