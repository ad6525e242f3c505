#include "operations/host/service.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace usher::operations {

namespace {

constexpr const char* kStateDirectory = "/var/lib/usher/";  // StateDirectory=usher

/// As a word of ExecStart=: systemd expands % and $ and splits at blanks.
std::string word(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '%' || c == '$') out += c;
    out += c;
  }
  return out + "\"";
}

}  // namespace

ServiceUnit service_unit(const Manifest& manifest, const ServiceOptions& options) {
  std::ostringstream out;
  out << "# Made by `usher install --systemd`.\n[Unit]\nDescription=Usher: " << manifest.name
      << " on " << options.host
      << "\nWants=network-online.target time-sync.target\n"
         "After=network-online.target time-sync.target\n"
         "# A robot that cannot start goes on trying.\nStartLimitIntervalSec=0\n\n"
      << "[Service]\nType=notify\nNotifyAccess=main\nExecStart=" << word(options.program)
      << " launch " << word(options.manifest) << " --host " << word(options.host)
      << " --run-directory " << word(std::string(kStateDirectory) + options.host);
  if (!options.keys.empty()) out << " --keys " << word(options.keys);
  out << "\n# The launcher stops its components in order. When it is gone without having done so, "
         "they and the\n"
         "# guards of the devices' lines are told to end themselves, and are not killed before the "
         "base stands.\n"
         "ExecStop=/bin/sh -c \"kill -TERM $$MAINPID; while kill -0 $$MAINPID; do sleep 0.05; "
         "done\"\n"
         "KillMode=control-group\nTimeoutStopSec=20\nTimeoutStartSec=30\n"
         "Restart=always\nRestartSec=200ms\n"
         "# The launcher says that it lives while it can keep its components running. When it does "
         "not, all are told\n"
         "# to end: the guard of the base's line ends after its driver, with a zero. What is left "
         "is killed once\n"
         "# the base stands: it rolls out for 2.5 s at most.\n"
         "WatchdogSec=5\nWatchdogSignal=SIGTERM\nTimeoutAbortSec=3\n"
         "RuntimeDirectory=usher\nRuntimeDirectoryPreserve=restart\n"
         "# What must outlive a stop and a boot lies here: an emergency stop holds until it is "
         "cleared.\n"
         "StateDirectory=usher\nEnvironment=XDG_RUNTIME_DIR=/run\n"
         "# Without them the drive chain of a user other than root would wait for other programs, "
         "and nothing would\n"
         "# run in real time.\n"
         "LimitNICE=31\nLimitRTPRIO=10\nLimitNOFILE=4096\nLimitCORE=0\nUMask=0077\nNoNewPrivileges="
         "true\n";
  if (!options.user.empty())
    out << "User=" << options.user << "\nSupplementaryGroups=dialout input audio video\n";
  out << "\n[Install]\nWantedBy=multi-user.target\n";
  return {"usher-" + options.host + ".service", out.str()};
}

ServiceNotifier::ServiceNotifier() {
  if (const char* path = std::getenv("NOTIFY_SOCKET"); path != nullptr) path_ = path;
  if (const char* limit = std::getenv("WATCHDOG_USEC"); limit != nullptr) {
    long long microseconds = 0;
    std::from_chars(limit, limit + std::strlen(limit), microseconds);
    watchdog_ = std::chrono::microseconds(microseconds);
  }
  for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  if (!path_.empty()) socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
}

ServiceNotifier::~ServiceNotifier() {
  if (socket_ >= 0) ::close(socket_);
}

void ServiceNotifier::send(const std::string& text) const {
  sockaddr_un address{};
  if (socket_ < 0 || path_.size() >= sizeof(address.sun_path)) return;
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path_.data(), path_.size());
  if (path_[0] == '@') address.sun_path[0] = '\0';  // an abstract socket
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path_.size());
  // Nobody listens any more: the service goes on all the same.
  static_cast<void>(::sendto(socket_, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                             reinterpret_cast<const sockaddr*>(&address), size));
}

void ServiceNotifier::ready() { send("READY=1"); }
void ServiceNotifier::stopping() { send("STOPPING=1"); }

void ServiceNotifier::alive(bool healthy, const std::string& status) {
  const auto now = std::chrono::steady_clock::now();
  if (status != status_) send("STATUS=" + status);
  status_ = status;
  if (!healthy || watchdog_.count() == 0 || now - told_ < watchdog_ / 3) return;
  told_ = now;
  send("WATCHDOG=1");
}

}  // namespace usher::operations
