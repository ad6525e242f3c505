#include "operations/experiments/only.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include "foundation/text/suggestion.hpp"

namespace usher::operations {

namespace {

constexpr std::uint64_t kLastRun = 1000000;

std::optional<std::uint64_t> run_number(std::string_view text) {
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || rest != end || number < 1 || number > kLastRun) return std::nullopt;
  return number;
}

}  // namespace

Error wrong_only(const std::string& text, const std::vector<std::string>& names,
                 const std::string& besides) {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i)
    list += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + names[i];
  return {"--only takes " + list + besides + ", not " + text + suggestion(text, names)};
}

Result<Only> only_of(const std::string& text, const std::vector<std::string>& names) {
  if (text.empty() || std::find(names.begin(), names.end(), text) != names.end())
    return Only{text, 0};
  return wrong_only(text, names);
}

Result<Only> only_run_of(const std::string& text, const std::vector<std::string>& names) {
  if (const auto all = only_of(text, names)) return all;
  const auto underscore = text.rfind('_');
  if (underscore != std::string::npos) {
    const auto number = run_number(std::string_view(text).substr(underscore + 1));
    const auto one = only_of(text.substr(0, underscore), names);
    if (number && one && !one->name.empty()) return Only{one->name, *number};
  }
  return wrong_only(text, names, ", or one run as " + names.front() + "_5");
}

Result<std::uint64_t> only_seed(const std::string& text) {
  if (text.empty()) return std::uint64_t{0};
  const auto seed = run_number(text);
  if (!seed) return Error{"--only takes a seed from 1 on, not " + text};
  return *seed;
}

}  // namespace usher::operations
