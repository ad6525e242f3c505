#include "operations/host/doctor.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "foundation/cpu/cpu.hpp"
#include "operations/launcher/precedence.hpp"
#include "operations/security/authority.hpp"

namespace usher::operations {

namespace {

namespace fs = std::filesystem;
using Verdict = Diagnosis::Verdict;

/// Closes a descriptor at the end of the scope.
class Socket {
 public:
  explicit Socket(int descriptor) : descriptor_(descriptor) {}
  ~Socket() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

std::string megabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f MB", bytes / (1 << 20));
  return text;
}

/// What a socket is really granted; the kernel cuts silently.
Diagnosis examine_buffer(const std::string& subject, int option, const std::string& setting) {
  const Socket socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  int granted = 0;
  socklen_t size = sizeof(granted);
  if (::setsockopt(socket.get(), SOL_SOCKET, option, &kSocketBuffer, sizeof(kSocketBuffer)) != 0 ||
      ::getsockopt(socket.get(), SOL_SOCKET, option, &granted, &size) != 0)
    return {subject, Verdict::kBad, std::strerror(errno), "a network is needed"};
  granted /= 2;  // Linux reports twice what it granted
  if (granted >= kSocketBuffer) return {subject, Verdict::kGood, megabytes(granted), ""};
  return {subject, Verdict::kBad, megabytes(granted),
          "sysctl -w " + setting + "=" + std::to_string(kSocketBuffer) +
              ", for good `usher install --sysctl`"};
}

Diagnosis examine_sysctl_file() {
  std::ifstream file(kSysctlPath);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  if (text == sysctl_file()) return {"sysctl file", Verdict::kGood, kSysctlPath, ""};
  return {"sysctl file", Verdict::kWarning,
          text.empty() ? std::string(kSysctlPath) + " is not there"
                       : "another " + std::string(kSysctlPath),
          "`usher install --sysctl`, or the buffers shrink at the next boot"};
}

/// Whether a datagram that is sent to the group of DDS discovery out of an interface comes back.
bool multicast_returns(const in_addr& interface) {
  const Socket receiver(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const Socket sender(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_addr.s_addr = htonl(INADDR_ANY);
  socklen_t size = sizeof(group);
  if (::bind(receiver.get(), reinterpret_cast<sockaddr*>(&group), size) != 0 ||
      ::getsockname(receiver.get(), reinterpret_cast<sockaddr*>(&group), &size) != 0)
    return false;
  inet_pton(AF_INET, "239.255.0.1", &group.sin_addr);
  ip_mreq membership{};
  membership.imr_multiaddr = group.sin_addr;
  membership.imr_interface = interface;
  if (::setsockopt(receiver.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership,
                   sizeof(membership)) != 0 ||
      ::setsockopt(sender.get(), IPPROTO_IP, IP_MULTICAST_IF, &interface, sizeof(interface)) != 0)
    return false;
  const char probe[] = "usher doctor";
  if (::sendto(sender.get(), probe, sizeof(probe), 0, reinterpret_cast<const sockaddr*>(&group),
               sizeof(group)) < 0)
    return false;
  pollfd entry{receiver.get(), POLLIN, 0};
  return ::poll(&entry, 1, 200) > 0;
}

void examine_interfaces(std::vector<Diagnosis>& found) {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) {
    found.push_back({"network", Verdict::kBad, std::strerror(errno), "a network is needed"});
    return;
  }
  bool any = false;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET ||
        (entry->ifa_flags & IFF_UP) == 0)
      continue;
    any = true;
    const auto& address = *reinterpret_cast<const sockaddr_in*>(entry->ifa_addr);
    char text[INET_ADDRSTRLEN] = "";
    inet_ntop(AF_INET, &address.sin_addr, text, sizeof(text));
    const std::string subject = "multicast on " + std::string(entry->ifa_name);
    if (multicast_returns(address.sin_addr)) {
      found.push_back({subject, Verdict::kGood, text, ""});
    } else {
      found.push_back({subject, Verdict::kWarning, std::string(text) + ", nothing comes back",
                       "`ip link set " + std::string(entry->ifa_name) +
                           " multicast on`, a firewall, or peers in the manifest"});
    }
  }
  ::freeifaddrs(list);
  if (!any)
    found.push_back(
        {"network", Verdict::kBad, "no interface is up", "`ip link set lo up` at least"});
}

Diagnosis examine_clock() {
  timex state{};
  const int kind = ::adjtimex(&state);
  const auto year = std::chrono::year_month_day(
                        std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now()))
                        .year();
  if (year < std::chrono::year(2024))
    return {"clock", Verdict::kBad, "it is the year " + std::to_string(static_cast<int>(year)),
            "set it: keys are not valid yet"};
  if (kind == TIME_ERROR || (state.status & STA_UNSYNC) != 0)
    return {"clock", Verdict::kWarning, "synchronized with nothing",
            "chrony or systemd-timesyncd; several hosts need the same time"};
  return {"clock", Verdict::kGood,
          "synchronized to " + std::to_string(state.maxerror / 1000) + " ms", ""};
}

Diagnosis examine_shared_memory() {
  const std::string folder = "/dev/shm";
  if (::access(folder.c_str(), W_OK) != 0)
    return {"shared memory", Verdict::kWarning, folder + ": " + std::strerror(errno),
            "others who use it on this machine will not find one another"};
  std::size_t left = 0;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename();
    if (name.find("fastrtps_") != std::string::npos || name.starts_with("fast_datasharing")) ++left;
  }
  if (left == 0) return {"shared memory", Verdict::kGood, "nothing left behind", ""};
  return {"shared memory", Verdict::kGood,
          std::to_string(left) + " files of other Fast DDS programs (Usher leaves none)", ""};
}

Diagnosis examine_run_directory(const std::string& directory) {
  // The next folder that exists decides whether it can be made.
  fs::path folder = directory;
  std::error_code ignored;
  while (!folder.empty() && folder != folder.root_path() && !fs::exists(folder, ignored))
    folder = folder.parent_path();
  if (::access(folder.c_str(), W_OK) != 0)
    return {"run directory", Verdict::kBad, folder.string() + ": " + std::strerror(errno),
            "another --run-directory, or the rights for it"};
  constexpr double kEnough = 200.0 * (1 << 20);
  struct statvfs disk {};
  ::statvfs(folder.c_str(), &disk);
  const double free = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
  if (free < kEnough)
    return {"run directory", Verdict::kWarning, directory + ", " + megabytes(free) + " free",
            "logs and memories need " + megabytes(kEnough)};
  return {"run directory", Verdict::kGood, directory, ""};
}

Diagnosis examine_devices() {
  std::string refused;
  std::size_t count = 0;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/dev", ignored)) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("ttyUSB") && !name.starts_with("ttyACM")) continue;
    ++count;
    if (::access(entry.path().c_str(), R_OK | W_OK) != 0) refused += " " + name;
  }
  if (!refused.empty())
    return {"serial devices", Verdict::kBad, "no right to use" + refused,
            "usermod -aG dialout USER"};
  return {"serial devices", Verdict::kGood,
          count == 0 ? "none plugged in" : std::to_string(count) + " usable", ""};
}

Diagnosis examine_limits() {
  rlimit files{};
  ::getrlimit(RLIMIT_NOFILE, &files);
  if (files.rlim_cur < 1024)
    return {"open files", Verdict::kWarning, std::to_string(files.rlim_cur), "ulimit -n 4096"};
  return {"open files", Verdict::kGood, std::to_string(files.rlim_cur), ""};
}

/// `usher launch` goes on without, and says so.
Diagnosis examine_precedence() {
  const bool first = may_go_first(), real_time = may_run_in_real_time();
  if (first && real_time)
    return {"precedence", Verdict::kGood,
            "the drive chain may go first, and real time is permitted", ""};
  std::string missing, lines;
  if (!first) missing = "no right to go before other programs", lines = "`USER - nice -11`";
  if (!real_time) {
    missing +=
        (missing.empty() ? "" : ", ") + std::string("no real time (two processors at least)");
    lines += (lines.empty() ? "" : " and ") + std::string("`USER - rtprio 11`");
  }
  return {"precedence", Verdict::kWarning, missing,
          lines + " in /etc/security/limits.d/usher.conf, then a new login"};
}

Diagnosis examine_processor() {
  const long cores = ::sysconf(_SC_NPROCESSORS_ONLN);
  constexpr const char* kSets[] = {"no SIMD", "SSE4.1", "AVX2"};
  const std::string found =
      std::to_string(cores) + " cores, " + kSets[static_cast<int>(cpu::best_simd())];
  if (cores < 2) return {"processor", Verdict::kWarning, found, "two cores carry a whole robot"};
  return {"processor", Verdict::kGood, found, ""};
}

std::string content(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

Diagnosis examine_identity(const fs::path& folder, const std::string& authority) {
  const std::string name = folder.filename();
  const std::string subject = "keys of " + name;
  struct stat key {};
  if (::stat((folder / "key.pem").c_str(), &key) != 0)
    return {subject, Verdict::kBad, "no key.pem", "`usher keys` makes it"};
  if ((key.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return {subject, Verdict::kBad, "others may read key.pem", "chmod 600"};
  if (const auto status = verify_certificate(content(folder / "certificate.pem"), authority, name);
      !status)
    return {subject, Verdict::kBad, status.error(), "`usher keys --renew`, or the right ca.pem"};
  if (const auto document = verify_document(content(folder / "permissions.smime"), authority);
      !document)
    return {subject, Verdict::kBad, "permissions: " + document.error(), "`usher keys` signs anew"};
  return {subject, Verdict::kGood, "valid", ""};
}

}  // namespace

std::string to_string(Diagnosis::Verdict verdict) {
  switch (verdict) {
    case Verdict::kGood:
      return "good";
    case Verdict::kWarning:
      return "warning";
    case Verdict::kBad:
      return "bad";
  }
  return "?";
}

std::string sysctl_file() {
  const std::string bytes = std::to_string(kSocketBuffer);
  return "# UDP buffers for Usher: a depth image or a map is larger than the default of 208 kB.\n"
         "net.core.rmem_max = " +
         bytes + "\nnet.core.wmem_max = " + bytes + "\n";
}

std::vector<Diagnosis> examine_host(const std::string& run_directory) {
  std::vector<Diagnosis> found;
  found.push_back(examine_buffer("receive buffer", SO_RCVBUF, "net.core.rmem_max"));
  found.push_back(examine_buffer("send buffer", SO_SNDBUF, "net.core.wmem_max"));
  found.push_back(examine_sysctl_file());
  examine_interfaces(found);
  found.push_back(examine_clock());
  found.push_back(examine_shared_memory());
  found.push_back(examine_run_directory(run_directory));
  found.push_back(examine_devices());
  found.push_back(examine_limits());
  found.push_back(examine_precedence());
  found.push_back(examine_processor());
  return found;
}

std::vector<Diagnosis> examine_keys(const std::string& folder) {
  std::vector<Diagnosis> found;
  const std::string authority = content(fs::path(folder) / "ca.pem");
  if (authority.empty())
    return {{"keys", Verdict::kBad, "no " + folder + "/ca.pem", "`usher keys` makes them"}};
  if (!verify_document(content(fs::path(folder) / "governance.smime"), authority))
    found.push_back(
        {"governance", Verdict::kBad, "not signed by the CA", "`usher keys` signs anew"});
  if (fs::exists(fs::path(folder) / "ca.key"))
    found.push_back({"key of the CA", Verdict::kWarning, folder + "/ca.key",
                     "keep it off the robot: who has it can make any identity"});
  std::set<fs::path> identities;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.is_directory(ignored)) identities.insert(entry.path());
  }
  for (const auto& path : identities) found.push_back(examine_identity(path, authority));
  return found;
}

}  // namespace usher::operations
