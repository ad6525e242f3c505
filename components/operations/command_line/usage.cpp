#include "operations/command_line/usage.hpp"

#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <vector>

#include "foundation/text/suggestion.hpp"

namespace usher::operations {

namespace {

constexpr int kFailed = 1;
constexpr int kMisused = 2;
constexpr double kLastDomain = 232;

int told(const std::string& message, int exit_code) {
  std::cerr << "usher: " << message << "\n";
  return exit_code;
}

/// The commands that were named, from the program to the last one: "usher map save".
std::vector<const CLI::App*> named(const CLI::App& app) {
  std::vector<const CLI::App*> commands{&app};
  for (auto below = app.get_subcommands(); !below.empty();
       below = commands.back()->get_subcommands())
    commands.push_back(below.front());
  return commands;
}

struct Complaint {
  std::string text;
  std::string meant;  ///< "; did you mean --seeds?", or empty
};

/// What is wrong, better than the library says it where nobody knows a word.
Complaint complaint(const CLI::App& app, const CLI::ParseError& error) {
  const auto rest = app.remaining(true);
  if (rest.empty()) return {error.what(), {}};
  const std::string& word = rest.front();
  const auto commands = named(app);
  std::vector<std::string> known;
  if (!word.starts_with('-')) {
    for (const auto* command : commands.back()->get_subcommands({}))
      known.push_back(command->get_name());
    if (known.empty()) return {"unexpected '" + word + "'", {}};
    return {"unknown command '" + word + "'", suggestion(word, known)};
  }
  for (const auto* command : commands) {
    for (const auto* option : command->get_options()) {
      for (const auto& name : option->get_lnames()) known.push_back("--" + name);
    }
  }
  const std::string option = word.substr(0, word.find('='));
  return {"unknown option " + option, suggestion(option, known)};
}

}  // namespace

int fail(const std::string& message) { return told(message, kFailed); }

int misused(const std::string& message) { return told(message, kMisused); }

std::optional<int> ended_by(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::ParseError& error) {
    std::string path;
    for (const auto* command : named(app)) path += command->get_name() + " ";
    const auto [text, meant] = complaint(app, error);
    return misused(text + "; see " + path + "--help" + meant);
  }
  return std::nullopt;
}

CLI::Validator within(double low, double high) {
  std::ostringstream range;
  range << std::setprecision(9) << "[" << low << ", " << high << "]";
  return CLI::Validator(
      [low, high, range = range.str()](const std::string& text) -> std::string {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        if (!text.empty() && *end == '\0' && value >= low && value <= high) return {};
        return "must be in " + range + ", got '" + text + "'";
      },
      "in " + range.str());
}

CLI::Validator domain_number() { return within(0, kLastDomain); }

}  // namespace usher::operations
