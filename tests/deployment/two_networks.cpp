#include "deployment/two_networks.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_packet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <map>
#include <random>

namespace usher::test {

namespace {

using Clock = std::chrono::steady_clock;

/// True when the command did what it should; its errors else.
bool run(std::vector<std::string> words, std::string* why = nullptr) {
  Process command(std::move(words));
  const bool good = command.wait() == 0;
  if (!good && why != nullptr) *why = command.errors();
  return good;
}

std::vector<std::string> ip(std::initializer_list<std::string> words) {
  std::vector<std::string> all{"/usr/sbin/ip"};
  all.insert(all.end(), words);
  return all;
}

/// All frames of an interface, as they are and can be sent again: unfinished checksums included.
int open_interface(const std::string& name) {
  const int socket = ::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, htons(ETH_P_ALL));
  const int on = 1;
  const int buffer = 8 << 20;
  ::setsockopt(socket, SOL_PACKET, PACKET_VNET_HDR, &on, sizeof(on));
  ::setsockopt(socket, SOL_SOCKET, SO_RCVBUFFORCE, &buffer, sizeof(buffer));
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_ALL);
  address.sll_ifindex = static_cast<int>(if_nametoindex(name.c_str()));
  if (address.sll_ifindex == 0 ||
      ::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    ::close(socket);
    return -1;
  }
  return socket;
}

}  // namespace

TwoNetworks::TwoNetworks(Kind kind) : kind_(kind) {
  static int count = 0;
  const std::string stem = "usher" + std::to_string(::getpid()) + "-" + std::to_string(++count);
  names_[0] = stem + "a";
  names_[1] = stem + "b";
  names_[2] = stem + "m";
}

std::string TwoNetworks::address(int side) const {
  if (kind_ == Kind::kOneSubnet) return side == 0 ? "10.77.0.1" : "10.77.0.2";
  return side == 0 ? "10.77.1.2" : "10.77.2.2";
}

std::unique_ptr<TwoNetworks> TwoNetworks::create(Kind kind, std::string& why) {
  if (::access("/usr/sbin/ip", X_OK) != 0) {
    why = "no /usr/sbin/ip (package iproute2)";
    return nullptr;
  }
  std::unique_ptr<TwoNetworks> made(new TwoNetworks(kind));
  const std::string& middle = made->names_[2];
  for (const auto& name : made->names_) {
    if (!run(ip({"netns", "add", name}), &why)) return nullptr;
    run(ip({"-n", name, "link", "set", "lo", "up"}));
  }
  for (int side = 0; side < 2; ++side) {
    const std::string& name = made->names_[side];
    const std::string port = "port" + std::to_string(side);
    const std::string own = made->address(side);
    if (!run(ip({"-n", middle, "link", "add", port, "type", "veth", "peer", "name", "eth0", "netns",
                 name}),
             &why))
      return nullptr;
    run(ip({"-n", name, "addr", "add", own + "/24", "dev", "eth0"}));
    run(ip({"-n", name, "link", "set", "eth0", "up"}));
    run(ip({"-n", middle, "link", "set", port, "up"}));
    if (kind == Kind::kRouted) {
      const std::string router = "10.77." + std::to_string(side + 1) + ".1";
      run(ip({"-n", middle, "addr", "add", router + "/24", "dev", port}));
      run(ip({"-n", name, "route", "add", "default", "via", router}));
    }
  }
  if (kind == Kind::kRouted) {
    bool forwards = false;
    within(middle, [&] {
      const int file = ::open("/proc/sys/net/ipv4/ip_forward", O_WRONLY | O_CLOEXEC);
      forwards = file >= 0 && ::write(file, "1", 1) == 1;
      if (file >= 0) ::close(file);
    });
    if (!forwards) {
      why = "no right to forward between namespaces";
      return nullptr;
    }
    return made;
  }
  within(middle, [&] {
    for (int side = 0; side < 2; ++side)
      made->sockets_[side] = open_interface("port" + std::to_string(side));
  });
  if (made->sockets_[0] < 0 || made->sockets_[1] < 0) {
    why = "no right to play a cable";
    return nullptr;
  }
  made->player_ = std::thread([network = made.get()] { network->play(); });
  return made;
}

TwoNetworks::~TwoNetworks() {
  stop_ = true;
  if (player_.joinable()) player_.join();
  for (const int socket : sockets_) {
    if (socket >= 0) ::close(socket);
  }
  for (const auto& name : names_) run(ip({"netns", "del", name}));
}

void TwoNetworks::set(const Line& from_a, const Line& from_b) {
  const std::lock_guard lock(mutex_);
  lines_[0] = from_a;
  lines_[1] = from_b;
}

void TwoNetworks::play() {
  struct Frame {
    int to;
    std::vector<std::uint8_t> bytes;
  };
  constexpr std::size_t kMostWaiting = 10'000;
  std::multimap<Clock::time_point, Frame> waiting;
  std::mt19937 random(1);
  std::vector<std::uint8_t> buffer(1 << 17);
  while (!stop_) {
    std::array<pollfd, 2> ports{{{sockets_[0], POLLIN, 0}, {sockets_[1], POLLIN, 0}}};
    timespec patience{0, 2'000'000};
    if (!waiting.empty()) {
      const auto rest = waiting.begin()->first - Clock::now();
      patience.tv_nsec = std::clamp<long>(rest.count(), 0, 2'000'000);
    }
    ::ppoll(ports.data(), ports.size(), &patience, nullptr);
    for (int side = 0; side < 2; ++side) {
      sockaddr_ll from{};
      socklen_t size = sizeof(from);
      for (int i = 0; i < 256; ++i) {
        const ssize_t got = ::recvfrom(sockets_[side], buffer.data(), buffer.size(), 0,
                                       reinterpret_cast<sockaddr*>(&from), &size);
        if (got <= 0) break;
        if (from.sll_pkttype == PACKET_OUTGOING) continue;  // what this thread sent
        Line line;
        {
          const std::lock_guard lock(mutex_);
          line = lines_[side];
        }
        const double chance = std::uniform_real_distribution<double>(0.0, 1.0)(random);
        if (line.cut || chance < line.loss || waiting.size() >= kMostWaiting) continue;
        auto due = Clock::now() + line.delay;
        if (line.jitter.count() > 0)
          due +=
              std::chrono::microseconds(random() % static_cast<std::uint64_t>(line.jitter.count()));
        waiting.emplace(due, Frame{1 - side, {buffer.begin(), buffer.begin() + got}});
      }
    }
    while (!waiting.empty() && waiting.begin()->first <= Clock::now()) {
      const Frame& frame = waiting.begin()->second;
      static_cast<void>(
          !::send(sockets_[frame.to], frame.bytes.data(), frame.bytes.size(), MSG_DONTWAIT));
      ++frames_;
      waiting.erase(waiting.begin());
    }
  }
}

std::unique_ptr<Process> TwoNetworks::start(const std::string& network,
                                            std::vector<std::string> words) {
  const std::vector<std::string> prefix{"/usr/sbin/ip", "netns", "exec", network};
  words.insert(words.begin(), prefix.begin(), prefix.end());
  return std::make_unique<Process>(std::move(words));
}

void TwoNetworks::within(const std::string& network, const std::function<void()>& function) {
  std::thread([&] {
    const int handle = ::open(("/run/netns/" + network).c_str(), O_RDONLY | O_CLOEXEC);
    const bool entered = handle >= 0 && ::setns(handle, CLONE_NEWNET) == 0;
    if (handle >= 0) ::close(handle);
    assert(entered);
    static_cast<void>(entered);
    function();
  }).join();
}

}  // namespace usher::test
