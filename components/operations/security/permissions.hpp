#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// What one identity may do in one DDS domain. Topics by their names on the wire ("rt/scan").
struct Permissions {
  std::string name;  ///< of the participant; its certificate is that of subject_of(name)
  std::uint32_t domain = 0;
  std::set<std::string> write, read;  ///< "*" in `read` = everything
};

/// Who the operator's programs are, whatever they are called: goto, status, topics, map ...
inline constexpr const char* kOperator = "operator";
/// Who `usher launch` is.
inline constexpr const char* kLauncher = "launcher";

/// Who the discovery server is, where the manifest has one.
inline constexpr const char* kDiscoveryServer = "discovery_server";

/// Of every component of a manifest: what its contract declares, no more. Of the operator: all
/// reading, and writing what the topic catalogue gives it. Of the launcher: all reading. Components
/// whose type has no contract are left out.
std::vector<Permissions> permissions_of(const Manifest& manifest, const Contracts& contracts);

/// The document of DDS-Security 1.1 (9.4.1.3), valid from yesterday for `days`.
std::string permissions_document(const Permissions& permissions, int days);
/// What such a document of ours says; the name is that of its subject. Fails when it is none.
Result<Permissions> read_permissions(const std::string& document);

/// The document of DDS-Security 1.1 (9.4.1.2) for a domain: nobody without identity, every RTPS
/// message signed, every topic under the permissions.
std::string governance_document(std::uint32_t domain);

}  // namespace usher::operations
