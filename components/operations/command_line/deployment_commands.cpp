#include <iostream>
#include <map>
#include <memory>
#include <set>

#include "idl/topics.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/command_line/judging.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/usage.hpp"

namespace usher::operations {

namespace {

int check(const std::vector<std::string>& manifests, const std::vector<Override>& overrides) {
  const auto installation = Installation::of_this_program();
  int bad = 0;
  for (const auto& path : manifests) {
    auto deployment = load_deployment(path, installation, overrides, keys_folder());
    if (!deployment) {
      ++bad;
      std::cout << to_string(finding_of(Verdict::kUnreadable, deployment.error(), path)) << "\n";
      continue;
    }
    if (deployment->findings.empty())
      deployment->findings = judge_by_components(*deployment, installation);
    for (const auto& finding : deployment->findings) {
      std::cout << to_string(finding) << "\n";
    }
    if (!deployment->findings.empty()) ++bad;
    if (deployment->findings.empty()) {
      const auto hosts = deployment->manifest.hosts.size();
      std::cout << path << ": good, " << deployment->manifest.components.size() << " components on "
                << hosts << (hosts == 1 ? " host\n" : " hosts\n");
    }
  }
  return bad == 0 ? 0 : 1;
}

/// The types that a manifest needs, for building no more than those.
int components(const std::string& path) {
  const auto manifest =
      read_manifest(path, config_directories(path, Installation::of_this_program()));
  if (!manifest) return fail(manifest.error());
  std::set<std::string> types;
  for (const auto& component : manifest->components) {
    types.insert(component.type);
    if (!component.group.empty()) types.insert("group");
  }
  for (const auto& type : types) std::cout << type << "\n";
  return 0;
}

/// The data flow in the language of graphviz: components as boxes in their hosts, topics as edges,
/// those of a fleet dashed: they come from the other robots too.
int graph(const std::string& path) {
  const auto installation = Installation::of_this_program();
  const auto contracts = read_contracts(installation.contracts);
  const auto manifest = read_manifest(path, config_directories(path, installation));
  if (!contracts) return fail(contracts.error());
  if (!manifest) return fail(manifest.error());
  std::cout << "digraph \"" << manifest->name
            << "\" {\n  rankdir=LR; node [shape=box, style=rounded];\n";
  for (std::size_t i = 0; i < manifest->hosts.size(); ++i) {
    std::cout << "  subgraph cluster_" << i << " { label=\"" << manifest->hosts[i].name << "\";";
    for (const auto& component : manifest->components) {
      if (component.host == manifest->hosts[i].name) std::cout << " \"" << component.name << "\";";
    }
    std::cout << " }\n";
  }
  std::map<std::string, std::vector<std::string>> writers;
  for (const auto& component : manifest->components) {
    const auto contract = contracts->find(component.type);
    if (contract == contracts->end()) {
      std::cerr << "usher: " << component.name << " is drawn alone: no contract of the type '"
                << component.type << "' here\n";
      continue;
    }
    for (const auto& output : contract->second.outputs)
      writers[output.topic].push_back(component.name);
  }
  for (const auto& component : manifest->components) {
    const auto contract = contracts->find(component.type);
    if (contract == contracts->end()) continue;
    for (const auto& input : contract->second.inputs) {
      if (input.topic == topics::kHeartbeat.name || input.topic == topics::kTf.name ||
          input.topic == topics::kTfStatic.name)
        continue;
      for (const auto& writer : writers[input.topic]) {
        const bool of_fleet = input.scope == topics::Scope::kFleet;
        if (of_fleet && manifest->fleet.robot.empty()) continue;
        std::cout << "  \"" << writer << "\" -> \"" << component.name << "\" [label=\""
                  << input.topic << "\"" << (of_fleet ? ", style=dashed" : "") << "];\n";
      }
    }
  }
  std::cout << "}\n";
  return 0;
}

}  // namespace

void add_set_option(CLI::App& command, std::vector<Override>& overrides) {
  command
      .add_option_function<std::vector<std::string>>(
          "--set",
          [&overrides](const std::vector<std::string>& texts) {
            for (const auto& text : texts) {
              auto parsed = parse_override(text);
              if (!parsed) throw CLI::ValidationError("--set", parsed.error());
              overrides.push_back(std::move(parsed).value());
            }
          },
          "COMPONENT.PARAMETER=VALUE, over everything else")
      ->allow_extra_args(false);
}

void add_deployment_commands(CLI::App& app, int& exit_code) {
  auto manifests = std::make_shared<std::vector<std::string>>();
  auto overrides = std::make_shared<std::vector<Override>>();
  auto* check_command =
      app.add_subcommand("check", "Judge manifests offline: wiring, rates, values, policies");
  check_command->add_option("manifest", *manifests, "Manifest files")->required();
  add_set_option(*check_command, *overrides);
  check_command->callback(
      [manifests, overrides, &exit_code] { exit_code = check(*manifests, *overrides); });

  auto manifest = std::make_shared<std::string>();
  auto* components_command =
      app.add_subcommand("components", "List the component types that a manifest needs");
  components_command->add_option("manifest", *manifest, "Manifest file")->required();
  components_command->callback([manifest, &exit_code] { exit_code = components(*manifest); });

  auto* graph_command = app.add_subcommand(
      "graph", "Print who sends what to whom, for graphviz (| dot -Tsvg > graph.svg)");
  graph_command->add_option("manifest", *manifest, "Manifest file")->required();
  graph_command->callback([manifest, &exit_code] { exit_code = graph(*manifest); });
}

}  // namespace usher::operations
