#pragma once

#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// Where this program finds its company. A build tree runs like an installed one: bin/ beside
/// share/usher/.
struct Installation {
  std::string programs;   ///< usher-<type>
  std::string contracts;  ///< <type>.yaml
  std::string share;      ///< config/, deploy/, idl/

  static Installation of_this_program();
};

/// Where a manifest's robot and site are looked for: beside its folder (deploy/x.yaml and config/),
/// then where the installed ones are.
std::vector<std::string> config_directories(const std::string& manifest_path,
                                            const Installation& installation);

/// Reads, resolves and judges. Fails only when there is no manifest to judge.
Result<Deployment> load_deployment(const std::string& manifest_path,
                                   const Installation& installation,
                                   const std::vector<Override>& overrides);

/// `amcl.max_beams=60`
Result<Override> parse_override(const std::string& text);

/// Where a deployment runs on this machine by default: one place for each user and DDS domain, so
/// that a second launch of the same robot is noticed.
std::string default_run_directory(std::uint32_t domain, const std::string& host);

}  // namespace usher::operations
