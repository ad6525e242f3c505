#include "operations/launcher/run_places.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <string_view>

namespace usher::operations {

namespace {

constexpr const char* kServiceDirectory = "/run/usher";  // RuntimeDirectory of the units

bool directory_of_mine(const std::string& path) {
  struct stat facts {};
  return lstat(path.c_str(), &facts) == 0 && S_ISDIR(facts.st_mode) && facts.st_uid == geteuid();
}

/// Where this user's deployments keep their locks, until a boot.
std::string runtime_directory() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && *runtime != '\0') return std::string(runtime) + "/usher";
  const std::string user = std::to_string(geteuid());
  if (directory_of_mine("/run/user/" + user)) return "/run/user/" + user + "/usher";
  return "/tmp/usher-" + user;
}

/// Where what they remember outlives a boot; without a home it cannot.
std::string state_directory() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state != '\0') return std::string(state) + "/usher";
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0') return std::string(home) + "/.local/state/usher";
  return runtime_directory();
}

std::string operator_file_of(std::uint32_t domain) {
  return "/domain-" + std::to_string(domain) + "-operator.yaml";
}

/// Of the name of a launcher's lock; nothing: it is no such name.
std::optional<std::uint32_t> domain_of_lock(const std::string& name) {
  constexpr std::string_view kBefore = "domain-", kAfter = ".lock";
  if (!name.starts_with(kBefore) || !name.ends_with(kAfter)) return std::nullopt;
  std::uint32_t domain = 0;
  const auto read =
      std::from_chars(name.data() + kBefore.size(), name.data() + name.size(), domain);
  if (read.ec != std::errc() || *read.ptr != '-') return std::nullopt;
  return domain;
}

/// Whether the process lives that wrote its number into a lock: a launcher that was killed leaves
/// its files. To try the lock itself could refuse it to one who starts now. A service's lock, which
/// its user alone may read, counts as held.
bool holder_lives(const std::string& lock) {
  if (access(lock.c_str(), R_OK) != 0) return errno == EACCES;
  pid_t pid = 0;
  std::ifstream(lock) >> pid;
  return pid > 0 && (kill(pid, 0) == 0 || errno == EPERM);
}

/// What the kernel calls the time since the machine started.
std::string boot() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  file >> id;
  return id;
}

}  // namespace

Status make_lock_directory() {
  const std::string path = runtime_directory();
  if (mkdir(path.c_str(), 0700) != 0 && errno != EEXIST)
    return Error{"cannot write " + path + ": " + std::strerror(errno)};
  struct stat facts {};
  if (lstat(path.c_str(), &facts) != 0 || !directory_of_mine(path))
    return Error{path + " must be a directory of this user, and is not"};
  if (!path.starts_with("/tmp/") || (facts.st_mode & 077) == 0) return {};
  if ((facts.st_mode & 022) != 0)
    return Error{path + " must be writable by this user alone, and others may write there"};
  if (chmod(path.c_str(), 0700) != 0)
    return Error{"cannot close " + path + " to others: " + std::strerror(errno)};
  return {};
}

std::string launcher_lock(std::uint32_t domain, const std::string& host) {
  return runtime_directory() + "/domain-" + std::to_string(domain) + "-" + host + ".lock";
}

Result<int> take_lock(const std::string& path) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file < 0) return Error{"cannot write " + path + ": " + std::strerror(errno)};
  if (flock(file, LOCK_EX | LOCK_NB) != 0) {
    std::ifstream holder(path);
    std::string pid;
    holder >> pid;
    close(file);
    return Error{"this robot is already launched here, by process " + pid + " (" + path + ")"};
  }
  const std::string text = std::to_string(getpid()) + "\n" + boot() + "\n";
  if (ftruncate(file, 0) != 0 ||
      write(file, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
    const std::string reason = std::strerror(errno);
    close(file);
    return Error{"cannot write " + path + ": " + reason};
  }
  return file;
}

bool written_since_boot(const std::string& lock_file) {
  std::ifstream file(lock_file);
  std::string pid;
  std::string id;
  return file >> pid >> id && id == boot();
}

std::string default_run_directory(std::uint32_t domain, const std::string& host) {
  return state_directory() + "/domain-" + std::to_string(domain) + (host.empty() ? "" : "-" + host);
}

std::vector<std::string> operator_files(std::uint32_t domain) {
  const std::string name = operator_file_of(domain);
  return {runtime_directory() + name, kServiceDirectory + name};
}

std::vector<std::uint32_t> launched_domains() {
  std::set<std::uint32_t> domains;
  for (const std::string& directory : {runtime_directory(), std::string(kServiceDirectory)}) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
      const auto domain = domain_of_lock(entry.path().filename());
      if (domain && holder_lives(entry.path()) &&
          access((directory + operator_file_of(*domain)).c_str(), F_OK) == 0)
        domains.insert(*domain);
    }
  }
  return {domains.begin(), domains.end()};
}

}  // namespace usher::operations
