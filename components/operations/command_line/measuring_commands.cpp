#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>

#include "foundation/text/suggestion.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/command_line/usage.hpp"

namespace usher::operations {

namespace {

/// Becomes another program of the installation.
int become(const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::cout << std::flush;
  execv(program.c_str(), pointers.data());
  return fail("cannot run " + program + ": " + std::strerror(errno));
}

constexpr const char* kBenchPrefix = "usher-bench-";

std::vector<std::string> benchmarks(const std::string& programs) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(programs)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(kBenchPrefix)) names.push_back(name.substr(std::strlen(kBenchPrefix)));
  }
  std::sort(names.begin(), names.end());
  return names;
}

int bench(const std::string& name, bool list, const std::vector<std::string>& rest) {
  const auto installation = Installation::of_this_program();
  const auto names = benchmarks(installation.programs);
  if (list || name.empty()) {
    for (const auto& known : names) std::cout << known << "\n";
    return list ? 0 : misused("name a benchmark of the list above");
  }
  if (std::find(names.begin(), names.end(), name) == names.end())
    return misused("unknown benchmark '" + name + "'; see usher bench --list" +
                   suggestion(name, names));
  return become(installation.programs + "/" + kBenchPrefix + name, rest);
}

}  // namespace

void add_measuring_commands(CLI::App& app, int& exit_code) {
  auto name = std::make_shared<std::string>();
  auto list = std::make_shared<bool>(false);
  auto* bench_command = app.add_subcommand(
      "bench", "Measure performance: usher bench NAME [--json] [--instructions]");
  bench_command->add_option("name", *name, "Which one");
  bench_command->add_flag("--list", *list, "Name them all");
  bench_command->footer(
      "Of each benchmark:\n"
      "  --json                      Print one JSON object\n"
      "  --instructions              Also count instructions, under valgrind\n"
      "  --benchmark_*               Options of Google Benchmark\n" +
      std::string(kExitCodes) + ", 4 the input data is absent");
  bench_command->allow_extras();
  bench_command->fallthrough(false);  // what it does not know is for the other program
  bench_command->callback(
      [=, &exit_code] { exit_code = bench(*name, *list, bench_command->remaining()); });

  auto* experiment_command = app.add_subcommand(
      "experiment",
      "Run an experiment: usher experiment NAME [--seeds N] [--out DIR]; --list names them all");
  experiment_command->set_help_flag();  // the other program knows its options
  experiment_command->prefix_command();
  experiment_command->fallthrough(false);
  experiment_command->callback([=, &exit_code] {
    exit_code = become(Installation::of_this_program().programs + "/usher-experiment",
                       experiment_command->remaining());
  });
}

}  // namespace usher::operations
