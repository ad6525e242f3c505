#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "operations/command_line/commands.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/table.hpp"
#include "operations/command_line/usage.hpp"
#include "operations/host/doctor.hpp"
#include "operations/host/service.hpp"
#include "operations/launcher/run_places.hpp"
#include "operations/security/keys.hpp"

namespace usher::operations {

namespace {

constexpr const char* kUnits = "/etc/systemd/system";

/// Asks at the terminal; no without one.
bool agreed(const std::string& question) {
  if (isatty(STDIN_FILENO) == 0) return false;
  std::cout << question << " [y/N] " << std::flush;
  std::string answer;
  return std::getline(std::cin, answer) && (answer == "y" || answer == "yes");
}

struct KeysArguments {
  std::string folder;
  std::string manifest;
  KeysOptions options;
  bool yes = false;
};

int keys(const KeysArguments& arguments) {
  const auto installation = Installation::of_this_program();
  const std::string path =
      arguments.manifest.empty() ? installation.share + "/deploy/marvin.yaml" : arguments.manifest;
  const auto contracts = read_contracts(installation.contracts);
  if (!contracts) return fail(contracts.error());
  const auto manifest = read_manifest(path, config_directories(path, installation));
  if (!manifest) return fail(manifest.error());
  if (arguments.options.renew && !arguments.yes && has_keys(arguments.folder) &&
      !agreed("Make all keys in " + arguments.folder +
              " anew? Hosts that have the old ones will be refused."))
    return fail("the keys in " + arguments.folder + " stay as they are (--yes makes them anew)");
  const auto made = make_keys(arguments.folder, manifest->name,
                              permissions_of(*manifest, *contracts), arguments.options);
  if (!made) return fail(made.error());
  Table table({"identity", "host", "key"});
  for (const auto& entry : *made) {
    const auto* component = manifest->component(entry.name);
    table.add(
        {entry.name, component != nullptr ? component->host : "-", entry.made ? "new" : "kept"});
  }
  std::cout
      << table.text() << "permissions and governance are signed for domain " << manifest->domain
      << "; a host needs ca.pem, governance.smime and the folders launcher, operator and those "
         "of what runs there"
      << (manifest->discovery_server.host.empty()
              ? ""
              : ", discovery_server on " + manifest->discovery_server.host)
      << "\n"
      << "keep " << arguments.folder << "/ca.key off the robot\n";
  return 0;
}

struct InstallArguments {
  std::string manifest;
  std::string host;
  std::string folder;
  std::string user;
  bool systemd = false;
  bool sysctl = false;
};

/// Says what it wrote.
bool write(const std::string& path, const std::string& text) {
  std::ofstream out(path, std::ios::trunc);
  out << text;
  out.close();
  if (!out) return fail("cannot write " + path + ": " + std::strerror(errno)) == 0;
  std::cout << "wrote " << path << "\n";
  return true;
}

int install_units(const InstallArguments& arguments) {
  if (arguments.manifest.empty()) return misused("--systemd needs a manifest");
  const auto installation = Installation::of_this_program();
  const auto deployment = load_deployment(arguments.manifest, installation, {}, keys_folder());
  if (!deployment) return fail(deployment.error());
  for (const auto& finding : deployment->findings) std::cerr << to_string(finding) << "\n";
  if (!deployment->findings.empty())
    return fail("this deployment could not work; nothing was installed");
  const Manifest& manifest = deployment->manifest;
  if (!arguments.host.empty() && manifest.host(arguments.host) == nullptr)
    return fail("unknown host '" + arguments.host + "' (" + manifest.path + ")");
  // Units that go elsewhere are another machine's.
  if (arguments.folder == kUnits && !arguments.user.empty() &&
      getpwnam(arguments.user.c_str()) == nullptr)
    return fail("unknown user '" + arguments.user + "'; nothing was installed");
  std::string remark;  // one line for each host: nobody pastes the unit of another one
  for (const auto& host : manifest.hosts) {
    if (!arguments.host.empty() && host.name != arguments.host) continue;
    const bool used = std::any_of(manifest.components.begin(), manifest.components.end(),
                                  [&](const ManifestComponent& c) { return c.host == host.name; });
    if (!used && arguments.host.empty()) continue;  // nothing to run there
    const auto unit = service_unit(
        manifest, {.program = installation.programs + "/usher",
                   .manifest = std::filesystem::absolute(arguments.manifest).lexically_normal(),
                   .host = host.name,
                   .keys = keys_folder(),
                   .user = arguments.user});
    if (!write(arguments.folder + "/" + unit.name, unit.text)) return 1;
    remark += "on " + host.name + ": systemctl daemon-reload && systemctl enable --now " +
              unit.name + "\n";
  }
  std::cout << remark;
  return 0;
}

int install(const InstallArguments& arguments) {
  if (!arguments.systemd && !arguments.sysctl)
    return misused("nothing to install: expected --systemd MANIFEST or --sysctl");
  if (arguments.sysctl) {
    if (!write(kSysctlPath, sysctl_file())) return 1;
    std::cout << "`sysctl --system` applies it now, a boot from then on\n";
  }
  return arguments.systemd ? install_units(arguments) : 0;
}

/// Exit code 0 unless something is bad.
int doctor(std::uint32_t domain) {
  auto found = examine_host(default_run_directory(domain, ""));
  if (!keys_folder().empty()) {
    for (auto& diagnosis : examine_keys(keys_folder())) found.push_back(std::move(diagnosis));
  }
  Table table({"what", "verdict", "found", "remedy"});
  bool bad = false;
  for (const auto& diagnosis : found) {
    bad = bad || diagnosis.verdict == Diagnosis::Verdict::kBad;
    table.add({diagnosis.subject, to_string(diagnosis.verdict), diagnosis.found, diagnosis.remedy});
  }
  std::cout << table.text();
  return bad ? 1 : 0;
}

}  // namespace

void add_host_commands(CLI::App& app, int& exit_code) {
  auto installing = std::make_shared<InstallArguments>();
  installing->folder = kUnits;
  auto* install_command =
      app.add_subcommand("install", "Make this machine run a deployment from boot on");
  install_command->add_flag("--systemd", installing->systemd,
                            "Write a unit for each host of a manifest, or for --host");
  install_command->add_option("manifest", installing->manifest, "Manifest file of --systemd");
  install_command->add_option("--host", installing->host, "Of --systemd: only this host's unit");
  install_command->add_option("--to", installing->folder, "Of --systemd: folder of the units")
      ->capture_default_str();
  install_command->add_option("--user", installing->user,
                              "Of --systemd: who runs it; root unless given");
  install_command->add_flag("--sysctl", installing->sysctl,
                            "Write the UDP buffer sizes to " + std::string(kSysctlPath) +
                                "; `sysctl --system` applies them");
  install_command->callback([installing, &exit_code] { exit_code = install(*installing); });

  auto domain = std::make_shared<std::uint32_t>(0);
  auto* doctor_command = app.add_subcommand(
      "doctor", "Examine this machine: buffers, multicast, clock, rights; with --keys the keys");
  doctor_command->add_option("--domain", *domain, "DDS domain")
      ->check(domain_number())
      ->capture_default_str();
  doctor_command->callback([domain, &exit_code] { exit_code = doctor(*domain); });

  auto arguments = std::make_shared<KeysArguments>();
  auto* keys_command = app.add_subcommand(
      "keys", "Make identities and permissions of a manifest's components; what is there is kept");
  keys_command->add_option("folder", arguments->folder, "Where the keys are or shall be")
      ->required();
  keys_command->add_option("--manifest", arguments->manifest,
                           "Manifest file; the shipped marvin.yaml unless given");
  keys_command->add_option("--days", arguments->options.days, "Validity of what is signed now")
      ->check(within(1, 36500))
      ->capture_default_str();
  keys_command->add_flag("--renew", arguments->options.renew,
                         "Make everything anew, the CA too; asks first");
  keys_command->add_flag("--yes", arguments->yes, "Do not ask");
  keys_command->callback([arguments, &exit_code] { exit_code = keys(*arguments); });
}

}  // namespace usher::operations
