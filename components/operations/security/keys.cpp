#include "operations/security/keys.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "operations/security/authority.hpp"

namespace usher::operations {

namespace {

namespace fs = std::filesystem;

constexpr mode_t kPrivate = 0600;
constexpr mode_t kPublic = 0644;

/// All or nothing: a reader sees the old file or the new one.
Status write_file(const std::string& path, const std::string& text, mode_t mode) {
  const std::string fresh = path + ".new";
  ::unlink(fresh.c_str());
  const int file = ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  bool good = file >= 0;
  for (std::size_t done = 0; good && done < text.size();) {
    const ssize_t written = ::write(file, text.data() + done, text.size() - done);
    good = written > 0;
    if (good) done += static_cast<std::size_t>(written);
  }
  good = good && ::fsync(file) == 0;
  const int error = errno;
  if (file >= 0) ::close(file);
  if (good && ::rename(fresh.c_str(), path.c_str()) == 0) return {};
  ::unlink(fresh.c_str());
  return Error{"cannot write " + path + ": " + std::strerror(good ? errno : error)};
}

Result<std::string> read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(file), {});
  if (!file.is_open() || file.bad())
    return Error{"cannot read " + path + ": " + std::strerror(errno)};
  return text;
}

Status make_folder(const std::string& path, fs::perms permissions) {
  std::error_code error;
  const bool made = fs::create_directories(path, error);
  if (!error && made) fs::permissions(path, permissions, error);
  if (error) return Error{"cannot make the folder " + path + ": " + error.message()};
  return {};
}

/// The CA of the folder, made when there is none.
Result<Authority> authority_of(const std::string& folder, const std::string& robot,
                               const KeysOptions& options, bool& made) {
  const std::string certificate = folder + "/ca.pem";
  const std::string key = folder + "/ca.key";
  made = options.renew || !has_keys(folder);
  if (!made) {
    const auto public_part = read_file(certificate);
    if (!public_part) return Error{public_part.error()};
    const auto private_part = read_file(key);
    if (!private_part)
      return Error{private_part.error() + " (the CA's key must be here to sign for others)"};
    auto loaded = Authority::load({*public_part, *private_part});
    if (!loaded) return Error{loaded.error() + " (" + folder + ")"};
    return loaded;
  }
  auto authority = Authority::create(robot + " CA", options.days);
  if (!authority) return authority;
  const auto pair = authority->pair();
  if (!pair) return Error{pair.error()};
  if (auto status = write_file(key, pair->key, kPrivate); !status) return Error{status.error()};
  if (auto status = write_file(certificate, pair->certificate, kPublic); !status)
    return Error{status.error()};
  return authority;
}

Status write_signed(const Authority& authority, const std::string& path,
                    const std::string& document) {
  const auto text = authority.sign(document);
  if (!text) return Error{text.error()};
  return write_file(path, *text, kPublic);
}

Result<KeysEntry> make_identity(const Authority& authority, const std::string& folder,
                                const Permissions& identity, const KeysOptions& options,
                                bool all_new) {
  KeysEntry entry{.name = identity.name, .made = true};
  const std::string own = folder + "/" + identity.name;
  if (auto status = make_folder(own, fs::perms::owner_all); !status) return Error{status.error()};
  std::error_code ignored;
  entry.made = all_new || !fs::exists(own + "/certificate.pem", ignored) ||
               !fs::exists(own + "/key.pem", ignored);
  if (entry.made) {
    const auto pair = authority.issue(identity.name, options.days);
    if (!pair) return Error{pair.error()};
    if (auto status = write_file(own + "/key.pem", pair->key, kPrivate); !status)
      return Error{status.error()};
    if (auto status = write_file(own + "/certificate.pem", pair->certificate, kPublic); !status)
      return Error{status.error()};
  }
  if (auto status = write_signed(authority, own + "/permissions.smime",
                                 permissions_document(identity, options.days));
      !status)
    return Error{status.error()};
  return entry;
}

std::string listed(const std::set<std::string>& topics) {
  std::string text;
  for (const auto& topic : topics)
    text += (text.empty() ? "" : ", ") + topic.substr(topic.starts_with("rt/") ? 3 : 0);
  return text;
}

/// What `wanted` has and `given` has not.
std::set<std::string> missing(const std::set<std::string>& wanted,
                              const std::set<std::string>& given) {
  std::set<std::string> rest;
  if (given.contains("*")) return rest;
  std::set_difference(wanted.begin(), wanted.end(), given.begin(), given.end(),
                      std::inserter(rest, rest.end()));
  return rest;
}

/// What is wrong with one identity, in words; empty = nothing.
std::string complaint(const Permissions& wanted, const std::string& folder,
                      const std::string& authority) {
  const std::string own = folder + "/" + wanted.name;
  const auto certificate = read_file(own + "/certificate.pem");
  if (!certificate) return certificate.error();
  if (auto status = verify_certificate(*certificate, authority, wanted.name); !status)
    return status.error() + " (" + own + "/certificate.pem)";
  const auto smime = read_file(own + "/permissions.smime");
  if (!smime) return smime.error();
  const std::string where = " (" + own + "/permissions.smime)";
  const auto document = verify_document(*smime, authority);
  if (!document) return document.error() + where;
  const auto given = read_permissions(*document);
  if (!given) return given.error() + where;
  if (given->name != wanted.name) return "these permissions are of '" + given->name + "'" + where;
  if (given->domain != wanted.domain)
    return "'" + wanted.name + "' has permissions for domain " + std::to_string(given->domain) +
           ", not for " + std::to_string(wanted.domain) + where;
  if (const auto rest = missing(wanted.write, given->write); !rest.empty())
    return "'" + wanted.name + "' may not write " + listed(rest) + where;
  if (const auto rest = missing(wanted.read, given->read); !rest.empty())
    return "'" + wanted.name + "' may not read " + listed(rest) + where;
  // More than the contract asks for is a hole, above all on drive/command.
  if (const auto extra = missing(given->write, wanted.write); !extra.empty())
    return "'" + wanted.name + "' may write " + listed(extra) +
           ", which its contract does not list" + where;
  return {};
}

}  // namespace

bool has_keys(const std::string& folder) {
  std::error_code ignored;
  return fs::exists(folder + "/ca.pem", ignored) || fs::exists(folder + "/ca.key", ignored);
}

Result<std::vector<KeysEntry>> make_keys(const std::string& folder, const std::string& robot,
                                         const std::vector<Permissions>& identities,
                                         const KeysOptions& options) {
  if (identities.empty()) return Error{"there is nobody to make keys for"};
  if (auto status = make_folder(folder, fs::perms::owner_all); !status)
    return Error{status.error()};
  std::vector<KeysEntry> entries;
  bool new_authority = false;
  const auto authority = authority_of(folder, robot, options, new_authority);
  if (!authority) return Error{authority.error()};
  entries.push_back({"ca", new_authority});
  if (auto status = write_signed(*authority, folder + "/governance.smime",
                                 governance_document(identities.front().domain));
      !status)
    return Error{status.error()};
  for (const auto& identity : identities) {
    auto entry = make_identity(*authority, folder, identity, options, new_authority);
    if (!entry) return Error{entry.error()};
    entries.push_back(std::move(entry).value());
  }
  return entries;
}

void judge_keys(const Manifest& manifest, const Contracts& contracts,
                std::vector<Finding>& findings) {
  if (manifest.keys.empty()) return;
  const auto authority = read_file(manifest.keys + "/ca.pem");
  if (!authority) {
    findings.push_back({Verdict::kMissingFile,
                        authority.error() + "; `usher keys` makes the keys of a manifest",
                        manifest.origin_of("security")});
    return;
  }
  std::error_code ignored;
  const auto has_identity = [&](const std::string& name) {
    return fs::exists(manifest.keys + "/" + name, ignored);
  };
  std::set<std::string> hosts_with_keys;
  for (const auto& component : manifest.components) {
    if (has_identity(component.name)) hosts_with_keys.insert(component.host);
  }
  std::vector<Finding> refused;
  std::size_t judged = 0;
  for (const auto& wanted : permissions_of(manifest, contracts)) {
    const auto* component = manifest.component(wanted.name);
    const std::string host = component != nullptr              ? component->host
                             : wanted.name == kDiscoveryServer ? manifest.discovery_server.host
                                                               : "";
    // Each host has a launcher; an operator's commands may come from another one.
    const bool elsewhere = host.empty()
                               ? wanted.name != kLauncher
                               : !hosts_with_keys.empty() && !hosts_with_keys.contains(host);
    if (!has_identity(wanted.name) && elsewhere) continue;
    ++judged;
    const std::string text = complaint(wanted, manifest.keys, *authority);
    if (text.empty()) continue;
    refused.push_back({Verdict::kNoPermission, text,
                       component != nullptr ? component->origin : manifest.origin_of("security")});
  }
  if (judged > 1 && refused.size() == judged) {
    findings.push_back({Verdict::kNoPermission,
                        "none of the " + std::to_string(judged) + " keys in " + manifest.keys +
                            " is one of this manifest; the first: " + refused.front().text,
                        manifest.origin_of("security")});
  } else {
    findings.insert(findings.end(), refused.begin(), refused.end());
  }
  const std::string governance = manifest.keys + "/governance.smime";
  const auto holds = read_file(governance);
  if (!holds || !verify_document(*holds, *authority)) {
    findings.push_back({Verdict::kNoPermission,
                        (holds ? governance + " is not signed by the CA" : holds.error()) +
                            ", so that nobody starts; `usher keys` signs it anew",
                        manifest.origin_of("security")});
  }
}

}  // namespace usher::operations
