#include "operations/command_line/installation.hpp"

#include <filesystem>

#include "operations/security/keys.hpp"

namespace usher::operations {

namespace fs = std::filesystem;

Installation Installation::of_this_program() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path root = program.parent_path().parent_path();
  const fs::path share = root / "share" / "usher";
  return {program.parent_path().string(), (share / "contracts").string(), share.string()};
}

std::vector<std::string> config_directories(const std::string& manifest_path,
                                            const Installation& installation) {
  const fs::path beside = fs::path(manifest_path).parent_path() / ".." / "config";
  return {beside.lexically_normal().string(), installation.share + "/config"};
}

Result<Deployment> load_deployment(const std::string& manifest_path,
                                   const Installation& installation,
                                   const std::vector<Override>& overrides, const std::string& keys,
                                   const std::string& site) {
  const auto contracts = read_contracts(installation.contracts);
  if (!contracts) return Error{contracts.error()};
  auto manifest = read_manifest(manifest_path, config_directories(manifest_path, installation));
  if (!manifest) return Error{manifest.error()};
  if (!keys.empty()) manifest->keys = keys;
  if (!site.empty()) manifest->site_file = site;
  auto deployment = resolve(*manifest, *contracts, overrides);
  judge_keys(*manifest, *contracts, deployment.findings);
  return deployment;
}

Result<Override> parse_override(const std::string& text) {
  const auto equals = text.find('=');
  const auto dot = text.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot == 0 || dot + 1 >= equals ||
      equals + 1 == text.size()) {
    return Error{"expected COMPONENT.PARAMETER=VALUE, got '" + text + "'"};
  }
  return Override{text.substr(0, dot), text.substr(dot + 1, equals - dot - 1),
                  text.substr(equals + 1)};
}

}  // namespace usher::operations
