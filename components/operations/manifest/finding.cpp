#include "operations/manifest/finding.hpp"

#include <algorithm>
#include <cctype>

namespace usher::operations {

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kUnreadable:
      return "unreadable";
    case Verdict::kUnknownType:
      return "unknown type";
    case Verdict::kUnknownHost:
      return "unknown host";
    case Verdict::kUnknownKey:
      return "unknown key";
    case Verdict::kWrongValue:
      return "wrong value";
    case Verdict::kMissingValue:
      return "missing value";
    case Verdict::kMissingFile:
      return "missing file";
    case Verdict::kMisplaced:
      return "misplaced";
    case Verdict::kNoWriter:
      return "no writer";
    case Verdict::kTwoWriters:
      return "two writers";
    case Verdict::kUnauthorizedWriter:
      return "unauthorized writer";
    case Verdict::kTypeMismatch:
      return "type mismatch";
    case Verdict::kQosMismatch:
      return "QoS mismatch";
    case Verdict::kRateTooLow:
      return "rate too low";
    case Verdict::kUnsafePolicy:
      return "unsafe policy";
    case Verdict::kSplitDriveChain:
      return "split drive chain";
    case Verdict::kSplitGroup:
      return "split group";
    case Verdict::kWrongIdl:
      return "wrong IDL";
    case Verdict::kNoPermission:
      return "no permission";
  }
  return "?";
}

Finding finding_of(Verdict verdict, const std::string& error, const std::string& origin) {
  if (!error.ends_with(')')) return {verdict, error, origin};
  std::size_t open = error.size() - 1;  // a path may have parentheses of its own
  for (int depth = 1; depth > 0 && open > 0;) {
    --open;
    depth += error[open] == ')' ? 1 : error[open] == '(' ? -1 : 0;
  }
  if (open == 0 || error[open - 1] != ' ') return {verdict, error, origin};
  const std::string place = error.substr(open + 1, error.size() - open - 2);
  const bool has_name = std::ranges::any_of(
      place, [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; });
  if (!has_name) return {verdict, error, origin};  // "(0.3, 0.1)" belongs to the error
  return {verdict, error.substr(0, open - 1), place};
}

std::string to_string(const Finding& finding) {
  return finding.origin + ": " + to_string(finding.verdict) + ": " + finding.text;
}

}  // namespace usher::operations
