#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "operations/manifest/manifest.hpp"

namespace usher::operations {

/// What a systemd unit for one host's part of a deployment says.
struct ServiceOptions {
  std::string program;   ///< absolute path of `usher`
  std::string manifest;  ///< absolute path
  std::string host;
  std::string keys;  ///< absolute path; empty = what the manifest says
  std::string user;  ///< empty = root
};

/// A file of a unit directory.
struct ServiceUnit {
  std::string name;  ///< "usher-nuc.service"
  std::string text;
};

/// One unit: `usher launch` for this host, restarted for ever, ended with all its components by the
/// watchdog when the launcher hangs or can no longer keep them running; killed is only what is left
/// of them when the base stands. Its run directory is /var/lib/usher/HOST, so that what is latched
/// stays latched over stops and boots.
ServiceUnit service_unit(const Manifest& manifest, const ServiceOptions& options);

/// The service's side of the sd_notify(3) protocol: datagrams to the socket that $NOTIFY_SOCKET
/// names. Does nothing where no service manager listens.
class ServiceNotifier {
 public:
  /// Reads NOTIFY_SOCKET and WATCHDOG_USEC, and takes them out of the environment that children
  /// get.
  ServiceNotifier();
  ~ServiceNotifier();
  ServiceNotifier(const ServiceNotifier&) = delete;
  ServiceNotifier& operator=(const ServiceNotifier&) = delete;

  void ready();
  void stopping();
  /// Call it often; it tells the watchdog "alive" at a third of its time, only when `healthy`, and
  /// the status line when it has changed.
  void alive(bool healthy, const std::string& status);

 private:
  void send(const std::string& text) const;
  int socket_ = -1;
  std::string path_;
  std::chrono::microseconds watchdog_{};
  std::chrono::steady_clock::time_point told_{};
  std::string status_;
};

}  // namespace usher::operations
