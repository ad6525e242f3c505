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

/// Reads, resolves and judges. Fails only when there is no manifest to judge. `keys` stands for the
/// manifest's `security:`, the file `site` for its site, where they are not empty.
Result<Deployment> load_deployment(const std::string& manifest_path,
                                   const Installation& installation,
                                   const std::vector<Override>& overrides,
                                   const std::string& keys = {}, const std::string& site = {});

/// `amcl.max_beams=60`
Result<Override> parse_override(const std::string& text);

}  // namespace usher::operations
